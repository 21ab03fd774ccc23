# SPDX-License-Identifier: Apache-2.0
"""A run as a table, in the terms of the model.

It has a row for each state, including the first one, and columns for its number (`step`), the time in s if the model
has a clock (`time`), the action of the step before it (`action`), the state and variables of each machine (`Arm.state`,
`Arm.way`), the status of each node of the tree (`PickUp: status`), the blackboard, and the other variables of the
model. An array has a column for each of its elements; true is 1, false 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeAlias

from roaml.simulation.session import Session
from roaml.simulation.state import SystemState
from roaml.smc.record import Plain
from roaml.views.actors import names_of
from roaml.views.shared_names import shared_names

Cell: TypeAlias = int | float | str


def rows(session: Session, first: int = 0) -> Iterator[dict[str, Cell]]:
    """The rows of the states from step `first` to the position of the session, both included: column -> cell. The
    session moves to `first`, and from there back to its position."""
    shown = shared_names(session.start, names_of(session.automata_of_model))
    for position in range(first, session.position + 1):
        session.jump(position)
        state = session.state()
        row: dict[str, Cell] = {"step": position}
        if state.time is not None:
            row["time"] = state.time
        row["action"] = session.steps[position - 1].action or "" if position else ""
        row.update(_state_cells(session, state, shown))
        yield row


def columns(session: Session, first: int = 0) -> dict[str, list[Cell]]:
    """The same table by columns, as `pandas.DataFrame` and `polars.DataFrame` accept it: column -> one cell for each
    row."""
    table: dict[str, list[Cell]] = {}
    for row in rows(session, first):
        for name, cell in row.items():
            table.setdefault(name, []).append(cell)
    return table


def cells_of(value: Plain) -> Iterator[int | float]:
    """The cells of a value: one for each element of an array; true is 1, false 0."""
    if isinstance(value, list):
        for element in value:
            yield from cells_of(element)
    else:
        yield int(value) if isinstance(value, bool) else value


def suffixes_of(value: Plain) -> Iterator[str]:
    """The suffixes of a variable's name in the columns of its value, in the order of `cells_of`: for example `[0][1]`
    for an element of an array of arrays, and "" for a value that is not an array."""
    if isinstance(value, list):
        for position, element in enumerate(value):
            yield from (f"[{position}]{more}" for more in suffixes_of(element))
    else:
        yield ""


def _state_cells(session: Session, state: SystemState, shown: Mapping[str, str]) -> Iterator[tuple[str, Cell]]:
    for machine in state.machines:
        yield f"{machine.identifier}.state", machine.state
        phrases = session.phrases(machine.automaton)
        for name, value in machine.variables.items():
            yield from _cells(f"{machine.identifier}.{phrases.get(name, name)}", value)
    for node in state.nodes:
        yield f"{node.name}: status", node.status.value
    for name, value in state.blackboard.items():
        yield from _cells(name, value)
    for name, value in state.shared.items():
        yield from _cells(shown[name], value)


def _cells(name: str, value: Plain) -> Iterator[tuple[str, int | float]]:
    for suffix, cell in zip(suffixes_of(value), cells_of(value), strict=True):
        yield name + suffix, cell
