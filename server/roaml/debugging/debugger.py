# SPDX-License-Identifier: Apache-2.0
"""A run that is moved to breakpoints, forwards and backwards.

A movement is made in small portions (`Debugger.advance`), so that a caller can interrupt it. Both directions stop at
the same positions: a breakpoint at which a run stops forwards also stops it backwards, in the same state.
"""

from __future__ import annotations

import enum
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cached_property

from roaml.debugging.breakpoints import (
    Breakpoint,
    BreakpointPlaces,
    Breakpoints,
    ExceptionFilter,
    Line,
    Matcher,
    logged,
)
from roaml.debugging.evaluate import Scope
from roaml.debugging.frames import TREE_THREAD, DebugThread, Frame, FrameRole, Stacks, node_of, root_of, threads
from roaml.debugging.scopes import Values
from roaml.debugging.sources import Sources
from roaml.debugging.values import shown
from roaml.durations import short_moment
from roaml.jani.node import Origin
from roaml.record import Record, replace
from roaml.scxml.names import TREE_ROOT_PREFIX, TreeEventKind, received_by, sent_by, tree_event_name
from roaml.simulation.choices import Choice, Outcome
from roaml.simulation.intervention import Intervention
from roaml.simulation.session import Session, ends_tick
from roaml.simulation.state import SystemState
from roaml.simulation.verdicts import Decided, Verdicts
from roaml.smc.fault import FaultError
from roaml.smc.record import TraceStep, TraceVerdict

MAX_STEPS = 200_000
"""The maximum number of steps of one movement. After that, the run stops and can be continued."""
MAX_FIRST_STEPS = 2_000
"""The maximum number of steps of the translation that are taken before the first stop."""
PORTION_S = 0.02
"""The time in s after which a movement returns to its caller, which then handles the requests of the client."""


class Unit(enum.Enum):
    """Where a movement ends if no breakpoint ends it earlier: after a step of the network, after a machine has handled
    an event completely, after a tick of the tree, or at the end of the run."""

    STEP = "step"
    TURN = "turn"
    TICK = "tick"
    END = "end"


class StopReason(enum.Enum):
    """Why a run has stopped. If DAP defines the reason, the value is that of DAP."""

    ENTRY = "entry"
    STEP = "step"
    PAUSE = "pause"
    BREAKPOINT = "breakpoint"
    FUNCTION_BREAKPOINT = "function breakpoint"
    DATA_BREAKPOINT = "data breakpoint"
    EXCEPTION = "exception"
    GOTO = "goto"
    VIOLATED = "violated"
    SATISFIED = "satisfied"
    FAILURE = "failure"
    CHANCE = "chance"
    TIME = "time"
    END = "end of the run"


# A client would show `exception` as an error of the program. These are events of the model.
_REASONS = {
    ExceptionFilter.VIOLATED: StopReason.VIOLATED,
    ExceptionFilter.SATISFIED: StopReason.SATISFIED,
    ExceptionFilter.FAILURE: StopReason.FAILURE,
    ExceptionFilter.CHANCE: StopReason.CHANCE,
    ExceptionFilter.TIME: StopReason.TIME,
}
_DECIDED = {ExceptionFilter.VIOLATED: TraceVerdict.FAILED, ExceptionFilter.SATISFIED: TraceVerdict.PASSED}
"""The verdict at which a filter for properties stops the run."""


class Cause(Record, frozen=True):
    """What has been executed immediately before a stop, and is the reason for it: the statement or node at `origin`, by
    an instance."""

    instance: int
    origin: Origin


class Stop(Record, frozen=True):
    """A stop of a run.

    Attributes:
        thread: the number of the thread that takes the next step, or that has reached the breakpoint.
        text: a description of what has happened, if the reason alone is not enough.
        breakpoints: the numbers of the breakpoints that were reached.
        filter: the exception filter that stopped the run, `VIOLATED` also for a breakpoint on a property; `None` for
            all other reasons.
        cause: the place of the last step because of which the run has stopped; `None` if there is none.
    """

    reason: StopReason
    thread: int
    text: str = ""
    breakpoints: tuple[int, ...] = ()
    filter: ExceptionFilter | None = None
    cause: Cause | None = None


class _Movement(Record):
    """A movement that has begun. `until` is the position at which a movement to a position ends, which passes over
    breakpoints; -1 for other movements."""

    unit: Unit
    forwards: bool
    position: int
    steps: int = 0
    is_first: bool = True
    until: int = -1


Log = Callable[[str, "Origin | None"], None]


class Debugger:
    """A session with breakpoints.

    Args:
        log: receives the messages of log points.

    Attributes:
        fault: the undefined operation because of which the next step cannot be taken; `None` if there is none.
        before: the values before the last movement; `None` if there was none.
    """

    def __init__(self, session: Session, sources: Sources, verdicts: Verdicts, log: Log) -> None:
        self.session = session
        self.sources = sources
        self.breakpoints = Breakpoints()
        self._verdicts = verdicts
        self._log = log
        self.fault: FaultError | None = None
        self._movement: _Movement | None = None
        self._matcher: Matcher | None = None
        self._looked_at = -1
        self._upcoming: TraceStep | None = None
        self._state: SystemState | None = None
        self._values: Values | None = None
        self._stacks: Stacks | None = None
        self._thread = self.threads[0].number if self.threads else TREE_THREAD
        self.before: Values | None = None
        self._follow()

    @cached_property
    def places(self) -> BreakpointPlaces:
        return BreakpointPlaces(self.session, self.sources)

    @cached_property
    def threads(self) -> tuple[DebugThread, ...]:
        return threads(self.session, self.sources)

    @cached_property
    def _threads_of(self) -> dict[int, int]:
        return {thread.instance: thread.number for thread in self.threads if thread.instance >= 0}

    def breakpoints_changed(self) -> None:
        """Update the debugger. Must be called after each change of `breakpoints`."""
        self._matcher = None

    # ------------------------------------------------------------ the state

    def upcoming(self) -> TraceStep | None:
        """The next step; `None` at the end of the run, and if the step fails (`fault`)."""
        if self._looked_at != self.session.position:
            self._looked_at = self.session.position
            self._state = self._values = self._stacks = None
            self.fault = None
            try:
                self._upcoming = self.session.upcoming()
            except FaultError as fault:
                self._upcoming, self.fault = None, fault
        return self._upcoming

    @property
    def state(self) -> SystemState:
        """The state of the system at the position."""
        self.upcoming()
        if self._state is None:
            self._state = self.session.state()
        return self._state

    @property
    def values(self) -> Values:
        upcoming = self.upcoming()
        if self._values is None:
            session = self.session
            verdicts = self._verdicts.verdicts(session.position)
            self._values = Values(session, self.sources, self.state, upcoming, verdicts)
        return self._values

    @property
    def stacks(self) -> Stacks:
        upcoming = self.upcoming()
        if self._stacks is None:
            self._stacks = Stacks(self.session, self.sources, self.state, upcoming)
        return self._stacks

    def stack(self, thread: int, stop: Stop | None = None) -> list[Frame]:
        """The frames of a thread; empty if there is no such thread. If `stop` has a cause in the thread, the innermost
        frame is the cause."""
        frames = next((self.stacks.stack(known) for known in self.threads if known.number == thread), [])
        if stop is None or stop.cause is None or stop.thread != thread:
            return frames
        return [self.stacks.executed(thread, stop.cause.instance, stop.cause.origin), *frames]

    def scope(self, instance: int) -> Scope:
        """The values of the names that expressions in an instance can use."""
        return self.values.names(Frame(0, "", None, instance, 0, FrameRole.STATEMENT))

    @property
    def verdicts(self) -> dict[str, TraceVerdict]:
        return self._verdicts.verdicts(self.session.position)

    # ------------------------------------------------------------ moving

    def begin(self, unit: Unit, *, forwards: bool = True, stops_here: bool = False) -> None:
        """Begin a movement, which `advance` continues.

        Args:
            stops_here: whether a breakpoint on the next step stops at once.
        """
        self._remember()
        self._movement = _Movement(unit, forwards, self.session.position, is_first=not stops_here)

    def begin_going_to(self, position: int) -> None:
        """Begin a movement to a position. If the run is shorter, new steps are taken, at most up to its end."""
        self._remember()
        self.session.jump(min(position, len(self.session.steps)))
        self._follow()
        self._movement = _Movement(Unit.STEP, True, self.session.position, until=position)

    def interrupt(self) -> Stop:
        """End the movement at the position that it has reached; return the stop."""
        self._settle()
        return self._stop(StopReason.PAUSE)

    def _settle(self) -> None:
        """End the movement. After a backward movement, go to the position that it has reached."""
        movement, self._movement = self._movement, None
        if movement is not None and not movement.forwards:
            self.session.jump(movement.position)

    @property
    def is_moving(self) -> bool:
        return self._movement is not None

    def advance(self, portion: float = PORTION_S) -> Stop | None:
        """Continue the movement for at most `portion` s; return `None` if it has not ended yet."""
        movement = self._movement
        if movement is None:
            return None
        deadline = time.monotonic() + portion
        stop = None
        while stop is None and time.monotonic() < deadline:
            stop = self._portion(movement)
            movement.is_first = False
            movement.steps += 1
            if stop is None and movement.steps >= MAX_STEPS:
                self._settle()
                stop = self._stop(StopReason.PAUSE, f"{MAX_STEPS:,} steps were taken without reaching a breakpoint")
        if stop is not None:
            self._movement = None
        return stop

    def _portion(self, movement: _Movement) -> Stop | None:
        """Take or examine a step."""
        try:
            if movement.until >= 0:
                return self._nearer(movement.until)
            return self._forwards(movement) if movement.forwards else self._backwards(movement)
        except FaultError as fault:
            self._looked_at, self._upcoming, self.fault = self.session.position, None, fault
            self._state = self._values = self._stacks = None
            return self._stop(StopReason.EXCEPTION, fault.message)

    def _nearer(self, position: int) -> Stop | None:
        if self.session.position < position and self.session.step() is not None:
            self._follow()
            return None
        is_there = self.session.position == position
        return self._stop(StopReason.GOTO, "" if is_there else f"the run ends after {self.session.position:,} steps")

    def _forwards(self, movement: _Movement) -> Stop | None:
        step = self.session.step()
        if step is None:
            return self._end()
        decided = self._follow()
        matcher = self._match()
        if not movement.is_first and (hits := matcher.before(step)):
            self.session.back()
            reached = self._reached(hits)
            if reached:
                return self._stop_at(reached)
            self.session.step()
        reached = self._reached(matcher.after(step, decided))
        if reached:
            return self._stop_at(reached)
        return self._stop(StopReason.STEP) if self._is_far_enough(movement.unit, step) else None

    def _backwards(self, movement: _Movement) -> Stop | None:
        """Examine the step before `movement.position`. The session itself only moves to positions where it may stop."""
        if movement.position == 0:
            self.session.jump(0)
            return self._stop(StopReason.ENTRY, "this is the start of the run")
        step = self.session.steps[movement.position - 1]
        matcher = self._match()
        if not movement.is_first and (hits := matcher.after(step, self._verdicts.at(movement.position))):
            self.session.jump(movement.position)
            if reached := self._reached(hits):
                return self._stop_at(reached)
        movement.position -= 1
        if hits := matcher.before(step):
            self.session.jump(movement.position)
            if reached := self._reached(hits):
                return self._stop_at(reached)
        if movement.unit is Unit.STEP:
            self.session.jump(movement.position)
            return self._stop(StopReason.STEP)
        return None

    def _is_far_enough(self, unit: Unit, step: TraceStep) -> bool:
        match unit:
            case Unit.STEP:
                return True
            case Unit.TURN:
                return self.session.ends_turn(step)
            case Unit.TICK:
                return ends_tick(step)
            case Unit.END:
                return False

    def go_to(self, position: int) -> Stop:
        """Go to a position of the run; to its last one if it has fewer steps."""
        self._remember()
        self.session.jump(min(position, len(self.session.steps)))
        self._follow()
        return self._stop(StopReason.GOTO)

    def choose(self, choice: Choice, outcome: Outcome | None) -> Stop:
        """Take a step that the user has chosen. The steps after the current position are discarded."""
        self._remember()
        position = self.session.position
        self.session.step(choice, outcome)
        self._verdicts.discard(position)
        self._looked_at = -1
        decided = self._follow()
        after = self._reached(self._match().after(self.session.steps[position], decided))
        return self._stop_at(after) if after else self._stop(StopReason.STEP)

    def intervene(self, change: Intervention) -> Stop:
        """Change the state as the user requests. The steps after the current position are discarded."""
        self._remember()
        position = self.session.position
        self.session.intervene(change)
        self._verdicts.discard(position)
        self._looked_at = -1
        self._follow()
        return self._stop(StopReason.STEP)

    def restart_frame(self, frame: Frame) -> Stop:
        """Go back to the position where a frame began: where a handler received its event, a state was entered, or a
        node was ticked."""
        steps = self.session.steps
        position = self.session.position
        tick = tree_event_name(frame.node, TreeEventKind.TICK)
        for index in range(position - 1, -1, -1):
            step = steps[index]
            if frame.role is FrameRole.NODE:
                if received_by(step.action or "") == tick:
                    return self.go_to(index)
                continue
            for part in step.parts:
                if part.instance != frame.instance:
                    continue
                is_handler = frame.role in (FrameRole.HANDLER, FrameRole.STATEMENT) and received_by(step.action or "")
                if is_handler:
                    return self.go_to(index)
                if frame.role is FrameRole.STATE and self._enters(
                    part.source, part.destination.location, part.instance
                ):
                    return self.go_to(index + 1)
        return self.go_to(0)

    def _enters(self, source: str, destination: str, instance: int) -> bool:
        return destination != source and self.session.is_state(instance, destination)

    # ------------------------------------------------------------ parts

    def _remember(self) -> None:
        self.before = self.values

    def _follow(self) -> list[Decided]:
        session = self.session
        return self._verdicts.follow(session.decisions, session.position, session.end is not None)

    def _match(self) -> Matcher:
        if self._matcher is None:
            self._matcher = Matcher(self.session, self.sources, self.places, self.breakpoints)
        return self._matcher

    def _reached(self, hits: Iterable[tuple[Breakpoint, int]]) -> list[tuple[Breakpoint, int]]:
        """The breakpoints that stop the run in the current state. The messages of log points are logged."""
        reached = []
        for breakpoint_, instance in dict.fromkeys(hits):
            needs_scope = breakpoint_.condition is not None or breakpoint_.message
            scope: Scope = self.scope(instance) if needs_scope else _nothing
            if not breakpoint_.is_met(scope) or not breakpoint_.stops():
                continue
            if breakpoint_.message:
                self._log(logged(breakpoint_.message, scope), self._origin_of(breakpoint_, instance))
            else:
                reached.append((breakpoint_, instance))
        return reached

    def _origin_of(self, breakpoint_: Breakpoint, instance: int) -> Origin | None:
        """The place of a breakpoint in the next step: the statement at its line, otherwise where the step begins."""
        parts = self._upcoming.parts if self._upcoming else ()
        part = next((part for part in parts if part.instance == instance), None)
        if part is None:
            return None
        assigned = (assignment.origin for assignment in part.destination.assignments)
        places = self.breakpoints.lines.items()
        lines = {Line(path, line) for path, of_file in places for line, other in of_file if other is breakpoint_}
        origins = (part.edge.origin, part.destination.origin, *assigned)
        return next((origin for origin in origins if self.places.line(origin) in lines), part.edge.origin)

    def _end(self) -> Stop:
        end = self.session.end
        return self._stop(StopReason.END, "no step is possible" if end is None else end.text)

    def _stop_at(self, reached: list[tuple[Breakpoint, int]]) -> Stop:
        breakpoints = self.breakpoints
        first, instance = reached[0]
        numbers = tuple(breakpoint_.number for breakpoint_, _ in reached if breakpoint_.number)
        filter_ = self._filter_of(first)
        reason = StopReason.BREAKPOINT if filter_ is None else _REASONS[filter_]
        if any(breakpoint_ is first for _, breakpoint_ in breakpoints.names):
            reason = StopReason.FUNCTION_BREAKPOINT
        elif any(breakpoint_ is first for _, breakpoint_ in breakpoints.variables):
            reason = StopReason.DATA_BREAKPOINT
        elif self._match().is_on_property(first):
            filter_ = ExceptionFilter.VIOLATED
        text = first.name if filter_ is None else self._text(filter_)
        cause = None if filter_ is None else self._cause(filter_)
        stop = self._stop(reason, text, numbers, instance if cause is None else cause.instance)
        return replace(stop, filter=filter_, cause=cause)

    def _filter_of(self, breakpoint_: Breakpoint) -> ExceptionFilter | None:
        """The filter to which a breakpoint belongs; `None` if it belongs to a line, a name or a variable."""
        filters = self.breakpoints.filters.items()
        return next((filter_ for filter_, of_filter in filters if of_filter is breakpoint_), None)

    def _decided(self, filter_: ExceptionFilter) -> list[Decided]:
        """The properties that are decided in the current state with the verdict of a filter."""
        decided = self._verdicts.at(self.session.position)
        return [property_ for property_ in decided if property_.verdict is _DECIDED.get(filter_)]

    def _cause(self, filter_: ExceptionFilter) -> Cause | None:
        """What decided the properties, or failed, in the last step. `None` if no variable that the properties read has
        changed, for example because the time has passed in which it should change."""
        step = self.session.steps[self.session.position - 1]
        parts = self.session.actors(step)
        places = [(part.instance, part.edge.origin) for part in parts]
        if filter_ in _DECIDED:
            read = {name for property_ in self._decided(filter_) for name in property_.variables}
            if all(change.variable.name not in read for change in step.changes):
                return None
            assignments = [(part.instance, a) for part in parts for a in part.destination.assignments]
            places = [(instance, a.origin) for instance, a in assignments if a.variable in read] + places
        elif filter_ is not ExceptionFilter.FAILURE:
            return None
        written = ((instance, origin) for instance, origin in places if self.sources.place(origin) is not None)
        return next((Cause(instance, origin) for instance, origin in written if origin is not None), None)

    def explanation(self, stop: Stop) -> tuple[str, tuple[str, ...]]:
        """Why the run has stopped, for readers.

        Returns:
            What has happened, as a clause, and further lines: what the decided properties require, and the last
            messages and the variables that they read.
        """
        if stop.filter is None or not (decided := self._decided(stop.filter)):
            return stop.text, ()
        comments = self.sources.comments
        lines = [comments[property_.name] for property_ in decided if property_.name in comments]
        variables = {name for property_ in decided for name in property_.variables}
        entries = self.values.read_by(variables)
        lines += [f"{entry.name}: {shown(entry.value)}, {entry.type}" for entry in entries]
        if stop.cause is None and self.session.end is not None:
            lines.append(f"the run has ended: {self.session.end.text}")
        names = ", ".join(property_.name for property_ in decided)
        subject = f"the property {names} is" if len(decided) == 1 else f"the properties {names} are"
        return f"{subject} {stop.filter.value}", tuple(lines)

    def _text(self, filter_: ExceptionFilter) -> str:
        match filter_:
            case ExceptionFilter.VIOLATED | ExceptionFilter.SATISFIED:
                return f"{filter_.value}: {', '.join(property_.name for property_ in self._decided(filter_))}"
            case ExceptionFilter.FAILURE:
                step = self.session.steps[self.session.position - 1]
                number = sent_by(step.action or "").split("_")[1]
                node = self.sources.nodes.get(int(number))
                return f"{self.session.names[node.automaton] if node else 'a node'} fails"
            case ExceptionFilter.CHANCE:
                return "the next step is decided by chance"
            case ExceptionFilter.TIME:
                return f"time advances to {short_moment(self.session.time or 0.0)}"

    def _stop(
        self,
        reason: StopReason,
        text: str = "",
        breakpoints: tuple[int, ...] = (),
        instance: int = -1,
    ) -> Stop:
        self._thread = self._thread_at(instance)
        return Stop(reason, self._thread, text, breakpoints)

    def entry(self) -> Stop:
        """The stop at the start of the run: before the first step that somebody has written. A saved run stays at its
        position."""
        if self.session.position == 0:
            self._skip_translation()
        return self._stop(StopReason.ENTRY)

    def _skip_translation(self) -> None:
        """Take the steps of the translation before the first other one; none if there is no other one, or if a property
        is decided before."""
        session = self.session
        for _ in range(MAX_FIRST_STEPS):
            upcoming = self.upcoming()
            if upcoming is None or not session.is_of_translation(upcoming):
                break
            session.step()
            if self._follow():
                break
        if self.upcoming() is None:
            session.jump(0)

    @contextmanager
    def elsewhere(self) -> Iterator[Session]:
        """Look at other positions of the run: within the context, the session may move. Then it returns to its
        position."""
        position = self.session.position
        try:
            yield self.session
        finally:
            self.session.jump(position)

    def follow(self) -> None:
        """Decide the properties up to the position of the session, within `elsewhere`."""
        self._follow()

    def first_stop(self, after: int, to: int) -> tuple[int, str] | None:
        """The first position after `after`, up to `to`, at which a breakpoint stops the run, with the reason ("" for a
        breakpoint on a line), within `elsewhere`; `None` if there is none. The steps up to `to` have been taken."""
        matcher, steps = self._match(), self.session.steps
        for position in range(after + 1, to + 1):
            hits = matcher.after(steps[position - 1], self._verdicts.at(position))
            if position == len(steps):
                self.session.jump(position)
                upcoming = self.upcoming()
            else:
                upcoming = steps[position]
            hits += matcher.before(upcoming) if upcoming is not None else []
            if hits:
                self.session.jump(position)
                reached = self._reached(hits)
                if reached:
                    filter_ = self._filter_of(reached[0][0])
                    return position, reached[0][0].name if filter_ is None else self._text(filter_)
        return None

    @property
    def decided(self) -> list[Decided]:
        """The properties that are decided in the part of the run that has been followed, in the order of their
        positions."""
        return self._verdicts.decided

    def _thread_at(self, instance: int) -> int:
        """The thread of an instance; if there is none, the thread of the first instance that takes part in the next
        step."""
        upcoming = self.upcoming()
        actors = [] if upcoming is None else [part.instance for part in self.session.actors(upcoming)]
        for actor in (instance, *actors):
            if actor in self._threads_of:
                return self._threads_of[actor]
            name = self.session.automata[actor] if actor >= 0 else ""
            if self.sources.nodes and (node_of(name) or name.startswith(TREE_ROOT_PREFIX)):
                return self._tree_thread(name)
        return self._thread

    def _tree_thread(self, automaton: str) -> int:
        """The thread of the tree of which an automaton is a node or the root."""
        trees = [thread for thread in self.threads if thread.root]
        if (number := node_of(automaton)) in self.sources.nodes:
            root = root_of(number, self.sources)
            return next(thread.number for thread in trees if thread.root == root)
        own = automaton.removeprefix(TREE_ROOT_PREFIX)
        return next((t.number for t in trees if self.sources.nodes[t.root].tree == own), TREE_THREAD)


def _nothing(_: str) -> None:
    return None
