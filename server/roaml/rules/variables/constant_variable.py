# SPDX-License-Identifier: Apache-2.0
"""The rule `constant-variable`, which constant_variable.md describes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.operators import OperatorKind
from roaml.expr.tree import Binary, Index, Member, Name, access_path, walk
from roaml.expr.types import Scalar, leaves
from roaml.model.machine import Assign, Chart, Data, Declaration, ReturnStatus, bodies
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Expression
from roaml.model.value_types import CONDITIONS, INTERFACE_KINDS, ValueUse, find_handle, section_of
from roaml.model.values.analyse import data_place
from roaml.model.values.describe import described
from roaml.model.values.domain import ValueSet, joined
from roaml.model.values.evaluate import is_within, literal, place_of
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.assignments import is_unchanged
from roaml.rules.support.words import Hole, difference, holes, words_of
from roaml.text import Span

_RECEIVED = (ProtocolPart.MESSAGE, ProtocolPart.REQUEST, ProtocolPart.GOAL)
"""What other machines send without being asked."""

_PREVIOUS = ("previous", "prev", "last", "old")
"""The first word of a variable that should keep the last value of another one."""

_VALUE_NAMES = frozenset(("default", "empty", "false", "initial", "nil", "none", "nothing", "null", "off", "zero"))
"""Words in the names of constants that are 0, false or empty."""

_SENT = (ValueUse.FIELD, ValueUse.PARAMETER)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report variables that should change but always have their initial value, except those in constant conditions:
    constant-condition reports these."""
    if not context.automata:
        return
    for chart in context.machine.charts:
        assigned = _assigned(chart)
        candidates = _read(context, chart) | _repeatedly_assigned(context, chart, assigned)
        alike = _by_words(assigned)
        for data in chart.data:
            if data.id is not None and data.id.value in candidates and not data.id.value.isupper():
                value = _only_value(context, chart, data, assigned.get(data.id.value, []))
                if value is not None:
                    statements = assigned.get(data.id.value, [])
                    similar = None if statements else _similar(context, chart, data.id.value, assigned, alike)
                    if similar is not None:
                        yield _forgotten(data.id.value, data.id.span, value, similar)
                        continue
                    yield from _constant(context, chart, data.id.value, data, value, statements)


def _constant(
    context: MachineContext, chart: Chart, name: str, data: Data, value: ValueSet, statements: list[Assign]
) -> Iterator[Finding]:
    assert data.id is not None
    shown = described(value)
    computed = [(s, s.value) for s in statements if isinstance(s.value, Expression) and name in _variables(s.value)]
    if computed:
        statement, kept = computed[0]
        if not is_unchanged(statement):  # self-assignment
            yield RULE.at(kept.span, f"this never changes `{name}`, which is always {shown}; change the expression")
    elif not statements and len(words_of(name)) > 1 and words_of(name)[0] in _PREVIOUS and not _is_named(name, value):
        message = f"`{name}` is always {shown}, because nothing assigns it; assign the value that it should keep"
        yield RULE.at(data.id.span, message)
    elif value.value and len(statements) < (1 if isinstance(value.value, bool) else _MIN_ASSIGNED):
        return  # a named constant
    elif statements and any(isinstance(s.value, Expression) and _variables(s.value) for s in statements):
        return  # a consequence of other variables
    elif statements:
        message = f"`{name}` is always {shown}, because all assignments assign its initial value; assign other values"
        yield RULE.at(data.id.span, message)
    elif not _VALUE_NAMES.isdisjoint(words_of(name)) or _is_reset_value(context, chart, name):
        return  # a named constant
    else:
        unread = next(_unread(context, chart, name), None)
        if unread is not None:
            message = f"`{name}` is always {shown}, because nothing assigns it, and nothing reads `{unread}`"
            yield RULE.at(data.id.span, f"{message}; assign received data to it, or remove it")
        elif _is_counted(context, chart, name):
            message = f"`{name}` is always {shown}, because nothing assigns it, although a condition limits it"
            yield RULE.at(data.id.span, f"{message} and it is sent; assign the values that it should get")
        elif (index := _index(context, chart, name)) is not None:
            message = (
                f"`{name}` is always {shown}, because nothing assigns it, although it is an index like `{index}`, "
                "which changes; assign the values that it should get"
            )
            yield RULE.at(data.id.span, message)


def _is_reset_value(context: MachineContext, chart: Chart, name: str) -> bool:
    """Whether a variable is used like a constant: other variables, which also get other values, are set to it, and else
    it is only compared."""
    reset = [
        s.location.text.strip()
        for s in chart.statements
        if isinstance(s, Assign) and s.location is not None and isinstance(s.value, Expression)
        if isinstance(s.value.tree, Name) and s.value.tree.name == name
    ]
    assigned = Counter(s.location.text.strip() for s in chart.statements if isinstance(s, Assign) and s.location)
    if not reset or any(assigned[place] == reset.count(place) for place in reset):
        return False
    return all(
        v.use in CONDITIONS or (v.use is ValueUse.ASSIGNED and isinstance(v.value.tree, Name))
        for v in context.typed.values
        if v.place.chart is chart and isinstance(v.value, Expression) and v.use is not ValueUse.LOCATION
        if name in _variables(v.value)
    )


def _is_counted(context: MachineContext, chart: Chart, name: str) -> bool:
    """Whether a variable is compared with a limit, and is also sent as it is, as a number that changes. A constant is
    one or the other."""
    own = [
        (v.use, v.value.tree)
        for v in context.typed.values
        if v.place.chart is chart and isinstance(v.value, Expression)
    ]
    is_sent = any(use in _SENT and isinstance(tree, Name) and tree.name == name for use, tree in own)
    return is_sent and any(
        isinstance(node, Binary) and node.operator.kind is OperatorKind.ORDER and _is_side(node, name)
        for use, tree in own
        if use in CONDITIONS
        for node in walk(tree)
    )


_FIXED = frozenset(("base", "first", "front", "home", "origin", "root", "start"))
"""Words in the names of constant indices."""


def _index(context: MachineContext, chart: Chart, name: str) -> str | None:
    """Another variable that is an index of the same array as `name` in one expression, and that changes; `None` if
    there is none."""
    if not _FIXED.isdisjoint(words_of(name)):
        return None
    assigned = _assigned(chart)
    for value in context.typed.values:
        if value.place.chart is not chart or not isinstance(value.value, Expression):
            continue
        indices = [
            (place_of(node.object), node.index.name)
            for node in walk(value.value.tree)
            if isinstance(node, Index) and isinstance(node.index, Name)
        ]
        arrays = [array for array, index in indices if index == name]
        for array, index in indices:
            if array in arrays and index != name and index in assigned:
                return index
    return None


def _is_side(node: Binary, name: str) -> bool:
    return any(isinstance(side, Name) and side.name == name for side in (node.left, node.right))


_MIN_ASSIGNED = 2
"""How many assignments of its initial value to a variable are no reset of a named constant."""


def _forgotten(name: str, span: Span, value: ValueSet, similar: Assign) -> Finding:
    assert similar.location is not None
    other = similar.location.text.strip()
    message = (
        f"`{name}` is always {described(value)}, because nothing assigns it, although `{other}` gets other values; "
        "assign it, or replace it by its value"
    )
    return RULE.at(span, message, related=[Related(similar.location.span, f"`{other}` is assigned")])


def _similar(
    context: MachineContext,
    chart: Chart,
    name: str,
    assigned: Mapping[str, Sequence[Assign]],
    alike: Mapping[Hole, Sequence[str]],
) -> Assign | None:
    """An assignment of a value that is not constant to a variable of the same type whose name differs in a
    number, or in which different requests store different data."""
    types = context.typed.variables.get(chart.scope, {})
    for other in (other for hole, _ in holes(name) for other in alike.get(hole, ())[:_MAX_ALIKE]):
        statements, words = assigned[other], difference(name, other)
        if words is None or types.get(other) != types.get(name):
            continue
        received = [s for s in statements if isinstance(s.value, Expression) and _variables(s.value)]
        if received and (all(word.isdigit() for word in words) or _is_for_two(chart, received)):
            return received[0]
    return None


_MAX_ALIKE = 8
"""How many similar variables are compared with one that nothing assigns."""


def _by_words(names: Iterable[str]) -> dict[Hole, list[str]]:
    """The names that differ in one word only, by what they have in common."""
    result: dict[Hole, list[str]] = {}
    for name in names:
        for hole, _ in holes(name):
            result.setdefault(hole, []).append(name)
    return result


def _is_for_two(chart: Chart, received: Sequence[Assign]) -> bool:
    """Whether different goals or requests store what they ask for in the same variable."""
    places = {
        handler.handle.value: s.value.text.strip()
        for _, handler, body in bodies(chart)
        if handler is not None and handler.handle is not None and handler.trigger in _RECEIVED[1:]
        for s in received
        if s in body and isinstance(s.value, Expression)
    }
    return len(places) > 1 and len(set(places.values())) == len(places)


def _is_named(name: str, value: ValueSet) -> bool:
    """Whether a variable is a named constant, such as `last_floor`, which is 5. A value that is kept begins with one
    that stands for none."""
    return words_of(name)[:1] == ["last"] and isinstance(value.value, int | float) and value.value > 0


def _only_value(context: MachineContext, chart: Chart, data: Data, statements: list[Assign]) -> ValueSet | None:
    """The initial value of a scalar variable, if it never has another one."""
    assert data.id is not None
    values = context.local_values.charts.get(chart.scope)
    type_ = context.typed.variables.get(chart.scope, {}).get(data.id.value)
    if values is None or not isinstance(type_, Scalar) or not isinstance(data.value, Expression):
        return None
    known = [_literal(data.value)]
    for s in statements:
        value = s.value if isinstance(s.value, Expression) else None
        known.append(None if value is None else _literal(value) or values.at(value.tree))
    every = [value for value in known if value is not None]
    together = joined(every)
    return together if len(every) == len(known) and together.value is not None else None


def _literal(value: Expression) -> ValueSet | None:
    return dict(literal("", value.tree)).get("")


def _assigned(chart: Chart) -> dict[str, list[Assign]]:
    result: dict[str, list[Assign]] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            result.setdefault((access_path(statement.location.tree) or ("",))[0], []).append(statement)
    return result


def _repeatedly_assigned(context: MachineContext, chart: Chart, assigned: Mapping[str, Sequence[Assign]]) -> set[str]:
    """The variables to which several places assign a value, and which nothing reads."""
    used = {name for v in context.typed.values if v.place.chart is chart and v.use is not ValueUse.LOCATION
            and isinstance(v.value, Expression) for name in _variables(v.value)}  # fmt: skip
    return {name for name, statements in assigned.items() if len(statements) >= _MIN_ASSIGNED and name not in used}


def _read(context: MachineContext, chart: Chart) -> set[str]:
    """The variables that are read, but not in a condition whose result is always the same, and not as the id of a goal,
    which wrong-goal-id checks."""
    values = context.local_values.charts.get(chart.scope)
    read = {s.status.value for s in chart.statements if isinstance(s, ReturnStatus) and s.status is not None}
    explained: set[str] = set()
    for value in context.typed.values:
        if value.place.chart is chart and isinstance(value.value, Expression) and value.use is not ValueUse.LOCATION:
            known = values.conditions.get(value.value.span) if values and value.use in CONDITIONS else None
            is_explained = value.use is ValueUse.ARGUMENT or (known is not None and known.alone.value is not None)
            (explained if is_explained else read).update(_variables(value.value))
    return read - explained


def _variables(expression: Expression) -> set[str]:
    return {node.name for node in walk(expression.tree) if isinstance(node, Name)}


def _unread(context: MachineContext, chart: Chart, name: str) -> Iterator[str]:
    """The places of data that arrive in handlers of a chart, have the kind of the scalar variable `name`, and are not
    read. Those of a response also have its name, because clients do not need all fields of a response."""
    type_ = context.typed.variables[chart.scope][name]
    for handler in (handler for state in chart.states for handler in state.handlers):
        part, declaration = handler.trigger, find_handle(context.machine, handler)
        if part not in (*_RECEIVED, ProtocolPart.RESPONSE) or declaration is None or declaration.type is None:
            continue
        interface = context.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)
        struct = dict(interface.parts).get(section_of(part)) if isinstance(interface, InterfaceType) else None
        read = set(_places(context, declaration))
        for path, leaf in leaves(struct) if struct is not None else ():
            place = ".".join((data_place(part) or "", *path))
            is_alike = isinstance(leaf, Scalar) and isinstance(type_, Scalar) and leaf.kind is type_.kind
            if part is ProtocolPart.RESPONSE and path[-1] != name:
                continue
            if is_alike and not any(is_within(place, outer) for outer in read):
                yield place


def _places(context: MachineContext, declaration: Declaration) -> Iterator[str]:
    """The places that the handlers of a declaration read."""
    for value in context.typed.values:
        handler = value.place.handler
        if handler is None or not isinstance(value.value, Expression):
            continue
        if find_handle(context.machine, handler) is declaration:
            nodes = list(walk(value.value.tree))
            inner = {node.object.span for node in nodes if isinstance(node, Member | Index)}
            whole = (node for node in nodes if node.span not in inner)
            yield from (place for node in whole if (place := place_of(node)) is not None)


RULE = Rule(
    "constant-variable",
    Severity.WARNING,
    "A variable that should change always has its initial value.",
    machine=check,
    whole=True,
)
