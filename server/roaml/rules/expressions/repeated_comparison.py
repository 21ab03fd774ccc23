# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-comparison`, which repeated_comparison.md describes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.infer import constant
from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Expr, Unary
from roaml.model.values.analyse import ChartValues
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.alternatives import alternatives, joined
from roaml.text import Span

MIN_ALTERNATIVES = 4
"""How many alternatives must compare a place before a repeated number is suspicious."""


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        values = context.values.charts.get(chart.scope)
        reported: set[Span] = set()
        for group in alternatives(context.machine, chart):
            for place, compared in _compared(group).items() if len(group) >= MIN_ALTERNATIVES else ():
                finding = _repeated(place, compared, values) if len(compared) == len(group) else None
                if finding is not None and finding.span not in reported:
                    reported.add(finding.span)
                    yield finding


class _Comparison(NamedTuple):
    """A place and the integer with which an alternative compares it, and all parts of the alternative."""

    number: int
    literal: Expr
    place: Expr
    parts: Sequence[Expr]


def _compared(group: Sequence[Expr]) -> Mapping[str, Sequence[_Comparison]]:
    """Place -> the integers with which the alternatives compare it, joined with `&&` with something else. The
    alternatives must join equally many conditions: if only some test more, one number may have several cases."""
    compared: dict[str, list[_Comparison]] = {}
    parts = [joined(tree, Operator.AND) for tree in group]
    if len({len(part) for part in parts}) != 1 or len(parts[0]) < 2:
        return compared  # if nothing else is tested, shadowed-branch and shadowed-transition report the second one
    for in_one, part in ((alternative, part) for alternative in parts for part in alternative):
        if isinstance(part, Binary) and part.operator is Operator.EQUAL:
            for tested, literal in ((part.left, part.right), (part.right, part.left)):
                place, number = place_of(tested), constant(literal)
                if place is not None and isinstance(number, int):
                    compared.setdefault(place, []).append(_Comparison(number, literal, tested, in_one))
    return compared


def _repeated(place: str, compared: Sequence[_Comparison], values: ChartValues | None) -> Finding | None:
    numbers = [comparison.number for comparison in compared]
    twice = [number for number, count in Counter(numbers).items() if count > 1]
    if len(twice) != 1 or len(set(numbers)) != len(numbers) - 1:
        return None
    one, other = (comparison for comparison in compared if comparison.number == twice[0])
    if _are_cases(one.parts, other.parts):
        return None
    for first in (0, 1):
        missing = set(range(first, first + len(numbers))) - set(numbers)
        if len(missing) == 1 and set(numbers) <= set(range(first, first + len(numbers))):
            (number,) = missing
            if min(numbers) < number < max(numbers) or _is_known(compared, number, values):
                return _finding(place, compared, twice[0], number)
    return None


def _are_cases(parts: Sequence[Expr], others: Sequence[Expr]) -> bool:
    """Whether two alternatives exclude each other, because they compare a place with different numbers, or one needs
    the opposite of what the other needs: they are two cases of the repeated number."""
    equal, needed = dict(map(_needed, parts)), dict(map(_needed, others))
    return any(place is not None and needed.get(place, value) != value for place, value in equal.items())


def _needed(part: Expr) -> tuple[str | None, object]:
    """The place of which a part of a condition needs a value, and this value."""
    if isinstance(part, Unary) and part.operator is UnaryOperator.NOT:
        return place_of(part.operand), False
    if isinstance(part, Binary) and part.operator is Operator.EQUAL:
        for tested, literal in ((part.left, part.right), (part.right, part.left)):
            place = place_of(tested)
            value = literal.value if isinstance(literal, Boolean) else constant(literal)
            if place is not None and value is not None:
                return place, value
    return place_of(part), True


def _is_known(compared: Sequence[_Comparison], number: int, values: ChartValues | None) -> bool:
    """Whether the place may have the value `number` according to what machines send and trees set."""
    known = [values.at(comparison.place) for comparison in compared] if values is not None else []
    return any(of_place is not None and of_place.only is not None and number in of_place.only for of_place in known)


def _finding(place: str, compared: Sequence[_Comparison], twice: int, missing: int) -> Finding:
    pair = [number for number, comparison in enumerate(compared) if comparison.number == twice]
    in_order = [at for at in pair if _is_ordered(compared, at, missing)]
    wrong = in_order[0] if len(in_order) == 1 else pair[-1]
    other = next(at for at in pair if at != wrong)
    span = compared[wrong].literal.span
    message = (
        f"two of these {len(compared)} conditions compare `{place}` with {twice}, and none with {missing}; did you "
        f"mean {missing}?"
    )
    related = [Related(compared[other].literal.span, f"also {twice}")]
    return RULE.at(span, message, *replacements(span, (str(missing),)), related=related)


def _is_ordered(compared: Sequence[_Comparison], at: int, missing: int) -> bool:
    """Whether the numbers ascend with `missing` at the index `at`."""
    numbers = [missing if index == at else comparison.number for index, comparison in enumerate(compared)]
    return numbers == sorted(numbers)


RULE = Rule(
    "repeated-comparison",
    Severity.WARNING,
    "Two alternatives compare a value with the same number, and none with the one that is missing.",
    machine=check,
    whole=True,
)
