# SPDX-License-Identifier: Apache-2.0
"""The whole state of a system as a tree of rows, which mark the changes since an earlier state of the same run."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.debugging.scopes import ScopeEntry, Values
from roaml.debugging.sources import Sources
from roaml.debugging.values import shown
from roaml.record import Record
from roaml.scxml.names import is_observer
from roaml.simulation.session import Session


class StateRow(Record, frozen=True):
    """A value of the state.

    Attributes:
        value: for readers; "" for a row that only groups other rows.
        before: the value in the earlier state; `None` if it is the same, or the row did not exist.
        has_changed: whether the value, or one of the rows below, differs from the earlier state.
    """

    name: str
    value: str
    before: str | None
    has_changed: bool
    rows: tuple[StateRow, ...] = ()


def overview(session: Session, sources: Sources, step: int, earlier: int) -> tuple[StateRow, ...]:
    """The state after `step` steps, without the observers of properties. Values that differ from the state after
    `earlier` steps are marked. Both steps have been taken in this run. The session is at position `step` afterwards.
    """
    before = _texts(_values(session, sources, earlier))
    after = _texts(_values(session, sources, step))

    def row(path: tuple[str, ...], rows: tuple[StateRow, ...]) -> StateRow:
        text, old = after[path], before.get(path)
        is_new = text != old and (old is not None or bool(text))
        return StateRow(path[-1], text, old if is_new else None, is_new or any(r.has_changed for r in rows), rows)

    children: dict[str, list[StateRow]] = {path[0]: [] for path in after}
    for path in after:
        if len(path) > 1:
            children[path[0]].append(row(path, ()))
    return tuple(row((group,), tuple(rows)) for group, rows in children.items())


def _values(session: Session, sources: Sources, step: int) -> Values:
    session.jump(step)
    return Values(session, sources, session.state(), None, {})


def _texts(values: Values) -> dict[tuple[str, ...], str]:
    """Path of each row -> its text: `(group,)` for the row of a group, `(group, name)` for those below it."""
    groups: Mapping[str, tuple[str, tuple[ScopeEntry, ...]]] = {
        **{
            machine.name: (machine.state, entries)
            for machine, entries in values.machines()
            if not is_observer(machine.name)
        },
        **{scope.name: ("", scope.entries) for scope in values.shared_scopes() if scope.entries},
    }
    texts: dict[tuple[str, ...], str] = {}
    for group, (text, entries) in groups.items():
        texts[group,] = text
        texts |= {(group, entry.name): shown(entry.value) for entry in entries}
    return texts
