# SPDX-License-Identifier: Apache-2.0
"""Completion in property files and in struct declarations in JSON: keys, operators, names and complete formulas."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.diagnostics import Symbol
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet, escaped
from roaml.ide.describe.system import node_of
from roaml.ide.json_tree import members
from roaml.ide.property_values import compared_global, names_of_global
from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue, Member
from roaml.language.json_schema import JSON_STRUCTS, PROPERTIES, JsonGrammar, Schema
from roaml.model.kinds import FileKind
from roaml.model.tree_paths import label_of
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.scxml.names import flagged_by
from roaml.text import Span

_GRAMMARS = {FileKind.PROPERTIES: PROPERTIES, FileKind.JSON_STRUCTS: JSON_STRUCTS}


def in_json(analysis: Analysis, path: str, offset: int) -> tuple[Span, list[CompletionItem]] | None:
    """The span that the completions at a caret replace, and the completions. `None` if no completion is possible, or if
    the file is neither a property file in JANI nor contains struct declarations in JSON."""
    kind = next(analysis.kind_in(path, system) for system in analysis.systems_of(path))
    grammar = _GRAMMARS.get(kind)
    read = analysis.json(path) if grammar else None
    source = analysis.source(path)
    if grammar is None or read is None or source is None:
        return None
    place = _place(grammar, read[0], source.text, offset)
    if place is None:
        return None
    return place.span, list(_keys(place) if place.is_key else _values(analysis, path, place))


class _Place(Record, frozen=True, eq=False):
    """The place of a caret in a JSON document.

    Attributes:
        schema: the schema of the object whose key is being written, or of the value that is being written.
        inside: the enclosing object or list.
        span: the part of the key or value that has been written, including quotes.
        is_key: whether a key is being written, not a value.
        bare: whether there is no value after the key.
    """

    grammar: JsonGrammar
    schema: Schema
    inside: JsonValue | None
    span: Span
    is_key: bool
    bare: bool = True


def _place(grammar: JsonGrammar, value: JsonValue, text: str, offset: int) -> _Place | None:
    schema: Schema = grammar.root
    inside: JsonValue | None = None
    while True:
        match value:
            case JsonObject() if value.span.start < offset:
                member = next((m for m in value.members if m.span.start <= offset <= _end(m, text)), None)
                if member is None:
                    return _gap(grammar, schema, value, text, offset)
                if offset <= member.key_span.end:
                    return _Place(grammar, schema, value, member.key_span, True, member.value is None)
                schema, inside = grammar.member(schema, value, member.key), value
                if member.value is None or not member.value.span.contains(offset):
                    if text[member.key_span.end : offset].lstrip().startswith(":"):
                        return _Place(grammar, schema, inside, Span(offset, offset), False)
                    return None
                value = member.value
            case JsonArray() if value.span.start < offset:
                inner = next((item for item in value.items if item.span.contains(offset)), None)
                inside, schema = value, grammar.item(schema, value)
                if inner is None:
                    return _Place(grammar, schema, inside, _word(text, offset), False)
                value = inner
            case JsonString():
                return _Place(grammar, schema, inside, value.span, False)
            case _:
                return _Place(grammar, schema, inside, _word(text, offset), False)


def _end(member: Member, text: str) -> int:
    """The end of a member. A member without a value extends to the next comma, closing bracket or end of line."""
    if member.value is not None and member.value.end > member.key_end:
        return member.value.end
    end = member.key_end
    while end < len(text) and text[end] not in ",}]\n":
        end += 1
    return end


def _gap(grammar: JsonGrammar, schema: Schema, value: JsonObject, text: str, offset: int) -> _Place | None:
    before = text[:offset].rstrip()
    if offset > value.end - 1 and text[value.end - 1 : value.end] == "}":
        return None
    if before.endswith(("{", ",", '"')):
        return _Place(grammar, schema, value, Span(offset, offset), True)
    return None


def _word(text: str, offset: int) -> Span:
    start = offset
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] in "_."):
        start -= 1
    return Span(start, offset)


# ------------------------------------------------------------------------- keys


def _keys(place: _Place) -> Iterator[CompletionItem]:
    if not isinstance(place.inside, JsonObject):
        return
    keys = place.grammar.keys(place.schema, place.inside)
    given = {member.key for member in place.inside.members if member.key_span != place.span}
    for key in keys.values():
        if key.name not in given:
            insert = escaped(f'"{key.name}"') if not place.bare else _with_value(place.grammar, key.name, key.schema)
            rank = Rank.LIKELY if key.required else Rank.LATE if key.name == "comment" else Rank.USUAL
            about = Symbol(place.grammar.name, SymbolKind.JSON, key.name, place.grammar.text(key.schema))
            detail = "required" if key.required else ""
            yield CompletionItem(key.name, ItemKind.ATTRIBUTE, insert, detail, about, rank, f'"{key.name}"')


def _with_value(grammar: JsonGrammar, name: str, schema: Schema) -> str:
    made = Snippet().text(f'"{name}": ')
    choices = grammar.choices(schema)
    types = {applying["type"] for applying in grammar.applying(schema, None) if isinstance(applying.get("type"), str)}
    if len(choices) == 1:
        return str(made.text(f'"{choices[0]}"'))
    if choices or "string" in types:
        return str(made.text('"').stop().text('"'))
    if "array" in types:
        return str(made.text("[").stop().text("]"))
    if "object" in types:
        return str(made.text("{").stop().text("}"))
    return str(made.stop())


# ----------------------------------------------------------------------- values


def _values(analysis: Analysis, path: str, place: _Place) -> Iterator[CompletionItem]:
    grammar, schema = place.grammar, place.schema
    for choice in grammar.choices(schema):
        rank = Rank.LATE if choice in _ALIASES else Rank.USUAL
        detail = _ALIASES.get(choice, "")
        yield CompletionItem(choice, ItemKind.OPERATOR, _quoted(choice), detail, None, rank, f'"{choice}"')
    if grammar is JSON_STRUCTS:
        yield from _references(analysis, path, place)
        return
    is_formula = grammar.is_a(schema, "formula")
    if is_formula or grammar.is_a(schema, "expression"):
        yield from _compared_values(place)
        yield from _names(analysis, path)
        yield from _operators(grammar, "formula" if is_formula else "expression")
        for word in ("true", "false"):
            yield CompletionItem(word, ItemKind.VALUE, rank=Rank.LATE)
    elif grammar.is_a(schema, "property"):
        yield from _SKELETONS


def _quoted(text: str) -> str:
    return escaped(f'"{text}"')


def _names(analysis: Analysis, path: str) -> Iterator[CompletionItem]:
    """The global variables of the translated systems of the file."""
    for path_of_system in analysis.systems_of(path):
        system = analysis.system(path_of_system) if path_of_system else None
        for name, variable in analysis.globals(system.path).items() if system else ():
            about = Symbol(system.path if system else "", SymbolKind.GLOBAL, name)
            rank = Rank.LIKELY if flagged_by(name) else Rank.USUAL
            node = node_of(system, name) if system else None
            label = label_of(system, node.instance) if system and node and node.instance else ""
            detail = " · ".join(filter(None, (str(variable.type), label)))
            filter_ = f'"{name} {label}"' if label else f'"{name}"'
            yield CompletionItem(name, ItemKind.VARIABLE, _quoted(name), detail, about, rank, filter_)


def _compared_values(place: _Place) -> Iterator[CompletionItem]:
    """The named values of the variable on the other side of a comparison."""
    around = members(place.inside) if place.inside is not None else {}
    variable = compared_global(around)
    for number, name in names_of_global(variable).items():
        yield CompletionItem(str(number), ItemKind.VALUE, detail=name, rank=Rank.BEST, filter=f"{number} {name}")


def _operators(grammar: JsonGrammar, kind: str) -> Iterator[CompletionItem]:
    """Items that insert an object for each operator, in the spelling of JANI, with all required members."""
    for operator, described in grammar.operators(kind):
        if operator in _ALIASES:
            continue
        made = Snippet().text("{" + f'"op": "{operator}"')
        for key in described["required"]:
            if key != "op":
                choices = grammar.choices(described["properties"][key])
                made.text(f', "{key}": ')
                made = made.text('"').stop(choices).text('"') if choices else made.stop()
        made.text("}")
        about = Symbol(grammar.name, SymbolKind.JSON, operator, grammar.text(described))
        rank = Rank.LATE if operator in _SELDOM else Rank.USUAL
        detail = grammar.title(described)
        yield CompletionItem(f"{{{operator}}}", ItemKind.SKELETON, str(made), detail, about, rank, f"{{{operator}")


def _references(analysis: Analysis, path: str, place: _Place) -> Iterator[CompletionItem]:
    """The definitions of a file of struct declarations."""
    if place.grammar.text(place.schema) != place.grammar.text(JSON_STRUCTS.definition("member")["properties"]["$ref"]):
        return
    read = analysis.json(path)
    root = read[0] if read else None
    for section in ("$defs", "definitions"):
        definitions = root.get(section) if isinstance(root, JsonObject) else None
        for member in definitions.members if isinstance(definitions, JsonObject) else ():
            label = f"#/{section}/{member.key}"
            yield CompletionItem(label, ItemKind.TYPE, _quoted(label), rank=Rank.BEST, filter=f'"{label}"')


_ALIASES = {
    "!": "¬",
    "||": "∨",
    "or": "∨",
    "&&": "∧",
    "and": "∧",
    "=>": "⇒",
    "==": "=",
    "!=": "≠",
    "<=": "≤",
    ">=": "≥",
}
"""Alternative spelling of an operator -> its spelling in JANI."""

_SELDOM = frozenset(
    (
        *("sin", "cos", "tan", "cot", "sec", "csc", "asin", "acos", "atan", "acot", "asec", "acsc"),
        *("sinh", "cosh", "tanh", "coth", "sech", "csch", "asinh", "acosh", "atanh", "acoth", "asech", "acsch"),
        *("sgn", "trc", "log", "Smin", "Smax", "timelock", "av", "ac", "da", "dv", "oa", "ov", "empty"),
        *("call", "nondet", "der"),
    )
)
"""Operators that are rarely used in properties."""


def _property(label: str, detail: str, path: Callable[[Snippet], Snippet]) -> CompletionItem:
    made = (
        Snippet().text('{\n\t"name": "').stop().text('",\n\t"expression": {\n\t\t"op": "filter",\n\t\t"fun": "values"')
    )
    made.text(',\n\t\t"values": {\n\t\t\t"op": "').stop(("Pmin", "Pmax")).text('",\n\t\t\t"exp": ')
    path(made).text('\n\t\t},\n\t\t"states": {"op": "initial"}\n\t}\n}')
    return CompletionItem(label, ItemKind.SKELETON, str(made), detail, rank=Rank.BEST, filter=f"{{{label}")


_SKELETONS = (
    _property(
        "property: eventually",
        "the probability that a condition becomes true",
        lambda made: made.text('{"op": "F", "exp": ').stop().text("}"),
    ),
    _property(
        "property: always",
        "the probability that a condition always holds",
        lambda made: made.text('{"op": "G", "exp": ').stop().text("}"),
    ),
    _property(
        "property: until",
        "the probability that one condition holds until another one holds",
        lambda made: made.text('{"op": "U", "left": ').stop().text(', "right": ').stop().text("}"),
    ),
    _property(
        "property: never before",
        "the probability that one condition does not hold before another one holds",
        lambda made: made.text('{"op": "W", "left": {"op": "¬", "exp": ').stop().text('}, "right": ').stop().text("}"),
    ),
)
