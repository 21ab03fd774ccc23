# SPDX-License-Identifier: Apache-2.0
"""A simulated run as files: CSV in the terms of the user, and JSON with the steps as `trace_files` writes them.

CSV has a line for each state, including the first one, and columns for its number, the time in s if the model has a
clock, the action of the step before it, the state and variables of each machine, the status of each node of the tree,
the blackboard, and the other variables of the model. Arrays and truth values are written as in `trace_files`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

from as2fm_lsp.verification.trace_files import cells_of, csv_line, step_row, suffixes_of
from roaml.simulation import Session, SystemState
from roaml.smc.record import Plain
from roaml.verification.target import VerificationTarget


def csv_lines(session: Session) -> Iterator[str]:
    """The lines for the run up to the position. The session moves from the start to there."""
    for position in range(session.position + 1):
        session.jump(position)
        state = session.state()
        row: list[tuple[str, int | float | str]] = [("step", position)]
        if state.time is not None:
            row.append(("time", state.time))
        row.append(("action", session.steps[position - 1].action or "" if position else ""))
        row += _columns(state)
        if position == 0:
            yield csv_line(name for name, _ in row)
        yield csv_line(cell for _, cell in row)


def _columns(state: SystemState) -> Iterator[tuple[str, int | float | str]]:
    for machine in state.machines:
        yield f"{machine.name}.state", machine.state
        for name, value in machine.variables.items():
            yield from _cells(f"{machine.name}.{name}", value)
    for node in state.nodes:
        yield f"bt_{node.number}", node.status.value
    for name, value in {**state.blackboard, **state.shared}.items():
        yield from _cells(name, value)


def _cells(name: str, value: Plain) -> Iterator[tuple[str, int | float]]:
    for suffix, cell in zip(suffixes_of(value), cells_of(value), strict=True):
        yield name + suffix, cell


def json_text(session: Session, target: VerificationTarget) -> str:
    """The steps up to the position, and what the run is."""
    saved, end = session.save(), session.end
    value = {
        "property": saved.property,
        "trace": saved.trace,
        "seed": saved.seed,
        "by_hand": session.is_by_hand,
        "steps": [step_row(target, session.automata, step) for step in session.steps[: session.position]],
        "verdict": session.verdict,
        "end": None if end is None else end.key,
    }
    return json.dumps(value, ensure_ascii=False, indent=1) + "\n"
