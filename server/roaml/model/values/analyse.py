# SPDX-License-Identifier: Apache-2.0
"""The values in one machine, in every state and expression.

Each chart is interpreted with sets of values: from the initial values, through all transitions whose conditions can
hold, until the sets at all states stay the same. Sets that grow for `MAX_VISITS` passes are widened; then they are
narrowed again by the conditions of the model.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Expr,
    Index,
    Member,
    Name,
    Number,
    ObjectLiteral,
    Unary,
    access_path,
    walk,
)
from roaml.expr.types import INTEGER_RANGES, Array, Scalar, ScalarKind, Struct, Type, is_kind, leaves
from roaml.interruption import checkpoint
from roaml.language import HL_SCXML
from roaml.model.behavior.explore import EVENT_VARIABLES
from roaml.model.machine import (
    Assign,
    Chart,
    Data,
    Handler,
    If,
    Machine,
    Param,
    RosSend,
    Send,
    SetOutput,
    State,
    Statement,
    Target,
    statements,
)
from roaml.model.syntax import Expression, PortRead, Value
from roaml.model.triggers import Trigger, chooses, trigger
from roaml.model.value_types import GOAL_STATUSES, TypedMachine, find_handle
from roaml.model.values.domain import (
    ANYTHING,
    BOTH,
    NONE,
    Origin,
    ValueSet,
    between,
    exactly,
    join,
    listed,
    widen,
)
from roaml.model.values.evaluate import Evaluator, Valuation, is_within, joined_valuations, literal, place_of
from roaml.model.values.remembered import Memory, RememberedPart, effects, names_in, names_of, root, text_of
from roaml.model.values.strides import strides
from roaml.record import Record, field
from roaml.roles import ProtocolPart
from roaml.scxml.names import STATUSES
from roaml.suggest import close_names
from roaml.text import Span

MAX_VISITS = 14
"""The number of times that the sets at a state may grow before they are widened."""

MAX_NARROWINGS = 3
"""The number of passes that narrow sets after they were widened."""

Fields: TypeAlias = "Mapping[str, ValueSet]"
"""The values of the leaf fields of a message, or of the parameters of an event, by dotted path. A field that is not
contained may have any value."""


Kept: TypeAlias = "Mapping[str, Expr]"
"""Boolean variable -> the condition whose result it keeps: an earlier statement of the same content assigned it, and
none has changed a variable of the condition since."""
NOTHING_KEPT: Kept = {}


class DataChannel(Record, frozen=True):
    """What arrives or is sent: a part of a ROS interface, with the handle; or an event or a port, with its name."""

    part: ProtocolPart
    name: str


Sent: TypeAlias = "Mapping[DataChannel, Fields]"
"""What a machine sends. A channel that is not contained is not used on any path."""
Arriving: TypeAlias = "Mapping[DataChannel, Fields]"
"""What can arrive at a machine. Nothing is known about the data of a channel that is not contained."""


class ConditionValues(Record, frozen=True):
    """The results of a condition.

    Attributes:
        alone: the results when the event arrives, or when the `<if>` is reached.
        here: the results where it is tested, after the earlier conditions did not hold; empty if it is never tested.
    """

    alone: ValueSet
    here: ValueSet


class ChartValues(Record, frozen=True, eq=False):
    """The values in a chart.

    Attributes:
        states: state that is entered -> the values of variables while the machine waits in it.
        conditions: the place of a condition -> its results; conditions in parts that are not executed are left out.
        seen: the place of an expression -> its values; expressions in parts that are not executed are left out.
        lengths: the place of an index -> the lengths of its array where it is used.
        uncovered: the place of the last condition of the handlers of a state for one event, all of which have
            conditions -> the values with which none of the conditions holds; left out if one of them always holds.
    """

    states: Mapping[str, Mapping[str, ValueSet]]
    conditions: Mapping[Span, ConditionValues]
    seen: Mapping[Span, ValueSet]
    lengths: Mapping[Span, ValueSet]
    uncovered: Mapping[Span, Mapping[str, ValueSet]]

    def at(self, expr: Expr) -> ValueSet | None:
        """The values of an expression; `None` if it is not evaluated on any path."""
        return self.seen.get(expr.span)


class MachineValues(Record, frozen=True, eq=False):
    """The values in a machine.

    Attributes:
        charts: scope of a chart -> its values. A chart with an unreadable part is left out.
        arriving: what can arrive at the machine.
        sent: what the machine sends.
        complete: whether all charts are contained, so that `sent` contains everything.
    """

    charts: Mapping[str, ChartValues]
    arriving: Arriving
    sent: Sent
    complete: bool


NO_VALUES = MachineValues({}, {}, {}, complete=False)

RESULT_CODE = ".code"
"""The key in `Fields` of the code of a result, which is not one of its fields."""


def analyse(
    machine: Machine,
    typed: TypedMachine,
    arriving: Arriving,
    ignored: frozenset[Span] = frozenset(),
    *,
    is_bounded: bool = False,
    memory: Memory | None = None,
) -> MachineValues:
    """The values in `machine` if the data that arrive are those in `arriving`.

    Args:
        ignored: the places of conditions that may have both results whatever the values are.
        is_bounded: whether only the values of the first passes are returned, instead of widened ones.
        memory: the memory of earlier analyses of this machine, to which this one is added.
    """
    memory = memory or Memory()
    charts: dict[str, ChartValues] = {}
    sent: dict[DataChannel, Fields] = {}
    broken = {v.place.chart for v in typed.values if isinstance(v.value, Expression) and v.value.broken}
    for chart in machine.charts:
        if chart not in broken and _is_whole(chart) and not _is_misread(chart, typed):
            interpreter = _Interpreter(machine, chart, typed, arriving, ignored, is_bounded, memory)
            charts[chart.scope] = interpreter.run()
            for channel, fields in interpreter.sent.items():
                sent[channel] = merged(sent[channel], fields) if channel in sent else fields
    return MachineValues(charts, arriving, sent, len(charts) == len(machine.charts))


def merged(first: Fields, second: Fields) -> Fields:
    """The fields that have values in both, with all their values."""
    return {path: join(values, second[path]) for path, values in first.items() if path in second}


def of_type(type_: Type) -> ValueSet:
    """All values of a type."""
    if isinstance(type_, Scalar):
        if type_.kind is ScalarKind.BOOL:
            return BOTH
        if type_.name in INTEGER_RANGES:
            low, high = INTEGER_RANGES[type_.name]
            return between(low, high, Origin.ASSUMED, Origin.ASSUMED)
    return ANYTHING


def values_by_type(type_: Type, place: str) -> Iterator[tuple[str, ValueSet]]:
    """The places in a value of `type_` at `place`, also those of elements, such as `path[].x`, each with the values of
    its type, if these have bounds."""
    match type_:
        case Array():
            yield from values_by_type(type_.element, f"{place}[]")
        case Struct():
            for name, member in type_.members:
                yield from values_by_type(member, f"{place}.{name}" if place else name)
        case _:
            values = of_type(type_)
            if values != ANYTHING:
                yield place, values


_DEFAULTS: Mapping[ScalarKind, bool | str] = {ScalarKind.BOOL: False, ScalarKind.STRING: ""}


def default_of(type_: Type) -> ValueSet:
    """The value of a field that is not set."""
    if isinstance(type_, Scalar):
        return exactly(_DEFAULTS.get(type_.kind, 0))
    return ANYTHING


def _is_whole(chart: Chart) -> bool:
    """Whether the initial state and all targets exist."""
    states = {state.id.value for state in chart.states if state.id}
    targets = [t.state for s in chart.states for h in s.handlers if h.effective for t in h.targets]
    return all(name is not None and name.value in states for name in (chart.initial, *targets))


def _is_misread(chart: Chart, typed: TypedMachine) -> bool:
    """Whether a chart contains an assignment whose location is unknown, or a misspelled element, which may be an
    assignment or a transition: then variables have other values than the rest of the chart assigns."""
    known = typed.variables.get(chart.scope, {})
    for statement in chart.statements:
        if isinstance(statement, Assign):
            path = () if statement.location is None else access_path(statement.location.tree) or ()
            if not path or path[0] not in known:
                return True
    inside = (element for state in chart.states for element in state.element.walk() if not element.is_foreign)
    return any(close_names(name, HL_SCXML.elements) for name in {e.name for e in inside} - HL_SCXML.elements.keys())


_DATA_OF = {
    ProtocolPart.MESSAGE: "_msg",
    ProtocolPart.REQUEST: "_req",
    ProtocolPart.RESPONSE: "_res",
    ProtocolPart.GOAL: "_goal",
    ProtocolPart.THREAD_START: "_goal",
    ProtocolPart.FEEDBACK: "_feedback",
    ProtocolPart.RESULT: "_wrapped_result.result",
    ProtocolPart.EVENT: "_event.data",
}
"""What arrives -> the place of its data (docs/spec/machines.md#event-variables)."""


def data_place(part: ProtocolPart) -> str | None:
    """The place of the data that arrive with a part of the protocol, such as `_msg`; `None` if there are none."""
    return _DATA_OF.get(part)


class _Group(Record, frozen=True):
    """Handlers of a state that are tested in order, and the values of the data of their event."""

    handlers: tuple[Handler, ...]
    data: Valuation
    part: RememberedPart


class _Interpreter(Record, eq=False, dict=True):
    machine: Machine
    chart: Chart
    typed: TypedMachine
    arriving: Arriving
    ignored: frozenset[Span]
    is_bounded: bool
    memory: Memory
    entered: dict[str, Valuation] = field(default_factory=dict)
    conditions: dict[Span, ConditionValues] = field(default_factory=dict)
    sent: dict[DataChannel, Fields] = field(default_factory=dict)
    uncovered: dict[Span, Valuation] = field(default_factory=dict)

    def __post_init__(self) -> None:
        chart = self.chart
        self.states = {state.id.value: state for state in reversed(chart.states) if state.id}
        types = self.typed.variables.get(chart.scope, {})
        self.whole = {
            ".".join((name, *path))
            for name, type_ in types.items()
            for path, leaf in leaves(type_)
            if is_kind(leaf, ScalarKind.INT)
        }
        self.capacities = {
            ".".join((name, *path, "length")): leaf.bound
            for name, type_ in types.items()
            for path, leaf in leaves(type_)
            if isinstance(leaf, Array) and leaf.bound is not None
        }
        # Not a method: a cycle of references would keep the machine in memory until the next garbage collection.
        self.evaluator = Evaluator(
            functools.partial(_is_whole_in, self.whole),
            dict(STATUSES),
            {place: values for name, type_ in types.items() for place, values in values_by_type(type_, name)},
            strides(chart, self.whole),
        )
        self.thresholds = sorted(self._thresholds())
        self.groups: dict[str, tuple[RememberedPart, list[_Group]]] = {}
        ports = {
            channel.name: frozenset(fields.items())
            for channel, fields in self.arriving.items()
            if channel.part is ProtocolPart.BLACKBOARD
        }
        strided = dict(self.evaluator.strides)
        self.variables = (frozenset(self.whole), *(frozenset(d.items()) for d in (self.capacities, ports, strided)))

    def _thresholds(self) -> set[float]:
        numbers: set[float] = set()
        values = [value.value for value in self.typed.values if value.place.chart is self.chart]
        for value in values:
            for node in walk(value.tree) if isinstance(value, Expression) else ():
                if isinstance(node, Number):
                    numbers |= {node.value - 1, node.value, node.value + 1, -node.value}
        return numbers

    # ------------------------------------------------------------- the passes

    def run(self) -> ChartValues:
        start = self._start()
        assert self.chart.initial is not None
        initial = self.chart.initial.value
        self.entered[initial] = start
        if self._ascend(initial):
            self._narrow(initial, start)
        self.evaluator.records = True
        self._start()
        for name in self.entered:
            checkpoint()
            for _ in self._from(name, self.entered[name]):
                pass
        return ChartValues(
            dict(self.entered), self.conditions, self.evaluator.seen, self.evaluator.lengths, self.uncovered
        )

    def _ascend(self, initial: str) -> bool:
        """Follow all transitions until no set grows; the result states whether sets were widened."""
        visits: dict[str, int] = {}
        joined: dict[tuple[str, str, int], Valuation] = {}
        waiting = {initial: None}
        widened = False
        while waiting:
            checkpoint()
            name = next(iter(waiting))
            del waiting[name]
            for number, (target, known) in enumerate(self._from(name, self.entered[name])):
                before = self.entered.get(target)
                last = joined.get((name, target, number), {})
                joined[name, target, number] = known
                if before is None:
                    after = known
                else:
                    after = _grown(before, known, last)
                    if after is before:
                        continue
                    visits[target] = visits.get(target, 0) + 1
                    if visits[target] > MAX_VISITS:
                        if self.is_bounded:
                            continue
                        widened = True
                        after = {place: widen(before[place], v, self.thresholds) for place, v in after.items()}
                self.entered[target] = after
                waiting[target] = None
        return widened

    def _narrow(self, initial: str, start: Valuation) -> None:
        for _ in range(MAX_NARROWINGS):
            entered: dict[str, Valuation] = {initial: start}
            for name, known in self.entered.items():
                checkpoint()
                for target, arrived in self._from(name, known):
                    entered[target] = joined_valuations(entered[target], arrived) if target in entered else arrived
            if entered == self.entered:
                return
            self.entered = entered

    # ------------------------------------------------------------ transitions

    def _start(self) -> Valuation:
        known: Valuation = {}
        types = self.typed.variables.get(self.chart.scope, {})
        for data in reversed(self.chart.data):
            if data.id is not None:
                known |= self._initial(data, types.get(data.id.value))
        assert self.chart.initial is not None
        entry = self.states[self.chart.initial.value].entry
        return self._body(entry.statements, known) if entry else known

    def _initial(self, data: Data, type_: Type | None) -> Valuation:
        assert data.id is not None
        name = data.id.value
        if isinstance(data.value, PortRead):
            return {name: self._port(data.value, type_)} if isinstance(type_, Scalar) else {}
        return dict(literal(name, data.value.tree)) if data.value is not None else {}

    def _port(self, read: PortRead, type_: Type | None) -> ValueSet:
        fields = self.arriving.get(DataChannel(ProtocolPart.BLACKBOARD, read.key.value if read.key else ""), {})
        return fields.get("") or (of_type(type_) if type_ is not None else ANYTHING)

    def _groups(self, name: str) -> tuple[RememberedPart, list[_Group]]:
        """The handlers of a state, as a whole and by their triggers."""
        if name not in self.groups:
            by_trigger: dict[Trigger | int | None, list[Handler]] = {}
            for number, handler in enumerate(self.states[name].handlers):
                if handler.effective:
                    key = trigger(self.machine, handler)
                    by_trigger.setdefault(number if key is None else key, []).append(handler)
            groups = [self._group(self.states[name], tuple(handlers)) for handlers in by_trigger.values()]
            names = frozenset(name for group in groups for name in group.part.names)
            self.groups[name] = RememberedPart(tuple(group.part.content for group in groups), names), groups
        return self.groups[name]

    def _group(self, state: State, handlers: tuple[Handler, ...]) -> _Group:
        data = self._data(handlers[0])
        leaving = state.exit.statements if state.exit else ()
        tests = [(text_of(h.cond), h.cond is not None and h.cond.span in self.ignored, chooses(h)) for h in handlers]
        bodies = [[(target, self._entry(target)) for target in handler.targets] for handler in handlers]
        done = tuple(
            tuple((t.state.value if t.state else "", effects(t.body), effects(entry)) for t, entry in targets)
            for targets in bodies
        )
        content = (self.variables, frozenset(data.items()), effects(leaving), tuple(tests), done)
        names = {name for handler in handlers for name in names_of(handler.cond)} | set(names_in(leaving))
        for target, entry in (pair for targets in bodies for pair in targets):
            names |= {*names_in(target.body), *names_in(entry)}
        return _Group(handlers, data, RememberedPart(content, frozenset(names)))

    def _entry(self, target: Target) -> tuple[Statement, ...]:
        entry = self.states[target.state.value].entry if target.state else None
        return entry.statements if entry else ()

    def _data(self, handler: Handler) -> Valuation:
        """The values of the data of the event that a handler waits for."""
        part = handler.trigger
        if part is None:
            return {}
        data: Valuation = {}
        if part is ProtocolPart.CHILD_STATUS:
            statuses = listed(STATUSES.values())
            data |= {"_bt.status": statuses, "_event.data.status": statuses}
        if part is ProtocolPart.RESULT:
            code = handler.type.code
            data["_wrapped_result.code"] = exactly(code) if code else listed(GOAL_STATUSES)
        if part is ProtocolPart.THREAD_FREE and handler.handle is not None:
            threads = [t for t in self.machine.threads if t.server and t.server.value == handler.handle.value]
            count = threads[0].count if threads else None
            if count is not None and count > 1:  # a test of the only number is harmless
                data["_event.data.thread_id"] = listed(range(count))
        if part in _DATA_OF:
            if part is ProtocolPart.EVENT:
                name = handler.event.value if handler.event else ""
            else:
                declaration = find_handle(self.machine, handler)
                name = declaration.handle.value if declaration and declaration.handle else ""
            for path, values in self.arriving.get(DataChannel(part, name), {}).items():
                if path != RESULT_CODE:
                    data[f"{_DATA_OF[part]}.{path}" if path else _DATA_OF[part]] = values
        return data

    def _from(self, name: str, known: Valuation) -> Iterable[tuple[str, Valuation]]:
        """The states that follow the state `name`, each with the values with which it is entered."""
        state = self.states[name]
        whole, groups = self._groups(name)
        if self.evaluator.records:
            return (found for group in groups for found in self._followed(state, group, known))

        def follow(inside: Valuation) -> Iterator[tuple[str, Valuation]]:
            for group in groups:
                yield from self.memory.transitions(group.part, inside, functools.partial(self._followed, state, group))

        return self.memory.transitions(whole, known, follow)

    def _followed(self, state: State, group: _Group, known: Valuation) -> Iterator[tuple[str, Valuation]]:
        """The states that follow `state` by the handlers of `group`. Transitions without an event exclude nothing in
        the other groups: they have no priority (docs/spec/machines.md#selection)."""
        left: Valuation | None = {**known, **group.data}
        alone = left
        assert alone is not None
        for handler in group.handlers:
            taken = left
            if handler.cond is not None:
                taken = self._condition(handler.cond, alone, left)
            if taken is not None:
                yield from self._take(state, handler, taken)
            if left is not None and not chooses(handler):
                left = None if handler.cond is None else self._unless(left, handler.cond)
        if left is not None and self.evaluator.records:
            self._uncover(group.handlers, left)

    def _uncover(self, handlers: tuple[Handler, ...], left: Valuation | None) -> None:
        conditions = [handler.cond for handler in handlers if handler.cond is not None]
        if len(conditions) < len(handlers):
            return
        for cond in conditions:  # a later condition may have excluded values of an earlier one
            left = None if left is None else self._unless(left, cond)
        if left is not None:
            self.uncovered[conditions[-1].span] = left

    def _condition(self, cond: Expression, alone: Valuation, left: Valuation | None) -> Valuation | None:
        """The values where a condition holds, if it is tested with `left`."""
        if self.evaluator.records:
            here = NONE if left is None else self.evaluator.values(left, cond.tree)
            before = self.conditions.get(cond.span)
            self.evaluator.records = False
            values = ConditionValues(self.evaluator.values(alone, cond.tree), here)
            self.evaluator.records = True
            if before is not None:
                values = ConditionValues(join(before.alone, values.alone), join(before.here, values.here))
            self.conditions[cond.span] = values
        if left is None or cond.span in self.ignored:
            return left
        return self.evaluator.assume(left, cond.tree, True)

    def _unless(self, known: Valuation, cond: Expression) -> Valuation | None:
        return known if cond.span in self.ignored else self.evaluator.assume(known, cond.tree, False)

    def _take(self, state: State, handler: Handler, known: Valuation) -> Iterator[tuple[str, Valuation]]:
        after_exit = self._body(state.exit.statements, known) if state.exit else known
        for target in handler.targets:
            assert target.state is not None
            after = self._body(target.body, after_exit)
            after = {place: v for place, v in after.items() if place[0] != "_" or root(place) not in EVENT_VARIABLES}
            entry = self.states[target.state.value].entry
            yield target.state.value, self._body(entry.statements, after) if entry else after

    # ------------------------------------------------------------- statements

    def _body(self, body: Iterable[Statement], known: Valuation, kept: Kept = NOTHING_KEPT) -> Valuation:
        for statement in body:
            match statement:
                case Assign():
                    known = self._assign(statement, known)
                    kept = _kept(kept, statement)
                case If():
                    known = self._if(statement, known, kept)
                    for inner in statements((statement,)):
                        kept = _without(kept, inner) if isinstance(inner, Assign) else kept
                case _ if self.evaluator.records:
                    self._record(statement, known)
        return known

    def _if(self, statement: If, known: Valuation, kept: Kept) -> Valuation:
        left: Valuation | None = known
        ends: list[Valuation] = []
        for branch in statement.branches:
            inside = left if branch.cond is None else self._condition(branch.cond, known, left)
            if inside is not None and branch.cond is not None:
                inside = self._assume_kept(inside, branch.cond.tree, True, kept)
            if inside is not None:
                ends.append(self._body(branch.body, inside, kept))
            if left is not None:
                left = None if branch.cond is None else self._unless(left, branch.cond)
            if left is not None and branch.cond is not None:
                left = self._assume_kept(left, branch.cond.tree, False, kept)
        if left is not None:
            ends.append(self._body(statement.otherwise.body, left, kept) if statement.otherwise else left)
        # No branch is possible only if a condition has no value, for example because of a division by zero.
        result = ends[0] if ends else known
        for end in ends[1:]:
            result = joined_valuations(result, end)
        return result

    def _assume_kept(self, known: Valuation, condition: Expr, holds: bool, kept: Kept) -> Valuation | None:
        """`known` where the conditions hold that are kept in the variables of `condition`, whose value is `holds`."""
        match condition:
            case Name() if condition.name in kept:
                return self.evaluator.assume(known, kept[condition.name], holds)
            case Unary(operator=UnaryOperator.NOT):
                return self._assume_kept(known, condition.operand, not holds, kept)
            case Binary(operator=Operator.AND | Operator.OR) if (condition.operator is Operator.AND) == holds:
                left = self._assume_kept(known, condition.left, holds, kept)
                return None if left is None else self._assume_kept(left, condition.right, holds, kept)
        return known

    def _assign(self, statement: Assign, known: Valuation) -> Valuation:
        if statement.location is None:
            return known
        location = statement.location.tree
        place = place_of(location)
        value = self._given(statement.value, known)
        if place is None:
            return known
        if self.evaluator.records:
            self.evaluator.values(known, location)
        if "[" in place:
            return self._with_element(location, known)
        after = {other: v for other, v in known.items() if not is_within(other, place)}
        if place.endswith(".length"):  # a greater length adds elements
            after = _without_elements(after, place.removesuffix(".length"))
        for path, values in value.items():
            after[place + path] = values
        return after

    def _given(self, value: Value | None, known: Valuation) -> Valuation:
        """The values of an assigned or sent value, by the places in it; "" is the value itself. Each begins with `.`,
        if it is not empty."""
        if isinstance(value, PortRead):
            return {"": self._port(value, None)}
        if value is None:
            return {}
        tree = value.tree
        if isinstance(tree, ArrayLiteral | ObjectLiteral):
            if self.evaluator.records:
                self.evaluator.values(known, tree)
            return dict(literal("", tree))
        result: Valuation = {}
        values = self.evaluator.values(known, tree)
        if values != ANYTHING:
            result[""] = values
        place = place_of(tree)
        if place is not None and "[" not in place:
            result |= {p[len(place) :]: v for p, v in known.items() if p.startswith(place) and is_within(p, place)}
        return result

    def _with_element(self, location: Expr, known: Valuation) -> Valuation:
        """The values after an assignment to an element, which makes its array, and the arrays around it, long enough
        (docs/spec/machines.md#assign)."""
        after = dict(known)
        while isinstance(location, Member | Index):
            if isinstance(location, Index):
                array = place_of(location.object)
                place = f"{array}.length"
                if array is not None and "[" not in array and place in after:
                    length = self._length(after[place], location.index, place, known)
                    most = self.capacities.get(place)
                    after[place] = length if most is None else _at_most(length, most)
                if array is not None:
                    after = _without_elements(after, array)
            location = location.object
        return after

    def _length(self, length: ValueSet, index: Expr, place: str, known: Valuation) -> ValueSet:
        evaluator = self.evaluator
        records, evaluator.records = evaluator.records, False
        number = evaluator.values(known, index)
        evaluator.records = records
        if place_of(index) == place:
            number = length
        if number.only is not None and length.only is not None:
            pairs = [(n, m) for n in number.only for m in length.only if not (isinstance(n, str) or isinstance(m, str))]
            if place_of(index) == place:
                pairs = [(n, n) for n, _ in pairs]
            return listed(max(n + 1, m) for n, m in pairs)
        low = length.low if length.only is None else min(m for m in length.only if not isinstance(m, str))
        if length.only is None and number.only is None and place_of(index) == place:
            return between(length.low + 1, length.high + 1, length.low_from, length.high_from)
        return ValueSet(None, low, math.inf, Origin.REACHED, Origin.ASSUMED)

    # --------------------------------------------------------------- sending

    def _record(self, statement: Statement, known: Valuation) -> None:
        match statement:
            case RosSend():
                declaration = find_handle(self.machine, statement)
                name = declaration.handle.value if declaration and declaration.handle else ""
                fields = self._fields(statement.fields, known)
                for path, type_ in self.typed.unset.get(statement.element, ()):
                    fields.setdefault(path, default_of(type_))
                if statement.part is ProtocolPart.RESULT:
                    fields[RESULT_CODE] = exactly(statement.type.code)
                for argument in (statement.goal_id, statement.thread_id):
                    self._given(argument, known)
                self._add(DataChannel(statement.part, name), fields)
            case Send():
                name = statement.event.value if statement.event else ""
                self._add(DataChannel(ProtocolPart.EVENT, name), self._fields(statement.params, known))
            case SetOutput():
                name = statement.key.value if statement.key else ""
                self._add(DataChannel(ProtocolPart.BLACKBOARD, name), self._given(statement.value, known))

    def _fields(self, params: Iterable[Param], known: Valuation) -> dict[str, ValueSet]:
        fields: dict[str, ValueSet] = {}
        for param in params:
            if param.name is not None:
                for path, values in self._given(param.value, known).items():
                    fields.setdefault(param.name.value + path, values)
        return fields

    def _add(self, channel: DataChannel, fields: Fields) -> None:
        self.sent[channel] = merged(self.sent[channel], fields) if channel in self.sent else fields


def _without_elements(known: Valuation, array: str) -> Valuation:
    """The values without those of the elements of an array, one of which has changed."""
    return {place: values for place, values in known.items() if not place.startswith(f"{array}[")}


def _is_whole_in(whole: set[str], place: str) -> bool:
    """Whether the values of a place are integers: it is one of `whole`, or a length."""
    return place in whole or place.endswith(".length")


def _kept(kept: Kept, statement: Assign) -> Kept:
    """The conditions that variables keep after an assignment."""
    kept = _without(kept, statement)
    location, value = statement.location, statement.value
    if location is None or not isinstance(location.tree, Name) or not isinstance(value, Expression):
        return kept
    name, tree = location.tree.name, value.tree
    is_condition = isinstance(tree, Binary) or (isinstance(tree, Unary) and tree.operator is UnaryOperator.NOT)
    if value.broken or not is_condition or name in names_of(value):
        return kept
    return {**kept, name: tree}


def _without(kept: Kept, statement: Assign) -> Kept:
    """`kept` without the conditions that no longer hold the values of their variables after an assignment."""
    changed = set(names_of(statement.location))
    return {
        name: tree
        for name, tree in kept.items()
        if name not in changed and not any(isinstance(n, Name) and n.name in changed for n in walk(tree))
    }


def _grown(before: Valuation, known: Valuation, last: Valuation) -> Valuation:
    """The values of both; `before` itself if it contains those of `known`, and `last` too."""
    grown = {}
    for place, values in before.items():
        other = known.get(place)
        if other is not None and other is not values and other is not last.get(place):
            both = join(values, other)
            if both != values:
                grown[place] = both
    if len(known) < len(before) or not known.keys() >= before.keys():
        return {place: grown.get(place, values) for place, values in before.items() if place in known}
    return before | grown if grown else before


def _at_most(length: ValueSet, most: int) -> ValueSet:
    """The lengths of an array that can hold `most` elements."""
    if length.only is not None:
        return listed(min(n, most) for n in length.only if not isinstance(n, str))
    return between(min(length.low, most), min(length.high, most), length.low_from, length.high_from)
