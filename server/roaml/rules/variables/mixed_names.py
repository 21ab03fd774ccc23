# SPDX-License-Identifier: Apache-2.0
"""The rule `mixed-names`, which mixed_names.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import NamedTuple

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.infer import constant
from roaml.expr.operators import COMPARING, Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Name, Unary, access_path, walk
from roaml.expr.types import Type
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import (
    Assign,
    Chart,
    Handler,
    If,
    Param,
    ReturnStatus,
    RosSend,
    Send,
    SetOutput,
    Statement,
    bodies,
    statements,
)
from roaml.model.message_constants import NumberedConstant, numbered_constants
from roaml.model.syntax import Expression, Value
from roaml.model.syntax import Name as SyntaxName
from roaml.model.values.evaluate import place_of
from roaml.model.waits import fixed_variables
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.words import LIMITS, difference, with_word, words_of
from roaml.scxml.names import STATUSES
from roaml.text import Span, TextEdit

_INITIATED = (ProtocolPart.MESSAGE, ProtocolPart.REQUEST, ProtocolPart.GOAL)
"""What a machine sends unasked. Answers have the names of what they answer; other rules check these."""


class _Part(NamedTuple):
    """A part of a machine that may have similar parts, with the name that distinguishes it.

    `uses` contains the names in it: role, name -> the first place. `kind` is equal for parts that are compared. `forms`
    contains how names are tested and which Booleans are assigned to them.
    """

    kind: str
    name: str
    span: Span
    uses: dict[tuple[str, str], Span]
    forms: Mapping[tuple[str, str], Set[str]] = {}


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        types = context.typed.variables.get(chart.scope, {})
        known = {*types, *context.machine.declarations_by_handle}
        known |= {s.event.value for s in chart.statements if isinstance(s, Send) and s.event is not None}
        reported: set[Span] = set()
        findings = (*_copied(list(_parts(chart)), known), *_steps(chart), *_pairs(context, chart), *_guards(chart))
        findings += (*_bounds(chart, types), *_statuses(chart))
        findings += tuple(_previous(chart, types))
        for finding in findings:
            if finding.span not in reported:
                reported.add(finding.span)
                yield finding
    yield from _numbered(context)


# --------------------------------------------------------- parts with similar names


_NEAR = 8
"""The number of similar parts before and after a part with which it is compared. A part is usually copied from one
beside it, and the states of a long machine, such as `step_1` to `step_500`, are all similar."""


def _copied(parts: Sequence[_Part], known: Iterable[str]) -> Iterator[Finding]:
    """Parts that use a name with the word of a similar part, although the name with their own word exists."""
    names = frozenset(known)
    similar: dict[tuple[object, ...], list[tuple[str, _Part]]] = {}
    for part in parts:
        words = words_of(part.name) if part.uses else []
        for number, word in enumerate(words if len(words) > 1 else ()):
            key = (part.kind, number, *words[:number], *words[number + 1 :])
            similar.setdefault(key, []).append((word, part))
    for group in similar.values():
        for number, (own, part) in enumerate(group):
            for word, other in group[max(0, number - _NEAR) : number + _NEAR + 1]:
                if word != own:
                    yield from _copies(part, other, word, own, names)


def _copies(part: _Part, other: _Part, word: str, own: str, known: frozenset[str]) -> Iterator[Finding]:
    used, others = {name for _, name in part.uses}, {name for _, name in other.uses}
    opposite = {
        name for (role, name), forms in part.forms.items() if forms.isdisjoint(other.forms.get((role, name), forms))
    }
    wrong: dict[tuple[str, str], list[tuple[str, Span]]] = {}
    for (role, name), span in part.uses.items():
        meant = with_word(name, word, own) if (role, name) in other.uses else None
        if name in opposite or meant is None or (role, meant) in part.uses or (role, meant) in other.uses:
            continue
        if role != "location" and (meant in used or meant in others):
            continue
        if name.isdigit() and not any(with_word(renamed, word, own) in used - others for renamed in others):
            continue
        if not name.isdigit() and meant not in known:
            continue
        wrong.setdefault((name, meant), []).append((role, span))
    for (name, meant), places in wrong.items():
        message = (
            f"`{part.name}` uses `{name}`, as `{other.name}` does, although there is `{meant}`; did you mean that?"
        )
        fix = Fix(f"Change to `{meant}`", tuple(TextEdit(span, meant) for _, span in places))
        role, span = places[0]
        related = [Related(other.uses[role, name], f"used for `{other.name}`")]
        yield RULE.at(span, message, fix, related=related)


def _parts(chart: Chart) -> Iterator[_Part]:
    for state in chart.states:
        inside: list[Statement] = list(state.entry.statements) if state.entry is not None else []
        for handler in state.handlers:
            own = [statement for target in handler.targets for statement in target.body]
            inside += own
            name = handler.handle or handler.event
            if name is not None and handler.trigger is not None:
                yield _Part(
                    handler.trigger.value, name.value, name.span, _uses(own, handler.cond), _forms(own, handler.cond)
                )
        if state.id is not None:
            yield _Part("state", state.id.value, state.id.span, _uses(inside), _forms(inside))
    beside = _beside(chart)
    for statement in chart.statements:
        match statement:
            case If(branches=branches):
                numbers = _numbers(statement)
                for branch in branches:
                    if branch.cond is not None and not branch.cond.broken:
                        uses = {**_uses(branch.body), **numbers[branch.element.span]}
                        kind = f"if {beside.get(statement.element.span.start, statement.element.span.start)}"
                        yield _Part(kind, branch.cond.text.strip(), branch.cond.span, uses, _forms(branch.body))
            case Send(event=event, params=params) if event is not None:
                yield _Part("send", event.value, event.span, _fields(params))
            case RosSend(handle=handle, fields=fields) if handle is not None:
                yield _Part(statement.element.name, handle.value, handle.span, _fields(fields))


def _beside(chart: Chart) -> dict[int, int]:
    """The offset of each `<if>` with one branch -> that of the first one in the same content: such elements one after
    the other are compared like the branches of one."""
    first: dict[int, int] = {}
    for _, _, body in bodies(chart):
        alone = [s.element.span.start for s in body if isinstance(s, If) and len(s.branches) == 1 and not s.otherwise]
        first.update(dict.fromkeys(alone, alone[0]) if alone else {})
    return first


def _fields(params: Sequence[Param]) -> dict[tuple[str, str], Span]:
    uses: dict[tuple[str, str], Span] = {}
    for param in params:
        _add(uses, f"field {param.name.value if param.name else ''}", param.value)
    return uses


def _numbers(statement: If) -> dict[Span, dict[tuple[str, str], Span]]:
    """The numbers that each branch assigns to variables to which not all branches assign the same number, as uses."""
    assigned: dict[Span, dict[tuple[str, str], Span]] = {}
    different: dict[str, set[str]] = {}
    for part in (*statement.branches, *((statement.otherwise,) if statement.otherwise else ())):
        uses = assigned.setdefault(part.element.span, {})
        for inner in part.body:
            if isinstance(inner, Assign) and isinstance(inner.value, Expression) and inner.location is not None:
                number, place = constant(inner.value.tree), place_of(inner.location.tree)
                if number is not None and place is not None:
                    uses["number " + place, str(number)] = inner.value.span
                    different.setdefault("number " + place, set()).add(str(number))
    return {
        element: {use: span for use, span in uses.items() if len(different[use[0]]) > 1}
        for element, uses in assigned.items()
    }


def _uses(body: Iterable[Statement], cond: Expression | None = None) -> dict[tuple[str, str], Span]:
    uses: dict[tuple[str, str], Span] = {}
    _add(uses, "cond", cond)
    for statement in statements(tuple(body)):
        match statement:
            case Assign(location=location, value=value):
                _add(uses, "location", location)
                _add(uses, "value", value)
            case SetOutput(value=value):
                _add(uses, "value", value)
            case If(branches=branches):
                for branch in branches:
                    _add(uses, "cond", branch.cond)
            case Send(event=name, params=params):
                if name is not None:
                    uses.setdefault(("sent", name.value), name.span)
                for param in params:
                    _add(uses, "value", param.value)
            case RosSend(handle=name, fields=fields):
                if name is not None and statement.part in _INITIATED:
                    uses.setdefault(("sent", name.value), name.span)
                for param in fields:
                    _add(uses, "value", param.value)
    return uses


def _forms(body: Iterable[Statement], cond: Expression | None = None) -> dict[tuple[str, str], set[str]]:
    """Role, name -> the Booleans that are assigned to it, or how conditions test it. A part that tests or sets the
    opposite of what a similar part does uses the name intentionally."""
    forms: dict[tuple[str, str], set[str]] = {}
    conditions = [cond]
    for statement in statements(tuple(body)):
        match statement:
            case Assign(location=Expression(tree=Name(name=name)), value=Expression(tree=Boolean(value=value))):
                forms.setdefault(("location", name), set()).add(str(value))
            case If(branches=branches):
                conditions += [branch.cond for branch in branches]
    for condition in conditions:
        if condition is not None and not condition.broken:
            inside: dict[int, str] = {}
            for node in walk(condition.tree):
                match node:
                    case Unary(operator=UnaryOperator.NOT, operand=Name() as operand):
                        inside[id(operand)] = "not"
                    case Binary(operator=operator, left=left, right=right) if operator.kind in COMPARING:
                        inside |= dict.fromkeys(map(id, (left, right)), operator.symbol)
                    case Name(name=name):
                        forms.setdefault(("cond", name), set()).add(inside.get(id(node), ""))
    return forms


def _add(uses: dict[tuple[str, str], Span], role: str, value: Value | None) -> None:
    if isinstance(value, Expression) and not value.broken:
        for node in walk(value.tree):
            if isinstance(node, Name):
                uses.setdefault((role, node.name), node.span)


# ------------------------------------------------------------------- steps


class _Step(NamedTuple):
    """An assignment that adds a constant to the value of a place, or subtracts it."""

    place: str
    read: str
    span: Span
    amount: tuple[Operator, float]


def _steps(chart: Chart) -> Iterator[Finding]:
    """Counters that are computed from a similar counter, as in `b_count = a_count + 1`."""
    steps = [step for s in chart.statements if isinstance(s, Assign) and (step := _step(s)) is not None]
    own = {(step.place, step.amount): step for step in steps if step.place == step.read}
    counted = {place for place, _ in own}
    for step in steps:
        other = own.get((step.read, step.amount))
        if step.place in counted or other is None or difference(step.place, step.read) is None:
            continue
        if len(words_of(step.place)) < 2 or any(_RELATIONS & {*words_of(name)} for name in (step.place, step.read)):
            continue
        message = f"`{step.place}` is computed from `{step.read}`, which is counted, too; did you mean `{step.place}`?"
        yield RULE.at(
            step.span, message, *replacements(step.span, (step.place,)), related=[Related(other.span, "counted here")]
        )


_RELATIONS = frozenset(("next", "following", "new", "last", "previous", "prev", "old", "current", "first", "end"))
"""Words that relate a value to another one: the next waypoint is the current one + 1."""


def _step(assign: Assign) -> _Step | None:
    if assign.location is None or not isinstance(assign.value, Expression) or assign.value.broken:
        return None
    tree = assign.value.tree
    if not isinstance(tree, Binary) or tree.operator not in (Operator.ADD, Operator.SUBTRACT):
        return None
    amount = constant(tree.right)
    if amount is None or access_path(assign.location.tree) is None or access_path(tree.left) is None:
        return None
    place, read = format_expr(assign.location.tree), format_expr(tree.left)
    return _Step(place, read, tree.left.span, (tree.operator, float(amount)))


# ------------------------------------------------------------- pairs of names


def _pairs(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Comparisons of names that differ in the last word, such as `goal_y > curr_x`, in machines that compare names with
    the same last word, such as `goal_x < curr_x`."""
    comparisons = [
        (node.left, node.right, node.operator)
        for value in context.typed.values
        if value.place.chart is chart and isinstance(value.value, Expression) and not value.value.broken
        for node in walk(value.value.tree)
        if isinstance(node, Binary) and node.operator.kind in COMPARING
        if isinstance(node.left, Name) and isinstance(node.right, Name)
    ]
    written = {(left.name, right.name, operator) for left, right, operator in comparisons}
    split = [(left, right, op, *_split(left.name), *_split(right.name)) for left, right, op in comparisons]
    matching = {(first, second): (left, right) for left, right, _, first, a, second, b in split if a == b}
    types = context.typed.variables.get(chart.scope, {})
    for left, right, operator, first, last, second, other in split:
        pattern = matching.get((first, second))
        if last == other or pattern is None or not (first or second):
            continue
        meant = with_word(right.name, other, last)
        if meant is None or meant not in types or with_word(left.name, last, other) not in types:
            continue
        if (left.name, meant, operator) in written:  # each with each
            continue
        message = f"`{left.name}` is compared with `{right.name}`, although there is `{meant}`; did you mean that?"
        related = [Related(Span(pattern[0].span.start, pattern[1].span.end), "names that belong together")]
        yield RULE.at(right.span, message, *replacements(right.span, (meant,)), related=related)


def _bounds(chart: Chart, types: Mapping[str, Type]) -> Iterator[Finding]:
    """Comparisons of a variable with a constant, although nothing reads a constant with the name of the variable, such
    as `max_tries` for `tries`."""
    fixed = fixed_variables(chart)
    limits = {name: frozenset(words_of(name)) - LIMITS for name in fixed if not LIMITS.isdisjoint(words_of(name))}
    if not limits:
        return
    expressions = [value for value in _values(chart) if not value.broken]
    read = {node.name for value in expressions for node in walk(value.tree) if isinstance(node, Name)}
    unread = {name: words for name, words in limits.items() if words and name not in read}
    for value in expressions if unread else ():
        for node in walk(value.tree):
            if not isinstance(node, Binary) or node.operator.kind not in COMPARING:
                continue
            for variable, constant_name in ((node.left, node.right), (node.right, node.left)):
                if not isinstance(variable, Name) or not isinstance(constant_name, Name):
                    continue
                own = frozenset(words_of(variable.name))
                if constant_name.name not in fixed or variable.name in fixed or own & {*words_of(constant_name.name)}:
                    continue
                for meant, words in unread.items():
                    if words <= own and types.get(meant) == types.get(constant_name.name):
                        message = (
                            f"`{variable.name}` is compared with `{constant_name.name}`, and nothing reads `{meant}`; "
                            "did you mean that?"
                        )
                        yield RULE.at(constant_name.span, message, *replacements(constant_name.span, (meant,)))


def _values(chart: Chart) -> Iterator[Expression]:
    """The expressions of a chart: conditions, and values that are assigned or sent."""
    values: list[Value | None] = [h.cond for state in chart.states for h in state.handlers]
    for statement in chart.statements:
        match statement:
            case If(branches=branches):
                values += [branch.cond for branch in branches]
            case Assign(value=value) | SetOutput(value=value):
                values.append(value)
            case Send(params=params) | RosSend(fields=params):
                values += [param.value for param in params]
    yield from (value for value in values if isinstance(value, Expression))


def _split(name: str) -> tuple[tuple[str, ...], str]:
    words = words_of(name)
    return tuple(words[:-1]), words[-1] if words else ""


# ------------------------------------------------------------- statuses


def _statuses(chart: Chart) -> Iterator[Finding]:
    """Handlers of one state that return another status than the one after which the constant in their condition is
    named, as in `_res.status == SKILL_RUNNING`, if another handler returns the status with the name of its constant."""
    for state in chart.states:
        named = [
            (status, returned, returned.value == status)
            for handler in state.handlers
            if (status := _named_status(handler)) is not None and (returned := _returned(handler)) is not None
        ]
        right = {status for status, _, is_right in named if is_right}
        for status, returned, is_right in named:
            if not is_right and returned.value in right:
                message = (
                    f"this returns {returned.value} under a condition for {status}, as another handler does; did you "
                    f"mean {status}?"
                )
                yield RULE.at(returned.span, message, *replacements(returned.span, (status,)))


def _named_status(handler: Handler) -> str | None:
    """The status in the name of the constant with which the condition of a handler compares something."""
    tree = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
    if not isinstance(tree, Binary) or tree.operator is not Operator.EQUAL:
        return None
    names = [side.name for side in (tree.left, tree.right) if isinstance(side, Name) and side.name.isupper()]
    statuses = [word.upper() for name in names for word in words_of(name)[-1:] if word.upper() in STATUSES]
    return statuses[0] if len(statuses) == 1 else None


def _returned(handler: Handler) -> SyntaxName | None:
    """The only status that a handler returns."""
    found = [s.status for target in handler.targets for s in statements(target.body) if isinstance(s, ReturnStatus)]
    return found[0] if len(found) == 1 else None


# -------------------------------------------------- machines with numbers

_MIN_NUMBERED = 3
"""How many machines of a system must have names that differ only in a number before their constants are compared with
it."""


def _numbered(context: MachineContext) -> Iterator[Finding]:
    """Constants with another number than the name of the machine, one of several that are copies of each other: the
    text `'door_3'`, or 3 in the field `door`, in the machine `CloseDoor2`. All copies that have the same constant, with
    another number, must have their own one: machines that name their neighbours, or count from 0, are right."""
    if context.system is None or context.machine.name is None:
        return
    name = context.machine.name
    words = words_of(name.value)
    numbers = [place for place, word in enumerate(words) if word.isdigit()]
    if len(numbers) != 1 or numbers[0] == 0:
        return
    (at,) = numbers
    kind, own = words[at - 1], words[at]
    numbered: dict[str, frozenset[NumberedConstant]] = {}
    for _, outline in context.system.nodes:
        other = words_of(outline.name)
        if len(other) != len(words) or other[at] == own or not other[at].isdigit():
            continue
        if [*other[:at], own, *other[at + 1 :]] == words:
            numbered.setdefault(other[at], outline.numbered)
    if len(numbered) < _MIN_NUMBERED - 1:
        return
    for known, tree in numbered_constants(context.machine, context.typed):
        # A number in a field may have another meaning. A text may name a machine that this system does not use.
        if known.number == own or (known.field and known.number not in numbered):
            continue
        if kind not in words_of(known.field or known.text):
            continue
        in_copies = [(n, c.number) for n, constants in numbered.items() for c in constants if _is_copy(c, known)]
        if len(in_copies) < _MIN_NUMBERED - 1 or any(number != of_copy for of_copy, number in in_copies):
            continue
        quote = context.source.text[tree.span.start] if known.text else ""
        meant = f"{quote}{known.text.replace('#', own)}{quote}" if known.text else own
        fix = Fix(f"Change to `{meant}`", (TextEdit(tree.span, meant),))
        message = f"the machine `{name.value}` uses the number of another one here; did you mean `{meant}`?"
        yield RULE.at(tree.span, message, fix, related=[Related(name.span, "the number of this machine")])


def _is_copy(constant_: NumberedConstant, other: NumberedConstant) -> bool:
    return constant_.field == other.field and constant_.text == other.text


# --------------------------------------------------------- previous values

_PREVIOUS = frozenset(("previous", "prev", "old"))
"""The first word of a variable that keeps the last value of another one."""

_CURRENT = frozenset(("current", "curr", "cur", "new", "latest", "actual"))


def _previous(chart: Chart, types: Mapping[str, Type]) -> Iterator[Finding]:
    """Variables that keep the last value of another one, as their names say, and get the value of a third one."""
    varying = {
        statement.location.tree.name
        for statement in chart.statements
        if isinstance(statement, Assign) and statement.location is not None
        if isinstance(statement.location.tree, Name) and not _accumulates(statement, statement.location.tree.name)
    }
    for statement in chart.statements:
        if not isinstance(statement, Assign) or not isinstance(statement.value, Expression) or not statement.location:
            continue
        location, value = statement.location.tree, statement.value.tree
        if not isinstance(location, Name) or not isinstance(value, Name):
            continue
        first, kept = words_of(location.name)[:1], words_of(location.name)[1:]
        if _PREVIOUS.isdisjoint(first) or not kept or set(words_of(value.name)) & set(kept):
            continue
        sources = [
            name
            for name, type_ in types.items()
            if name != location.name and words_of(name)[-len(kept) :] == kept and type_ == types.get(location.name)
            # `max_error` and `sum_error` are no values of which the previous one is kept.
            if name in varying or not _CURRENT.isdisjoint(words_of(name)[:1])
        ]
        if len(sources) == 1:
            message = f"`{location.name}` gets `{value.name}`, although there is `{sources[0]}`; did you mean that?"
            yield RULE.at(value.span, message, *replacements(value.span, sources))


def _accumulates(statement: Assign, name: str) -> bool:
    return isinstance(statement.value, Expression) and name in variables_in((statement.value.tree,))


# ------------------------------------------------------------ guards of steps


class _Guard(NamedTuple):
    """A condition and the variable that is counted under it. `read` contains the variables whose order it tests."""

    counted: Name
    read: Sequence[Name]


def _guards(chart: Chart) -> Iterator[Finding]:
    """Conditions that test another variable than the one that is counted under them, beside several conditions that
    test the variable that is counted."""
    for statement in chart.statements:
        if isinstance(statement, If):
            yield from _mixed([_guard(branch.cond, branch.body) for branch in statement.branches])
    for state in chart.states:
        single = [handler for handler in state.handlers if len(handler.targets) == 1]
        yield from _mixed([_guard(handler.cond, handler.targets[0].body) for handler in single])


def _mixed(guards: Sequence[_Guard | None]) -> Iterator[Finding]:
    known = [guard for guard in guards if guard is not None]
    right = [guard for guard in known if guard.counted.name in {name.name for name in guard.read}]
    counted = {guard.counted.name for guard in known}
    tested = [name.name for guard in known for name in guard.read]
    if len(known) != len(right) + 1 or len(right) < 2:
        return
    wrong = next(guard for guard in known if guard not in right)
    other = next((name for name in wrong.read if difference(name.name, wrong.counted.name) is not None), None)
    if other is None or other.name not in counted:
        return
    # The one that is used too often is the wrong one.
    times = [guard.counted.name for guard in known].count(wrong.counted.name)
    place, meant = (other, wrong.counted) if times <= tested.count(other.name) else (wrong.counted, other)
    message = (
        f"`{wrong.counted.name}` is counted under a condition for `{other.name}`, while the other conditions here test "
        f"the variable that is counted; did you mean `{meant.name}`?"
    )
    related = [Related(meant.span, f"`{meant.name}`")]
    yield RULE.at(place.span, message, *replacements(place.span, (meant.name,)), related=related)


def _guard(cond: Expression | None, body: Sequence[Statement]) -> _Guard | None:
    """The variable that is counted in a body, if there is exactly one, and what its condition compares."""
    counted = [
        statement.location.tree
        for statement in body
        if isinstance(statement, Assign) and statement.location is not None
        if (step := _step(statement)) is not None and step.place == step.read
        if isinstance(statement.location.tree, Name)
    ]
    if cond is None or cond.broken or len(counted) != 1:
        return None
    comparisons = [n for n in walk(cond.tree) if isinstance(n, Binary) and n.operator.kind is OperatorKind.ORDER]
    read = [side for node in comparisons for side in (node.left, node.right) if isinstance(side, Name)]
    return _Guard(counted[0], read) if read else None


RULE = Rule(
    "mixed-names",
    Severity.WARNING,
    "A name belongs to a similar part of the machine.",
    machine=check,
    whole=True,
)
