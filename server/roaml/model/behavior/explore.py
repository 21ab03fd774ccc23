# SPDX-License-Identifier: Apache-2.0
"""The graph of a chart: every configuration that it may be in between two events, and every step between them.

A configuration consists of a state, the answers that are owed and awaited in it (`phases`), the goals whose ids are
stored in variables (`ids`), and the knowledge about values. A step handles an event, or is an eventless transition. It
executes everything in the transition (docs/spec/machines.md#onentry) and ends in a configuration. The earlier steps
decide which events may arrive: a response only after its request, a tick only after the answer to the previous tick.

- The graph contains every path that the chart can take, and it may contain paths that it cannot take.
- Its size is bounded. If the knowledge about values has too many variants, it is discarded; a chart that is still too
  large has no graph (`None`).
- It depends on one machine only and is cached as long as its chart exists.
"""

from __future__ import annotations

import weakref
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping

from roaml.exhaustive import Vocabulary, assert_never
from roaml.expr.format import format_expr
from roaml.expr.tree import ErrorExpr, Expr, Name, access_path, walk
from roaml.interruption import checkpoint
from roaml.model.behavior.knowledge import NOTHING, ConditionFacts, Domain, Knowledge, is_literal, variables_in
from roaml.model.behavior.phases import (
    ANY_ID,
    AWAITED_ANSWER,
    HALT,
    OWED,
    TICK,
    Duty,
    DutyKind,
    GoalStatus,
    HeldId,
    HeldIds,
    Phase,
    Phases,
    ProtocolEvent,
    Subject,
    phase_in,
)
from roaml.model.machine import (
    Assign,
    CallChild,
    Chart,
    Declaration,
    Handler,
    If,
    Machine,
    NoEffect,
    ReturnHalted,
    ReturnStatus,
    RosSend,
    Send,
    State,
    Statement,
    statements,
)
from roaml.model.syntax import Expression
from roaml.model.value_types import find_handle
from roaml.record import Record, field, replace
from roaml.roles import ProtocolPart
from roaml.scxml.names import STATUSES
from roaml.text import Span

MAX_CONFIGURATIONS = 4000
"""The maximum number of configurations of a graph, and of paths through the statements of one step."""

MAX_KNOWLEDGE_VARIANTS = 12
"""The maximum number of configurations that differ only in the knowledge about values."""

UNKNOWN_STATE = "?"
"""The state of a configuration after a transition to a state that does not exist. Anything may happen in it."""


class FaultKind(Vocabulary):
    UNASKED = "unasked"
    """Nothing waits for the answer: it was sent before, or never requested."""
    WRONG_KIND = "wrong-kind"
    """A tick that is answered like a halt, or a halt like a tick."""
    UNSTORED = "unstored"
    """A goal id that was never stored."""
    FOREIGN = "foreign"
    """A value that is not the id of a goal."""
    OTHER = "other"
    """The id of a goal of another action."""
    EARLIER = "earlier"
    """The id of an earlier goal instead of that of the goal that has just arrived."""
    REJECTED = "rejected"
    """A result, feedback or the start of a thread for a goal that was rejected."""
    UNDECIDED = "undecided"
    """A result for a goal that has not been accepted."""
    NO_GOAL = "no-goal"
    """A request to cancel a goal while no goal of the client is accepted."""
    THREAD = "thread"
    """A thread that does not exist."""


class Fault(Record, frozen=True):
    """A statement on a path that must not be executed after the previous steps of the path, such as a second answer to
    one request.

    Attributes:
        duty: the duty that the statement answers or concerns.
        statement: the statement that must not be executed.
        certain: whether the fault occurs whatever the conditions in the bodies are.
        source: for `FOREIGN`, the expression that was assigned to the variable; for `EARLIER`, a variable that holds
            the id of the goal that has arrived, or "" if there is none; "" for other kinds.
    """

    kind: FaultKind
    duty: Duty
    statement: Statement
    certain: bool
    source: str = ""


class ChartConfiguration(Record, frozen=True):
    """A configuration of a chart.

    Attributes:
        resting: whether no condition of the eventless handlers holds, so that the machine stays until an event arrives.
    """

    state: str
    phases: Phases = ()
    ids: HeldIds = ()
    knowledge: Knowledge = NOTHING
    resting: bool = False

    def phase(self, subject: Subject, handle: str = "") -> Phase | None:
        return phase_in(self.phases, subject, handle)

    @property
    def tree(self) -> Phase | None:
        """The phase of a plugin: `TICKED`, `HALTING`, `RUNNING` or `ENDED`; `None` if it was neither ticked nor halted
        yet."""
        return phase_in(self.phases, Subject.TREE, "")

    def answering(self, duty: Duty) -> Phase | None:
        """The phase of the response to a request, of the decision on a goal, or of the result of a goal; `None` if the
        machine does not owe it."""
        subject = OWED.get(duty.kind)
        return None if subject is None else phase_in(self.phases, subject, duty.handle)

    def owes(self, duty: Duty) -> bool:
        match duty.kind:
            case DutyKind.TICK:
                return self.tree is Phase.TICKED
            case DutyKind.HALT:
                return self.tree is Phase.HALTING
            case DutyKind.REQUEST | DutyKind.GOAL | DutyKind.RESULT:
                return self.answering(duty) is not None
            case DutyKind.THREAD:
                return False
            case _:
                return assert_never(duty.kind)


class BehaviorStep(Record, frozen=True, eq=False):
    """A step from one configuration to another.

    Attributes:
        source, target: the indices of the configurations in `Behavior.configurations`.
        event: the received event; `None` for a transition without event.
        handler: the handler that is executed; if no condition holds, the last one that was tried.
        choice: the index of the handler's target that is taken.
        ignored: whether no condition holds, so that the event is consumed without effect
            (docs/spec/semantics.md#discarded-events), or, without an event, the machine stays in its state.
        sent: the events that are sent, in order.
        faults: the faults of the statements that are executed.
        certain: whether the target is the same whatever the conditions inside the bodies are.
    """

    source: int
    target: int
    event: ProtocolEvent | None
    handler: Handler
    choice: int
    ignored: bool
    sent: tuple[ProtocolEvent, ...]
    faults: tuple[Fault, ...]
    certain: bool


class Behavior(Record, frozen=True, eq=False):
    """The graph of a chart.

    Attributes:
        owner: refers to the chart. The reference is weak, because the chart caches its graph: otherwise, each version
            of a machine in an editor would remain in memory until the next garbage collection.
        configurations: all configurations, the initial ones first.
        starts: the number of initial configurations.
        steps: all steps; `outgoing` groups them by their source.
        at_start: the events that the `<onentry>` of the initial state sends.
        statuses: the statuses that each `<bt_return_status>` returns on the paths on which the status is known.
        approximate: whether some knowledge was discarded, so that the graph may contain impossible paths.
    """

    owner: weakref.ref[Chart]
    configurations: tuple[ChartConfiguration, ...]
    starts: int
    steps: tuple[BehaviorStep, ...]
    at_start: tuple[ProtocolEvent, ...]
    statuses: Mapping[ReturnStatus, frozenset[str]]
    approximate: bool

    @property
    def chart(self) -> Chart:
        chart = self.owner()
        assert chart is not None, "a graph is used only while its machine is in use"
        return chart

    @property
    def size(self) -> int:
        return len(self.configurations)

    def outgoing(self) -> list[list[BehaviorStep]]:
        by_source: list[list[BehaviorStep]] = [[] for _ in self.configurations]
        for step in self.steps:
            by_source[step.source].append(step)
        return by_source


def explore(machine: Machine, chart: Chart, *, fine: bool = False) -> Behavior | None:
    """The graph of a chart of `machine`; `None` if it has no initial state or is too large.

    It is cached with the chart and discarded with it.

    Args:
        fine: whether values are followed from step to step. This takes longer and excludes more of the impossible
            paths, so it is used for charts that may contain an error.
    """
    known: dict[bool, Behavior | None] = chart.__dict__.setdefault("behavior", {})
    if fine not in known:
        known[fine] = _Explorer(machine, chart, fine).run()
    return known[fine]


class _Path(Record, frozen=True):
    """One path through the statements that a step executes."""

    phases: Phases
    ids: HeldIds
    knowledge: Knowledge
    sent: tuple[ProtocolEvent, ...] = ()
    faults: tuple[Fault, ...] = ()
    certain: bool = True

    def phase(self, subject: Subject, handle: str = "") -> Phase | None:
        return phase_in(self.phases, subject, handle)

    @property
    def tree(self) -> Phase | None:
        return phase_in(self.phases, Subject.TREE, "")

    def at(self, subject: Subject, handle: str, phase: Phase | None) -> _Path:
        key = (subject, handle)
        phases = [entry for entry in self.phases if entry[0] != key]
        if phase is not None:
            phases.append((key, phase))
            phases.sort()
        return replace(self, phases=tuple(phases))

    def wrong(self, kind: FaultKind, duty: Duty, statement: Statement, source: str = "") -> _Path:
        return replace(self, faults=(*self.faults, Fault(kind, duty, statement, self.certain, source)))

    def held(self, variable: str) -> HeldId | None:
        """The goal whose id `variable` holds; `None` if no id was stored in it."""
        return next((held for name, held in self.ids if name == variable), None)

    def holding(self, variable: str, held: HeldId | None) -> _Path:
        ids = [entry for entry in self.ids if entry[0] != variable]
        if held is not None:
            ids.append((variable, held))
            ids.sort()
        return replace(self, ids=tuple(ids))

    def variable_with(self, held: HeldId) -> str:
        """A variable that holds the id `held`; "" if there is none."""
        return next((variable for variable, other in self.ids if other == held), "")

    def with_ids(self, handle: str, before: GoalStatus, after: GoalStatus) -> _Path:
        """A copy of this path in which the goals of the server `handle` with the status `before` have the status
        `after`."""
        old, new = HeldId(before, handle), HeldId(after, handle)
        return replace(self, ids=tuple((variable, new if held == old else held) for variable, held in self.ids))


def _kinds(chart: Chart) -> tuple[Mapping[str, str], frozenset[str], frozenset[str]]:
    """The base types of the scalar variables of a chart, the names of its integer variables and of the event variables
    that contain only integers, and the names of its boolean variables."""
    types = {d.id.value: d.type.name for d in chart.data if d.id and d.type and d.type.name}
    scalar = {name: type_.base for name, type_ in types.items() if not type_.dimensions}
    integers = {name for name, base in scalar.items() if base.startswith(("int", "uint"))} | {"_action", "_bt"}
    return scalar, frozenset(integers), frozenset(name for name, base in scalar.items() if base == "bool")


def condition_facts(chart: Chart) -> ConditionFacts:
    """The facts that are needed to evaluate the conditions of a chart."""
    _, integers, logical = _kinds(chart)
    return ConditionFacts(integers, logical, constants=STATUSES)


class _TooLargeError(Exception):
    pass


EVENT_VARIABLES = frozenset(
    ("_event", "_msg", "_req", "_res", "_goal", "_action", "_feedback", "_wrapped_result", "_bt")
)
"""Variables that hold the data of the current event. They are not available after the step that handles it."""


class _Group(Record, frozen=True):
    """The handlers of a state for one event. `touched` contains the subjects, each with a handle, whose phases the
    steps of the group may read or change."""

    state: State
    event: ProtocolEvent | None
    handlers: tuple[Handler, ...]
    touched: frozenset[tuple[Subject, str]]


_Reaction = tuple[str, _Path, Handler, int, bool]
"""A reaction to an event: the state that it leads to, the path through its statements, its handler, the index of the
handler's target, and whether the event is ignored."""

_ANSWERABLE = (
    ProtocolPart.BT_TICK,
    ProtocolPart.BT_HALT,
    ProtocolPart.REQUEST,
    ProtocolPart.GOAL,
    ProtocolPart.RESPONSE,
    ProtocolPart.RESULT,
    ProtocolPart.CHILD_STATUS,
    ProtocolPart.CHILD_HALTED,
)
"""Events that must be answered, or that are answers: an automaton waits forever if one is discarded because no
condition holds."""
_CODES = (4, 5, 6)
_ARRIVED = {
    ProtocolPart.GOAL: GoalStatus.ASKED,
    ProtocolPart.THREAD_START: GoalStatus.ACCEPTED,
    ProtocolPart.CANCEL: GoalStatus.ACCEPTED,
}
"""An event that carries the id of a goal -> the status of that goal when the event arrives."""
_DECIDED = (GoalStatus.ACCEPTED, GoalStatus.EARLIER, GoalStatus.REJECTED, GoalStatus.FINISHED)
_WRONG_GOAL = {
    GoalStatus.ASKED: FaultKind.UNDECIDED,
    GoalStatus.EARLIER: FaultKind.EARLIER,
    GoalStatus.REJECTED: FaultKind.REJECTED,
    GoalStatus.FINISHED: FaultKind.UNASKED,
}
"""The status of a goal -> the fault if a result, feedback or the start of a thread names a goal with this status."""
_OF_INTERFACES = tuple(subject for subject in Subject if subject not in (Subject.TREE, Subject.CHILD))


class _Explorer(Record, eq=False, dict=True):
    machine: Machine
    chart: Chart
    fine: bool
    numbers: dict[ChartConfiguration, int] = field(default_factory=dict)
    steps: dict[tuple[object, ...], BehaviorStep] = field(default_factory=dict)
    statuses: defaultdict[ReturnStatus, set[str]] = field(default_factory=lambda: defaultdict(set))
    approximate: bool = False

    def __post_init__(self) -> None:
        chart = self.chart
        self.states: dict[str, State] = {}
        for state in chart.states:
            if state.id is not None:
                self.states.setdefault(state.id.value, state)
        self.thread = chart.scope != ""
        self.threaded = {t.server.value for t in self.machine.threads if t.server}
        self.count = next((t.count for t in self.machine.threads if t.chart is chart), None)
        self.counts = {t.server.value: t.count for t in self.machine.threads if t.server and t.count}
        scalar, integers, logical = _kinds(chart)
        counted = self._counted()
        self.relevant = self._relevant(scalar, logical) if self.fine else counted | self._statuses()
        followed = None if not self.fine else self.relevant | EVENT_VARIABLES
        self.facts = ConditionFacts(integers, logical, followed, counted)
        self.status_facts = ConditionFacts(integers, logical, followed, counted, STATUSES)
        self.counts_down = bool(self.counts) and self._counts_down()
        self.deciding = self._deciding()
        self.goal_ids = self._goal_ids()
        self.may_be_ids = self._may_be_ids() if self.goal_ids else frozenset()
        self.declarations: dict[Handler | RosSend, Declaration | None] = {}
        self.effective: dict[tuple[Statement, ...], tuple[Statement, ...]] = {}
        self.groups: dict[str, list[_Group]] = {}
        self.reactions: dict[tuple[State, ProtocolEvent | None, Phases, HeldIds, Knowledge], list[_Reaction]] = {}
        self.group_reactions: list[_Reaction] = []
        self.known_here: dict[tuple[str, Phases, HeldIds], set[Knowledge]] = {}
        self.goal_here = ANY_ID  # the meaning of `_action.goal_id` in the current step

    def declaration(self, user: Handler | RosSend) -> Declaration | None:
        if user not in self.declarations:
            self.declarations[user] = find_handle(self.machine, user)
        return self.declarations[user]

    # --------------------------------------------------- variables that matter

    def _relevant(self, scalar: Mapping[str, str], logical: frozenset[str]) -> frozenset[str]:
        """The variables whose values may decide which path is taken: those that several conditions read, those that
        conditions read and that are booleans or are assigned only literals, those in thread numbers and returned
        statuses, and those that are copied to any of these."""
        read: list[Expr] = [h.cond.tree for state in self.chart.states for h in state.handlers if h.cond]
        relevant = {*self._counted(), *self._statuses()}
        assigned: dict[str, list[Expr | None]] = {}
        for statement in self.chart.statements:
            match statement:
                case If():
                    read += [branch.cond.tree for branch in statement.branches if branch.cond]
                case Assign() if statement.location:
                    value = statement.value.tree if isinstance(statement.value, Expression) else None
                    root = (access_path(statement.location.tree) or ("",))[0]
                    assigned.setdefault(root, []).append(value)
        often = Counter(name for tree in read for name in variables_in((tree,)))
        relevant |= {name for name, count in often.items() if count > 1}
        relevant |= {
            name
            for name in often
            if all(name in logical or (v is not None and is_literal(v)) for v in assigned.get(name, ()))
        }
        sources = set(relevant)
        while sources:
            values = [
                value
                for name in sources
                for value in assigned.get(name, ())
                if isinstance(value, Name) or (value is not None and name in self._counted())
            ]
            sources = {name for name in variables_in(values) if name in scalar} - relevant
            relevant |= sources
        return frozenset(relevant) - EVENT_VARIABLES

    def _statuses(self) -> frozenset[str]:
        """The variables whose values `<bt_return_status>` returns."""
        given = (s.status.value for s in self.chart.statements if isinstance(s, ReturnStatus) and s.status)
        return frozenset(given) - set(STATUSES)

    def _counts_down(self) -> bool:
        """Whether the chart changes a thread number when a thread becomes free. The graph does not contain the number
        of running threads, so in the graph this thread number could decrease without end."""
        numbers = set(self._counted())
        while True:
            values = [
                s.value.tree
                for s in self.chart.statements
                if isinstance(s, Assign) and s.location and isinstance(s.value, Expression)
                if not variables_in((s.location.tree,)).isdisjoint(numbers)
            ]
            if variables_in(values) <= numbers:
                break
            numbers |= variables_in(values)
        return any(
            isinstance(statement, Assign)
            and statement.location is not None
            and not variables_in((statement.location.tree,)).isdisjoint(numbers)
            for state in self.chart.states
            for handler in state.handlers
            if handler.trigger is ProtocolPart.THREAD_FREE
            for target in handler.targets
            for statement in statements(target.body)
        )

    def _counted(self) -> frozenset[str]:
        """The variables that hold thread numbers."""
        started = (s.thread_id.tree for s in self.chart.statements if isinstance(s, RosSend) and s.thread_id)
        return variables_in(started)

    def _deciding(self) -> frozenset[str]:
        """The handles of the actions whose goal responses the machine receives (docs/spec/ros.md#action-client)."""
        handlers = (h for chart in self.machine.charts for state in chart.states for h in state.handlers)
        responses = (find_handle(self.machine, h) for h in handlers if h.trigger is ProtocolPart.GOAL_RESPONSE)
        return frozenset(d.handle.value for d in responses if d is not None and d.handle is not None)

    def _goal_ids(self) -> frozenset[str]:
        """The variables that hold the ids of goals."""
        goal_ids = {
            s.goal_id.tree.name
            for s in self.chart.statements
            if isinstance(s, RosSend) and s.goal_id is not None and isinstance(s.goal_id.tree, Name)
        }
        if not goal_ids:
            return frozenset()
        goal_ids |= {
            s.location.tree.name
            for s in self.chart.statements
            if isinstance(s, Assign) and s.location and isinstance(s.location.tree, Name)
            if isinstance(s.value, Expression) and access_path(s.value.tree) == ("_action", "goal_id")
        }
        while True:
            copied = {
                s.value.tree.name
                for s in self.chart.statements
                if isinstance(s, Assign) and s.location and isinstance(s.value, Expression)
                if isinstance(s.value.tree, Name) and access_path(s.location.tree) in {(name,) for name in goal_ids}
            }
            if copied <= goal_ids:
                return frozenset(goal_ids)
            goal_ids |= copied

    def _may_be_ids(self) -> frozenset[str]:
        """The variables, including those for event data, that may hold the id of a goal: all except the fields of a
        goal, and variables that are computed only from these fields, from constants and from each other."""
        candidates = set(EVENT_VARIABLES - {"_goal"})
        assigned = [
            ((access_path(s.location.tree) or ("",))[0], s.value.tree if isinstance(s.value, Expression) else None)
            for s in self.chart.statements
            if isinstance(s, Assign) and s.location
        ]
        while True:
            more = {
                root for root, value in assigned if value is None or not variables_in((value,)).isdisjoint(candidates)
            }
            if more <= candidates:
                return frozenset(candidates)
            candidates |= more

    # ----------------------------------------------------------------- search

    def run(self) -> Behavior | None:
        initial = self.chart.initial.value if self.chart.initial else ""
        if initial not in self.states:
            return None
        at_start: list[ProtocolEvent] = []
        try:
            entry = self.states[initial].entry
            path = _Path((), (), self._initial())
            paths = self._bodies([entry.statements if entry else ()], [path])
            for entered in paths:
                at_start += entered.sent
                self._number(ChartConfiguration(initial, entered.phases, entered.ids, self._kept(entered.knowledge)))
            starts = len(self.numbers)
            done = 0
            while done < len(self.numbers):
                for configuration in list(self.numbers)[done:]:
                    checkpoint()
                    self._from(configuration, self.numbers[configuration])
                    done += 1
        except _TooLargeError:
            return None
        return Behavior(
            weakref.ref(self.chart),
            tuple(self.numbers),
            starts,
            tuple(self.steps.values()),
            tuple(dict.fromkeys(at_start)),
            {statement: frozenset(answers) for statement, answers in self.statuses.items()},
            self.approximate,
        )

    def _initial(self) -> Knowledge:
        knowledge = NOTHING
        for data in self.chart.data:
            if data.id and data.id.value in self.relevant and isinstance(data.value, Expression):
                value = self.facts.value(NOTHING, data.value.tree)
                if value is not None:
                    knowledge = self.facts.know(knowledge, data.id.value, Domain(frozenset((value,))))
        return knowledge

    def _number(self, configuration: ChartConfiguration) -> int:
        known = self.numbers.get(configuration)
        if known is not None:
            return known
        place = (configuration.state, configuration.phases, configuration.ids)
        here = self.known_here.setdefault(place, set())
        if len(here) >= MAX_KNOWLEDGE_VARIANTS and configuration.knowledge != NOTHING:
            self.approximate = True
            return self._number(replace(configuration, knowledge=NOTHING))
        here.add(configuration.knowledge)
        if len(self.numbers) >= MAX_CONFIGURATIONS:
            raise _TooLargeError
        self.numbers[configuration] = len(self.numbers)
        return self.numbers[configuration]

    def _kept(self, knowledge: Knowledge) -> Knowledge:
        return knowledge.within(self.relevant)

    def _from(self, configuration: ChartConfiguration, number: int) -> None:
        for group in self._groups(configuration.state):
            comes = not configuration.resting if group.event is None else self._may_come(configuration, group.event)
            if comes:
                self._react(configuration, number, group)

    def _groups(self, name: str) -> list[_Group]:
        """The handlers of a state, grouped by the event that they wait for."""
        if name not in self.groups:
            state = self.states.get(name)
            by_event: dict[ProtocolEvent | None, list[Handler]] = {}
            for handler in state.handlers if state else ():
                if handler.effective:
                    by_event.setdefault(self.event(handler), []).append(handler)
            groups = by_event.items()
            self.groups[name] = [_Group(state, e, tuple(hs), self._touched(state, e, hs)) for e, hs in groups if state]
        return self.groups[name]

    def _touched(
        self, state: State, event: ProtocolEvent | None, handlers: Iterable[Handler]
    ) -> frozenset[tuple[Subject, str]]:
        """The subjects, each with a handle, whose phases the steps of a group may read or change."""
        touched: set[tuple[Subject, str]] = {(Subject.TREE, ""), (Subject.CHILD, "")}
        if event is not None:
            handle = event.name
            touched |= {(subject, handle) for subject in _OF_INTERFACES}
        bodies = [state.exit.statements if state.exit else ()]
        for handler in handlers:
            for target in handler.targets:
                entered = self.states.get(target.state.value) if target.state else None
                bodies += [target.body, entered.entry.statements if entered and entered.entry else ()]
        for statement in (inner for body in bodies for inner in statements(body)):
            if isinstance(statement, RosSend):
                declaration = self.declaration(statement)
                handle = declaration.handle.value if declaration and declaration.handle else ""
                awaits = statement.part is ProtocolPart.GOAL and handle not in self.deciding
                touched |= {
                    (subject, handle)
                    for subject in _OF_INTERFACES
                    if awaits or statement.part is ProtocolPart.CANCEL or subject is not Subject.OUTCOME
                }
        return frozenset(touched)

    def event(self, handler: Handler) -> ProtocolEvent | None:
        """The event that a handler waits for; `None` if the handler is eventless."""
        match handler.trigger:
            case None:
                return None
            case ProtocolPart.EVENT:
                return ProtocolEvent(ProtocolPart.EVENT, handler.event.value if handler.event else "")
            case ProtocolPart.BT_TICK | ProtocolPart.BT_HALT:
                return ProtocolEvent(handler.trigger, "")
            case ProtocolPart.CHILD_STATUS | ProtocolPart.CHILD_HALTED:
                return ProtocolEvent(handler.trigger, handler.child.value if handler.child else "")
        declaration = self.declaration(handler)
        handle = declaration.handle if declaration and declaration.handle else handler.handle
        return ProtocolEvent(handler.trigger, handle.value if handle else "")

    def _may_come(self, configuration: ChartConfiguration, event: ProtocolEvent) -> bool:
        match event.part:
            case ProtocolPart.BT_TICK | ProtocolPart.BT_HALT:
                return configuration.tree not in (Phase.TICKED, Phase.HALTING)
            case ProtocolPart.CHILD_STATUS:
                return configuration.phase(Subject.CHILD) in (Phase.TICKED, Phase.SEVERAL)
            case ProtocolPart.CHILD_HALTED:
                return configuration.phase(Subject.CHILD) in (Phase.HALTED, Phase.SEVERAL)
            case ProtocolPart.REQUEST:
                return configuration.phase(Subject.REQUEST, event.name) is None
            case ProtocolPart.GOAL:
                return configuration.phase(Subject.GOAL, event.name) is None
            case ProtocolPart.CANCEL:
                is_followed = self.thread or event.name not in self.threaded
                return not is_followed or configuration.phase(Subject.RESULT, event.name) is not None
            case ProtocolPart.RESPONSE | ProtocolPart.RESULT | ProtocolPart.GOAL_RESPONSE:
                return configuration.phase(AWAITED_ANSWER[event.part], event.name) is not None
        return True

    def _react(self, configuration: ChartConfiguration, number: int, group: _Group) -> None:
        """Add the steps with which a group reacts to its event in a configuration.

        The reactions depend on few phases, so they are computed once for many configurations.
        """
        taken = self._received(_Path(configuration.phases, configuration.ids, configuration.knowledge), group.event)
        inside = tuple(entry for entry in taken.phases if entry[0] in group.touched)
        key = (group.state, group.event, inside, taken.ids, taken.knowledge)
        if key not in self.reactions:
            self.group_reactions = self.reactions[key] = []
            self._decide(group, replace(taken, phases=inside))
        outside = tuple(entry for entry in taken.phases if entry[0] not in group.touched)
        for state, path, handler, choice, ignored in self.reactions[key]:
            phases = tuple(sorted((*outside, *path.phases))) if outside else path.phases
            rests = ignored and group.event is None
            target = self._number(ChartConfiguration(state, phases, path.ids, path.knowledge, rests))
            step = (number, target, group.event, handler, choice, ignored, path.sent, path.faults, path.certain)
            if step not in self.steps:
                self.steps[step] = BehaviorStep(*step)

    def _decide(self, group: _Group, taken: _Path) -> None:
        event, handlers = group.event, group.handlers
        if event is not None and event.part is ProtocolPart.RESULT:
            for code in _CODES:
                with_code = tuple(h for h in handlers if h.type.code in (code, 0))
                if with_code:
                    self._choose(group, with_code, taken)
        elif event is not None and event.part is ProtocolPart.GOAL_RESPONSE:
            self._answered(group, handlers[0], taken)
        else:
            self._choose(group, handlers, taken)

    def _choose(self, group: _Group, handlers: tuple[Handler, ...], taken: _Path) -> None:
        """Add the reactions of the first handler whose condition holds (docs/spec/machines.md#selection).

        If it is unknown which handler this is, the reactions of all handlers that may be the first are added.
        """
        facts, event = self.facts, group.event
        ways = [taken.knowledge]
        matters = event is not None and event.part in _ANSWERABLE
        if event is not None and event.part in (ProtocolPart.CHILD_STATUS, ProtocolPart.CHILD_HALTED):
            facts = self.status_facts
            if event.part is ProtocolPart.CHILD_STATUS:
                ways = [facts.know(taken.knowledge, "_bt.status", Domain(frozenset(STATUSES.values())))]
        for handler in handlers:
            if handler.cond is None:
                self._execute(group, handler, [replace(taken, knowledge=way) for way in ways])
                return
            if not (self.fine or matters):
                self._execute(group, handler, [taken])
                continue
            tree = handler.cond.tree
            holding = [known for way in ways for known in facts.assume(way, tree, True)]
            self._execute(group, handler, [replace(taken, knowledge=way) for way in holding])
            ways = [known for way in ways for known in facts.assume(way, tree, False)]
        if matters or (self.fine and event is None):
            assert group.state.id is not None
            for way in ways:
                # If the conditions enumerate values, no other value is ever sent, and the event is not discarded.
                if not way.enumerates(taken.knowledge):
                    path = replace(taken, knowledge=self._kept(way))
                    self.group_reactions.append((group.state.id.value, path, handlers[-1], 0, True))

    def _answered(self, group: _Group, handler: Handler, taken: _Path) -> None:
        """Add two reactions to the answer to a goal: the goal is accepted and its result is awaited, or it is
        rejected."""
        assert group.event is not None
        for choice, phase in ((0, Phase.AWAITED), (1, None)):
            self._execute(group, handler, [taken.at(Subject.OUTCOME, group.event.name, phase)], choice)

    def _execute(self, group: _Group, handler: Handler, paths: list[_Path], only: int | None = None) -> None:
        state, event = group.state, group.event
        leave = state.exit.statements if state.exit else ()
        arrived = _ARRIVED.get(event.part) if event else None
        self.goal_here = HeldId(arrived, event.name) if event and arrived else ANY_ID
        for choice, target in enumerate(handler.targets):
            if only is not None and choice != only:
                continue
            name = target.state.value if target.state else UNKNOWN_STATE
            entered = self.states.get(name)
            enter = entered.entry.statements if entered and entered.entry else ()
            for path in self._bodies([leave, target.body, enter], paths):
                known = self._kept(path.knowledge) if entered else NOTHING
                after = name if entered else UNKNOWN_STATE
                done = replace(path, knowledge=known)
                # After the decision on a later goal, the earlier goal is an accepted goal again.
                if event is not None and event.part is ProtocolPart.GOAL:
                    done = done.with_ids(event.name, GoalStatus.EARLIER, GoalStatus.ACCEPTED)
                self.group_reactions.append((after, done, handler, choice, False))

    def _received(self, path: _Path, event: ProtocolEvent | None) -> _Path:
        """The path after the arrival of an event, before any statement is executed."""
        if event is None:
            return path
        match event.part:
            case ProtocolPart.BT_TICK:
                return path.at(Subject.TREE, "", Phase.TICKED)
            case ProtocolPart.BT_HALT:
                return path.at(Subject.TREE, "", Phase.HALTING)
            case ProtocolPart.CHILD_STATUS | ProtocolPart.CHILD_HALTED:
                return path if path.phase(Subject.CHILD) is Phase.SEVERAL else path.at(Subject.CHILD, "", None)
            case ProtocolPart.REQUEST:
                return path.at(Subject.REQUEST, event.name, Phase.DUE)
            case ProtocolPart.GOAL:
                path = path.with_ids(event.name, GoalStatus.ACCEPTED, GoalStatus.EARLIER)
                return path.at(Subject.GOAL, event.name, Phase.DUE)
            case ProtocolPart.THREAD_START:
                return path.at(Subject.RESULT, event.name, Phase.DUE)
            case ProtocolPart.RESPONSE | ProtocolPart.RESULT | ProtocolPart.GOAL_RESPONSE:
                subject = AWAITED_ANSWER[event.part]
                several = path.phase(subject, event.name) is Phase.SEVERAL
                return path if several else path.at(subject, event.name, None)
        return path

    # ------------------------------------------------------------- statements

    def _bodies(self, bodies: Iterable[tuple[Statement, ...]], paths: list[_Path]) -> list[_Path]:
        for body in bodies:
            for statement in self._effective(body):
                paths = list(dict.fromkeys(after for path in paths for after in self._run(statement, path)))
                if len(paths) > MAX_CONFIGURATIONS:
                    raise _TooLargeError
        return paths

    def _effective(self, body: tuple[Statement, ...]) -> tuple[Statement, ...]:
        """The statements of a body that affect the graph. Most assignments do not."""
        if body not in self.effective:
            self.effective[body] = tuple(statement for statement in body if self._matters(statement))
        return self.effective[body]

    def _matters(self, statement: Statement) -> bool:
        match statement:
            case Assign():
                root = (access_path(statement.location.tree) or ("",))[0] if statement.location else ""
                return root in self.relevant or root in self.goal_ids
            case If():
                parts = statement.parts
                return any(self._effective(part.body) for part in parts)
        return not isinstance(statement, NoEffect)

    def _run(self, statement: Statement, path: _Path) -> Iterable[_Path]:
        match statement:
            case Assign():
                return self._assign(statement, path)
            case If():
                return self._if(statement, path)
            case ReturnStatus():
                return self._status(statement, path)
            case ReturnHalted():
                return (self._halted(statement, path),)
            case Send():
                return (
                    self._sent(
                        path, ProtocolEvent(ProtocolPart.EVENT, statement.event.value if statement.event else "")
                    ),
                )
            case CallChild():
                busy, called = path.phase(Subject.CHILD), Phase.HALTED if statement.halts else Phase.TICKED
                sent = self._sent(
                    path, ProtocolEvent(ProtocolPart.CHILD_HALT if statement.halts else ProtocolPart.CHILD_TICK, "")
                )
                return (sent.at(Subject.CHILD, "", Phase.SEVERAL if busy else called),)
            case RosSend():
                return (self._communicate(statement, path),)
        return (path,)

    def _sent(self, path: _Path, event: ProtocolEvent) -> _Path:
        return replace(path, sent=(*path.sent, event))

    def _assign(self, statement: Assign, path: _Path) -> Iterable[_Path]:
        if statement.location is None:
            return (path,)
        location = statement.location.tree
        value = statement.value.tree if isinstance(statement.value, Expression) else None
        root = (access_path(location) or ("",))[0]
        if root in self.goal_ids:
            path = path.holding(root, self._stored(location, value, path))
        if root not in self.relevant:
            return (path,)
        return [replace(path, knowledge=k) for k in self.facts.assign(path.knowledge, location, value)]

    def _stored(self, location: Expr, value: Expr | None, path: _Path) -> HeldId | None:
        """The goal whose id the variable holds after an assignment of `value`; `None` if `value` is a constant, or a
        variable in which no id was stored."""
        if not isinstance(location, Name) or value is None or any(isinstance(e, ErrorExpr) for e in walk(value)):
            return ANY_ID
        if access_path(value) == ("_action", "goal_id"):
            goal = self.goal_here
            is_decided = goal.status is GoalStatus.ASKED and path.phase(Subject.GOAL, goal.of) is None
            return ANY_ID if is_decided else goal
        if isinstance(value, Name) and value.name in self.goal_ids:
            return path.held(value.name)
        if self.facts.value(NOTHING, value) is not None:
            return None
        roots = variables_in((value,))
        if roots and roots.isdisjoint(self.may_be_ids):
            return HeldId(GoalStatus.FOREIGN, format_expr(value))
        return ANY_ID

    def _if(self, statement: If, path: _Path) -> Iterable[_Path]:
        if not self.fine:
            return self._any_part(statement, path)
        ways = [path.knowledge]
        parts: list[tuple[list[Knowledge], tuple[Statement, ...]]] = []
        for branch in statement.branches:
            if branch.cond is None:
                parts.append((ways, branch.body))
                continue
            parts.append(([k for way in ways for k in self.facts.assume(way, branch.cond.tree, True)], branch.body))
            ways = [k for way in ways for k in self.facts.assume(way, branch.cond.tree, False)]
        parts.append((ways, statement.otherwise.body if statement.otherwise else ()))
        possible = [(known, body) for known, body in parts if known]
        certain = path.certain and len(possible) == 1
        paths: list[_Path] = []
        for known, body in possible:
            paths += self._bodies([body], [replace(path, knowledge=k, certain=certain) for k in dict.fromkeys(known)])
        return paths

    def _any_part(self, statement: If, path: _Path) -> Iterable[_Path]:
        paths = [after for branch in statement.branches for after in self._bodies([branch.body], [path])]
        paths += self._bodies([statement.otherwise.body], [path]) if statement.otherwise else [path]
        return [replace(after, certain=False) for after in paths]

    def _status(self, statement: ReturnStatus, path: _Path) -> Iterable[_Path]:
        word = statement.status.value if statement.status else ""
        if word in STATUSES:
            answers: tuple[str, ...] = (word,)
        else:
            value = self.facts.value(path.knowledge, Name(Span(0, 0), word))
            answers = tuple(name for name, number in STATUSES.items() if number == value)
        self.statuses[statement].update(answers)
        path = self._sent(path, ProtocolEvent(ProtocolPart.BT_STATUS, ""))
        if path.tree is Phase.TICKED:
            phases = [
                phase
                for phase, is_answer in (
                    (Phase.ENDED, any(answer != "RUNNING" for answer in answers)),
                    (Phase.RUNNING, "RUNNING" in answers),
                )
                if is_answer or not answers
            ]
            return [path.at(Subject.TREE, "", phase) for phase in phases]
        if path.tree is Phase.HALTING:
            return (path.wrong(FaultKind.WRONG_KIND, HALT, statement),)
        return (path.wrong(FaultKind.UNASKED, TICK, statement),)

    def _halted(self, statement: ReturnHalted, path: _Path) -> _Path:
        path = self._sent(path, ProtocolEvent(ProtocolPart.BT_HALTED, ""))
        if path.tree is Phase.HALTING:
            return path.at(Subject.TREE, "", Phase.ENDED)
        if path.tree is Phase.TICKED:
            return path.wrong(FaultKind.WRONG_KIND, TICK, statement)
        return path.wrong(FaultKind.UNASKED, HALT, statement)

    def _communicate(self, statement: RosSend, path: _Path) -> _Path:
        declaration = self.declaration(statement)
        if declaration is None or declaration.handle is None:
            return path
        part, handle = statement.part, declaration.handle.value
        path = self._sent(path, ProtocolEvent(part, handle))
        match part:
            case ProtocolPart.REQUEST:
                return self._awaiting(path, Subject.RESPONSE, handle)
            case ProtocolPart.GOAL:
                return self._awaiting(path, Subject.DECISION if handle in self.deciding else Subject.OUTCOME, handle)
            case ProtocolPart.CANCEL:
                is_accepted = path.phase(Subject.OUTCOME, handle) is not None
                return path if is_accepted else path.wrong(FaultKind.NO_GOAL, Duty(DutyKind.RESULT, handle), statement)
            case ProtocolPart.RESPONSE:
                if path.phase(Subject.REQUEST, handle):
                    return path.at(Subject.REQUEST, handle, None)
                return path.wrong(FaultKind.UNASKED, Duty(DutyKind.REQUEST, handle), statement)
            case ProtocolPart.GOAL_ACCEPTED | ProtocolPart.GOAL_REJECTED:
                return self._decided(statement, path, handle, part is ProtocolPart.GOAL_ACCEPTED)
            case ProtocolPart.RESULT:
                return self._finished(statement, path, handle)
            case ProtocolPart.FEEDBACK:
                goals = (GoalStatus.ASKED, GoalStatus.ACCEPTED, GoalStatus.EARLIER)
                return self._checked_id(statement, path, Duty(DutyKind.RESULT, handle), goals)
            case ProtocolPart.THREAD_START:
                duty = Duty(DutyKind.RESULT, handle)
                path = self._checked_id(statement, path, duty, (GoalStatus.ASKED, GoalStatus.ACCEPTED))
                return self._started(statement, path, handle)
        return path

    def _decided(self, statement: RosSend, path: _Path, handle: str, accepts: bool) -> _Path:
        duty = Duty(DutyKind.GOAL, handle)
        is_due = path.phase(Subject.GOAL, handle) is not None
        goals = (GoalStatus.ASKED,) if is_due else (GoalStatus.ASKED, *_DECIDED)
        path = self._checked_id(statement, path, duty, goals)
        if any(fault.statement is statement and fault.kind is FaultKind.OTHER for fault in path.faults):
            return path
        if not is_due:
            return path.wrong(FaultKind.UNASKED, duty, statement)
        path = path.at(Subject.GOAL, handle, None)
        path = path.with_ids(handle, GoalStatus.ASKED, GoalStatus.ACCEPTED if accepts else GoalStatus.REJECTED)
        if accepts and handle not in self.threaded:
            path = path.at(Subject.RESULT, handle, Phase.SEVERAL if path.phase(Subject.RESULT, handle) else Phase.DUE)
        return path

    def _finished(self, statement: RosSend, path: _Path, handle: str) -> _Path:
        duty = Duty(DutyKind.RESULT, handle)
        before = len(path.faults)
        goals = (GoalStatus.ACCEPTED, GoalStatus.EARLIER)
        path = self._checked_id(statement, path, duty, goals)
        variable = statement.goal_id.tree if statement.goal_id else None
        was_earlier = False
        if isinstance(variable, Name):
            held = path.held(variable.name)
            was_earlier = held == HeldId(GoalStatus.EARLIER, handle)
            if held is not None and held.of == handle and held.status in goals:
                path = path.holding(variable.name, HeldId(GoalStatus.FINISHED, handle))
        if len(path.faults) > before:
            return path.at(Subject.RESULT, handle, None)  # a fault of the id was added: do not report a second fault
        if handle in self.threaded and not self.thread:
            return path
        match path.phase(Subject.RESULT, handle):
            case Phase.SEVERAL if was_earlier and not path.variable_with(HeldId(GoalStatus.EARLIER, handle)):
                return path.at(Subject.RESULT, handle, Phase.DUE)  # only the goal that has just arrived is left
            case Phase.DUE:
                return path.at(Subject.RESULT, handle, None)
            case None:
                return path.wrong(FaultKind.UNASKED, duty, statement)
        return path

    def _awaiting(self, path: _Path, subject: Subject, handle: str) -> _Path:
        return path.at(subject, handle, Phase.SEVERAL if path.phase(subject, handle) else Phase.AWAITED)

    def _checked_id(self, statement: RosSend, path: _Path, duty: Duty, goals: tuple[GoalStatus, ...]) -> _Path:
        """The path, with a fault if the statement does not name a goal by the id with which the goal arrived, or names
        a goal with another status than those in `goals`.

        Args:
            duty: the duty that the statement answers.
            goals: the valid statuses of the goal.
        """
        tree = statement.goal_id.tree if statement.goal_id else None
        if not isinstance(tree, Name) or tree.name not in self.goal_ids:
            return path
        held = path.held(tree.name)
        if held is None:
            return path.wrong(FaultKind.UNSTORED, duty, statement)
        if held.status is GoalStatus.ANY:
            return path
        if held.status is GoalStatus.FOREIGN:
            return path.wrong(FaultKind.FOREIGN, duty, statement, held.of)
        if held.of != duty.handle:
            return path.wrong(FaultKind.OTHER, duty, statement)
        if held.status in goals:
            return path
        if duty.kind is DutyKind.GOAL:
            asked = HeldId(GoalStatus.ASKED, duty.handle)
            return path.wrong(FaultKind.EARLIER, duty, statement, path.variable_with(asked))
        return path.wrong(_WRONG_GOAL[held.status], duty, statement)

    def _started(self, statement: RosSend, path: _Path, handle: str) -> _Path:
        count = self.counts.get(handle)
        if count is None or statement.thread_id is None:
            return path
        values = self.facts.values(path.knowledge, statement.thread_id.tree)
        values = values.narrowed(is_integer=True) or values  # below 2 means at most 1
        if values.only is not None:
            numbers = [number for number in values.only if not isinstance(number, str)]
            below = min(numbers, default=0) < 0 and not self.counts_down
            wrong = below or max(numbers, default=0) >= count
        else:
            is_high = values.high > count if values.high_open else values.high >= count
            wrong = (is_high and values.high != float("inf")) or values.low >= count
        return path.wrong(FaultKind.THREAD, Duty(DutyKind.THREAD, handle), statement) if wrong else path
