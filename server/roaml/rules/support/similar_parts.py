# SPDX-License-Identifier: Apache-2.0
"""Parts of a machine with similar names, and the names in them that belong to the other part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import NamedTuple

from roaml.expr.infer import constant
from roaml.expr.operators import COMPARING, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Name, Unary, walk
from roaml.model.machine import Assign, Chart, If, Param, RosSend, Send, SetOutput, Statement, bodies, statements
from roaml.model.syntax import Expression, Value
from roaml.model.values.evaluate import place_of
from roaml.roles import ProtocolPart
from roaml.rules.support.words import holes, with_word
from roaml.text import Span

_INITIATED = (ProtocolPart.MESSAGE, ProtocolPart.REQUEST, ProtocolPart.GOAL)
"""What a machine sends unasked. Answers have the names of what they answer; other rules check these."""

_NEAR = 8
"""The number of similar parts before and after a part with which it is compared. A part is usually copied from one
beside it, and the states of a long machine, such as `step_1` to `step_500`, are all similar."""


class SimilarPart(NamedTuple):
    """A part of a machine that may have similar parts, with the name that distinguishes it.

    `uses` contains the names in it: role, name -> the first place. `kind` is equal for parts that are compared. `forms`
    contains how names are tested and which Booleans are assigned to them.
    """

    kind: str
    name: str
    span: Span
    uses: dict[tuple[str, str], Span]
    forms: Mapping[tuple[str, str], Set[str]] = {}


class CopiedName(NamedTuple):
    """A name that `part` uses as the similar part `other` does, although `meant` has the word of its own name. `places`
    contains its places, each with its role."""

    part: SimilarPart
    other: SimilarPart
    name: str
    meant: str
    places: Sequence[tuple[str, Span]]


def copied_names(chart: Chart, known: Iterable[str]) -> Iterator[CopiedName]:
    """The names in parts that have the word of a similar part, although the name with their own word exists."""
    names = frozenset(known)
    similar: dict[tuple[object, ...], list[tuple[str, SimilarPart]]] = {}
    for part in _parts(chart):
        for hole, word in holes(part.name) if part.uses else ():
            if hole.others:
                similar.setdefault((part.kind, hole), []).append((word, part))
    for group in similar.values():
        for number, (own, part) in enumerate(group):
            for word, other in group[max(0, number - _NEAR) : number + _NEAR + 1]:
                if word != own:
                    yield from _copies(part, other, word, own, names)


def _copies(part: SimilarPart, other: SimilarPart, word: str, own: str, known: frozenset[str]) -> Iterator[CopiedName]:
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
    return (CopiedName(part, other, name, meant, places) for (name, meant), places in wrong.items())


def _parts(chart: Chart) -> Iterator[SimilarPart]:
    for state in chart.states:
        inside: list[Statement] = list(state.entry.statements) if state.entry is not None else []
        for handler in state.handlers:
            own = [statement for target in handler.targets for statement in target.body]
            inside += own
            name = handler.handle or handler.event
            if name is not None and handler.trigger is not None:
                yield SimilarPart(
                    handler.trigger.value, name.value, name.span, _uses(own, handler.cond), _forms(own, handler.cond)
                )
        if state.id is not None:
            yield SimilarPart("state", state.id.value, state.id.span, _uses(inside), _forms(inside))
    beside = _beside(chart)
    for statement in chart.statements:
        match statement:
            case If(branches=branches):
                numbers = _numbers(statement)
                for branch in branches:
                    if branch.cond is not None and not branch.cond.broken:
                        uses = {**_uses(branch.body), **numbers[branch.element.span]}
                        kind = f"if {beside.get(statement.element.span.start, statement.element.span.start)}"
                        yield SimilarPart(kind, branch.cond.text.strip(), branch.cond.span, uses, _forms(branch.body))
            case Send(event=event, params=params) if event is not None:
                yield SimilarPart("send", event.value, event.span, _fields(params))
            case RosSend(handle=handle, fields=fields) if handle is not None:
                yield SimilarPart(statement.element.name, handle.value, handle.span, _fields(fields))


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
    for part in statement.parts:
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
