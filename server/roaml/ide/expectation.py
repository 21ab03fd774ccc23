# SPDX-License-Identifier: Apache-2.0
"""Edits that set the expectation of a property: in its file if the property is written in XML, or in the configuration
if it is written in JANI."""

from __future__ import annotations

from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.ide.verifiable import Verifiable
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.expectation_setting import expectation_edit
from roaml.text import Span, TextEdit
from roaml.xml_syntax.escapes import escape


def is_written_in_file(analysis: Analysis, property_: Verifiable) -> bool:
    """Whether the expectation is an attribute of the property; otherwise it is in the configuration, as that of a
    property of one instance: the attribute would be that of all instances."""
    if analysis.kind(property_.path) is not FileKind.XML_PROPERTIES:
        return False
    file = analysis.property_file(property_.path)
    return file is not None and any(w.id is not None and w.id.value == property_.name for w in file.properties)


def in_property_file(analysis: Analysis, property_: Verifiable, expected: str) -> WorkspaceEdit:
    """The edit that sets the attribute `expect` of a property in XML.

    Args:
        expected: the expectation, such as `>= 0.9`.
    """
    file = analysis.property_file(property_.path)
    written = next((w for w in file.properties if w.id and w.id.span == property_.name_span), None) if file else None
    if written is None:
        return WorkspaceEdit()
    value = escape(expected)
    if written.expect is not None:
        edit = TextEdit(written.expect.span, value)
    else:
        at = written.element.attributes[-1].span.end
        edit = TextEdit(Span(at, at), f' expect="{value}"')
    return WorkspaceEdit({property_.path: (edit,)})


def in_configuration(path: str, text: str | None, name: str, expected: str) -> WorkspaceEdit:
    """The edit that sets the entry of a property in the table `verify.expect` of a configuration file; empty if the
    entry cannot be added.

    Args:
        path: the configuration file.
        text: the text of the file; `None` if the file does not exist.
    """
    edit = expectation_edit(path, text or "", name, expected)
    if edit is None:
        return WorkspaceEdit()
    return WorkspaceEdit({path: (edit,)}) if text is not None else WorkspaceEdit(created={path: edit.new_text})
