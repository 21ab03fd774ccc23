# SPDX-License-Identifier: Apache-2.0
"""Semantic tokens for coloring: tags by their role, attribute names, names in values, and expressions.

- Tokens do not overlap, and none extends over the end of a line.
- Only the syntax and the grammar determine the tokens: names in expressions are not resolved.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Iterator
from functools import cache, lru_cache
from operator import attrgetter
from typing import NamedTuple

from roaml.expr import parse as expr
from roaml.expr.parse import ExpressionTokenKind
from roaml.ide.json_tree import values
from roaml.ide.syntax import Typed, XmlFile, expression_sources, walk, xml_file
from roaml.json_syntax import JsonBool, JsonNumber, JsonObject, JsonString, Member
from roaml.language import BEHAVIOR_TREE, HL_SCXML, AttributeType
from roaml.model.kinds import FileKind
from roaml.model.syntax import name_of
from roaml.model.tree import blackboard_variable
from roaml.project.analysis import Analysis
from roaml.regex import regex
from roaml.roles import NodeKind, SymbolKind, ValueRole
from roaml.text import Decoded, Span
from roaml.xml_syntax import Attribute


class TokenKind(enum.Enum):
    STRUCTURE_TAG = "tag of a part"
    STATE_TAG = "tag of a state"
    TRANSITION_TAG = "tag of a transition"
    ROS_TAG = "tag of a ROS element"
    BT_TAG = "tag of the tree protocol"
    CONTROL_TAG = "tag of a control node"
    DECORATOR_TAG = "tag of a decorator"
    LEAF_TAG = "tag of an action, condition or plugin"
    SUBTREE_TAG = "tag of a subtree"
    ATTRIBUTE = "attribute or key"
    STATE = "state"
    EVENT = "event"
    HANDLE = "ROS interface or timer"
    PORT = "port"
    MEMBER = "field, struct member or parameter"
    PLUGIN = "plugin"
    TREE = "tree, machine"
    TYPE = "type"
    VARIABLE = "variable"
    EVENT_VARIABLE = "event variable"
    CONSTANT = "name of a constant value"
    LIBRARY = "library of functions"
    FUNCTION = "function"
    NUMBER = "number"
    STRING = "string"
    LITERAL = "literal word"
    OPERATOR = "operator"


class Modifier(enum.Enum):
    DECLARATION = "names something new"
    DEPRECATED = "an older spelling"


class SemanticToken(NamedTuple):
    span: Span
    kind: TokenKind
    modifiers: frozenset[Modifier] = frozenset()


def semantic_tokens(analysis: Analysis, path: str, within: Span | None = None) -> tuple[SemanticToken, ...]:
    """The tokens of a file, or those that touch a part of it, in the order of the text."""
    source = analysis.source(path)
    if source is None:
        return ()
    if (file := xml_file(analysis, path)) is not None:
        tokens = _xml(file)
    elif analysis.kind(path) is FileKind.PROPERTIES and (json := analysis.json(path)) is not None:
        tokens = (token for value in values(json[0]) for token in _json(value))
    else:
        return ()
    if within is not None:
        tokens = (token for token in tokens if token.span.start <= within.end and within.start <= token.span.end)
    return tuple(_on_lines(source.text, sorted(tokens, key=attrgetter("span"))))


_LINE = regex(r"[^\r\n]+")


def _on_lines(text: str, tokens: Iterable[SemanticToken]) -> Iterator[SemanticToken]:
    """The tokens split at line ends, without tokens that begin inside other tokens."""
    done = 0
    for token in tokens:
        start, end = token.span
        if start >= done:
            if (line := _LINE.match(text, start, end)) and line.end() == end:
                yield token  # the common case
            else:
                for part in _LINE.finditer(text, start, end):
                    yield token._replace(span=Span(*part.span()))
            done = end


# ------------------------------------------------------------------------- XML


def _xml(file: XmlFile) -> Iterator[SemanticToken]:
    for typed in walk(file):
        kind = _tag_kind(file, typed)
        element, type_ = typed
        if kind is not None:
            modifiers = _modifiers(deprecated=bool(type_ and type_.use))
            yield SemanticToken(element.name_span, kind, modifiers)
            if element.close_name_span is not None:
                yield SemanticToken(element.close_name_span, kind, modifiers)
        for attribute in element.attributes:
            known = type_.attributes.get(attribute.name) if type_ else None
            yield SemanticToken(
                attribute.name_span, TokenKind.ATTRIBUTE, _modifiers(deprecated=bool(known and known.use))
            )
            yield from _value(file, attribute, known)
        for source in expression_sources(file.document, typed):
            yield from expression_tokens(source)


def _tag_kind(file: XmlFile, typed: Typed) -> TokenKind | None:
    """The kind of a tag; `None` for unknown tags. In a tree, an unknown tag is the name of a plugin."""
    element, type_ = typed
    if file.grammar is BEHAVIOR_TREE:
        if type_ is None:
            return TokenKind.LEAF_TAG
        return _NODES[type_.node] if type_.node else TokenKind.STRUCTURE_TAG
    if type_ is None:
        return None
    if any(attribute.defines is SymbolKind.STATE for attribute in type_.attributes.values()):
        return TokenKind.STATE_TAG
    if element.name.startswith("ros_"):
        return TokenKind.ROS_TAG
    if element.name.startswith("bt_") and file.grammar is HL_SCXML:
        return TokenKind.BT_TAG
    return TokenKind.TRANSITION_TAG if type_.receives else TokenKind.STRUCTURE_TAG


_NODES = {
    NodeKind.CONTROL: TokenKind.CONTROL_TAG,
    NodeKind.DECORATOR: TokenKind.DECORATOR_TAG,
    NodeKind.ACTION: TokenKind.LEAF_TAG,
    NodeKind.CONDITION: TokenKind.LEAF_TAG,
    NodeKind.SUBTREE: TokenKind.SUBTREE_TAG,
}

_SYMBOLS = {
    SymbolKind.STATE: TokenKind.STATE,
    SymbolKind.EVENT: TokenKind.EVENT,
    SymbolKind.PORT: TokenKind.PORT,
    SymbolKind.VARIABLE: TokenKind.VARIABLE,
    SymbolKind.MODEL_PARAMETER: TokenKind.CONSTANT,
    SymbolKind.PLUGIN: TokenKind.PLUGIN,
    SymbolKind.TREE: TokenKind.TREE,
    SymbolKind.MACHINE: TokenKind.TREE,
    SymbolKind.PROPERTY: TokenKind.TREE,
    SymbolKind.PORT_VARIABLE: TokenKind.VARIABLE,
    SymbolKind.TREE_NODE: TokenKind.TREE,
    SymbolKind.STRUCT: TokenKind.TYPE,
    **dict.fromkeys((SymbolKind.FIELD, SymbolKind.MEMBER, SymbolKind.PARAMETER), TokenKind.MEMBER),
    **dict.fromkeys((SymbolKind.PUBLISHER, SymbolKind.SUBSCRIBER, SymbolKind.TIMER), TokenKind.HANDLE),
    **dict.fromkeys(
        (SymbolKind.SERVICE_CLIENT, SymbolKind.SERVICE_SERVER, SymbolKind.ACTION_CLIENT, SymbolKind.ACTION_SERVER),
        TokenKind.HANDLE,
    ),
}
_VALUES = {
    ValueRole.TYPE: TokenKind.TYPE,
    ValueRole.ROS_TYPE: TokenKind.TYPE,
    ValueRole.NUMBER: TokenKind.NUMBER,
    ValueRole.CHILD_INDEX: TokenKind.NUMBER,
    ValueRole.STATUS: TokenKind.CONSTANT,
}


def _value(file: XmlFile, attribute: Attribute, known: AttributeType | None) -> Iterator[SemanticToken]:
    """The token for the value of an attribute; none if the value is an expression."""
    name = name_of(attribute)
    if name is None:
        return
    if file.grammar is BEHAVIOR_TREE and blackboard_variable(name.value) is not None:
        yield SemanticToken(name.span, TokenKind.VARIABLE)
    elif known is not None:
        symbol = known.defines or next(iter(known.refers), None)
        kind = (_SYMBOLS.get(symbol) if symbol else None) or (_VALUES.get(known.value) if known.value else None)
        if kind is not None:
            yield SemanticToken(name.span, kind, _modifiers(declaration=bool(known.defines)))


@cache
def _modifiers(*, declaration: bool = False, deprecated: bool = False) -> frozenset[Modifier]:
    modifiers = ((Modifier.DECLARATION, declaration), (Modifier.DEPRECATED, deprecated))
    return frozenset(modifier for modifier, holds in modifiers if holds)


# ----------------------------------------------------------------- expressions


def expression_tokens(source: Decoded) -> Iterator[SemanticToken]:
    """The tokens of an expression, without brackets, dots and commas."""
    for start, end, kind in _words(source.text):
        yield SemanticToken(source.span(start, end), kind)


@lru_cache(maxsize=5000)  # files repeat the same expressions, and most are unchanged after the next keystroke
def _words(text: str) -> tuple[tuple[int, int, TokenKind], ...]:
    """The tokens of an expression: the offsets in its text at which each begins and ends, and its kind."""
    words: list[tuple[int, int, TokenKind]] = []
    tokens = expr.tokens(text)
    for i, token in enumerate(tokens):
        before = tokens[i - 1].text if i else ""
        after = tokens[i + 1].text if i + 1 < len(tokens) else ""
        kind = _word(token.text, before, after) if token.kind is ExpressionTokenKind.NAME else _OTHERS.get(token.kind)
        if kind is not None and not (kind is TokenKind.OPERATOR and token.text in _PUNCTUATION):
            words.append((token.start, token.end, kind))
    return tuple(words)


_OTHERS = {
    ExpressionTokenKind.NUMBER: TokenKind.NUMBER,
    ExpressionTokenKind.STRING: TokenKind.STRING,
    ExpressionTokenKind.TEMPLATE: TokenKind.STRING,
    ExpressionTokenKind.PUNCTUATOR: TokenKind.OPERATOR,
}
_PUNCTUATION = frozenset("()[]{},.;")
_LITERALS = frozenset(("true", "false", "null", "undefined"))


def _word(word: str, before: str, after: str) -> TokenKind:
    if after == "(":
        return TokenKind.FUNCTION
    if before == ".":
        return TokenKind.MEMBER
    if word == "Math":
        return TokenKind.LIBRARY
    if word in _LITERALS:
        return TokenKind.LITERAL
    return TokenKind.EVENT_VARIABLE if word in _event_variables() else TokenKind.VARIABLE


@cache
def _event_variables() -> frozenset[str]:
    return frozenset(binding.name for element in HL_SCXML.elements.values() for binding in element.binds)


# ------------------------------------------------------------------------ JSON


_OPERATOR_KEYS = ("op", "fun")
_PLAIN_KEYS = ("name", "comment")


def _json(value: object) -> Iterator[SemanticToken]:
    """The tokens of one value and of the keys and strings directly inside it. The key determines the kind of a
    string."""
    if isinstance(value, JsonObject):
        for member in value.members:
            yield SemanticToken(member.key_span, TokenKind.ATTRIBUTE)
            if isinstance(member.value, JsonString):
                yield _string(member, member.value)
    elif isinstance(value, JsonNumber):
        yield SemanticToken(value.span, TokenKind.NUMBER)
    elif isinstance(value, JsonBool):
        yield SemanticToken(value.span, TokenKind.LITERAL)


def _string(member: Member, value: JsonString) -> SemanticToken:
    """The token of a string in a property: a variable, except for operators and comments."""
    if member.key in _OPERATOR_KEYS:
        return SemanticToken(value.span, TokenKind.OPERATOR)
    return SemanticToken(value.span, TokenKind.STRING if member.key in _PLAIN_KEYS else TokenKind.VARIABLE)
