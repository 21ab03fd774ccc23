# SPDX-License-Identifier: Apache-2.0
"""The names in the start tag and the end tag of an element, which are edited together."""

from __future__ import annotations

from roaml.ide.syntax import xml_file
from roaml.project.analysis import Analysis
from roaml.text import Span

NAME_PATTERN = r"[^\s<>/=\"'&!?;,()\[\]{}]+"
"""The value of LSP's `wordPattern`: a pattern for names of elements, including unfinished ones."""


def linked_names(analysis: Analysis, path: str, offset: int) -> tuple[Span, ...]:
    """The spans of the names in the start tag and the end tag of an element; empty if the offset is in neither of them,
    or if the names differ."""
    file = xml_file(analysis, path)
    for element in file.document.path_at(offset)[-1:] if file else ():
        first, second = element.name_span, element.close_name_span
        if file and second is not None and (first.contains(offset) or second.contains(offset)):
            text = file.document.text
            if text[first.start : first.end] == text[second.start : second.end]:
                return (first, second)
    return ()
