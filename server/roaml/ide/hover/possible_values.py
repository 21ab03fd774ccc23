# SPDX-License-Identifier: Apache-2.0
"""The values that a variable or a field can have at a place, as a hover text."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.tree import Member, Name, walk
from roaml.ide.hover.place import Place
from roaml.model.kinds import FileKind
from roaml.model.machine import Chart
from roaml.model.values.analyse import ChartValues
from roaml.model.values.describe import described, is_informative
from roaml.model.values.domain import ANYTHING, ValueSet, joined


def possible_values(place: Place) -> str:
    """A sentence for the variable or field at a place; "" if no more is known about its values than its type."""
    machine = place.analysis.machine(place.path) if place.kind is FileKind.MACHINE else None
    if machine is None:
        return ""
    texts: dict[str, None] = {}
    for system in place.systems:
        known = place.analysis.values_in(place.path, system)
        for chart in machine.charts:
            if chart.scope in known.charts:
                texts |= dict.fromkeys(_texts(place, chart, known.charts[chart.scope]))
    return "\n\n".join(texts)


def _texts(place: Place, chart: Chart, values: ChartValues) -> Iterator[str]:
    if place.expression is not None:
        for node in walk(place.expression.tree):
            is_here = isinstance(node, Name | Member) and _name_span_contains(node, place.offset)
            here = values.at(node) if is_here else None
            if here is not None and is_informative(here):
                yield f"Value here: {described(here)}."
        return
    for data in chart.data:
        if data.id is not None and data.id.span.contains(place.offset):
            everywhere: ValueSet = joined(state.get(data.id.value, ANYTHING) for state in values.states.values())
            if is_informative(everywhere):
                yield f"Values: {described(everywhere)}."


def _name_span_contains(node: Name | Member, offset: int) -> bool:
    return (node.span if isinstance(node, Name) else node.name_span).contains(offset)
