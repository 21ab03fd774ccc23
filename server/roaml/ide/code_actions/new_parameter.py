# SPDX-License-Identifier: Apache-2.0
"""A number becomes a parameter (docs/spec/parameters.md), so that it can be varied without changing the models."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from roaml.edit.elements import first_in, last_in
from roaml.expansion.declarations import SECTIONS, declarations
from roaml.expansion.problems import Problems
from roaml.expr.parse import parse
from roaml.expr.tree import Number, walk
from roaml.expr.types import INTEGER_RANGES
from roaml.ide.code_actions.action import EXTRACT, CodeAction, WorkspaceEdit
from roaml.ide.syntax import walk as elements_of
from roaml.ide.syntax import xml_file
from roaml.model.kinds import FileKind
from roaml.model.syntax import name_of
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.roles import ValueRole
from roaml.text import Decoded, Edit, Span, TextEdit
from roaml.xml_syntax import Document, Element

_ROLES = (ValueRole.EXPRESSION, ValueRole.CONSTANT, ValueRole.NUMBER)
_KINDS = (FileKind.MACHINE, FileKind.XML_PROPERTIES, FileKind.TREE)
_NAMES = {"rate_hz": "rate", "prob": "probability", "within": "within", "after": "after", "time": "time"}


_UNNAMED = ("expr", "cond", "location", "event")
"""The attributes and elements whose names say nothing about a number in them."""


class _Literal(NamedTuple):
    """A number in a file: its span, its text, a name for it and its type, and the text that replaces it."""

    span: Span
    text: str
    name: str
    type: str
    is_port: bool


def actions(analysis: Analysis, path: str, place: Span) -> Iterator[CodeAction]:
    """An action for the number at a place in a file that belongs to exactly one system."""
    systems = analysis.systems_of(path)
    system = systems[0]
    if len(systems) != 1 or system is None or analysis.kind(path) not in _KINDS:
        return
    found = _literal_at(analysis, path, place)
    document = analysis.document(system)
    if found is None or document is None or document.root is None:
        return
    name = _unused(analysis, system, document, found.name)

    def make() -> WorkspaceEdit:
        assert document.root is not None
        use = f"$(var {name})" if found.is_port else name
        line = f'<parameter name="{name}" type="{found.type}" value="{found.text}" />'
        section = document.root.find(SECTIONS[0])
        declared: Edit = (
            last_in(document, section, line)
            if section is not None
            else first_in(document, document.root, f"<{SECTIONS[0]}>", f"    {line}", f"</{SECTIONS[0]}>")
        )
        changes = {path: (TextEdit(found.span, use),), system: (declared,)}
        edits = {file: in_layout(source, edits) for file, edits in changes.items() if (source := analysis.source(file))}
        return WorkspaceEdit({file: tuple(file_edits) for file, file_edits in edits.items()})

    yield CodeAction(f"Make {found.text} the parameter `{name}` of the system", EXTRACT, make)


def literals(analysis: Analysis, path: str) -> Iterator[tuple[Element, Span]]:
    """The numbers of a machine that can become parameters, except 0 and 1, which are rarely quantities, each with its
    element."""
    file = xml_file(analysis, path)
    for element, type_ in elements_of(file) if file is not None else ():
        for attribute in element.attributes:
            role = type_.attributes.get(attribute.name) if type_ else None
            if role is None or role.value not in _ROLES or not attribute.has_value or file is None:
                continue
            tree, findings = parse(file.document.decoded(attribute.value_span))
            for node in walk(tree) if not findings else ():
                if isinstance(node, Number) and file.document.text[node.span.start : node.span.end] not in ("0", "1"):
                    yield element, node.span


def _literal_at(analysis: Analysis, path: str, place: Span) -> _Literal | None:
    file = xml_file(analysis, path)
    if file is None:
        return None
    is_tree = analysis.kind(path) is FileKind.TREE
    for element, type_ in elements_of(file):
        if not (element.span.start <= place.start and place.end <= element.span.end):
            continue
        for attribute in element.attributes:
            span = attribute.value_span
            if not (attribute.has_value and span.start <= place.start and place.end <= span.end):
                continue
            role = type_.attributes.get(attribute.name) if type_ else None
            source = file.document.decoded(span)
            if is_tree:
                is_port = type_ is None or type_.node is not None
                return _number(file.document, source, place, element, attribute.name, is_port=True) if is_port else None
            if role is not None and role.value in _ROLES:
                return _number(file.document, source, place, element, attribute.name, is_port=False)
        content = file.document.content(element) if type_ is not None and type_.value in _ROLES else None
        if content is not None and content.offset(0) <= place.start <= content.offset(len(content.text)):
            return _number(file.document, content, place, element, element.name, is_port=False)
    return None


def _number(
    document: Document, source: Decoded, place: Span, element: Element, part: str, *, is_port: bool
) -> _Literal | None:
    tree, findings = parse(source)
    if findings or (is_port and not isinstance(tree, Number)):
        return None
    for node in walk(tree):
        if isinstance(node, Number) and node.span.start <= place.start and place.end <= node.span.end:
            declared = name_of(element.get("type"))
            is_real = node.is_real or part in ("rate_hz", "prob") or (declared and declared.value.startswith("float"))
            # The type of a variable limits the values of its initial value.
            is_whole = part == "expr" and node is tree and declared is not None and declared.value in INTEGER_RANGES
            type_ = declared.value if declared is not None and is_whole else "float64" if is_real else "int32"
            text = document.text[node.span.start : node.span.end]  # a number contains no escapes
            owner = name_of(element.get("id")) or name_of(element.get("name"))
            stem = _NAMES.get(part) or (f"initial_{owner.value}" if owner and part == "expr" else part)
            return _Literal(node.span, text, stem, type_, is_port)
    return None


def _unused(analysis: Analysis, system: str, document: Document, stem: str) -> str:
    """A name that begins with `stem` and that no parameter of the system and no word in its files is."""
    name = "parameter" if stem in _UNNAMED else "".join(c if c.isalnum() else "_" for c in stem)
    taken = {parameter.name.value for parameter in declarations(document, Problems())}
    texts = [source.text for path in analysis.files_of(system) if (source := analysis.source(path))]
    candidate, number = name, 2
    while candidate in taken or any(f'id="{candidate}"' in text for text in texts):
        candidate, number = f"{name}_{number}", number + 1
    return candidate
