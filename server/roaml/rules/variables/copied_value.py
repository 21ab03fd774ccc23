# SPDX-License-Identifier: Apache-2.0
"""The rule `copied-value`, which copied_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.tree import Binary, Call, Expr, Member, access_path, walk
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import Scalar, Struct, Type, leaves
from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, Chart, Data, Handler, If, Param, RosSend, Send, SetOutput, Statement, bodies
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Expression, Value
from roaml.model.tree import TreeNode
from roaml.model.value_types import INTERFACE_KINDS, ValueUse, find_handle
from roaml.model.values.analyse import DataChannel
from roaml.model.values.evaluate import is_within, place_of
from roaml.model.waits import fixed_variables
from roaml.record import replace
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule, TreeContext, replacements
from roaml.rules.support.forest import trees_of
from roaml.rules.support.odd_constants import odd_constants
from roaml.rules.support.words import difference, with_word
from roaml.text import Span, TextEdit


class _Copy(NamedTuple):
    """A value and where it goes: the name of the variable, field, parameter or port, and the name of the value."""

    target: str
    value: str
    span: Span


class _Suspicion(NamedTuple):
    """A value that another target gets, too, and the name of the value that is probably meant."""

    copy: _Copy
    other: _Copy
    meant: str


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        reported: set[Span] = set()
        for _, handler, body in bodies(chart):
            twice = _read_twice(context, chart, handler, body) if handler is not None else ()
            for finding in (*_named(context, chart, handler, body), *twice, *_equal_changes(body)):
                if finding.span not in reported:
                    reported.add(finding.span)
                    yield finding
        yield from _constant_fields(context, chart)
        yield from _equal_constants(context, chart)


def _named(
    context: MachineContext, chart: Chart, handler: Handler | None, body: Sequence[Statement]
) -> Iterator[Finding]:
    for group in _groups(body):
        for copy, other, meant in _suspicions(group):
            if _exists(context, chart, handler, meant.split(".")) and not _is_start(context, chart, copy, meant):
                yield _finding(copy, other, meant, copy.value, meant)
        for copy, other in _unlike_others(group):
            if _exists(context, chart, handler, [copy.target]):
                yield _finding(copy, other, copy.target, copy.value, copy.target)


def _unlike_others(group: Sequence[_Copy]) -> Iterator[tuple[_Copy, _Copy]]:
    """The fields that get the variable with the name of another field, which gets it, too, while most fields of the
    message get the variables with their own names."""
    own = {copy.target: copy for copy in group if copy.target == copy.value}
    for copy in group:
        other = own.get(copy.value)
        if other is not None and copy is not other and len(own) >= _MIN_OWN_NAMES and copy.target not in own:
            yield copy, other


_MIN_OWN_NAMES = 3
"""How many fields of a message must get the variables with their names before another one is suspicious."""


def _read_twice(
    context: MachineContext, chart: Chart, handler: Handler, body: Sequence[Statement]
) -> Iterator[Finding]:
    """Report two variables that get the same field of a message, or are computed from it in the same way, although
    nothing in the machine reads another field, whose value varies."""
    first: dict[str, Assign] = {}
    for statement in body:
        if not isinstance(statement, Assign) or statement.location is None:
            continue
        if not isinstance(statement.value, Expression) or statement.value.broken:
            continue
        fields = {place for node in walk(statement.value.tree) if (place := place_of(node)) and place.startswith(_DATA)}
        longest = {place for place in fields if not any(is_within(other, place) for other in fields - {place})}
        earlier = first.setdefault(format_expr(statement.value.tree), statement)
        if len(longest) != 1 or earlier is statement or earlier.location is None:
            continue
        (field,) = longest
        unread = _unread(context, chart, handler, field)
        target, other = format_expr(statement.location.tree), format_expr(earlier.location.tree)
        if target != other and unread is not None and not _continues(chart, (statement, earlier)):
            message = f"`{target}` gets the same value as `{other}`, and nothing reads `{unread}`; did you mean that?"
            spans = [n.span for n in walk(statement.value.tree) if place_of(n) == field]
            yield RULE.at(
                statement.value.span,
                message,
                Fix(f"Change to `{unread}`", tuple(TextEdit(span, unread) for span in spans)),
                related=[Related(earlier.element.name_span, "the same value")],
            )


def _continues(chart: Chart, starts: Sequence[Assign]) -> bool:
    """Whether the variables that two assignments set are computed from their own values elsewhere: the least and the
    greatest value, for example, begin with the same one."""
    places = [place_of(start.location.tree) for start in starts if start.location is not None]
    return all(
        any(
            place_of(statement.location.tree) == place and place in map(place_of, walk(statement.value.tree))
            for statement in chart.statements
            if isinstance(statement, Assign) and statement.location is not None
            if isinstance(statement.value, Expression) and not statement.value.broken
        )
        for place in places
    )


def _equal_changes(body: Sequence[Statement]) -> Iterator[Finding]:
    """Report two similar variables to which the same computed value is added, or from which it is subtracted: only
    their sum would differ from one of them."""
    changes: dict[str, Assign] = {}
    for statement in body:
        if not isinstance(statement, Assign) or statement.location is None:
            continue
        tree = statement.value.tree if isinstance(statement.value, Expression) else None
        place = place_of(statement.location.tree)
        if not isinstance(tree, Binary) or place is None or place_of(tree.left) != place:
            continue
        if not any(isinstance(node, Call) for node in walk(tree.right)):
            continue
        earlier = changes.setdefault(f"{tree.operator.symbol}{format_expr(tree.right)}", statement)
        other = place_of(earlier.location.tree) if earlier.location is not None else None
        if other is not None and difference(place, other) is not None:
            message = f"`{place}` changes by the same value as `{other}`; change one of them"
            yield RULE.at(tree.right.span, message, related=[Related(earlier.element.name_span, "the same change")])


def _equal_constants(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Report two constants whose names differ in one word, such as `SKILL_SUCCESS` and `SKILL_FAILURE`, if they have
    the same value and are sent in the same field: its receivers cannot distinguish them."""
    fixed = fixed_variables(chart)
    sent: dict[str, set[str]] = {}
    for statement in chart.statements:
        if not isinstance(statement, RosSend) or statement.handle is None:
            continue
        for param in statement.fields:
            tree = param.value.tree if isinstance(param.value, Expression) and not param.value.broken else None
            if isinstance(tree, NameExpr) and tree.name.isupper() and tree.name in fixed and param.name is not None:
                sent.setdefault(f"{statement.handle.value} {param.name.value}", set()).add(tree.name)
    odd = odd_constants(context, chart) if sent else {}  # inconsistent-constant reports these with their value
    first: dict[object, Data] = {}
    for data in chart.data:
        if data.id is None or not data.id.value.isupper() or data.id.value not in fixed or data.value is None:
            continue
        if data.id.value in odd:
            continue
        if not any(
            data.id.value in names and _is_enumeration([fixed[name] for name in names]) for names in sent.values()
        ):
            continue
        earlier = first.setdefault(fixed[data.id.value], data)
        if earlier is data or earlier.id is None or difference(earlier.id.value, data.id.value) is None:
            continue
        if any({earlier.id.value, data.id.value} <= names for names in sent.values()):
            message = (
                f"`{data.id.value}` has the same value as `{earlier.id.value}`, and both are sent in the same field; "
                "change one of them"
            )
            for span, other in ((earlier.id.span, data.id.span), (data.id.span, earlier.id.span)):
                yield RULE.at(span, message, related=[Related(other, "the same value")])


def _is_enumeration(values: Sequence[object]) -> bool:
    """Whether numbers are consecutive from 0 or 1, except that some are equal, as those of statuses and commands are.
    Other numbers, such as durations and speeds, are equal by chance."""
    numbers = sorted(value for value in values if isinstance(value, Fraction) and value.denominator == 1)
    return bool(numbers) and numbers[0] in (0, 1) and numbers[-1] - numbers[0] <= len(numbers) - 1


def _constant_fields(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Report a field of a message that is read although all machines send the same constant in it, if nothing reads the
    only other field of its type that arrives with other values, and their names differ in one word."""
    meant: dict[tuple[str, str], str | None] = {}
    for value in context.typed.values:
        handler, expression = value.place.handler, value.value
        if value.place.chart is not chart or handler is None or handler.trigger is not ProtocolPart.MESSAGE:
            continue
        if not isinstance(expression, Expression) or expression.broken or _DATA not in expression.text:
            continue
        nodes = {place: node for node in walk(expression.tree) if (place := place_of(node)) is not None}
        declaration = find_handle(context.machine, handler)
        if declaration is None or declaration.handle is None:
            continue
        arriving = context.values.arriving.get(DataChannel(handler.trigger, declaration.handle.value), {})
        for place, node in nodes.items():
            known = arriving.get(place.removeprefix(_DATA)) if place.startswith(_DATA) else None
            if known is None or known.value is None:
                continue
            key = (declaration.handle.value, place)
            if key not in meant:
                meant[key] = _unread(context, chart, handler, place)
            unread = meant[key]
            if unread is not None and difference(place, unread) is not None:
                message = (
                    f"`{place}` always arrives with the same value, and nothing reads `{unread}`; did you mean that?"
                )
                yield RULE.at(node.span, message, Fix(f"Change to `{unread}`", (TextEdit(node.span, unread),)))


_DATA = "_msg."


def _unread(context: MachineContext, chart: Chart, handler: Handler, field: str) -> str | None:
    """The only other field of the kind of `field` that arrives with several values and that nothing reads."""
    declaration = find_handle(context.machine, handler)
    if declaration is None or declaration.handle is None or handler.trigger is not ProtocolPart.MESSAGE:
        return None
    arriving = context.values.arriving.get(DataChannel(handler.trigger, declaration.handle.value), {})
    struct = _received(context, handler)
    kinds = {".".join(path): leaf.kind for path, leaf in leaves(struct) if isinstance(leaf, Scalar)} if struct else {}
    read = {
        place
        for value in context.typed.values
        if value.place.chart is chart and isinstance(value.value, Expression)
        for node in walk(value.value.tree)
        if (place := place_of(node)) is not None and place.startswith(_DATA)
    }
    kind = kinds.get(field.removeprefix(_DATA))
    constants = {path for path, values in arriving.items() if values.value is not None}
    unread = [
        _DATA + path
        for path, of_path in kinds.items()
        if of_path is kind and path not in constants and _DATA + path not in read
    ]
    return unread[0] if len(unread) == 1 and kind is not None else None


def _is_start(context: MachineContext, chart: Chart, copy: _Copy, meant: str) -> bool:
    """Whether a value is probably where a variable begins, as in an empty range: the variable also gets other values,
    and the variable that seems to be meant has another purpose."""
    assigned = [s for s in chart.statements if isinstance(s, Assign) and isinstance(s.value, Expression)]
    if copy.value.split(".")[0] in _ROOTS or not any(
        s.value is not None and s.value.span == copy.span for s in assigned
    ):
        return False
    others = [s for s in assigned if s.location is not None and s.location.text.strip() == copy.target]
    others = [s for s in others if not any(same.value == copy.value for same in _copies("", s.value))]
    return bool(others) and any(
        meant.split(".", maxsplit=1)[0] in variables_in((value.value.tree,))
        for value in context.typed.values
        if value.place.chart.scope == chart.scope and isinstance(value.value, Expression)
        if value.use is not ValueUse.LOCATION
    )


def _finding(copy: _Copy, other: _Copy, meant: str, written: str, fixed: str) -> Finding:
    message = (
        f"`{copy.target}` gets `{written}`, as `{other.target}` does, although there is `{meant}`; did you mean that?"
    )
    fixes = replacements(copy.span, (fixed,))
    return RULE.at(copy.span, message, *fixes, related=[Related(other.span, "the same value")])


# ------------------------------------------------------------------- machines


def _groups(body: Sequence[Statement]) -> Iterator[list[_Copy]]:
    """The values that are assigned one after the other, and those that one element sends."""
    assigned: list[_Copy] = []
    for statement in body:
        match statement:
            case Assign(location=Expression() as location, value=value) if access_path(location.tree) is not None:
                assigned += _copies(location.text.strip(), value)
            case SetOutput(key=key, value=value) if key is not None:
                assigned += _copies(key.value, value)
            case Send(params=params):
                yield list(_sent(params))
            case RosSend(fields=fields):
                yield list(_sent(fields))
            case If():
                for branch in statement.parts:
                    yield from _groups(branch.body)
    yield assigned


def _sent(params: Sequence[Param]) -> Iterator[_Copy]:
    for param in params:
        if param.name is not None:
            yield from _copies(param.name.value, param.value)


def _copies(target: str, value: Value | None) -> Iterator[_Copy]:
    """The copy of a variable or field that is not in an array."""
    if isinstance(value, Expression) and not value.broken and _is_plain(value.tree):
        yield _Copy(target, ".".join(access_path(value.tree) or ()), value.span)


def _is_plain(tree: Expr) -> bool:
    while isinstance(tree, Member):
        tree = tree.object
    return isinstance(tree, NameExpr)


_ROOTS = {"_msg": 1, "_req": 1, "_res": 1, "_goal": 1, "_feedback": 1, "_wrapped_result": 2, "_event": 2}
"""An event variable -> the number of names before the name of the field."""


def _exists(context: MachineContext, chart: Chart, handler: Handler | None, path: Sequence[str]) -> bool:
    """Whether there is a variable, or a field of the event that a handler receives, with this path."""
    root = path[0]
    if root not in _ROOTS:
        types: Mapping[str, Type] = context.typed.variables.get(chart.scope, {})
        return root in types and _has(types[root], path[1:])
    return handler is not None and _has(_received(context, handler), path[_ROOTS[root] :])


def _received(context: MachineContext, handler: Handler) -> Type | None:
    if handler.trigger is ProtocolPart.EVENT:
        return context.event_data(handler.event.value) if handler.event else None
    declaration = find_handle(context.machine, handler)
    if declaration is None or declaration.type is None or declaration.kind not in INTERFACE_KINDS:
        return None
    interface = context.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)
    part = ProtocolPart.GOAL if handler.trigger is ProtocolPart.THREAD_START else handler.trigger
    if not isinstance(interface, InterfaceType) or part is None:
        return None
    return dict(interface.parts).get(part.value)


def _has(type_: Type | None, path: Sequence[str]) -> bool:
    for name in path:
        type_ = type_.member(name) if isinstance(type_, Struct) else None
    return type_ is not None


# ---------------------------------------------------------------------- trees


def in_tree(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    entries = {entry for _, _, node in forest.all_nodes for entry in _entries(node).values()}
    for _, node in forest.own_nodes:
        bound = _entries(node)
        if len(bound) < 2 or forest.calls_tree(node):
            continue
        spans = {setting.attribute.name: setting.value.span for setting in ports_of(node)}
        group = [_Copy(port, entry, spans[port]) for port, entry in bound.items()]
        for copy, other, meant in _suspicions(group):
            if meant in entries:
                finding = _finding(copy, other, meant, f"{{{copy.value}}}", f"{{{meant}}}")
                words = difference(copy.value, meant)
                if words is not None and words[0].isdigit():  # one of several alike, which may be meant twice
                    finding = replace(finding, severity=Severity.INFORMATION)
                yield finding
        for copy, other in _exchanged(group):
            message = f"the ports `{copy.target}` and `{other.target}` are bound to each other's entries; exchange them"
            edits = (TextEdit(copy.span, f"{{{other.value}}}"), TextEdit(other.span, f"{{{copy.value}}}"))
            related = [Related(other.span, "the other port")]
            yield RULE.at(copy.span, message, Fix("Exchange the entries", edits), related=related)


def _entries(node: TreeNode) -> dict[str, str]:
    """The entries to which the ports of a node are bound."""
    bound = {setting.attribute.name: entry_of(setting) for setting in ports_of(node)}
    return {port: entry for port, entry in bound.items() if entry is not None}


def _exchanged(group: Sequence[_Copy]) -> Iterator[tuple[_Copy, _Copy]]:
    """Two ports for coordinates that get the entries with each other's names. Other names are often exchanged
    intentionally: the way back leads from the goal to the start."""
    for copy in group:
        for other in group:
            words = difference(copy.target, other.target)
            if words is None or copy.value != other.target or other.value != copy.target:
                continue
            if all(len(word) == 1 for word in words) and words[0] < words[1]:
                yield copy, other


# ---------------------------------------------------------------------- names


def _suspicions(group: Sequence[_Copy]) -> Iterator[_Suspicion]:
    """The values that two targets get although the names of the targets differ in a word that is also in the name of
    the value."""
    values = {copy.value for copy in group}
    for number, copy in enumerate(group):
        for other in group:
            words = difference(copy.target, other.target) if copy.value == other.value else None
            meant = None if words is None else with_word(copy.value, words[1], words[0])
            if meant is not None and meant not in values and _is_last(group, number, copy.target):
                yield _Suspicion(copy, other, meant)
                break


def _is_last(group: Sequence[_Copy], number: int, target: str) -> bool:
    """Whether no later value replaces that of a target."""
    return all(later.target != target for later in group[number + 1 :])


RULE = Rule(
    "copied-value",
    Severity.WARNING,
    "Two names get the same value, although there is a value with the name of the second one.",
    machine=check,
    tree=in_tree,
    whole=True,
)
