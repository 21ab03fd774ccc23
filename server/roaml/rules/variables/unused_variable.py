# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-variable`, which unused_variable.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from roaml.diagnostics import Finding, Fix, Related, Severity, Tag
from roaml.edit.elements import removal, remove
from roaml.expr.operators import COMPARING
from roaml.expr.tree import Binary, Call, Expr, Name, access_path, walk
from roaml.expr.types import Type
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import (
    Assign,
    CallChild,
    Chart,
    Data,
    If,
    Param,
    ReturnStatus,
    RosSend,
    Send,
    Statement,
    bodies,
    statements,
)
from roaml.model.syntax import Expression, Value
from roaml.model.syntax import Name as SyntaxName
from roaml.model.value_types import ValueUse
from roaml.model.values.evaluate import place_of
from roaml.model.waits import fixed_variables
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.words import LIMITS, difference, with_word, words_of
from roaml.text import Span


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        values = [value.value for value in context.typed.values if value.place.chart is chart]
        if any(isinstance(value, Expression) and value.broken for value in values):
            continue  # the part that cannot be read may use the variable
        used = _used(values, chart)
        written = _only_written(values, chart) if context.system is not None else {}
        for data in chart.data:
            if data.id is None:
                continue
            if data.id.value not in used:
                message = f"the variable `{data.id.value}` is never used"
                yield RULE.at(data.id.span, message, _remove(context, data), tags=(Tag.UNNECESSARY,))
            elif data.id.value in written:
                spans, computed, reads_itself = written[data.id.value]
                message = f"the variable `{data.id.value}` is assigned, but its value is never read"
                if reads_itself:
                    message += " except in its own assignments"
                related = [Related(span, "assigned here") for span in spans]
                twin = _twin(context, chart, data.id.value, spans)
                types = context.typed.variables.get(chart.scope, {})
                meant = list({n.span: n for n in _meant(chart, data.id.value, values, types, computed)}.values())
                if len(meant) == 1:
                    message = f"{message}; did you mean it here instead of `{meant[0].name}`?"
                    fixes = replacements(meant[0].span, (data.id.value,))
                    related.append(Related(data.id.span, "the variable"))
                    yield RULE.at(meant[0].span, message, *fixes, related=related, severity=Severity.WARNING)
                    continue
                if twin is not None:
                    message += f", although that of `{twin}` is, which the same handler does not assign"
                related += [Related(name.span, "perhaps it is meant here") for name in meant]
                severity = Severity.WARNING if computed or meant or twin is not None else None
                yield RULE.at(data.id.span, message, related=related, severity=severity)


def _remove(context: MachineContext, data: Data) -> Fix:
    """A fix that removes a variable together with the comment that states its type."""
    title, text = "Remove the variable", context.source.text
    if not data.comment_type or data.type is None:
        return remove(context.document, data.element, title, preferred=True)
    start = text.rfind("<!--", 0, data.type.span.start)
    return Fix(title, (removal(text, Span(start, data.element.span.end)),))


def _only_written(values: list[Value], chart: Chart) -> dict[str, tuple[list[Span], bool, bool]]:
    """Variable that is assigned and read nowhere else than in its own assignments -> the places of the assignments,
    whether one of them computes its value, as in `m + 1`, and whether one of them reads the variable itself, as in
    `n + 1` for `n` or in an index of its location."""
    assigned: dict[str, list[Span]] = {}
    own: dict[Span, str] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            root = (access_path(statement.location.tree) or ("",))[0]
            assigned.setdefault(root, []).append(statement.location.span)
            own[statement.location.span] = root
            if isinstance(statement.value, Expression):
                own[statement.value.span] = root
    read, computed, itself = _named(chart), set(), set()
    locations = {span for spans in assigned.values() for span in spans}
    for value in values:
        if not isinstance(value, Expression):
            continue
        target = own.get(value.span)
        nodes = list(walk(value.tree))
        names = [node.name for node in nodes if isinstance(node, Name)]
        read |= {name for name in names if name != target}
        if target is not None and names.count(target) > (value.span in locations):
            itself.add(target)
        if target is not None and value.span not in locations and any(_computes(node, target) for node in nodes):
            computed.add(target)
    return {name: (spans, name in computed, name in itself) for name, spans in assigned.items() if name not in read}


def _twin(context: MachineContext, chart: Chart, name: str, spans: Sequence[Span]) -> str | None:
    """A variable that is probably read by mistake instead of `name`: its name differs in one word, it is not assigned
    in the handlers that assign `name`, and both only get data that arrive."""
    if len(words_of(name)) < 2:
        return None
    types = context.typed.variables.get(chart.scope, {})
    handlers = {value.place.handler for value in context.typed.values if value.value.span in spans}
    assigned: set[str] = set()
    read: set[str] = set()
    for value in context.typed.values:
        if value.place.chart is chart and isinstance(value.value, Expression):
            if value.use is not ValueUse.LOCATION:
                read |= variables_in((value.value.tree,))
            elif value.place.handler in handlers:
                assigned |= variables_in((value.value.tree,))
    others: dict[str, list[Assign]] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            others.setdefault((access_path(statement.location.tree) or ("",))[0], []).append(statement)
    for other, type_ in types.items():
        is_similar = str(type_) == str(types.get(name)) and difference(name, other) is not None
        received = (*others.get(name, ()), *others.get(other, ()))
        if is_similar and other in read - assigned and other in others and all(map(_is_received, received)):
            return other
    return None


def _meant(
    chart: Chart, name: str, values: Sequence[Value], types: Mapping[str, Type], computed: bool
) -> Iterator[Name]:
    """Where another variable is read, but the unread variable `name` is probably meant: twice in one operation, as in
    `temp_a + temp_a`, in a field beside others that get the variables with their names, or beside the words of the
    unread variable. `computed`: whether an assignment computes its value, as that of a counter."""
    sources = _sources(chart)
    beside = (*_receivers(chart, name), *(_limits(chart, values) if computed else ()))
    named = (read for other, read in beside if _is_named(name, other, read.name))
    yield from (read for read in named if types.get(read.name) == types.get(name))
    yield from (read for read in _repeated_tests(chart, name) if types.get(read.name) == types.get(name))
    for statement in chart.statements:
        if isinstance(statement, RosSend | Send):
            yield from _fields(statement.fields if isinstance(statement, RosSend) else statement.params, name, sources)
        for value in _sent_or_assigned(statement):
            for node in walk(value.tree):
                match node:
                    case Binary(left=Name(name=left), right=Name(name=right) as operand) if left == right:
                        if len(words_of(name)) > 1 and difference(name, right) is not None:
                            yield operand


def _repeated_tests(chart: Chart, name: str) -> Iterator[Name]:
    """Where one of two `<if>` in the same content tests the same flag as the other one, although what it guards has the
    word in which the unread variable differs from this flag."""
    for _, _, body in bodies(chart):
        tests = [(s.branches[0].cond.tree, s) for s in body if isinstance(s, If) and s.branches and s.branches[0].cond]
        flags = [(tree, statement) for tree, statement in tests if isinstance(tree, Name)]
        for flag, statement in flags:
            pair = difference(name, flag.name)
            if pair is not None and [tree.name for tree, _ in flags].count(flag.name) > 1:
                inside = {word for used in _assigned_in(statement) for word in words_of(used)}
                if pair[0] in inside and pair[1] not in inside:
                    yield flag


def _assigned_in(statement: If) -> Iterator[str]:
    """The variables that the first branch of an `<if>` assigns."""
    for inner in statements(statement.branches[0].body):
        if isinstance(inner, Assign) and inner.location is not None:
            yield from access_path(inner.location.tree) or ()


def _receivers(chart: Chart, unread: str) -> Iterator[tuple[str, Name]]:
    """Variables that are assigned or sent as they are, each with the name of the variable other than `unread`, or of
    the message with one field, that gets the value."""
    for statement in chart.statements:
        match statement:
            case Assign(location=Expression(tree=Name(name=name)), value=Expression(tree=Name() as read)):
                if name != unread:
                    yield name, read
            case (
                RosSend(handle=SyntaxName(value=name), fields=(Param(value=Expression(tree=Name() as read)),))
                | Send(event=SyntaxName(value=name), params=(Param(value=Expression(tree=Name() as read)),))
            ):
                yield name, read


def _limits(chart: Chart, values: Sequence[Value]) -> Iterator[tuple[str, Name]]:
    """Variables that are compared with a constant which is named as a limit, each with the name of the constant."""
    fixed = fixed_variables(chart)
    for node in (node for value in values if isinstance(value, Expression) for node in walk(value.tree)):
        match node:
            case Binary(operator=operator, left=Name() as left, right=Name() as right) if operator.kind in COMPARING:
                for read, limit in ((left, right), (right, left)):
                    if limit.name in fixed and not LIMITS.isdisjoint(words_of(limit.name)):
                        yield limit.name, read


def _is_named(name: str, beside: str, read: str) -> bool:
    """Whether the words beside a variable `read` are those of the unread variable `name`, and none is its own:
    `robot_loc` for `req_loc` instead of `req_obj`, `charging` for `is_charging`, `max_turns` for `turns`."""
    own, used = {*words_of(name)} - LIMITS, {*words_of(read)} - LIMITS
    about = {*words_of(beside)} - LIMITS
    pair = difference(name, read)
    if pair is not None:
        return pair[0] in about and pair[1] not in about
    return bool(about) and about <= own and about.isdisjoint(used)


def _sent_or_assigned(statement: Statement) -> Iterator[Expression]:
    match statement:
        case Assign(value=Expression() as value):
            yield value
        case Send(params=params) | RosSend(fields=params):
            for param in params:
                if isinstance(param.value, Expression):
                    yield param.value


def _fields(fields: Sequence[Param], name: str, sources: Mapping[str, Set[str]]) -> Iterator[Name]:
    """The variables that fields get instead of `name`, which has the name of the field, receives the field with its
    name, or is named like the variable of another field."""
    plain = [
        (field.name.value.rpartition(".")[2], field.value.tree)
        for field in fields
        if field.name is not None and isinstance(field.value, Expression) and isinstance(field.value.tree, Name)
    ]
    own = [value for key, value in plain if value.name == key or key in sources.get(value.name, ())]
    for key, value in plain:
        named = any(value is not other for other in own) and value not in own
        if key == name and value.name != key and len(words_of(key)) > 1:
            yield value
            continue
        if named and (key == name or key in sources.get(name, ())):
            yield value
            continue
        for other, its in plain:
            words = difference(other, key)
            if words is not None and its.name != other and with_word(its.name, *words) == name:
                yield value
                break


def _sources(chart: Chart) -> dict[str, set[str]]:
    """Variable -> the names of the fields that it receives."""
    sources: dict[str, set[str]] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None and isinstance(statement.value, Expression):
            target, source = place_of(statement.location.tree), place_of(statement.value.tree)
            if target is not None and source is not None and source.startswith("_"):
                sources.setdefault(target, set()).add(source.rpartition(".")[2])
    return sources


def _is_received(statement: Assign) -> bool:
    return isinstance(statement.value, Expression) and any(
        name.startswith("_") for name in variables_in((statement.value.tree,))
    )


def _computes(node: Expr, variable: str) -> bool:
    if isinstance(node, Name):
        return node.name == variable
    return isinstance(node, Call | Binary)


def _used(values: list[Value], chart: Chart) -> set[str]:
    used = {
        node.name
        for value in values
        if isinstance(value, Expression)
        for node in walk(value.tree)
        if isinstance(node, Name)
    }
    return used | _named(chart)


def _named(chart: Chart) -> set[str]:
    """The variables in attributes that contain a name instead of an expression."""
    named = {handler.child.value for state in chart.states for handler in state.handlers if handler.child}
    for statement in chart.statements:
        match statement:
            case ReturnStatus(status=name) | CallChild(child=name) if name is not None:
                named.add(name.value)
    return named


RULE = Rule("unused-variable", Severity.HINT, "A variable is never used.", machine=check, whole=True)
