# SPDX-License-Identifier: Apache-2.0
"""The smallest parts of every model: names, expressions and port reads, each with its position."""

from __future__ import annotations

from typing import TypeAlias

from roaml.diagnostics import Finding
from roaml.expr.parse import parse
from roaml.expr.tree import Expr
from roaml.expr.types import TypeName, parse_type
from roaml.record import Record
from roaml.text import Decoded, Span
from roaml.xml_syntax import Attribute, Document, Element
from roaml.xml_syntax.names import SPACE


class Name(Record, frozen=True):
    """A name in the file, with its position."""

    value: str
    span: Span


class Expression(Record, frozen=True):
    """An expression and its syntax errors. `source` contains the decoded text and its mapping to the file."""

    source: Decoded
    span: Span
    tree: Expr
    findings: tuple[Finding, ...]

    @property
    def text(self) -> str:
        return self.source.text

    @property
    def broken(self) -> bool:
        """Whether the expression has syntax errors, so that parts of the text are missing in `tree`."""
        return bool(self.findings)


class PortRead(Record, frozen=True):
    """A `<bt_get_input key="…"/>`, which reads the value of a port."""

    key: Name | None
    span: Span


Value: TypeAlias = Expression | PortRead


class TypeRef(Record, frozen=True):
    """A type as written; `name` is `None` if the text does not have the form of a type."""

    text: str
    span: Span
    name: TypeName | None


def name_of(attribute: Attribute | None) -> Name | None:
    """The value of an attribute, without surrounding white space of XML; `None` if it is missing or empty.

    Other white space remains part of the name, as in the grammar, so that rules report such names.
    """
    stripped = "" if attribute is None else attribute.value.strip(SPACE)
    if attribute is None or not stripped:
        return None
    value, span = attribute.value, attribute.value_span
    if stripped == value:
        return Name(value, span)
    lead = len(value) - len(value.lstrip(SPACE))
    return Name(stripped, Span(span.start + lead, span.end - (len(value) - lead - len(stripped))))


def expression_of(document: Document, attribute: Attribute | None) -> Expression | None:
    """The expression in an attribute; `None` if the attribute is missing, or has no value because it is half typed."""
    if attribute is None or not attribute.has_value:
        return None
    return expression_from(document.decoded(attribute.value_span))


def expression_from(source: Decoded) -> Expression:
    tree, findings = parse(source)
    return Expression(source, source.span(0, len(source.text)), tree, findings)


def type_of(attribute: Attribute | None) -> TypeRef | None:
    name = name_of(attribute)
    return None if name is None else TypeRef(name.value, name.span, parse_type(name.value))


def value_of(document: Document, element: Element, name: str) -> Value | None:
    """The value in the attribute or child element `name` (docs/spec/files.md#attribute-or-child); `None` if both are
    missing. The attribute takes precedence."""
    attribute = element.get(name)
    if attribute is not None:
        return expression_of(document, attribute)
    child = _child_value(document, element, name)
    return expression_from(child) if isinstance(child, Decoded) else child


def text_or_port(document: Document, element: Element, name: str) -> Name | PortRead | None:
    """The value in the attribute or child element `name` as plain text instead of an expression; see `value_of`."""
    attribute = element.get(name)
    if attribute is not None:
        return name_of(attribute)
    child = _child_value(document, element, name)
    return Name(child.text, child.span(0, len(child.text))) if isinstance(child, Decoded) else child


def _child_value(document: Document, element: Element, name: str) -> Decoded | PortRead | None:
    """The `<bt_get_input>` or the text in the child element `name`; `None` if there is neither."""
    child = element.find(name)
    if child is None:
        return None
    return port_read(child) or document.content(child)


def port_read(element: Element) -> PortRead | None:
    """The `<bt_get_input>` in an element that contains a value; `None` if there is none."""
    read = element.find("bt_get_input")
    return None if read is None else PortRead(name_of(read.get("key")), read.span)
