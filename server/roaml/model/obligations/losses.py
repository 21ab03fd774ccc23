# SPDX-License-Identifier: Apache-2.0
"""Finds the places where an obligation is lost: the answer can no longer be sent, or it no longer names its goal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.expr.tree import access_path
from roaml.model.behavior.duties import TAKING, backward, follows, forward, keeps_goals, moves, unfinished
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import Duty, DutyKind, GoalStatus, HeldId, Phase, ProtocolEvent, Subject
from roaml.model.machine import Assign, State, Statement, statements
from roaml.model.obligations.protocols import ClientProtocols, Interleaving
from roaml.model.syntax import Expression
from roaml.record import Record
from roaml.roles import ProtocolPart


class Loss(Record, frozen=True, eq=False):
    """An obligation that is lost.

    Attributes:
        step: the step after which the answer is missing.
        path: the steps before it: the first one receives the event of the duty. Empty if `step` receives it.
        between: the request or goal that must arrive while the answer is due; `None` if none must.
        race: whether `step` receives a plain event although the machine could still answer: the answer depends on the
            order of events.
        overwritten: the assignment that overwrites the id of the goal; `None` if the obligation is lost otherwise.
    """

    duty: Duty
    step: BehaviorStep
    path: tuple[BehaviorStep, ...]
    between: Interleaving | None = None
    race: bool = False
    overwritten: Statement | None = None


def losses(behavior: Behavior, duty: Duty, protocols: ClientProtocols) -> Iterator[Loss]:
    """The places where the answer to `duty` is lost, in the order of the steps."""

    def possible(step: BehaviorStep) -> bool:
        return protocols.possible(behavior, step)

    live = _live(behavior, protocols)
    lost = unfinished(behavior, duty, possible)
    steps = [s for s in behavior.steps if s.source in live and possible(s) and protocols.is_sent(s)]
    for step in _dead_ends(behavior, duty, lost & live, steps):
        yield _loss(behavior, duty, protocols, step, step.source not in lost)
    if duty.kind is DutyKind.RESULT:
        for step in steps:
            if step.source not in lost:
                yield from _overwritten(behavior, duty, protocols, step)


def waiting_behind(behavior: Behavior, loss: Loss, protocols: ClientProtocols) -> set[int]:
    """The configurations that owe the lost answer and are the target of the step of a loss or can be reached from
    it."""
    lost = unfinished(behavior, loss.duty, lambda step: protocols.possible(behavior, step))
    inside = (step for step in behavior.steps if step.source in lost and step.target in lost)
    return forward({loss.step.target} & lost, inside)


def _live(behavior: Behavior, protocols: ClientProtocols) -> set[int]:
    """The configurations that the machine can reach if its clients keep to their protocols."""
    known: dict[tuple[Behavior, ClientProtocols], set[int]] = behavior.chart.__dict__.setdefault("live", {})
    key = (behavior, protocols)
    if key not in known:
        known.clear()
        steps = (s for s in behavior.steps if protocols.possible(behavior, s) and protocols.is_sent(s))
        known[key] = forward(set(range(behavior.starts)), steps)
    return known[key]


def _dead_ends(
    behavior: Behavior, duty: Duty, lost: frozenset[int], steps: Iterable[BehaviorStep]
) -> Iterator[BehaviorStep]:
    """The steps after which the answer to `duty` is missing.

    After the step that makes the answer impossible, the machine may still wait for events that it has caused, such as
    the response to a request. Then the step that handles the last of these events is returned, because the answer is
    missing there. But if the machine waits in a state that handles the next event of `duty`, such as the next tick, the
    step that leads into this state is returned.

    Args:
        lost: the configurations that owe the answer and from which no path leads to it.
        steps: the steps that can be taken.
    """
    inside = [step for step in steps if step.source in lost and step.target in lost]
    following = [step for step in inside if follows(step)]
    going_on = backward({step.source for step in following if step.source != step.target}, inside)
    takers = (s for s in behavior.chart.states if any(h.trigger is TAKING[duty.kind] for h in s.handlers))
    ready = {state.id.value for state in takers if state.id}
    if going_on >= lost:
        # The steps form endless cycles: report the steps that lead into them or, for a goal, the one that leads back to
        # where the next goal is received.
        back = [step for step in inside if _is_return(behavior, duty, step, ready)]
        if duty.kind is DutyKind.RESULT and len({step.handler for step in back}) == 1:
            yield from back
            return
        going_on, following = set(), []
    early: list[BehaviorStep] = []
    late: list[BehaviorStep] = []
    for step in steps:
        if step.target not in lost or step.source in lost:
            continue
        if step.target not in going_on:
            yield step
        elif _begins_nothing(behavior, duty, step) or (
            moves(behavior, step) and behavior.configurations[step.target].state in ready
        ):
            early.append(step)
        else:
            late.append(step)
    ends = [s for s in following if s.target not in going_on and (s.source in going_on or s.ignored)]
    for handler in dict.fromkeys(step.handler for step in late):
        begun = [s for s in late if s.handler is handler]
        behind = forward({step.target for step in begun}, inside)
        if _receives(duty, begun[0]) and len({end.handler for end in ends if end.source in behind}) > 1:
            early += begun  # every path forgets the answer: one finding where the event is handled
    yield from early
    reported = forward({step.target for step in early}, inside)
    yield from (step for step in ends if step.source not in reported)


def _is_return(behavior: Behavior, duty: Duty, step: BehaviorStep, ready: set[str]) -> bool:
    """Whether a step leads from a state that does not handle the event of `duty` to one that does."""
    source, target = behavior.configurations[step.source], behavior.configurations[step.target]
    return target.state in ready and source.state not in ready and not _receives(duty, step)


_RECEIVED_AS = {
    DutyKind.TICK: (ProtocolPart.BT_TICK,),
    DutyKind.HALT: (ProtocolPart.BT_HALT,),
    DutyKind.REQUEST: (ProtocolPart.REQUEST,),
    DutyKind.GOAL: (ProtocolPart.GOAL,),
    DutyKind.RESULT: (ProtocolPart.GOAL, ProtocolPart.THREAD_START),
}


def _begins_nothing(behavior: Behavior, duty: Duty, step: BehaviorStep) -> bool:
    """Whether a step receives the event of `duty`, sends nothing and stays in its state, so that what the machine waits
    for there has another cause."""
    return _receives(duty, step) and not step.sent and not moves(behavior, step)


def _receives(duty: Duty, step: BehaviorStep) -> bool:
    return step.event is not None and step.event.part in _RECEIVED_AS[duty.kind]


def _loss(behavior: Behavior, duty: Duty, protocols: ClientProtocols, step: BehaviorStep, answerable: bool) -> Loss:
    """The loss in a step. `answerable` says whether the machine could answer before the step."""
    race = answerable and step.event is not None and step.event.part is ProtocolPart.EVENT
    race = race and behavior.configurations[step.source].owes(duty)
    path = _path(behavior, duty, protocols, step)
    for taken in (step, *reversed(path)):
        if behavior.configurations[taken.source].owes(duty):
            for between in protocols.interleavings(behavior, taken):
                if between is not None and between.duty == duty:
                    return Loss(duty, step, path, between, race)
    return Loss(duty, step, path, None, race)


def _path(behavior: Behavior, duty: Duty, protocols: ClientProtocols, last: BehaviorStep) -> tuple[BehaviorStep, ...]:
    """The shortest path from the step that receives the event of `duty` to the step before `last`; if there is one, a
    path on which no other request or goal arrives."""
    if not behavior.configurations[last.source].owes(duty):
        return ()
    incoming: dict[int, list[BehaviorStep]] = {}
    for step in behavior.steps:
        if protocols.possible(behavior, step):
            incoming.setdefault(step.target, []).append(step)
    for undisturbed in (True, False):
        after: dict[int, BehaviorStep | None] = {last.source: None}
        waiting = [last.source]
        for here in waiting:
            for step in incoming.get(here, ()):
                owed = behavior.configurations[step.source].owes(duty)
                if owed and undisturbed and any(protocols.interleavings(behavior, step)):
                    continue
                if not owed:
                    return _unrolled(step, after)
                if step.source not in after:
                    after[step.source] = step
                    waiting.append(step.source)
    return ()


def _unrolled(first: BehaviorStep, after: dict[int, BehaviorStep | None]) -> tuple[BehaviorStep, ...]:
    path, step = [first], after[first.target]
    while step is not None:
        path.append(step)
        step = after[step.target]
    return tuple(path)


# ------------------------------------------------------- ids of running goals


def _overwritten(behavior: Behavior, duty: Duty, protocols: ClientProtocols, step: BehaviorStep) -> Iterator[Loss]:
    """The loss of a running goal whose id the step overwrites with that of a goal of another client."""
    goal = ProtocolEvent(ProtocolPart.GOAL, duty.handle)
    source, target = behavior.configurations[step.source], behavior.configurations[step.target]
    if step.event != goal or not source.owes(duty):
        return
    running = HeldId(GoalStatus.ACCEPTED, duty.handle)
    if (
        running not in [held for _, held in source.ids]
        or target.phase(Subject.RESULT, duty.handle) is not Phase.SEVERAL
    ):
        return
    if keeps_goals(behavior, target, duty.handle):
        return
    between = protocols.interleaving(duty, goal)
    if between is None or between.is_of_one_client or not between.asker:
        return
    for statement in _executed(behavior, step):
        value = statement.value if isinstance(statement, Assign) else None
        if isinstance(value, Expression) and access_path(value.tree) == ("_action", "goal_id"):
            yield Loss(duty, step, _path(behavior, duty, protocols, step), between, overwritten=statement)
            return


def _executed(behavior: Behavior, step: BehaviorStep) -> Iterator[Statement]:
    """The statements that a step may execute: those of the left state, of the handler, and of the entered state."""
    states: dict[str, State] = {state.id.value: state for state in behavior.chart.states if state.id}
    left = states.get(behavior.configurations[step.source].state)
    entered = states.get(behavior.configurations[step.target].state)
    yield from statements(left.exit.statements if left and left.exit else ())
    yield from statements(step.handler.targets[step.choice].body)
    yield from statements(entered.entry.statements if entered and entered.entry else ())
