# SPDX-License-Identifier: Apache-2.0
"""The rule `index-out-of-bounds`, which index_out_of_bounds.md describes."""

from __future__ import annotations

import math
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import IndexOutOfBounds, constant, infer
from roaml.expr.operators import MIRRORED, OPPOSITE, Operator, UnaryOperator
from roaml.expr.tree import ArrayLiteral, Binary, Boolean, Expr, Index, Member, Name, Unary, access_path, walk
from roaml.expr.types import Array, Type
from roaml.model.machine import Assign, Chart, Handler
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue, ValuePlace, ValueUse
from roaml.model.values.describe import described
from roaml.model.values.domain import Origin, exactly, interval
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.append_counters import ends_in_time
from roaml.rules.support.blocks import is_reset
from roaml.rules.support.free_threads import counts_threads
from roaml.rules.support.index_guards import is_guarded
from roaml.rules.support.written import written
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        yield from _never_filled(chart)
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, IndexOutOfBounds):
                if problem.index < 0:
                    yield RULE.at(problem.span, "an index must be at least 0")
                else:
                    last = (problem.array.bound or 1) - 1
                    message = f"`{problem.array}` has no element {problem.index}; the last index is {last}"
                    yield RULE.at(problem.span, message, *_more_room(value, problem))
        if isinstance(value.value, Expression) and not value.value.broken:
            yield from _unbounded(context, value.place, value.value.tree)
            yield from _computed(context, value.place, value.value.tree)
            yield from _behind(context, value)
            yield from _beyond_length(context, value)
            if value.use is ValueUse.LOCATION:
                yield from _append(context, value, value.value.tree)
                yield from _length(context, value, value.value.tree)


def _more_room(value: TypedValue, problem: IndexOutOfBounds) -> Iterator[Fix]:
    """A fix that declares the array with enough elements, if it is a variable."""
    if not isinstance(value.value, Expression):
        return
    used = [n for n in walk(value.value.tree) if isinstance(n, Index) and n.index.span == problem.span]
    names = [node.object.name for node in used if isinstance(node.object, Name)]
    for data in value.place.chart.data:
        type_ = data.type.name if data.type else None
        if data.type and data.id and data.id.value in names and type_ and len(type_.dimensions) == 1:
            new = f"{type_.base}[{problem.index + 1}]"
            yield Fix(f"Declare `{data.id.value}` as {new}", (TextEdit(data.type.span, new),), preferred=False)


def _unbounded(context: MachineContext, place: ValuePlace, tree: Expr) -> Iterator[Finding]:
    """Report indices beyond the size that arrays without a bound have in this system."""
    if context.system is None:
        return
    size = context.system.parameters.max_array_size
    for node in walk(tree):
        if not isinstance(node, Index):
            continue
        number = constant(node.index)
        if isinstance(number, int) and number >= size:
            array = _type_of(context, place, node.object)
            if isinstance(array, Array) and array.bound is None:
                message = (
                    f"`{array}` has no element {number}; an array without a bound has {size} elements "
                    "(`max_array_size`)"
                )
                yield RULE.at(node.index.span, message)


def _computed(context: MachineContext, place: ValuePlace, tree: Expr) -> Iterator[Finding]:
    """Report indices that are not constant and can be outside of their array."""
    chart = context.values.charts.get(place.chart.scope)
    size = context.system.parameters.max_array_size if context.system else None
    for node in walk(tree):
        if not isinstance(node, Index) or constant(node.index) is not None or chart is None:
            continue
        values = chart.at(node.index)
        array = _type_of(context, place, node.object)
        room = (array.bound or size) if isinstance(array, Array) else None
        if values is None or room is None or _is_length_of(context, node.index, node.object):
            continue
        bounds = interval(values)
        text = context.source.text[slice(*node.index.span)]
        for number, origin, is_outside in (
            (bounds.high, bounds.high_from, bounds.high >= room),
            (bounds.low, bounds.low_from, bounds.low < 0),
        ):
            if not is_outside or origin is Origin.ASSUMED:
                continue
            reason = "the last index is" if number >= 0 else "the first index is 0, and the last one is"
            always = bounds.low >= room or bounds.high < 0
            if origin is Origin.WIDENED and not always and ".length" in text:
                continue  # a length is at most the size of its array
            index = node.index if isinstance(node.index, Name) and not always else None
            if index is not None and is_guarded(place.chart, chart, place, index, _holding(place), room):
                continue
            if (
                index is not None
                and number > 0
                and origin is Origin.WIDENED
                and counts_threads(place.chart, index.name)
            ):
                continue  # a thread is free only after it was started
            if origin is Origin.REACHED or always:
                shown = number if math.isfinite(number) else bounds.low
                message = f"`{text}` {'is' if always else 'can be'} {shown:g} here; {reason} {room - 1}"
                yield RULE.at(node.index.span, message, severity=Severity.ERROR if always else Severity.WARNING)
            else:
                message = f"no condition limits `{text}` here; {reason} {room - 1}"
                yield RULE.at(node.index.span, message, severity=Severity.INFORMATION)
            break


def _behind(context: MachineContext, value: TypedValue) -> Iterator[Finding]:
    """Report reads of `v[v.length]`, the element behind the last one."""
    assert isinstance(value.value, Expression)
    written_to: list[Expr] = []
    location = value.value.tree if value.use is ValueUse.LOCATION else None
    while isinstance(location, Member | Index):
        written_to.append(location)
        location = location.object
    for node in walk(value.value.tree):
        if not isinstance(node, Index) or any(node is part for part in written_to):
            continue
        if _is_length_of(context, node.index, node.object):
            name = written(context, node.object)
            message = f"`{name}` has no element `{name}.length`; the last index is `{name}.length - 1`"
            fix = Fix(f"Change to `{name}.length - 1`", (TextEdit(node.index.span, f"{name}.length - 1"),))
            yield RULE.at(node.index.span, message, fix)


def _beyond_length(context: MachineContext, value: TypedValue) -> Iterator[Finding]:
    """Report reads of elements that an array does not have yet."""
    assert isinstance(value.value, Expression)
    chart = context.values.charts.get(value.place.chart.scope)
    if chart is None or value.use is ValueUse.LOCATION:
        return
    size = context.system.parameters.max_array_size if context.system else None
    nodes = list(walk(value.value.tree))
    measured = {node.object.span for node in nodes if isinstance(node, Member) and node.name == "length"}
    for node in nodes:
        if not isinstance(node, Index) or node.span in measured or _is_length_of(context, node.index, node.object):
            continue
        length = chart.lengths.get(node.index.span)
        if length is None:
            continue
        number = constant(node.index)
        index, most = (exactly(number) if number is not None else chart.at(node.index)), interval(length)
        array = _type_of(context, value.place, node.object)
        room = (array.bound or size) if isinstance(array, Array) else None
        if index is None or index.only == frozenset() or most.high_from is not Origin.REACHED:
            continue
        reached = interval(index)
        if room is not None and (reached.high >= room or reached.low < 0):
            continue  # outside of the array in any case
        always = reached.low >= most.high and reached.low_from is Origin.REACHED
        if always or (length.value is not None and reached.high >= most.high and reached.high_from is Origin.REACHED):
            name, text = written(context, node.object), context.source.text[slice(*node.index.span)]
            what = f"`{name}` has no element {reached.low if always else reached.high:g} here"
            where = f": its length is {described(length)}" if always else f", but `{text}` can be {reached.high:g}"
            yield RULE.at(node.index.span, f"{what}{where}", severity=Severity.WARNING)


def _never_filled(chart: Chart) -> Iterator[Finding]:
    """Report reads of an element behind the initial ones, if all assignments to this element read it first."""
    assigns = [s for s in chart.executed if isinstance(s, Assign) and s.location is not None]
    for data in chart.data:
        initial = data.value.tree if isinstance(data.value, Expression) else None
        if data.id is None or not isinstance(initial, ArrayLiteral) or not initial.elements:
            continue
        name, count = data.id.value, len(initial.elements)
        own = [s for s in assigns if s.location is not None and (access_path(s.location.tree) or ("",))[0] == name]
        places = [_element_of(s.location.tree, name) for s in own if s.location is not None]
        if any(place is None for place in places):
            continue  # the array grows elsewhere
        for statement, place in zip(own, places, strict=True):
            reads = _reads(statement, name, place)
            same = [_reads(s, name, place) for s, other in zip(own, places, strict=True) if other == place]
            if place is not None and place >= count and all(same):
                message = (
                    f"`{name}` has no element {place} here: its initial value has {count} element"
                    f"{'s' * (count > 1)}, and this reads the element before it is first assigned; give it an initial "
                    "value"
                )
                yield from (RULE.at(node.index.span, message, severity=Severity.WARNING) for node in reads)


def _element_of(location: Expr, name: str) -> int | None:
    """The constant index of an element of the variable `name`; `None` for other places."""
    if not isinstance(location, Index) or not isinstance(location.object, Name) or location.object.name != name:
        return None
    number = constant(location.index)
    return number if isinstance(number, int) else None


def _reads(statement: Assign, name: str, index: int | None) -> list[Index]:
    """Where an assignment reads an element of the variable `name`."""
    tree = statement.value.tree if isinstance(statement.value, Expression) else None
    nodes = walk(tree) if tree is not None else ()
    return [node for node in nodes if isinstance(node, Index) and _element_of(node, name) == index]


def _append(context: MachineContext, value: TypedValue, tree: Expr) -> Iterator[Finding]:
    """Report `v[v.length]`, which writes after the end of a full bounded array, unless a condition prevents it, or an
    earlier statement sets the array."""
    if not isinstance(tree, Index) or not _is_length_of(context, tree.index, tree.object):
        return
    array = _type_of(context, value.place, tree.object)
    if not isinstance(array, Array) or array.bound is None:
        return
    if _fits(context, value.place, tree.index, array.bound):
        return
    if not (_has_room(context, value.place, tree, array.bound) or _set_before(context, value, tree.object)):
        name = written(context, tree.object)
        yield RULE.at(
            tree.index.span,
            (
                f"`{name}` has at most {array.bound} elements, and no condition prevents a write after the last one; "
                f"test `{name}.length` first"
            ),
            severity=Severity.WARNING,
        )


def _fits(context: MachineContext, place: ValuePlace, index: Expr, bound: int) -> bool:
    """Whether all values that an index can have are below `bound`."""
    chart = context.values.charts.get(place.chart.scope)
    values = chart.at(index) if chart is not None else None
    return values is not None and interval(values).high < bound


def _length(context: MachineContext, value: TypedValue, tree: Expr) -> Iterator[Finding]:
    """Report an assignment to `v.length` of a negative number, or of more elements than the array can hold."""
    if not isinstance(tree, Member) or tree.name != "length":
        return
    array = _type_of(context, value.place, tree.object)
    assigned = next(
        (v for v in context.typed.values if v.use is ValueUse.ASSIGNED and v.element is value.element), None
    )
    if not isinstance(array, Array) or assigned is None or not isinstance(assigned.value, Expression):
        return
    number = constant(assigned.value.tree)
    most = array.bound or (context.system.parameters.max_array_size if context.system else None)
    if number is not None and number < 0:
        fix = Fix("Change to `0`", (TextEdit(assigned.value.span, "0"),), preferred=False)
        yield RULE.at(assigned.value.span, "a length must be at least 0", fix)
    elif number is not None and most is not None and number > most:
        yield RULE.at(
            assigned.value.span,
            f"`{written(context, tree.object)}` has at most {most} elements, so its length cannot be {number}",
        )


def _set_before(context: MachineContext, value: TypedValue, array: Expr) -> bool:
    """Whether an earlier statement of the same body sets the whole array or its length."""
    names = (written(context, array), f"{written(context, array)}.length")
    return any(
        isinstance(other.value, Expression)
        and other.use is ValueUse.LOCATION
        and (other.place.state, other.place.handler, other.place.part)
        == (value.place.state, value.place.handler, value.place.part)
        and other.value.span.start < value.value.span.start
        and written(context, other.value.tree) in names
        for other in context.typed.values
    )


def _is_length_of(context: MachineContext, expr: Expr, array: Expr) -> bool:
    return (
        isinstance(expr, Member) and expr.name == "length" and written(context, expr.object) == written(context, array)
    )


def _type_of(context: MachineContext, place: ValuePlace, expr: Expr) -> Type:
    variables = context.typed.variables.get(place.chart.scope, {})
    return infer(expr, variables.get)[0]


def _holding(place: ValuePlace) -> list[tuple[Expression, bool]]:
    """The conditions whose values are known at a place."""
    conditions = list(place.branch_conditions or ())
    if place.handler is not None and place.handler.cond is not None:
        conditions.append((place.handler.cond, True))
    if place.state is not None and place.handler is not None:
        group = _trigger(place.handler)
        earlier = place.state.handlers[: place.state.handlers.index(place.handler)]
        conditions += [(h.cond, False) for h in earlier if h.cond and _trigger(h) == group]
    return conditions


def _has_room(context: MachineContext, place: ValuePlace, append: Index, bound: int) -> bool:
    """Whether a condition that holds at this place keeps the length of the array below `bound`."""
    holding, array, values = _holding(place), append.object, context.values.charts.get(place.chart.scope)
    if any(_limits(context, place.chart, condition.tree, array, bound, holds) for condition, holds in holding):
        return True
    return values is not None and ends_in_time(place.chart, values, append, holding, bound)


def _trigger(handler: Handler) -> tuple[object, ...]:
    """The trigger of a handler, as a key: handlers with equal keys are tested in document order."""
    names = (handler.event, handler.handle, handler.child)
    return (handler.trigger, *(name.value if name else "" for name in names))


def _limits(context: MachineContext, chart: Chart, expr: Expr, array: Expr, bound: int, holds: bool) -> bool:
    """Whether the length of the array is below `bound` if the value of `expr` is `holds`."""
    match expr:
        case Unary(operator=UnaryOperator.NOT):
            return _limits(context, chart, expr.operand, array, bound, not holds)
        case Binary(operator=Operator.AND | Operator.OR):
            sides = (_limits(context, chart, side, array, bound, holds) for side in (expr.left, expr.right))
            return any(sides) if (expr.operator is Operator.AND) is holds else all(sides)
        case Binary(operator=operator) if operator in OPPOSITE:
            if _is_length_of(context, expr.left, array):
                number = constant(expr.right)
            elif _is_length_of(context, expr.right, array):
                number, operator = constant(expr.left), MIRRORED.get(operator, operator)
            else:
                return False
            return _below(operator if holds else OPPOSITE[operator], number, bound)
        case Name():
            return _keeps_limit(context, chart, expr, array, bound, holds)
    return False


def _keeps_limit(context: MachineContext, chart: Chart, expr: Name, array: Expr, bound: int, holds: bool) -> bool:
    """Whether a Boolean variable keeps the result of a condition that limits the length of the array: each assignment
    that can give it the value `holds` does, or is beside one that sets the array. An array that has grown since then is
    not considered."""
    kept = [
        statement.value.tree
        for statement in chart.statements
        if isinstance(statement, Assign) and statement.location and place_of(statement.location.tree) == expr.name
        if isinstance(statement.value, Expression)
        if not (isinstance(statement.value.tree, Boolean) and statement.value.tree.value is not holds)
        if not (isinstance(statement.value.tree, Boolean) and is_reset(chart, statement, place_of(array) or ""))
    ]
    return bool(kept) and all(
        not isinstance(tree, Name) and _limits(context, chart, tree, array, bound, holds) for tree in kept
    )


def _below(operator: Operator, number: float | None, bound: int) -> bool:
    """Whether `length OPERATOR number` keeps the length below `bound`. A limit that is not constant (`None`) is
    assumed to do so."""
    match operator:
        case Operator.LESS:
            return number is None or number <= bound
        case Operator.LESS_EQUAL | Operator.EQUAL:
            return number is None or number < bound
        case Operator.NOT_EQUAL:
            # The length grows by 1, so it cannot pass a number that the condition excludes.
            return number is None or 0 < number <= bound
    return False


RULE = Rule("index-out-of-bounds", Severity.ERROR, "An index is outside of its array.", machine=check, whole=True)
