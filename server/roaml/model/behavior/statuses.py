# SPDX-License-Identifier: Apache-2.0
"""The statuses that a plugin can return from a tick."""

from __future__ import annotations

from roaml.model.behavior.duties import forward
from roaml.model.behavior.explore import Behavior, explore
from roaml.model.behavior.phases import Phase
from roaml.model.machine import Machine, ReturnStatus
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.scxml.names import STATUSES

_RUNNING = "RUNNING"


class TickStatuses(Record, frozen=True):
    """The names of the statuses that a plugin can return at any tick, and at its first tick or after it has ended."""

    ever: frozenset[str]
    first: frozenset[str]


ANY_STATUS = TickStatuses(frozenset(STATUSES), frozenset(STATUSES))
"""The statuses of a plugin about which nothing is known."""


def tick_statuses(machine: Machine) -> TickStatuses:
    """The statuses that a machine can return, whatever the values of its variables are; all, if it returns the value of
    a variable, or no status."""
    returned = [s for s in machine.chart.executed if isinstance(s, ReturnStatus)]
    words = {statement.status.value if statement.status else "" for statement in returned}
    if not words or not words <= STATUSES.keys():
        return ANY_STATUS
    ever = frozenset(words)
    behavior = explore(machine, machine.chart)
    if behavior is None or _RUNNING not in ever:
        return TickStatuses(ever, ever)
    return TickStatuses(ever, _first(behavior, ever))


def _first(behavior: Behavior, ever: frozenset[str]) -> frozenset[str]:
    """The statuses with which a plugin that is not running can answer a tick."""
    phases = [configuration.tree for configuration in behavior.configurations]
    ticks = [s for s in behavior.steps if s.event and s.event.part is ProtocolPart.BT_TICK]
    begun = {step.target for step in ticks if phases[step.source] in (None, Phase.ENDED)}
    inside = [step for step in behavior.steps if phases[step.source] is Phase.TICKED]
    answered = {phases[number] for number in forward(begun, inside)}
    ends = ever - {_RUNNING} if Phase.ENDED in answered else frozenset()
    return ends | (ever & {_RUNNING} if Phase.RUNNING in answered else frozenset()) or ever
