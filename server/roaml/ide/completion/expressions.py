# SPDX-License-Identifier: Apache-2.0
"""Completion in an expression: names, functions, and after a dot the members of the value before it.

The text before the caret is read as text, not as a tree, because it is usually incomplete.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from roaml.diagnostics import Symbol
from roaml.distributions.laws import LAWS, LawFunction
from roaml.expr.infer import infer
from roaml.expr.operators import FUNCTIONS, Function
from roaml.expr.parse import parse
from roaml.expr.types import (
    BOOL,
    INT,
    UNKNOWN,
    Array,
    Scalar,
    ScalarKind,
    Struct,
    StructKind,
    Type,
    fits,
    member_type,
    unwrap,
    wrap,
)
from roaml.expr.zero import zero_text
from roaml.ide.completion import property_files
from roaml.ide.completion.compared_values import compared_values
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.model_parameters import parameters_in_scope
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.completion.struct_keys import struct_keys
from roaml.ide.names.occurrence import variable
from roaml.model.syntax import PortRead
from roaml.model.value_types import STATUS, bindings, find_handle, interface_part, port_type
from roaml.regex import regex
from roaml.roles import SymbolKind, ValuePart
from roaml.scxml.names import STATUSES
from roaml.text import Decoded, Span
from roaml.xml_syntax import Element

_NAME = regex(r"[A-Za-z_$][\w$]*\Z|\Z", re.ASCII)
_NAME_AFTER = regex(r"[\w$]*", re.ASCII)
_CLOSERS = {"]": "[", ")": "("}


class Beginning(NamedTuple):
    """The part of a name that has been typed. `object` is the text before the dot that precedes the name; `None` if
    there is no dot."""

    span: Span
    object: str | None


def beginning(text: str, start: int, offset: int) -> Beginning | None:
    """The beginning of the name at the caret `offset`.

    Args:
        text: the text of the file.
        start: the offset at which the expression begins.

    Returns:
        The beginning, or `None` where no name is possible: in a string or a number, or after the `&` of an entity.
    """
    before = text[start:offset]
    if _in_string(before):
        return None
    last_name = _NAME.search(before)
    behind = _NAME_AFTER.match(text, offset)
    assert behind is not None
    if (
        last_name is None
        or before[: last_name.start()].endswith("&")
        or before[last_name.start() - 1 : last_name.start()].isdigit()
    ):
        return None
    span = Span(start + last_name.start(), behind.end())
    lead = before[: last_name.start()].rstrip()
    if not lead.endswith("."):
        return Beginning(span, None)
    object_ = _object(lead[:-1].rstrip())
    return None if not object_ or object_[0].isdigit() else Beginning(span, object_)


def _in_string(text: str) -> bool:
    quote = ""
    for character in text:
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
    return bool(quote)


def _object(text: str) -> str:
    """The chain of names, indices and calls at the end of a text."""
    at, open_ = len(text), []
    while at > 0:
        character = text[at - 1]
        if character in _CLOSERS:
            open_.append(_CLOSERS[character])
        elif open_ and character == open_[-1]:
            open_.pop()
        elif not open_ and not (character.isalnum() or character in "_$."):
            break
        at -= 1
    return "" if open_ else text[at:]


def in_expression(
    request: Request, subject: CompletionSubject, part: str, start: int
) -> tuple[Span, list[CompletionItem]] | None:
    """The completions at the caret in an expression that begins at `start`.

    Args:
        part: the name of the attribute or element that contains the expression.

    Returns:
        The span that the items replace, and the items; `None` if there are none.
    """
    text = request.file.document.text
    if "{" in text[start : request.offset]:
        keys = struct_keys(text, start, request.offset, _required_type(request, subject, part))
        if keys is not None:
            return keys
    begun = beginning(text, start, request.offset)
    if begun is None:
        return None
    events = _event_variables(request, part)
    variables = _variables(request)
    scope = {**variables, **events}
    if begun.object is not None:
        return begun.span, list(_members(request, begun.object, scope))
    if part == "location":
        return begun.span, [_variable(request, name, type_, None) for name, type_ in variables.items()]
    required_type = _required_type(request, subject, part)
    items = [_variable(request, name, type_, required_type) for name, type_ in variables.items()]
    if property_files.is_property_file(request):
        items += property_files.compared_values(request, start)
    elif request.machine is not None:
        items += compared_values(request, start, scope)
    items += parameters_in_scope(request, variables)
    items += [
        CompletionItem(
            name,
            ItemKind.VARIABLE,
            detail=str(type_),
            about=Symbol("", SymbolKind.EVENT_VARIABLE, name),
            rank=Rank.LIKELY,
        )
        for name, type_ in events.items()
        if name not in STATUSES
    ]
    items += [
        CompletionItem(name, ItemKind.VALUE, detail="status of the child", rank=Rank.LIKELY)
        for name in events
        if name in STATUSES
    ]
    items += [
        CompletionItem(word, ItemKind.VALUE, detail="bool", rank=_fitting(BOOL, required_type))
        for word in ("true", "false")
    ]
    items.append(CompletionItem("Math", ItemKind.FUNCTION, detail="functions", rank=Rank.LATE))
    items += [_function(function, "Math.", Rank.LATE) for function in FUNCTIONS.values()]
    if request.machine is not None and part == "expr":
        items += [_law(law) for law in LAWS.values()]
    return begun.span, items


def initial_values(type_: Type) -> Iterator[CompletionItem]:
    """Items for typical initial values of a type."""
    if type_ == UNKNOWN:
        return
    if type_ == BOOL:
        yield CompletionItem("false", ItemKind.VALUE, rank=Rank.BEST)
        yield CompletionItem("true", ItemKind.VALUE, rank=Rank.BEST)
        return
    snippet = Snippet()
    _literal(type_, snippet)
    yield CompletionItem(zero_text(type_), ItemKind.VALUE, str(snippet), detail=str(type_), rank=Rank.BEST)


def _literal(type_: Type, snippet: Snippet) -> None:
    if isinstance(type_, Struct):
        for number, (name, member) in enumerate(type_.members):
            snippet.text(f"{', ' if number else '{'}'{name}': ")
            _literal(member, snippet)
        snippet.text("}")
    elif isinstance(type_, Array):
        snippet.text("[").stop().text("]")
    else:
        snippet.stop([zero_text(type_)])


# ------------------------------------------------------------------------ names


def _variables(request: Request) -> Mapping[str, Type]:
    if property_files.is_property_file(request):
        return property_files.variables(request)
    if request.machine is None or request.chart is None:
        return {}
    typed = request.analysis.typed_in(request.path, request.system_path)
    return typed.variables.get(request.chart.scope, {})


def _event_variables(request: Request, attribute: str) -> Mapping[str, Type]:
    if request.machine is None or request.handler is None:
        return {}
    is_condition = attribute == "cond" and request.handler.element.open_span.contains(request.offset)
    part = ValuePart.COND if is_condition else ValuePart.BODY
    known = bindings(request.handler, part, request.machine, request.environment)
    if part is ValuePart.COND and "_bt" in known:
        known |= dict.fromkeys(STATUSES, STATUS)
    return known


def _variable(request: Request, name: str, type_: Type, required_type: Type | None) -> CompletionItem:
    scope = request.chart.scope if request.chart else ""
    about = variable(request.path, name, scope)
    if property_files.is_property_file(request):
        about = Symbol(request.path, SymbolKind.PORT_VARIABLE, name)
    return CompletionItem(name, ItemKind.VARIABLE, detail=str(type_), about=about, rank=_fitting(type_, required_type))


def _fitting(type_: Type, required_type: Type | None) -> Rank:
    """The rank of a value of type `type_`: the best one if it has the required type."""
    if required_type is None or UNKNOWN in (required_type, type_):
        return Rank.USUAL
    return Rank.BEST if fits(type_, required_type) else Rank.USUAL


def _members(request: Request, object_: str, scope: Mapping[str, Type]) -> Iterator[CompletionItem]:
    if object_ == "Math":
        yield from (_function(function, "", Rank.USUAL) for function in FUNCTIONS.values())
        return
    tree, findings = parse(Decoded(object_, 0))
    type_ = UNKNOWN if findings else infer(tree, scope.get)[0]
    if isinstance(type_, Array) or (isinstance(type_, Scalar) and type_.kind is ScalarKind.STRING):
        yield CompletionItem("length", ItemKind.MEMBER, detail=str(INT))
    # The member of an array of structs is the array of the members (docs/spec/types.md#leaves).
    inner, bounds = unwrap(type_)
    if not isinstance(inner, Struct):
        return
    for name, member in inner.members:
        about = Symbol("", SymbolKind.FIELD, name, inner.name)
        if inner.kind is StructKind.DECLARED:
            about = Symbol(request.system_path or request.path, SymbolKind.MEMBER, name, inner.name)
        yield CompletionItem(name, ItemKind.MEMBER, detail=str(wrap(member, bounds)), about=about)


def _function(function: Function, prefix: str, rank: Rank) -> CompletionItem:
    snippet = Snippet().text(f"{prefix}{function.name}(")
    needed = function.parameters[: len(function.parameters) - function.optional]
    for number, parameter in enumerate(needed):
        snippet.text(", " if number else "").stop([parameter])
    snippet.text(")")
    detail = f"{function.signature.removeprefix(f'Math.{function.name}')} → {function.result}"
    label = f"{prefix}{function.name}"
    return CompletionItem(
        label, ItemKind.FUNCTION, str(snippet), detail, Symbol("", SymbolKind.FUNCTION, function.name), rank
    )


def _law(law: LawFunction) -> CompletionItem:
    """An item for a distribution of values."""
    snippet = Snippet().text(f"{law.name}(")
    for number, parameter in enumerate(law.value_parameters):
        snippet.text(", " if number else "").stop([parameter])
    snippet.text(")")
    about = Symbol("", SymbolKind.FUNCTION, law.name)
    return CompletionItem(law.name, ItemKind.FUNCTION, str(snippet), "a random number", about, Rank.LATE)


# ----------------------------------------------------------------- required types


def _required_type(request: Request, subject: CompletionSubject, part: str) -> Type | None:
    """The required type of the expression; `None` if it is not known."""
    known = subject.type.attributes.get(part)
    if known is not None and known.value_type in ("bool", "int"):
        return BOOL if known.value_type == "bool" else INT
    around = [typed.element for typed in subject.parents]
    if known is not None and subject.element is not None:
        # If the expression is the text of `<expr>`, the last parent is its element.
        around.append(subject.element)
    if not around:
        return None
    element = around[-1]
    match element.name:
        case "field" if len(around) > 1:
            return _required_field_type(request, element, around[-2])
        case "assign":
            location = element.get("location")
            return infer(parse(Decoded(location.value, 0))[0], _variables(request).get)[0] if location else None
        case "bt_set_output":
            return _required_output_type(request, element)
    return None


def _required_field_type(request: Request, element: Element, holder: Element) -> Type | None:
    name, statement = element.get("name"), request.ros_send_of(holder)
    if statement is None or name is None or request.machine is None:
        return None
    declaration = find_handle(request.machine, statement)
    return _at(interface_part(statement.part, declaration, request.environment), name.value)


def _required_output_type(request: Request, element: Element) -> Type | None:
    key = element.get("key")
    for port in request.machine.ports if request.machine else ():
        if key is not None and port.key is not None and port.key.value == key.value and request.machine:
            return port_type(request.machine, PortRead(port.key, element.span))
    return None


def _at(type_: Type, path: str) -> Type:
    for name in path.split("."):
        type_ = member_type(type_, name) or UNKNOWN
    return type_
