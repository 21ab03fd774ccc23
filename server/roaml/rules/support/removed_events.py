# SPDX-License-Identifier: Apache-2.0
"""Events that an older version of the language used between plugins and the tree."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.machine import Handler, Machine, Send

REMOVED_EVENTS = {
    "bt_success": '<bt_return_status status="SUCCESS"/>',
    "bt_failure": '<bt_return_status status="FAILURE"/>',
    "bt_running": '<bt_return_status status="RUNNING"/>',
    "bt_halted": "<bt_return_halted/>",
}


def uses_removed_events(machine: Machine) -> bool:
    """Whether a plugin uses the removed events, so that its other answers cannot be checked."""
    return any(removed_handlers(machine)) or any(removed_sends(machine))


def removed_handlers(machine: Machine) -> Iterator[Handler]:
    for chart in machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.event is not None and handler.event.value in ("bt_tick", "bt_halt"):
                    yield handler


def removed_sends(machine: Machine) -> Iterator[Send]:
    for chart in machine.charts:
        for statement in chart.statements:
            if isinstance(statement, Send) and statement.event and statement.event.value in REMOVED_EVENTS:
                yield statement
