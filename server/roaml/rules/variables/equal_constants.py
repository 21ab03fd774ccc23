# SPDX-License-Identifier: Apache-2.0
"""The rule `equal-constants`, which equal_constants.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from fractions import Fraction

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.operators import OperatorKind
from roaml.expr.tree import Binary, Name, walk
from roaml.model.machine import Assign, Chart, RosSend, Send
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.model.waits import fixed_variables
from roaml.rules.rule import MachineContext, Rule

_MIN_ALTERNATIVES = 3
"""How many constants one place must get or be compared with before two equal ones are suspicious: two may be settings,
such as the speeds in two states."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report constants with the same value that are alternatives of one variable or field."""
    for chart in context.machine.charts:
        numbers = {name: value for name, value in fixed_variables(chart).items() if isinstance(value, Fraction)}
        ids = {data.id.value: data for data in chart.data if data.id is not None and data.id.value in numbers}
        if len(ids) < _MIN_ALTERNATIVES:
            continue
        reported: set[str] = set()
        for alternatives in _alternatives(context, chart, ids).values():
            names = [name for name in ids if name in alternatives]
            values = [numbers[name] for name in names]
            # A series of distinct numbers has one mistake at most.
            if len(names) < _MIN_ALTERNATIVES or len(set(values)) != len(names) - 1:
                continue
            second = next(place for place, value in enumerate(values) if value in values[:place])
            name, first = names[second], names[values.index(values[second])]
            data, other = ids[name], ids[first]
            if name not in reported and data.id is not None and other.id is not None and data.value is not None:
                reported.add(name)
                message = (
                    f"`{name}` has the same value as `{first}`, so they mean the same; give each of the "
                    f"{len(names)} constants another value"
                )
                yield RULE.at(data.value.span, message, related=[Related(other.id.span, f"`{first}`")])


def _alternatives(context: MachineContext, chart: Chart, constants: Collection[str]) -> dict[str, set[str]]:
    """Variable or field -> the constants that are assigned to it, sent in it, or compared with it for equality."""
    found: dict[str, set[str]] = {}

    def note(place: str | None, value: object) -> None:
        tree = value.tree if isinstance(value, Expression) else value
        if place is not None and place not in constants and isinstance(tree, Name) and tree.name in constants:
            found.setdefault(place, set()).add(tree.name)

    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            note(place_of(statement.location.tree), statement.value)
        elif isinstance(statement, RosSend):
            for param in statement.fields:
                handle = statement.handle.value if statement.handle is not None else ""
                note(f"{handle}/{param.name.value if param.name is not None else ''}", param.value)
        elif isinstance(statement, Send):
            for param in statement.params:
                event = statement.event.value if statement.event is not None else ""
                note(f"{event}/{param.name.value if param.name is not None else ''}", param.value)
    for node in _comparisons(context, chart):
        note(place_of(node.left), node.right)
        note(place_of(node.right), node.left)
    return found


def _comparisons(context: MachineContext, chart: Chart) -> Iterator[Binary]:
    for value in context.typed.values:
        if value.place.chart is chart and isinstance(value.value, Expression) and not value.value.broken:
            for node in walk(value.value.tree):
                if isinstance(node, Binary) and node.operator.kind is OperatorKind.EQUALITY:
                    yield node


RULE = Rule(
    "equal-constants",
    Severity.WARNING,
    "Two of several constants for one variable or field have the same value.",
    machine=check,
)
