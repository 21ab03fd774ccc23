# SPDX-License-Identifier: Apache-2.0
"""The rule `early-status`, which early_status.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.behavior.phases import AWAITED_ANSWER
from roaml.model.machine import Chart, Handler, If, ReturnStatus, RosSend, State, statements
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.text import TextEdit

_ASKS = (ProtocolPart.REQUEST, ProtocolPart.GOAL)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the status SUCCESS of a state that waits for an answer, if the tick that asked for it returned RUNNING."""
    for chart in context.machine.charts:
        for state in chart.states:
            tick = _only_tick(state)
            asked = _asked(chart, state) if tick is not None and _waits(state) else None
            returned = _returned(tick) if tick is not None else ()
            if asked is None or len(returned) != 1 or returned[0].status is None:
                continue
            status = returned[0].status
            if status.value == "SUCCESS":
                message = (
                    "this returns SUCCESS while the answer to the request is still awaited, although the tick that "
                    "sent the request returned RUNNING; return RUNNING until the answer has arrived"
                )
                fix = Fix("Change to `RUNNING`", (TextEdit(status.span, "RUNNING"),))
                yield RULE.at(status.span, message, fix, related=[Related(asked.element.name_span, "the request")])


def _only_tick(state: State) -> Handler | None:
    """The only handler of ticks in a state, if it has no condition and stays in the state."""
    ticks = [h for h in state.handlers if h.trigger is ProtocolPart.BT_TICK and h.effective]
    own = state.id.value if state.id is not None else ""
    stays = ticks and all(t.state is not None and t.state.value == own for t in ticks[0].targets)
    return ticks[0] if len(ticks) == 1 and stays and ticks[0].cond is None else None


def _waits(state: State) -> bool:
    """Whether an answer leads from a state to another one."""
    own = state.id.value if state.id is not None else ""
    return any(
        handler.effective
        and handler.trigger in AWAITED_ANSWER
        and any(target.state is not None and target.state.value != own for target in handler.targets)
        for handler in state.handlers
    )


def _asked(chart: Chart, state: State) -> RosSend | None:
    """The request that a tick sends on its way into `state`, if all ticks that lead there return RUNNING."""
    own = state.id.value if state.id is not None else ""
    found: list[RosSend] = []
    for other in chart.states:
        for handler in other.handlers if other is not state else ():
            if handler.trigger is not ProtocolPart.BT_TICK or not handler.effective:
                continue
            if not any(target.state is not None and target.state.value == own for target in handler.targets):
                continue
            asks = [s for t in handler.targets for s in statements(t.body) if isinstance(s, RosSend)]
            asks = [s for s in asks if s.part in _ASKS]
            returned = _returned(handler)
            if not asks or not returned or any(r.status is None or r.status.value != "RUNNING" for r in returned):
                return None
            found += asks
    return found[0] if found else None


def _returned(handler: Handler) -> tuple[ReturnStatus, ...]:
    """The statuses that a handler returns; none if an `<if>` decides."""
    inside = [s for target in handler.targets for s in statements(target.body)]
    if any(isinstance(s, If) for s in inside):
        return ()
    return tuple(s for s in inside if isinstance(s, ReturnStatus))


RULE = Rule(
    "early-status",
    Severity.WARNING,
    "A plugin returns SUCCESS although it still waits for an answer.",
    machine=check,
    whole=True,
)
