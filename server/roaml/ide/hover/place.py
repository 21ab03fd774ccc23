# SPDX-License-Identifier: Apache-2.0
"""A place in a file, looked up once for all hover texts."""

from __future__ import annotations

from roaml.ide.names.lookup import occurrences_at
from roaml.ide.names.occurrence import Occurrence
from roaml.ide.syntax import Typed, expression_in, path_at, xml_file
from roaml.model.kinds import FileKind
from roaml.model.syntax import Expression
from roaml.project.analysis import Analysis
from roaml.record import Record


class Place(Record, frozen=True):
    """A place in a file, and what is known about it.

    Attributes:
        text: the text of the file.
        kind: the kind of the file.
        systems: the systems of the file; `(None,)` if it belongs to no system.
        names: the occurrences of the name at the place, in each system; empty if there is no name.
        elements: the enclosing XML elements, outermost first.
        expression: the enclosing expression.
    """

    analysis: Analysis
    path: str
    offset: int
    text: str
    kind: FileKind
    systems: tuple[str | None, ...]
    names: tuple[Occurrence, ...]
    elements: tuple[Typed, ...] = ()
    expression: Expression | None = None


def place_at(analysis: Analysis, path: str, offset: int) -> Place | None:
    """The place at an offset in a file; `None` if the file cannot be read."""
    source = analysis.source(path)
    if source is None:
        return None
    kind, systems = analysis.kind(path), analysis.systems_of(path)
    names = occurrences_at(analysis, path, offset)
    file = xml_file(analysis, path)
    if file is None:
        return Place(analysis, path, offset, source.text, kind, systems, names)
    elements = tuple(path_at(file, offset))
    expression = expression_in(file.document, elements[-1], offset) if elements else None
    return Place(analysis, path, offset, source.text, kind, systems, names, elements, expression)
