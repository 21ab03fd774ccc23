# SPDX-License-Identifier: Apache-2.0
"""Integer constants that have another value than in the other machines of a system, which exchange the values."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from roaml.expr.infer import constant as number_of
from roaml.expr.tree import Binary, Name, walk
from roaml.model.machine import Assign, Chart
from roaml.model.message_constants import named_constants
from roaml.model.syntax import Expression
from roaml.model.value_types import ValueUse
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext
from roaml.rules.support.words import words_of

MIN_EQUAL = 2
"""In how many other machines a constant of the same name must be before another value is suspicious."""

MIN_SIMILAR = 3
"""The same for constants whose names contain the words of the others, such as `NAV_MOVING` for `NAV_STATUS_MOVING`."""


def odd_constants(context: MachineContext, chart: Chart) -> dict[str, tuple[int, int]]:
    """Constant of `chart` -> its value, and the different value that it has in all other machines that have it."""
    own = {constant.name: constant.number for constant in named_constants(chart)}
    if context.system is None or not own:
        return {}
    others = {
        path: {constant.name: constant.number for constant in outline.named}
        for path, outline in (*context.system.nodes, *context.system.plugins)
        if path != context.source.path and outline.named
    }
    expected = {name: _expected(name, others.values()) for name in own if _is_series(name, own)}
    odd = {name: (own[name], meant) for name, meant in expected.items() if meant not in (None, own[name])}
    return {name: numbers for name, numbers in odd.items() if not _is_internal(context, chart, name, own)}


def _is_internal(context: MachineContext, chart: Chart, constant: str, constants: Collection[str]) -> bool:
    """Whether a constant is only assigned to variables and compared with them that get nothing but constants and are
    not sent: other machines see nothing of its value."""
    own = [
        (value, value.value.tree)
        for value in context.typed.values
        if value.place.chart is chart and isinstance(value.value, Expression)
    ]
    known = set(constants)
    shown = {tree.name for value, tree in own if isinstance(tree, Name) and value.use in _SHOWN}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None and isinstance(statement.value, Expression):
            name, tree = place_of(statement.location.tree), statement.value.tree
            is_constant = (isinstance(tree, Name) and tree.name in known) or number_of(tree) is not None
            if name is not None and not is_constant:
                shown.add(name)
    for value, tree in own:
        if isinstance(tree, Name) and tree.name == constant and value.use in _SHOWN:
            return False
        for node in walk(tree):
            sides = [node.left, node.right] if isinstance(node, Binary) else []
            names = [side.name if isinstance(side, Name) else None for side in sides]
            if constant in names and (None in names or not shown.isdisjoint(names)):
                return False
    return True


_SHOWN = (ValueUse.PARAMETER, ValueUse.FIELD, ValueUse.OUTPUT)


def _is_series(name: str, names: Collection[str]) -> bool:
    """Whether other constants begin with the same word, as those that distinguish the values of a status. Others may be
    settings, which differ between machines."""
    first = words_of(name)[:1]
    return any(other != name and other.isupper() and words_of(other)[:1] == first for other in names)


def _expected(name: str, others: Collection[Mapping[str, int]]) -> int | None:
    """The value of a constant in all other machines that have it; `None` if they are few or have several values."""
    equal = [constants[name] for constants in others if name in constants and _is_series(name, constants)]
    if len(equal) >= MIN_EQUAL:
        return equal[0] if len(set(equal)) == 1 else None
    similar = [n for constants in others for known, n in constants.items() if _is_similar(name, known)]
    return similar[0] if len(similar) >= MIN_SIMILAR and len(set(similar)) == 1 else None


def _is_similar(name: str, other: str) -> bool:
    """Whether two names end in the same word, and one contains all words of the other."""
    words, others = words_of(name), words_of(other)
    return words[-1:] == others[-1:] and (set(words) <= set(others) or set(others) <= set(words))
