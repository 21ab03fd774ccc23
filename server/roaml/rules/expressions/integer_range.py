# SPDX-License-Identifier: Apache-2.0
"""The rule `integer-range`, which integer_range.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import ArrayLiteral, Binary, Call, Conditional, Expr, Member, Name, Number, ObjectLiteral, walk
from roaml.expr.types import INTEGER_RANGES, Array, Scalar, ScalarKind, Struct, Type, is_kind, unwrap
from roaml.model.behavior.instants import may_be_sent_repeatedly
from roaml.model.machine import Assign, Handler, Statement, statements
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue, ValueUse
from roaml.model.values.analyse import ChartValues, analyse
from roaml.model.values.arriving import arriving_by_type
from roaml.model.values.domain import Origin, ValueSet, between, interval, meet
from roaml.model.values.evaluate import Evaluator, place_of
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.known_parts import conjuncts
from roaml.rules.support.retype import as_type, wide_enough
from roaml.rules.support.triggers import received_event
from roaml.rules.support.written import written
from roaml.text import Span, TextEdit

MAX_COUNTED = 2**8
"""The maximum number up to which a variable without a limit is assumed to count."""


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if not isinstance(value.value, Expression):
            continue
        tree = value.value.tree
        integers = [n for n in walk(tree) if isinstance(n, Number) and not n.is_real]
        if value.required is not None and is_kind(value.required, ScalarKind.REAL):
            integers = [n for n in integers if n is not tree]  # it is converted to a real number
        too_large = [n for n in integers if not n.is_whole]
        for literal in too_large:
            message = "this number does not fit into 64 bits, the size of an integer in a model"
            yield RULE.at(literal.span, f"{message}; write a real number with a point", severity=Severity.ERROR)
        if not too_large and value.required is not None:
            for span, number, type_ in outside(value.value.tree, value.required):
                low, high = INTEGER_RANGES[type_]
                wider = wide_enough(number, type_)
                fixes = as_type(context, value, wider) if wider and not _is_nested(value.required) else ()
                message = f"{number} does not fit into `{type_}`, whose range is {low} to {high}"
                yield RULE.at(span, message, *fixes)
            yield from _computed(context, value)


def _computed(context: MachineContext, value: TypedValue) -> Iterator[Finding]:
    """Report computed values that can be outside the range of the type that they must have."""
    chart = context.values.charts.get(value.place.chart.scope)
    type_ = value.required.name if isinstance(value.required, Scalar) else ""
    if chart is None or not isinstance(value.value, Expression) or type_ not in INTEGER_RANGES:
        return
    tree = value.value.tree
    values = chart.at(tree)
    if values is None or constant(tree) is not None or isinstance(tree, Conditional | Name | Member):
        return
    low, high = INTEGER_RANGES[type_]
    bounds, caused = interval(values), _within_limits(chart, tree, low, high)
    for above in (True, False):
        bound, origin = (bounds.high, bounds.high_from) if above else (bounds.low, bounds.low_from)
        if caused.high <= high if above else caused.low >= low:
            continue  # another assignment is the cause
        if low <= bound <= high or origin is Origin.ASSUMED or (origin is Origin.WIDENED and high > MAX_COUNTED):
            continue
        if origin is Origin.WIDENED and (
            _is_limited_next(context, value, chart, above=above) or _arrives_once(context, value.place.handler)
        ):
            continue
        if _is_limited(context, value, chart, above=above):
            continue
        reached: float | None = bound
        if origin is Origin.WIDENED:
            early = _early(context, value, tree)
            reached = None if early is None else early.high if above else early.low
        if _is_related(chart, tree):
            reached = None
        range_ = f"`{type_}`, whose range is {low} to {high}"
        if reached is not None and not low <= reached <= high:
            wider = wide_enough(int(reached), type_)
            verb = "is" if values.value is not None else "can be"
            message = f"the value {verb} {reached:g}, which does not fit into {range_}"
            fixes = (*_limited(tree, above=above), *(as_type(context, value, wider) if wider else ()))
            yield RULE.at(tree.span, message, *fixes)
        else:
            side = "greater" if above else "smaller"
            message = f"no condition limits this value, so it can become {side} than {range_}"
            yield RULE.at(tree.span, message, severity=Severity.INFORMATION)
        return


def _limited(tree: Expr, *, above: bool) -> Iterator[Fix]:
    """A fix that exchanges `Math.min` and `Math.max` if the wrong side is limited: `Math.min(x, 0)` is at most 0."""
    wrong, right = ("max", "min") if above else ("min", "max")
    if not isinstance(tree, Call) or not isinstance(tree.function, Member):
        return
    if tree.function.name == wrong and any(constant(argument) is not None for argument in tree.arguments):
        yield Fix(f"Change to `Math.{right}`", (TextEdit(tree.function.name_span, right),))


def _is_related(chart: ChartValues, tree: Expr) -> bool:
    """Whether an expression combines several values that vary. They may be related, as in `total - left`, and the
    analysis of values does not know which of them occur together."""
    places = [n for n in walk(tree) if place_of(n) is not None]
    inner = [part for n in places for part in walk(n) if part is not n]
    outer = (n for n in places if not any(n is part for part in inner))
    return sum((known := chart.at(n)) is None or known.value is None for n in outer) > 1


def _within_limits(chart: ChartValues, tree: Expr, low: int, high: int) -> ValueSet:
    """The values of an expression as long as the variables in it have values from `low` to `high`."""
    places = [(place, n) for n in walk(tree) if (place := place_of(n)) is not None]
    limits = between(low, high)
    known = {place: meet(interval(v), limits) for place, n in places if (v := chart.at(n)) is not None}
    return interval(Evaluator(lambda _: True).values(known, tree))


def _is_limited(context: MachineContext, value: TypedValue, chart: ChartValues, *, above: bool) -> bool:
    """Whether a condition that holds compares the same expression, such as `x + y`, with a value that fits. The
    analysis of values only follows what conditions say about variables."""
    assert isinstance(value.value, Expression)
    place, type_ = value.place, value.required
    handler = place.handler
    if handler is None or not isinstance(type_, Scalar) or _is_changed(value, handler):
        return False
    holding = [condition for condition, holds in place.branch_conditions or () if holds]
    holding += [handler.cond] if handler.cond is not None else []
    low, high = INTEGER_RANGES[type_.name]
    own = written(context, value.value.tree)
    for comparison in (part for condition in holding for part, holds in conjuncts(condition.tree, True) if holds):
        smaller, greater = _sides(comparison)
        same, other = (smaller, greater) if above else (greater, smaller)
        if same is None or other is None or written(context, same) != own:
            continue
        limit = chart.at(other)
        if limit is not None and (interval(limit).high <= high if above else interval(limit).low >= low):
            return True
    return False


def _is_limited_next(context: MachineContext, value: TypedValue, chart: ChartValues, *, above: bool) -> bool:
    """Whether the state that follows an assignment has a transition without an event that is taken before the variable
    leaves its range: its condition compares the variable with a value that fits, and it leaves the state or assigns the
    variable."""
    place, handler, type_ = value.place, value.place.handler, value.required
    location = next(
        (
            v.value.tree
            for v in context.typed.values
            if v.use is ValueUse.LOCATION and v.element is value.element and isinstance(v.value, Expression)
        ),
        None,
    )
    if handler is None or not isinstance(location, Name) or not isinstance(type_, Scalar):
        return False
    low, high = INTEGER_RANGES[type_.name]
    limit = high if above else low
    states = {state.id.value: state for state in place.chart.states if state.id is not None}
    entered = [states.get(target.state.value) if target.state else None for target in handler.targets]
    return bool(entered) and all(
        state is not None
        and state.id is not None
        and any(
            later.trigger is None and _leaves(chart, later, state.id.value, location.name, limit, above=above)
            for later in state.handlers
        )
        for state in entered
    )


def _arrives_once(context: MachineContext, handler: Handler | None) -> bool:
    """Whether a handler takes a message or event that each of its senders sends at most once, so that it is not taken
    again and again."""
    if context.system is None or handler is None or handler.trigger not in (ProtocolPart.MESSAGE, ProtocolPart.EVENT):
        return False
    event = received_event(context.machine, handler)
    return event is not None and not any(
        may_be_sent_repeatedly(context.system, automaton, event) for automaton in context.automata
    )


def _leaves(chart: ChartValues, later: Handler, state: str, name: str, limit: int, *, above: bool) -> bool:
    """Whether a handler leaves a state, or assigns a variable, once the variable reaches a value within `limit`."""
    stays = [target for target in later.targets if target.state is None or target.state.value == state]
    if later.cond is None or not all(_assigns(target.body, name) for target in stays):
        return False
    comparison = later.cond.tree
    smaller, greater = _sides(comparison)
    if isinstance(comparison, Binary) and comparison.operator is Operator.EQUAL:
        smaller, greater = (comparison.right, comparison.left) if above else (comparison.left, comparison.right)
    same, other = (greater, smaller) if above else (smaller, greater)
    values = chart.at(other) if other is not None else None
    if not isinstance(same, Name) or same.name != name or values is None:
        return False
    return interval(values).high <= limit if above else interval(values).low >= limit


def _assigns(body: tuple[Statement, ...], name: str) -> bool:
    return any(isinstance(s, Assign) and s.location and place_of(s.location.tree) == name for s in statements(body))


def _is_changed(value: TypedValue, handler: Handler) -> bool:
    """Whether another assignment of the handler changes a variable of an expression."""
    assert isinstance(value.value, Expression)
    used = {place_of(n) for n in walk(value.value.tree)} - {None}
    assigned = (s for target in handler.targets for s in statements(target.body) if isinstance(s, Assign))
    return any(s.value is not value.value and s.location and place_of(s.location.tree) in used for s in assigned)


def _sides(tree: Expr) -> tuple[Expr | None, Expr | None]:
    """The smaller and the greater side of a comparison; `None` twice if it is none."""
    match tree:
        case Binary(operator=Operator.LESS | Operator.LESS_EQUAL):
            return tree.left, tree.right
        case Binary(operator=Operator.GREATER | Operator.GREATER_EQUAL):
            return tree.right, tree.left
    return None, None


def _early(context: MachineContext, value: TypedValue, tree: Expr) -> ValueSet | None:
    """The values of an expression in the first passes of a loop."""
    arriving = context.values.arriving if context.system else arriving_by_type(context.machine, context.interface)
    chart = analyse(context.machine, context.typed, arriving, is_bounded=True).charts.get(value.place.chart.scope)
    values = chart.at(tree) if chart is not None else None
    return interval(values) if values is not None else None


def _is_nested(required: Type) -> bool:
    """Whether the integer is a member of a struct, whose type is declared elsewhere."""
    return isinstance(unwrap(required)[0], Struct)


def outside(expr: Expr, required: Type) -> Iterator[tuple[Span, int, str]]:
    """The constants in `expr` outside the range of the integer type that they must have, each as its place, its value
    and the name of the type."""
    match expr, required:
        case ArrayLiteral(), Array():
            for element in expr.elements:
                yield from outside(element, required.element)
        case ObjectLiteral(), Struct():
            for member in expr.members:
                if type_ := required.member(member.key):
                    yield from outside(member.value, type_)
        case Conditional(), _:
            yield from outside(expr.then, required)
            yield from outside(expr.otherwise, required)
        case _, Scalar(kind=ScalarKind.INT, name=name) if name in INTEGER_RANGES:
            number = constant(expr)
            if isinstance(number, int) and not INTEGER_RANGES[name][0] <= number <= INTEGER_RANGES[name][1]:
                yield expr.span, number, name


RULE = Rule(
    "integer-range",
    Severity.WARNING,
    "A value is or can be outside the range of its integer type.",
    machine=check,
    whole=True,
)
