# SPDX-License-Identifier: Apache-2.0
"""The rule `inconsistent-operator`, which inconsistent_operator.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.operators import MIRRORED, Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, Unary, walk
from roaml.model.machine import Assign, Chart, If, Statement
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.alternatives import alternatives, handlers_by_trigger, joined
from roaml.rules.support.steps import step_of
from roaml.rules.support.words import difference, words_of
from roaml.text import Span, TextEdit

_LOGICAL = (Operator.AND, Operator.OR)

MIN_ALIKE = 3
"""How many alike conditions there must be, with the different one, before one operator is suspicious."""

MAX_ALIKE = 100
"""The maximum number of conditions that are compared with each other."""


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        reported: set[Span] = set()
        findings = (
            finding
            for alike in alternatives(context.machine, chart)
            for finding in (*_connectives(alike[:MAX_ALIKE]), *_limits(alike[:MAX_ALIKE]))
        )
        for finding in (*findings, *_directions(context, chart)):
            if finding.span not in reported:
                reported.add(finding.span)
                yield finding


# ------------------------------------------------------------- && and ||


def _connectives(trees: Sequence[Expr]) -> Iterator[Finding]:
    """Report the only one of several alike conditions that joins its comparisons with the other operator."""
    shapes: dict[object, list[Binary]] = {}
    for tree in trees:
        if isinstance(tree, Binary) and tree.operator in _LOGICAL:
            shapes.setdefault((_shape(tree.left), _shape(tree.right)), []).append(tree)
    for alike in shapes.values():
        for operator in _LOGICAL:
            odd = [tree for tree in alike if tree.operator is not operator]
            usual = [tree for tree in alike if tree.operator is operator]
            if len(usual) >= MIN_ALIKE - 1 and len(odd) == 1 and _same_subject(odd[0], usual):
                message = (
                    f"this condition joins its parts with `{odd[0].operator.symbol}`, and the {len(usual)} "
                    f"conditions like it with `{operator.symbol}`; did you mean that?"
                )
                text = operator.symbol.replace("&", "&amp;")
                fix = Fix(f"Change to `{operator.symbol}`", (TextEdit(odd[0].operator_span, text),))
                related = [Related(usual[0].operator_span, f"`{operator.symbol}`")]
                yield RULE.at(odd[0].operator_span, message, fix, related=related)


def _same_subject(odd: Binary, usual: Sequence[Binary]) -> bool:
    """Whether conditions test the same place on one side, such as the `way` in `way == 1 && x < 9`, and the odd one
    does not test it on both: `x < 0 || x > 9` and `way == 2 || way == 3` need another operator than the others."""
    left, right = _tested(odd.left), _tested(odd.right)
    if not left.isdisjoint(right):
        return False
    return any(
        own and all(_tested(side) == own for side in sides)
        for own, sides in ((left, [t.left for t in usual]), (right, [t.right for t in usual]))
    )


def _tested(tree: Expr) -> frozenset[str]:
    """The places in a comparison or negation, or the place itself."""
    match tree:
        case Binary():
            return _tested(tree.left) | _tested(tree.right)
        case Unary():
            return _tested(tree.operand)
    place = place_of(tree)
    return frozenset((place,)) if place is not None else frozenset()


def _shape(tree: Expr) -> object:
    """The structure of a condition: what it compares, and how it joins comparisons. The directions of comparisons are
    left out."""
    if isinstance(tree, Binary) and tree.operator in _LOGICAL:
        return (tree.operator, _shape(tree.left), _shape(tree.right))
    if isinstance(tree, Binary) and tree.operator.kind in (OperatorKind.ORDER, OperatorKind.EQUALITY):
        return tree.operator.kind
    if isinstance(tree, Unary):
        return (tree.operator, _shape(tree.operand))
    return "value"


# ---------------------------------------------------------------- < and <=


class _Limit(NamedTuple):
    """A comparison of a variable with a limit, with the variable on the left."""

    node: Binary
    place: str
    operator: Operator
    limit: str


_STRICT = {Operator.LESS: Operator.LESS_EQUAL, Operator.GREATER: Operator.GREATER_EQUAL}
_LOOSE = {loose: strict for strict, loose in _STRICT.items()}


def _limits(trees: Sequence[Expr]) -> Iterator[Finding]:
    """Report the only comparison that includes its limit, or excludes it, if a similar variable is compared with the
    same limit in the other way, and all other comparisons are strict, or not."""
    limits = [limit for tree in trees for node in walk(tree) if (limit := _limit(node)) is not None]
    strict = [limit for limit in limits if limit.operator in _STRICT]
    loose = [limit for limit in limits if limit.operator in _LOOSE]
    for few, many in ((strict, loose), (loose, strict)):
        if len(few) != 1 or len(many) < MIN_ALIKE - 1:
            continue
        odd = few[0]
        usual = _STRICT.get(odd.operator) or _LOOSE[odd.operator]
        for other in many:
            if other.operator is usual and other.limit == odd.limit and _is_similar(odd.place, other.place):
                written = usual if place_of(odd.node.left) == odd.place else MIRRORED[usual]
                message = (
                    f"`{odd.place}` is compared with `{odd.limit}` by `{odd.node.operator.symbol}`, and "
                    f"`{other.place}` by `{other.node.operator.symbol}`; did you mean `{written.symbol}`?"
                )
                text = written.symbol.replace("<", "&lt;")
                fix = Fix(f"Change to `{written.symbol}`", (TextEdit(odd.node.operator_span, text),))
                related = [Related(other.node.span, "a similar comparison")]
                yield RULE.at(odd.node.operator_span, message, fix, related=related)
                break


def _is_similar(name: str, other: str) -> bool:
    """Whether two names differ in one word and share the others, or are letters, such as `x` and `y`. A height `z` has
    other limits than the coordinates of a plane."""
    words = difference(name, other)
    if words is None or "z" in words:
        return False
    return len(words_of(name)) > 1 or len(words[0]) == len(words[1]) == 1


def _limit(node: Expr) -> _Limit | None:
    if not isinstance(node, Binary) or node.operator.kind is not OperatorKind.ORDER:
        return None
    left, right = place_of(node.left), place_of(node.right)
    if left is not None:
        return _Limit(node, left, node.operator, format_expr(node.right))
    return _Limit(node, right, MIRRORED[node.operator], format_expr(node.left)) if right is not None else None


# ------------------------------------------------------------- directions


def _directions(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Report the only one of several conditions that allows a step of a variable away from the limit with which it
    compares the variable, as `x > 9` before `x + 1`."""
    groups = [
        [(handler.cond, handler.targets[0].body) for handler in group if len(handler.targets) == 1]
        for state in chart.states
        for group in handlers_by_trigger(context.machine, state)
    ]
    groups += [[(b.cond, b.body) for b in s.branches] for s in chart.statements if isinstance(s, If)]
    for group in groups:
        steps = [step for cond, body in group if cond is not None and (step := _step(cond, body)) is not None]
        away = [limit for limit, towards in steps if not towards]
        if len(away) == 1 and len(steps) > MIN_ALIKE:
            operator = MIRRORED[away[0].node.operator]
            message = (
                f"what this condition allows leads `{away[0].place}` away from the limit `{away[0].limit}`, unlike the "
                f"{len(steps) - 1} conditions like it; did you mean `{operator.symbol}`?"
            )
            fix = Fix(
                f"Change to `{operator.symbol}`",
                (TextEdit(away[0].node.operator_span, operator.symbol.replace("<", "&lt;")),),
            )
            right = next(limit for limit, towards in steps if towards)
            related = [Related(right.node.span, "a similar condition")]
            yield RULE.at(away[0].node.operator_span, message, fix, related=related)


def _step(cond: Expression, body: Sequence[Statement]) -> tuple[_Limit, bool] | None:
    """The limit of the only variable that `cond` compares and `body` steps, and whether the step leads to the limit."""
    found = []
    for node in _joined_comparisons(cond):
        limit = _limit(node)
        for statement in body if limit is not None else ():
            place = place_of(statement.location.tree) if isinstance(statement, Assign) and statement.location else None
            value = statement.value if isinstance(statement, Assign) else None
            if limit is not None and place == limit.place and isinstance(value, Expression):
                sign = step_of(value.tree, place)
                if sign:
                    found.append((limit, (sign > 0) == (limit.operator in (Operator.LESS, Operator.LESS_EQUAL))))
    return found[0] if len(found) == 1 else None


def _joined_comparisons(cond: Expression) -> Sequence[Expr]:
    return () if cond.broken else joined(cond.tree, Operator.AND)


RULE = Rule(
    "inconsistent-operator",
    Severity.WARNING,
    "A condition has another operator than the similar conditions beside it.",
    machine=check,
)
