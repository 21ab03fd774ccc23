# SPDX-License-Identifier: Apache-2.0
"""Variables as the protocol represents them. References denote the values that a client may open; they are valid while
the run is stopped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from roaml.debugging.breakpoints import WatchedVariable
from roaml.debugging.scopes import ScopeEntry
from roaml.debugging.values import SEPARATOR, Value, shown, type_of
from roaml.record import Record


class Shown(Record, frozen=True):
    """A variable with its value at the previous stop, which is `None` if it had no value there."""

    entry: ScopeEntry
    before: Value | None


class References:
    """The reference numbers of scopes, structs and arrays."""

    def __init__(self) -> None:
        self._children: list[Sequence[Shown]] = []

    def add(self, children: Sequence[Shown]) -> int:
        """Add variables that the client may open; return their reference number."""
        self._children.append(children)
        return len(self._children)

    def children(self, reference: int) -> Sequence[Shown] | None:
        """The variables that a reference denotes; `None` if there is no such reference."""
        return self._children[reference - 1] if 1 <= reference <= len(self._children) else None

    def of_value(self, value: Value, entry: ScopeEntry, before: Value | None) -> int:
        """The reference number of the parts of a value; 0 if the value has no parts."""
        if isinstance(value, (dict, list)) and value:
            return self.add(tuple(_parts(value, entry, before)))
        return 0

    def variable(self, shown_: Shown) -> dict[str, Any]:
        """A `Variable` of the protocol. If the value has changed since the previous stop, the attributes contain
        `changed`, and `type` also contains the previous value."""
        entry, before = shown_.entry, shown_.before
        has_changed = before is not None and before != entry.value
        attributes = ["changed"] if has_changed else []
        if entry.variable is None:
            attributes.insert(0, "readOnly")
        type_ = entry.type or type_of(entry.value)
        variable: dict[str, Any] = {
            "name": entry.name,
            "value": shown(entry.value),
            "type": f"{type_}, was {shown(before)}" if has_changed and before is not None else type_,
            "variablesReference": self.of_value(entry.value, entry, before),
            "presentationHint": {"attributes": attributes},
        }
        if entry.expression:
            variable["evaluateName"] = entry.expression
        if isinstance(entry.value, list):
            variable["indexedVariables"] = len(entry.value)
        elif isinstance(entry.value, dict):
            variable["namedVariables"] = len(entry.value)
        return variable


def _parts(value: dict[str, Value] | list[Value], entry: ScopeEntry, before: Value | None) -> Iterable[Shown]:
    if isinstance(value, dict):
        for name, member in value.items():
            old = before.get(name) if isinstance(before, dict) else None
            expression = f"{entry.expression}.{name}" if entry.expression else ""
            owner = entry.variable
            variable = None if owner is None else WatchedVariable(owner.instance, f"{owner.name}{SEPARATOR}{name}")
            yield Shown(ScopeEntry(name, member, "", expression, variable), old)
        return
    for number, element in enumerate(value):
        old = before[number] if isinstance(before, list) and number < len(before) else None
        expression = f"{entry.expression}[{number}]" if entry.expression else ""
        yield Shown(ScopeEntry(f"[{number}]", element, "", expression), old)
