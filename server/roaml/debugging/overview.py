# SPDX-License-Identifier: Apache-2.0
"""The whole state of a system as a tree of rows, with what has changed since an earlier state of the same run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from roaml.debugging.scopes import ScopeEntry, Values
from roaml.debugging.sources import Sources
from roaml.debugging.values import shown
from roaml.simulation.session import Session


@dataclass(frozen=True, slots=True)
class StateRow:
    """A value of the state.

    Attributes:
        value: for readers; "" for a row that only groups others.
        before: its value in the earlier state; `None` if it is the same.
        has_changed: whether the value, or one of the rows below, differs from the earlier state.
    """

    name: str
    value: str
    before: str | None
    has_changed: bool
    rows: tuple[StateRow, ...] = ()


def overview(session: Session, sources: Sources, step: int, earlier: int) -> tuple[StateRow, ...]:
    """The state after `step` steps; what differs from the state after `earlier` steps is marked. The session moves.

    Both states are in the run already.
    """
    texts_before = {path: text for path, text, _ in _texts(_values(session, sources, earlier))}
    rows: dict[str, StateRow] = {}
    children: dict[str, list[StateRow]] = {}
    for path, text, group in _texts(_values(session, sources, step)):
        old = texts_before.get(path)
        is_new = text != old and (old is not None or bool(text))
        row = StateRow(path[-1], text, old if is_new else None, is_new)
        if len(path) == 1:
            rows[group] = row
            children[group] = []
        else:
            children[group].append(row)
    return tuple(
        StateRow(row.name, row.value, row.before, row.has_changed or any(r.has_changed for r in children[group]),
            tuple(children[group]))
        for group, row in rows.items()
    )  # fmt: skip


def _values(session: Session, sources: Sources, step: int) -> Values:
    session.jump(step)
    return Values(session, sources, session.state(), None, {})


def _texts(values: Values) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """The path of each row, its text, and the name of its group: first the row of a group, then those below it."""
    groups: Mapping[str, tuple[str, tuple[ScopeEntry, ...]]] = {
        **{machine.name: (machine.state, entries) for machine, entries in values.machines()},
        **{scope.name: ("", scope.entries) for scope in values.shared_scopes() if scope.entries},
    }
    for group, (text, entries) in groups.items():
        yield (group,), text, group
        for entry in entries:
            yield (group, entry.name), shown(entry.value), group
