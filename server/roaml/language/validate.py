# SPDX-License-Identifier: Apache-2.0
"""The places where a document violates its grammar.

- The tables of the grammar find all violations, and the positions of nearly all.
- If only the order of children is wrong, libxml2 and `xmlschema` explain why (`SchemaViolation`), except if the XML
  itself is not well-formed.
- Elements and attributes of foreign namespaces are ignored.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator
from typing import Any, TypeAlias

from roaml.interruption import checkpoint
from roaml.language.grammar import AttributeType, ElementType, Grammar, Multiplicity, SimpleType
from roaml.language.resources import schema_path
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import UNBOUNDED
from roaml.suggest import are_similar
from roaml.text import Span
from roaml.xml_syntax import Attribute, CData, Document, Element, Text
from roaml.xml_syntax.escapes import replace_forbidden
from roaml.xml_syntax.names import SPACE, is_local_name

_UNREAD = ("xml-syntax", "nesting-too-deep")
"""The codes of findings after which parts of the document may be missing in the tree."""


class UnknownElement(Record, frozen=True):
    """An element whose name does not occur in the grammar."""

    element: Element
    parent: ElementType


class MisplacedElement(Record, frozen=True):
    """An element of the grammar that is not allowed in `parent`."""

    element: Element
    type: ElementType
    parent: ElementType


class TooManyElements(Record, frozen=True):
    """An element that exceeds `most`, the number of elements with its name, or of elements with any name, that `parent`
    allows; `first` is the first of these elements."""

    element: Element
    first: Element
    parent: ElementType
    most: int


class MissingElement(Record, frozen=True):
    """`element` lacks a required child. A child with one of `names` is required; if `names` is empty, any child is
    sufficient."""

    element: Element
    type: ElementType
    names: tuple[str, ...]


class UnknownAttribute(Record, frozen=True):
    element: Element
    attribute: Attribute
    type: ElementType


class MissingAttribute(Record, frozen=True):
    element: Element
    type: ElementType
    attribute: AttributeType


class InvalidValue(Record, frozen=True):
    """The value of an attribute is not one that the grammar allows; `required` is a noun phrase for the allowed
    values."""

    element: Element
    attribute: Attribute
    type: AttributeType
    required: str


class StrayText(Record, frozen=True):
    """Character data where the grammar does not allow any."""

    span: Span
    parent: ElementType


class SchemaViolation(Record, frozen=True):
    """Any other violation of the schema; `reason` is the message of `xmlschema`."""

    element: Element
    reason: str


Violation: TypeAlias = (
    UnknownElement
    | MisplacedElement
    | TooManyElements
    | MissingElement
    | UnknownAttribute
    | MissingAttribute
    | InvalidValue
    | StrayText
    | SchemaViolation
)


def validate(document: Document, grammar: Grammar) -> tuple[Violation, ...]:
    """The places where `document` violates `grammar`; empty if the root belongs to another grammar."""
    root = document.root
    if root is None or root.name not in grammar.roots:
        return ()
    disordered: list[Element] = []
    violations = list(_walk(document, root, grammar, disordered))
    if not violations and disordered and not any(finding.code in _UNREAD for finding in document.findings):
        tree, back = to_lxml(document, root)
        if not grammar.validator.validate(tree):
            violations.extend(_explain(tree, back, grammar))
    return tuple(violations)


class Misfit(Record, frozen=True):
    """An element that the grammar does not know or does not allow where it is, with its parent and the type of the
    parent."""

    element: Element
    parent: Element
    parent_type: ElementType


def misfits(root: Element | None, grammar: Grammar) -> Iterator[Misfit]:
    """The topmost elements below `root` that the grammar does not know or does not allow where they are. This is much
    faster than `validate`."""
    if root is None or root.name not in grammar.roots:
        return
    stack = [(root, grammar.elements[root.name])]
    while stack:
        element, type_ = stack.pop()
        for child in element.elements:
            if child.is_foreign:
                continue
            child_type = grammar.child(type_, child.name)
            if child_type is not None:
                stack.append((child, child_type))
            elif type_.any_child is None:
                yield Misfit(child, element, type_)


# ---------------------------------------------------------------- by the tables


_ANYTHING = ElementType("", "", {}, {}, {}, Multiplicity(0, UNBOUNDED), any_attribute=True, text=True)
"""The type of an unknown element where any element is allowed. The elements in it may be known."""


def _walk(document: Document, root: Element, grammar: Grammar, disordered: list[Element]) -> Iterator[Violation]:
    """The violations, except that elements whose children are in a wrong order are appended to `disordered`."""
    stack: list[tuple[Element, ElementType]] = [(root, grammar.elements[root.name])]
    while stack:
        checkpoint()
        element, type_ = stack.pop()
        yield from _attributes(element, type_)
        if not type_.text:
            yield from _stray_text(document, element, type_)
        counts: dict[str, list[Element]] = {}
        names = []
        below: list[tuple[Element, ElementType]] = []
        for child in element.elements:
            if child.is_foreign:
                continue
            child_type = grammar.child(type_, child.name)
            if child_type is not None:
                below.append((child, child_type))
            elif type_.any_child is None:
                known = grammar.find(child.name)
                if known is None and child.is_undeclared:
                    continue  # it may be of another language: the parser reports its prefix
                if known is None:
                    yield UnknownElement(child, type_)
                else:
                    yield MisplacedElement(child, known, type_)
                    below.append((child, known))
            elif not type_.any_is_opaque:
                below.append((child, _ANYTHING))
            counts.setdefault(child.name, []).append(child)
            names.append(f"{child.name} ")
        yield from _counts(element, type_, counts)
        if type_.order and not re.fullmatch(type_.order, "".join(names)):
            disordered.append(element)
        stack.extend(reversed(below))


def _attributes(element: Element, type_: ElementType) -> Iterator[Violation]:
    present = set()
    for attribute in element.attributes:
        name = attribute.name
        present.add(name)
        known = type_.attributes.get(name)
        if known is not None:
            if attribute.has_value and (required := unmet(known.simple, attribute.value)):
                yield InvalidValue(element, attribute, known, required)
        elif not type_.any_attribute and ":" not in name and name != "xmlns":
            yield UnknownAttribute(element, attribute, type_)
    if element.complete or element.self_closing or element.close_span:
        for known in type_.attributes.values():
            if known.required and known.name not in present:
                yield MissingAttribute(element, type_, known)


def _stray_text(document: Document, element: Element, type_: ElementType) -> Iterator[Violation]:
    for node in element.nodes:
        if isinstance(node, (Text, CData)) and node.value.strip():
            raw = document.text[node.span.start : node.span.end]
            start = node.span.start + len(raw) - len(raw.lstrip())
            yield StrayText(Span(start, start + len(raw.strip())), type_)


def _counts(element: Element, type_: ElementType, counts: dict[str, list[Element]]) -> Iterator[Violation]:
    for name, children in counts.items():
        occurs = type_.children.get(name)
        if occurs is not None and len(children) > occurs.most:
            for extra in children[occurs.most :]:
                yield TooManyElements(extra, children[0], type_, occurs.most)
    if not element.complete:
        return
    for name, occurs in type_.children.items():
        if occurs.least > len(counts.get(name, ())):
            yield MissingElement(element, type_, (name,))
    if type_.any_child is not None:
        every = [child for children in counts.values() for child in children]
        if len(every) < type_.any_child.least:
            yield MissingElement(element, type_, ())
        for extra in every[type_.any_child.most :]:
            yield TooManyElements(extra, every[0], type_, type_.any_child.most)


def misspelled_attribute(element: Element, name: str, known: Iterable[str]) -> bool:
    """Whether an attribute of `element` that is not in `known` is probably a misspelling of `name`. The rule
    `unknown-attribute` reports it; others do not report that `name` is missing."""
    names = set(known)
    return any(a.name not in names and are_similar(a.name, name) for a in element.attributes)


def unmet(simple: SimpleType, value: str) -> str:
    """A noun phrase for the values that `simple` allows, "something" if there is no specific phrase; "" if `value` is
    one of these values."""
    text = value.strip(SPACE)
    if simple.choices:
        choices = [choice.value for choice in simple.choices if not choice.use]
        return "" if any(choice.value == value for choice in simple.choices) else _one_of(choices)
    if simple.base in _NUMBERS:
        return _unmet_number(simple, text)
    if not text and (simple.non_empty or simple.pattern):
        return "something"
    if simple.pattern and not re.fullmatch(simple.pattern, value, re.ASCII):
        return "`package/Type`" if "/" in simple.pattern else "something"
    return ""


_INTEGER = regex(r"[+-]?\d+\Z", re.ASCII)
_DECIMAL = regex(r"[+-]?(\d+(\.\d*)?|\.\d+)\Z", re.ASCII)
_DOUBLE = regex(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\Z", re.ASCII)
_NUMBERS: dict[str, tuple[re.Pattern[str], str, float | None]] = {
    "integer": (_INTEGER, "a whole number", None),
    "nonNegativeInteger": (_INTEGER, "a whole number, at least 0", 0),
    "positiveInteger": (_INTEGER, "a whole number, at least 1", 1),
    "decimal": (_DECIMAL, "a number", None),
    "double": (_DOUBLE, "a number", None),
}


def _unmet_number(simple: SimpleType, text: str) -> str:
    form, noun, least = _NUMBERS[simple.base]
    if simple.least is not None:
        noun, least = f"{noun}, at least {simple.least:g}", simple.least
    if simple.above is not None:
        noun += f" above {simple.above:g}"
    if simple.most is not None:
        noun += f" and at most {simple.most:g}" if simple.above is not None else f" up to {simple.most:g}"
    if not form.match(text) or len(text) > 300:
        return noun
    value = float(text)
    too_small = (least is not None and value < least) or (simple.above is not None and value <= simple.above)
    return noun if too_small or (simple.most is not None and value > simple.most) else ""


def _one_of(choices: list[str]) -> str:
    quoted = [f"`{choice}`" for choice in choices]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"


# ------------------------------------------------------------------- by libxml2


def to_lxml(document: Document, root: Element) -> tuple[Any, dict[Any, Element]]:
    """The tree for libxml2, and the mapping back to the elements of the document. The tree contains no namespaces,
    elements in foreign namespaces, comments, or white space around texts."""
    top = _new(None, root)
    back = {top: root}
    stack = [(root, top)]
    while stack:
        element, copy = stack.pop()
        last = None
        for node in element.nodes:
            if isinstance(node, Element):
                if node.is_foreign:
                    continue
                last = _new(copy, node)
                back[last] = node
                stack.append((node, last))
            elif isinstance(node, (Text, CData)) and (text := replace_forbidden(node.value.strip())):
                if last is None:
                    copy.text = (copy.text or "") + text
                else:
                    last.tail = (last.tail or "") + text
    return top, back


_is_local_name = functools.lru_cache(maxsize=1024)(is_local_name)
"""The result is cached, because a document repeats a few names many times."""


def _new(parent: Any, element: Element) -> Any:
    from lxml import etree  # noqa: PLC0415 - valid documents do not need it

    attributes = {
        a.name: replace_forbidden(a.value)
        for a in element.attributes
        if _is_local_name(a.name) and not a.name.startswith("xml")
    }
    tag = element.name if _is_local_name(element.name) else "not-a-name"
    return etree.Element(tag, attributes) if parent is None else etree.SubElement(parent, tag, attributes)


@functools.cache
def _explainer(schema: str) -> Any:
    import xmlschema  # noqa: PLC0415 - takes 0.2 s to import and is seldom needed

    return xmlschema.XMLSchema(str(schema_path(schema)))


def _explain(tree: Any, back: dict[Any, Element], grammar: Grammar) -> Iterator[SchemaViolation]:
    for error in _explainer(grammar.schema).iter_errors(tree):
        reason = " ".join(str(error.reason or error.message).split())
        yield SchemaViolation(back.get(error.elem, back[tree]), reason)
