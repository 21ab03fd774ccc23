# SPDX-License-Identifier: Apache-2.0
"""Links a property file to its system: finds the events of its ports, checks the conditions of its properties, and
collects the problems (docs/spec/xml-properties.md)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from roaml.comparison import read_comparison
from roaml.durations import NANOSECONDS
from roaml.exact_number import exact_number
from roaml.expr.infer import (
    ADVICE,
    BadComparison,
    BadOperand,
    DivisionByZero,
    RandomUsed,
    UnknownFunction,
    UnknownMember,
    UnknownName,
    infer,
)
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Name, walk
from roaml.expr.types import BOOL, UNKNOWN, ScalarKind, Type, is_kind
from roaml.model.globals import GlobalVariable
from roaml.model.initial import check_initial
from roaml.model.property_file import (
    PortVariableKind,
    PropertyFile,
    PropertySection,
    TimeInterval,
    WrittenProperty,
    WrittenScope,
)
from roaml.model.property_ports import FindInterface, LinkedPort, LinkedVariable, PortLinker
from roaml.model.property_problems import Problem, ProblemKind, Remedy
from roaml.model.property_sentences import sentence
from roaml.model.syntax import Expression
from roaml.model.syntax import Name as WrittenName
from roaml.model.system import System
from roaml.model.timing import TimerRate, periods
from roaml.model.values.domain import ValueSet
from roaml.observers.properties import (
    CLOSE,
    LEFT,
    OPEN,
    RIGHT,
    FormulaProperty,
    Pattern,
    PatternProperty,
    Property,
    ScopeKind,
    Since,
    Window,
)
from roaml.observers.properties import (
    walk as walk_formula,
)
from roaml.record import Record, field
from roaml.suggest import close_names
from roaml.text import Span
from roaml.xml_syntax import Element


class LinkedProperty(Record, frozen=True):
    """A property without problems, for which an observer can be built.

    Attributes:
        conditions: input of the observer -> its expression.
        ports: the ports whose variables the property reads; the observer makes a step at each of their events.
        path: the path of the property file.
        sentence: the property as an English sentence.
    """

    name: str
    is_assumption: bool
    property: Property
    conditions: Mapping[str, Expression]
    ports: tuple[LinkedPort, ...]
    written: WrittenProperty
    path: str
    sentence: str


class LinkedFile(Record, frozen=True, eq=False):
    """A linked file.

    Attributes:
        properties: the properties without problems.
        values: variable of a port -> the values that it can have, as far as they are known.
    """

    file: PropertyFile
    ports: tuple[LinkedPort, ...]
    properties: tuple[LinkedProperty, ...]
    problems: tuple[Problem, ...]
    values: Mapping[str, ValueSet] = field(default_factory=dict)


def clock_step(system: System) -> int | None:
    """The step of the clock in ns; `None` if the system has no timer."""
    periods_ns = [period.nanoseconds for period in periods(system)]
    return math.gcd(*periods_ns) if periods_ns else None


def link(
    file: PropertyFile,
    system: System,
    find: FindInterface,
    variables: Mapping[str, GlobalVariable],
    taken: Mapping[str, str],
    path: str,
) -> LinkedFile:
    """Link the ports and properties of a file to a system.

    Args:
        path: the path of the file.
        variables: the global variables of the translated system.
        taken: name of a property in the files that the system lists before this one -> the name of that file for
            messages.
    """
    return _Linker(file, system, find, variables, taken, path).linked()


class _Linker:
    def __init__(
        self,
        file: PropertyFile,
        system: System,
        find: FindInterface,
        variables: Mapping[str, GlobalVariable],
        taken: Mapping[str, str],
        path: str,
    ) -> None:
        self.file = file
        self.path = path
        self.ports = PortLinker(system, find, variables)
        self.linked_ports = tuple(self.ports.link(port) for port in file.ports)
        self.problems = self.ports.problems
        self.step = clock_step(system)
        self.max_time = system.parameters.max_time
        self.taken = taken
        self.by_id: dict[str, tuple[LinkedPort, LinkedVariable]] = {}
        self.used: set[str] = set()

    def report(
        self,
        kind: ProblemKind,
        span: Span,
        message: str,
        close: Iterable[str] = (),
        remedy: Remedy | None = None,
        element: Element | None = None,
        harmless: bool = False,
    ) -> None:
        self.problems.append(Problem(kind, span, message, tuple(close), remedy, element, harmless))

    def linked(self) -> LinkedFile:
        self._check_variables()
        self._check_names()
        self._check_interfaces()
        properties = [self._property(written) for written in self.file.properties]
        self._check_use()
        kept = tuple(linked for linked in properties if linked is not None)
        return LinkedFile(self.file, self.linked_ports, kept, tuple(self.problems))

    # ------------------------------------------------------------ variables

    def _check_variables(self) -> None:
        for port in self.linked_ports:
            for variable in port.variables:
                name = variable.written.id
                assert name is not None
                if variable.id in self.by_id:
                    self.report(
                        ProblemKind.REPEATED_ID,
                        name.span,
                        f"another variable has the id `{variable.id}`; rename one of them",
                    )
                elif not _is_identifier(variable.id):
                    message = (
                        f"conditions cannot use `{variable.id}`: an id must begin with a letter or `_` and "
                        "contain only letters, digits and `_`"
                    )
                    self.report(ProblemKind.PORT_VARIABLE, name.span, message)
                self.by_id.setdefault(variable.id, (port, variable))
                initial = variable.written.initial
                if initial is not None and variable.kind is not PortVariableKind.EVENT:
                    self._check_initial(initial, variable.type)

    def _check_initial(self, initial: Expression, type_: Type) -> None:
        if initial.broken:
            self.report(ProblemKind.PORT_VARIABLE, initial.findings[0].span, initial.findings[0].message)
        elif check_initial(initial.tree, type_):
            message = f"`expr`, the value before the first event, must be a constant of type `{type_}`"
            self.report(ProblemKind.PORT_VARIABLE, initial.span, message)

    def _check_names(self) -> None:
        seen: set[str] = set()
        for written in self.file.properties:
            if written.id is None:
                continue
            name = written.id.value
            if name in seen:
                self.report(
                    ProblemKind.REPEATED_ID,
                    written.id.span,
                    f"another property has the id `{name}`; rename one of them",
                )
            elif name in self.taken:
                message = (
                    f"another property of the system, in {self.taken[name]}, has the id `{name}`; rename one of them"
                )
                self.report(ProblemKind.REPEATED_ID, written.id.span, message)
            seen.add(name)

    def _check_interfaces(self) -> None:
        """Report ports whose variable has the name of another interface of the same type that no port listens to."""
        listened = {(port.kind, port.name.value) for port in self.file.ports if port.name is not None}
        for port in self.file.ports:
            for name, variable in self.ports.namesakes(port).items():
                if port.name is not None and (port.kind, name) not in listened:
                    message = (
                        f"`{variable}` is a variable of `{port.name.value}`, but no port listens to `{name}`, which "
                        f"has the same type; did you mean `{name}`?"
                    )
                    self.report(ProblemKind.MISLEADING, port.name.span, message, (name,))

    def _check_use(self) -> None:
        if any(problem.kind in (ProblemKind.CONDITION, ProblemKind.FORM) for problem in self.problems):
            return  # an invalid condition may be intended to use the variable
        for port in self.linked_ports:
            if not port.variables:
                message = "this port has no variables, so no property can use it"
                element = port.written.element
                self.report(ProblemKind.UNUSED, element.name_span, message, (), Remedy.REMOVE_ELEMENT, element)
            for variable in port.variables:
                if variable.id not in self.used and variable.written.id is not None:
                    message = f"no property uses `{variable.id}`"
                    element = variable.written.element
                    self.report(
                        ProblemKind.UNUSED, variable.written.id.span, message, (), Remedy.REMOVE_ELEMENT, element
                    )

    # ----------------------------------------------------------- properties

    def _property(self, written: WrittenProperty) -> LinkedProperty | None:
        before = len(self.problems)
        self._check_expectation(written)
        for expression in written.expressions:
            self._check_condition(expression)
        if written.pattern is None and written.formula is None:
            if written.logic is None:
                message = "a property needs a `pattern`, or a formula in `logic` and `expr`"
            else:
                message = "the formula is missing; add it in `expr`"
            self.report(ProblemKind.FORM, written.element.name_span, message)
        expressions = self._pattern(written) if written.pattern is not None else self._formula(written)
        errors = [problem for problem in self.problems[before:] if problem.kind not in _HINTS]
        if expressions is None or errors or written.id is None:
            return None
        property_, conditions = expressions
        names = {node.name for c in conditions.values() for node in walk(c.tree) if isinstance(node, Name)}
        ports = tuple(p for p in self.linked_ports if any(variable.id in names for variable in p.variables))
        is_assumption = written.section is PropertySection.ASSUMES
        return LinkedProperty(
            written.id.value,
            is_assumption,
            property_,
            conditions,
            ports,
            written,
            self.path,
            sentence(self.file, written),
        )

    def _check_expectation(self, written: WrittenProperty) -> None:
        expect = written.expect
        if expect is None:
            return
        comparison = read_comparison(expect.value)
        if written.section is PropertySection.ASSUMES:
            self.report(ProblemKind.FORM, expect.span, "an assumption has no probability; remove `expect`")
        elif comparison is None or not 0 <= comparison.number <= 1:
            message = "`expect` must compare the probability with a number from 0 to 1, for example `>= 0.9`"
            self.report(ProblemKind.FORM, expect.span, message)

    def _check_condition(self, condition: Expression) -> None:
        if condition.broken:
            for finding in condition.findings:
                self.report(ProblemKind.CONDITION, finding.span, finding.message)
            return
        type_, problems = infer(condition.tree, self._type_of)
        self.used |= {node.name for node in walk(condition.tree) if isinstance(node, Name)}
        reported = False
        for problem in problems:
            if isinstance(problem, ADVICE):
                continue
            reported = True
            close: tuple[str, ...] = ()
            if isinstance(problem, UnknownName):
                close = close_names(problem.name, self.by_id)
            self.report(ProblemKind.CONDITION, problem.span, _in_words(problem, close), close)
        if not reported and type_ != UNKNOWN and not is_kind(type_, ScalarKind.BOOL):
            message = f"a condition must be true or false, but this expression has the type `{type_}`"
            self.report(ProblemKind.CONDITION, condition.span, message)
        self._check_together(condition)

    def _type_of(self, name: str) -> Type | None:
        return self.by_id[name][1].type if name in self.by_id else None

    def _check_together(self, condition: Expression) -> None:
        for part in walk(condition.tree):
            if isinstance(part, Binary) and part.operator is Operator.AND:
                left, right = self._event(part.left), self._event(part.right)
                if left is not None and right is not None and left[0] is not right[0]:
                    message = (
                        f"`{left[1].id}` and `{right[1].id}` are never true together: each event is a separate step"
                    )
                    self.report(ProblemKind.NEVER_TOGETHER, part.span, message)

    def _event(self, tree: object) -> tuple[LinkedPort, LinkedVariable] | None:
        linked = self.by_id.get(tree.name) if isinstance(tree, Name) else None
        return linked if linked is not None and linked[1].kind is PortVariableKind.EVENT else None

    def _pattern(self, written: WrittenProperty) -> tuple[Property, dict[str, Expression]] | None:
        assert written.pattern is not None
        if written.logic is not None or written.formula is not None:
            message = "a property cannot have both a `pattern` and a formula; remove one of them"
            self.report(ProblemKind.FORM, written.pattern.span, message)
            return None
        if written.pattern.value not in {pattern.value for pattern in Pattern}:
            return None  # the schema reports it
        pattern = Pattern(written.pattern.value)
        conditions = self._conditions(written, pattern)
        scope = self._scope(written)
        window = self._window(written, pattern, is_reaction=self._is_reaction(pattern, conditions))
        if conditions is None or scope is None or window is None:
            return None
        kind, limits = scope
        if window.upper is not None and self.step is not None and written.intervals:
            time = window.upper * self.step
            if pattern is Pattern.RECURRENCE or (pattern is Pattern.EXISTENCE and kind is ScopeKind.GLOBALLY):
                self._compare_with_the_sender(pattern, conditions[LEFT], written.intervals[0], time)
            elif pattern is Pattern.RESPONSE:
                self._compare_with_the_answer(conditions, written.intervals[0], time)
        if pattern is Pattern.UNIVERSALITY and kind is ScopeKind.GLOBALLY and window.lower == 0:
            self._check_start(conditions[LEFT])
        return PatternProperty(pattern, kind, window), {**conditions, **limits}

    def _is_reaction(self, pattern: Pattern, conditions: Mapping[str, Expression] | None) -> bool:
        """Whether a property relates an event to a reaction that no other timer sends. In the model, it can be sent at
        the same time; a limit that is a little shorter than a step means the same on the robot."""
        if pattern not in (Pattern.RESPONSE, Pattern.PRECEDENCE) or conditions is None:
            return False
        first, reaction = (self._slowest_timer(conditions[side].tree) for side in (LEFT, RIGHT))
        return reaction is None or reaction == first

    def _check_start(self, condition: Expression) -> None:
        if self._event(condition.tree) is not None:
            name = condition.text.strip()
            message = f"`{name}` is false at the start of every trace and between events, so this property never holds"
            self.report(ProblemKind.FALSE_AT_START, condition.span, message)

    def _compare_with_the_sender(
        self, pattern: Pattern, condition: Expression, interval: TimeInterval, time: int
    ) -> None:
        """Report an event that is required more often, or earlier, than the timer ticks that is the only reason to send
        it."""
        timer, written = self._slowest_timer(condition.tree), interval.time or interval.within
        if timer is None or written is None or time >= timer.period.nanoseconds:
            return
        sender = timer.automaton.name if timer.automaton is not None else ""
        what = "the time between two messages" if pattern is Pattern.RECURRENCE else "the time until the first message"
        message = (
            f"this is shorter than {what}, {_duration(timer.period.nanoseconds)}: only the timer `{timer.name}` makes "
            f"`{sender}` send them, so the property never holds"
        )
        self.report(ProblemKind.SHORT, written.span, message)

    def _compare_with_the_answer(self, conditions: Mapping[str, Expression], interval: TimeInterval, time: int) -> None:
        """Report a response that is required earlier than the next tick of the timer that is the only reason to send
        it, if what it answers is sent between two ticks."""
        first, answer = (self._slowest_timer(conditions[side].tree) for side in (LEFT, RIGHT))
        written = interval.time or interval.within
        if first is None or answer is None or written is None or time >= answer.period.nanoseconds:
            return
        if first.period.nanoseconds % answer.period.nanoseconds == 0:
            return  # the ticks are at the same time, and the answer may be sent at once
        # The longest time from a tick of the first timer to the next tick of the other one.
        longest = answer.period.nanoseconds - math.gcd(first.period.nanoseconds, answer.period.nanoseconds)
        if time < longest:
            sender = answer.automaton.name if answer.automaton is not None else ""
            message = (
                f"only the timer `{answer.name}` makes `{sender}` send the response, every "
                f"{_duration(answer.period.nanoseconds)}; after some events, the next tick is {_duration(longest)} "
                "later, so the property does not hold"
            )
            self.report(ProblemKind.SHORT, written.span, message)

    def _slowest_timer(self, tree: Expr) -> TimerRate | None:
        """The timer without which the events are not sent that a condition requires; of several, the slowest."""
        timers: list[TimerRate] = []
        for part in _parts(tree, Operator.AND):
            events = [self._event(alternative) for alternative in _parts(part, Operator.OR)]
            known = [self.ports.slowest_timer(event[0].written) if event is not None else None for event in events]
            if known[0] is not None and all(timer == known[0] for timer in known):
                timers.append(known[0])
        return max(timers, key=lambda timer: timer.period.nanoseconds, default=None)

    def _conditions(self, written: WrittenProperty, pattern: Pattern) -> dict[str, Expression] | None:
        needed = 2 if pattern.is_binary else 1
        given = len(written.conditions)
        if given != needed:
            needed_events = "two `<event>` in `<events>`" if needed == 2 else "one `<event>`"
            message = (
                f"`{pattern.value}` needs {needed_events}; there {'is' if given == 1 else 'are'} {given or 'none'}"
            )
            self.report(ProblemKind.FORM, written.element.name_span, message)
            return None
        return dict(zip((LEFT, RIGHT), written.conditions, strict=False))

    def _scope(self, written: WrittenProperty) -> tuple[ScopeKind, dict[str, Expression]] | None:
        if not written.scopes:
            message = 'the scope is missing; add `<scope type="globally"/>` for the whole trace'
            element = written.element
            self.report(ProblemKind.FORM, element.name_span, message, (), Remedy.ADD_SCOPE, element)
            return None
        scope = written.scopes[0]
        if scope.type is None or scope.type.value not in {kind.value for kind in ScopeKind}:
            return None  # the schema reports it
        kind = ScopeKind(scope.type.value)
        limits = dict(self._limits(scope, kind, scope.type))
        complete = (OPEN in limits or not kind.has_event) and (CLOSE in limits or not kind.has_until)
        return (kind, limits) if complete else None

    def _limits(self, scope: WrittenScope, kind: ScopeKind, place: WrittenName) -> Iterator[tuple[str, Expression]]:
        rows = ((OPEN, "event", scope.event, kind.has_event), (CLOSE, "until", scope.until, kind.has_until))
        for name, attribute, condition, is_needed in rows:
            if is_needed and condition is None:
                self.report(ProblemKind.FORM, place.span, f"the scope `{kind.value}` needs the attribute `{attribute}`")
            elif condition is not None and not is_needed:
                message = f"the scope `{kind.value}` cannot have the attribute `{attribute}`; remove it"
                self.report(ProblemKind.FORM, condition.span, message, (), Remedy.REMOVE_ATTRIBUTE, scope.element)
            elif condition is not None:
                yield name, condition

    def _formula(self, written: WrittenProperty) -> tuple[Property, dict[str, Expression]] | None:
        formula = written.formula
        if formula is None:
            return None
        elements = [scope.element for scope in written.scopes] + [interval.element for interval in written.intervals]
        for span in (*(c.span for c in written.conditions), *(element.name_span for element in elements)):
            self.report(
                ProblemKind.FORM,
                span,
                "a property with a formula cannot have events, a scope or an interval; remove this element",
            )
        for span, message in formula.notation.problems:
            self.report(ProblemKind.FORM, formula.source.span(*span), message)
        if formula.notation.formula is None:
            return None
        property_ = FormulaProperty(formula.notation.formula)
        timed = [n for n in walk_formula(property_.formula) if isinstance(n, Since) and not n.window.is_unbounded]
        if timed and self.step is None:
            self._no_clock(written.element.name_span)
        return property_, {condition.text: condition for condition in formula.atoms}

    # ----------------------------------------------------------------- time

    def _window(self, written: WrittenProperty, pattern: Pattern, *, is_reaction: bool) -> Window | None:
        if not written.intervals:
            if pattern is Pattern.RECURRENCE:
                message = "`recurrence` needs a `<time_interval>` within which the condition must be true again"
                self.report(ProblemKind.TIME, written.element.name_span, message)
                return None
            return Window()
        interval = written.intervals[0]
        place = interval.element.name_span
        ends = (interval.time, interval.after, interval.within)
        if interval.unit is None or interval.unit.value not in NANOSECONDS:
            return None  # the schema reports it
        if not any(ends):
            self.report(ProblemKind.TIME, place, "an interval needs `time`, `after` or `within`")
            return None
        if interval.time is not None and (interval.after or interval.within):
            message = "`time` has the same meaning as `within`; use only `after` and `within`"
            self.report(ProblemKind.TIME, interval.time.span, message)
            return None
        if pattern is Pattern.RECURRENCE and interval.after is not None:
            self.report(ProblemKind.TIME, interval.after.span, "`recurrence` cannot have `after`; use `time`")
            return None
        if self.step is None:
            self._no_clock(place)
            return None
        unit = NANOSECONDS[interval.unit.value]
        window = self._in_steps(interval, unit, self.step)
        if window is not None:
            self._compare_with_the_clock(interval, unit, self.step, is_reaction=is_reaction)
        return window

    def _no_clock(self, span: Span) -> None:
        self.report(
            ProblemKind.TIME,
            span,
            "the system has no timer and therefore no clock that measures this time; declare a timer",
        )

    def _in_steps(self, interval: TimeInterval, unit: int, step: int) -> Window | None:
        upper_written = interval.time or interval.within
        after, within = _number(interval.after), _number(upper_written)
        if (interval.after is not None and after is None) or (upper_written is not None and within is None):
            return None  # the schema reports it
        lower = 0 if after is None else math.ceil(after * unit / step)
        upper = None if within is None else math.floor(within * unit / step)
        if after is not None and within is not None and after > within:
            assert interval.after is not None
            message = (
                f"`after` is greater than `within`, so the interval from {interval.after.value} to "
                f"{_text(upper_written)} is empty"
            )
            self.report(ProblemKind.TIME, interval.after.span, message)
            return None
        if max(lower, upper or 0) > MAX_STEPS:
            message = (
                f"the interval has {max(lower, upper or 0):,} steps of the clock; at most {MAX_STEPS:,} are supported"
            )
            self.report(ProblemKind.TIME, interval.element.name_span, message)
            return None
        if upper is not None and lower > upper:
            place = interval.after.span if interval.after else interval.element.name_span
            message = (
                f"the interval contains no step of the clock, whose steps take {_duration(step)}; extend the interval"
            )
            self.report(ProblemKind.TIME, place, message)
            return None
        return Window(lower, upper)

    def _compare_with_the_clock(self, interval: TimeInterval, unit: int, step: int, *, is_reaction: bool) -> None:
        """Report ends of an interval that no trace reaches, or that are shorter than a step of the clock."""
        for written in (interval.after, interval.time or interval.within):
            number = _number(written)
            if written is None or number is None:
                continue
            if self.max_time is not None and number * unit > self.max_time:
                message = (
                    f"the traces end at {_duration(self.max_time)} (`max_time`), before this time; shorten the "
                    "interval or let the system run longer"
                )
                self.report(ProblemKind.BEYOND_END, written.span, message)
                return
            shortest = step / MAX_COARSENESS if is_reaction and written is not interval.after else step
            if 0 < number * unit < shortest:
                meaning = "the next step" if written is interval.after else "the same time only"
                message = f"this is shorter than a step of the clock, {_duration(step)}, so it means {meaning}"
                self.report(ProblemKind.SHORT, written.span, message)
                return


MAX_COARSENESS = 10
"""How many times longer than the limit of a reaction a step of the clock may be. Beyond it, the unit may be wrong."""
MAX_STEPS = 1_000_000
"""The maximum number of steps of the clock in the bounds of a time interval."""

_HINTS = (
    ProblemKind.MISLEADING,
    ProblemKind.NEVER_TOGETHER,
    ProblemKind.FALSE_AT_START,
    ProblemKind.BEYOND_END,
    ProblemKind.SHORT,
)


def _parts(tree: Expr, operator: Operator) -> Iterator[Expr]:
    """What a condition joins with `&&` or `||`; the condition itself if it joins nothing."""
    if isinstance(tree, Binary) and tree.operator is operator:
        yield from _parts(tree.left, operator)
        yield from _parts(tree.right, operator)
    else:
        yield tree


def _text(name: WrittenName | None) -> str:
    return "" if name is None else name.value


def _number(name: WrittenName | None) -> Fraction | None:
    """The value of `name` as a non-negative number; `None` if it is missing or is not a non-negative number."""
    value = exact_number(name.value) if name is not None else None
    return value if value is not None and value >= 0 else None


def _duration(nanoseconds: int) -> str:
    unit, size = next((unit, size) for unit, size in NANOSECONDS.items() if nanoseconds % size == 0)
    return f"{nanoseconds // size} {unit}"


def _is_identifier(text: str) -> bool:
    return text.isascii() and text.isidentifier()


def _in_words(problem: object, close: tuple[str, ...]) -> str:
    hint = f"; did you mean `{close[0]}`?" if close else ""
    match problem:
        case UnknownName(name=name):
            return f"no port of this file has a variable `{name}`{hint}"
        case UnknownMember(name=name):
            return f"there is no member `{name}`; select the field in a `<state_var>` of the port"
        case BadOperand(operator=operator, given=given, required=required):
            operand = "a boolean" if required == BOOL else "a number"
            return f"`{operator}` takes {operand}, not a value of type `{given}`"
        case BadComparison(operator=operator, left=left, right=right):
            return f"`{operator}` cannot compare `{left}` with `{right}`"
        case UnknownFunction(name=name):
            return f"there is no function `{name}`; only functions of `Math` can be called"
        case DivisionByZero():
            return "division by zero"
        case RandomUsed():
            return "a condition cannot call `Math.random()`"
    return "the expression cannot be evaluated"
