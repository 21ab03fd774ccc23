# SPDX-License-Identifier: Apache-2.0
"""The formatter of supported files, which returns edits.

- Only white space between tokens is changed, so the meaning of a file stays the same. Formatting the result again
  changes nothing.
- A file with syntax errors is not changed.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.formatting import json as format_json
from roaml.ide.formatting import xml as format_xml
from roaml.ide.formatting.layout import FileLayout, Spacing, edits
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import SourceFile, Span, TextEdit

DEFAULT = FileLayout()

_XML = (FileKind.MACHINE, FileKind.SYSTEM, FileKind.TREE, FileKind.STRUCTS, FileKind.XML_PROPERTIES)
_JSON = (FileKind.PROPERTIES, FileKind.JANI_MODEL)


def can_format(analysis: Analysis, path: str) -> bool:
    """Whether a file is of a kind that is formatted, and has no syntax errors."""
    return next(_gaps(analysis, path, DEFAULT), None) is not None


def has_formatter(analysis: Analysis, path: str) -> bool:
    """Whether files of this kind are formatted."""
    return analysis.kind(path) in (*_XML, *_JSON)


def format_edits(
    analysis: Analysis, path: str, layout: FileLayout = DEFAULT, within: Span | None = None
) -> tuple[TextEdit, ...]:
    """The edits that format a file, in the order of the text.

    Args:
        analysis: the state of the workspace.
        path: the file.
        layout: the layout; a JSON file that is indented by two or four spaces keeps this width.
        within: if given, only edits in the lines that this span touches are returned.
    """
    source = analysis.source(path)
    if source is None:
        return ()
    changes = sorted(edits(source.text, _gaps(analysis, path, layout)))
    if within is not None:
        start, end = _lines_around(source, within)
        last = end if end == len(source.text) else end - 1  # an insertion after the line end belongs to the next line
        changes = [edit for edit in changes if start <= edit.span.start <= last and edit.span.end <= end]
    return tuple(changes)


def _gaps(analysis: Analysis, path: str, layout: FileLayout) -> Iterator[Spacing]:
    kind, source = analysis.kind(path), analysis.source(path)
    if kind in _XML and (document := analysis.document(path)) is not None:
        yield from format_xml.gaps(document, layout)
    elif kind in _JSON and source is not None and (json := analysis.json(path)) is not None:
        _, findings = json
        if all(finding.code != "json-syntax" for finding in findings):
            yield from format_json.gaps(source.text, layout)


def _lines_around(source: SourceFile, span: Span) -> Span:
    """The span of the lines that `span` touches. A line is not included if `span` ends at its beginning."""
    lines = source.lines
    end = max(span.start, span.end - 1)
    return Span(lines.line_start(lines.position(span.start).line), lines.line_end(lines.position(end).line))
