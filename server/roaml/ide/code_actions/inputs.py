# SPDX-License-Identifier: Apache-2.0
"""Edits that list files in a system file."""

from __future__ import annotations

from roaml.edit.elements import after, first_in, last_in, removal
from roaml.ide.code_actions import new_file
from roaml.model.system_file import SECTION_NAMES, ListedFile, SystemSection
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.text import TextEdit


def add_input(analysis: Analysis, system: str, section: SystemSection, type_: str, path: str) -> tuple[TextEdit, ...]:
    """The edits that list a file at the end of a section of a system file; empty if the section already lists the file.
    A missing section is created."""
    file, document, source = analysis.system_file(system), analysis.document(system), analysis.source(system)
    if file is None or document is None or source is None:
        return ()
    if any(listed.path == path and listed.input.section is section for listed in analysis.listed(system)):
        return ()
    written = [entry.src.value for entry in file.inputs if entry.src]
    entry = f'<input type="{type_}" src="{new_file.relative(path, system, written)}" />'
    parent = file.element.find(section.value)
    if parent is not None:
        edit = last_in(document, parent, entry)
    else:
        lines = (f"<{section.value}>", f"    {entry}", f"</{section.value}>")
        before = ("parameters", "mc_parameters", *SECTION_NAMES[: SECTION_NAMES.index(section.value)])
        earlier = [child for child in file.element.elements if child.name in before]
        edit = after(document, earlier[-1], *lines) if earlier else first_in(document, file.element, *lines)
    return tuple(in_layout(source, (edit,)))


def move_input(
    analysis: Analysis, system: str, listed: ListedFile, section: SystemSection, type_: str
) -> tuple[TextEdit, ...]:
    """The edits that move a file to another section of a system file. A section that would be empty is removed."""
    source, file = analysis.source(system), analysis.system_file(system)
    if source is None or file is None:
        return ()
    parent = file.element.find(listed.input.section.value)
    alone = parent is not None and len(parent.elements) == 1
    gone = parent.span if parent is not None and alone else listed.input.element.span
    added = add_input(analysis, system, section, type_, listed.path)
    return (*in_layout(source, (removal(source.text, gone),)), *added)
