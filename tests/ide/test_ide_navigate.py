# SPDX-License-Identifier: Apache-2.0
"""Definition, declaration, type definition, implementation, references and highlights."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

import pytest
from ide_models import ROBOT, load

from fixture import split_files
from roaml.ide import navigation
from roaml.ide.hierarchy import calls
from roaml.ide.navigation.workspace_symbols import search
from roaml.project.analysis import Analysis
from roaml.text import Location

QUESTIONS = {
    "definition": navigation.definition,
    "declaration": navigation.declaration,
    "type": navigation.type_definition,
    "implementation": navigation.implementation,
    "references": navigation.references,
}

# file, a piece of its text with a caret, question: the places as `file:line:text`
CASES = """
a.ascxml  target="|s"><assign  definition  a.ascxml:4:s
a.ascxml  event="g|o" target  definition  a.ascxml:5:go
a.ascxml  event="g|o" target  implementation  a.ascxml:6:go
a.ascxml  event="g|o" target  references  a.ascxml:5:go  a.ascxml:6:go  properties.jani:1:go  properties.jani:2:go
a.ascxml  data.|to.x  definition  a.ascxml:5:to
a.ascxml  data.to.|x  definition  types.xml:1:x
a.ascxml  data.|to.x  type  types.xml:1:Pose
a.ascxml  id="|p" type  type  types.xml:1:Pose
a.ascxml  type="Po|se" expr  definition  types.xml:1:Pose
a.ascxml  type="std_msgs/|Int32"  definition  Int32.msg:1:
a.ascxml  topic="|/a/b"  definition
a.ascxml  topic="/|a/b"  type  Int32.msg:1:
a.ascxml  topic="/|a/b"  declaration  a.ascxml:3:a/b  tree.xml:5:a/b
a.ascxml  name="in|put" topic  type  Int32.msg:1:
a.ascxml  _msg.|data  definition  Int32.msg:4:data
plugin.ascxml  key="go|al"/>  definition  plugin.ascxml:2:goal
plugin.ascxml  key="|out" type  references  plugin.ascxml:4:out  plugin.ascxml:10:out  tree.xml:5:out  tree.xml:10:out
tree.xml  <Wa|lk goal  implementation  plugin.ascxml:1:Walk
tree.xml  <Sequ|ence>  definition  behaviortree_cpp.txt:24:Sequence
tree.xml  goal="{|g}" out  definition  tree.xml:5:g
tree.xml  execute="Ma|in"  definition  tree.xml:2:Main
tree.xml  ID="|Sub" t  definition  tree.xml:9:Sub
tree.xml  |<Sequence>  definition
main.xml  src="ty|pes.xml"  definition  types.xml:1:
properties.jani  go__|to__x  definition  a.ascxml:5:to
properties.jani  topic_a|__b_msg  references  a.ascxml:3:a/b  properties.jani:2:a__b  tree.xml:5:a/b
"""


def caret(folder: Path, file: str, piece: str) -> tuple[str, int]:
    """The path of a file and the offset of the caret in the first such piece of its text."""
    text = (folder / file).read_text(encoding="utf-8")
    before, _, after = piece.partition("|")
    assert before + after in text, piece
    return str(folder / file), text.index(before + after) + len(before)


def shown(analysis: Analysis, places: Iterable[Location]) -> list[str]:
    lines = []
    for path, span in places:
        source = analysis.source(path)
        assert source is not None
        line = source.lines.position(span.start).line + 1
        lines.append(f"{os.path.basename(path)}:{line}:{source.text[span.start : span.end]}")
    return lines


def rows() -> list[tuple[str, str, str, list[str]]]:
    cases = []
    for line in CASES.strip().splitlines():
        file, piece, question, *expected = re.split(r"  +", line.strip())
        cases.append((file, piece, question, expected))
    return cases


@pytest.mark.parametrize(("file", "piece", "question", "expected"), rows())
def test_places(file: str, piece: str, question: str, expected: list[str], tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    places = QUESTIONS[question](analysis, *caret(tmp_path, file, piece))
    assert sorted(shown(analysis, places)) == sorted(expected)


def test_references_without_declaration(tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    place = caret(tmp_path, "a.ascxml", 'event="g|o" target')
    references = navigation.references(analysis, *place, with_declaration=False)
    assert shown(analysis, references) == ["a.ascxml:6:go", "properties.jani:1:go", "properties.jani:2:go"]


def test_highlights(tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    path, offset = caret(tmp_path, "a.ascxml", 'location="|p.x"')
    source = analysis.source(path)
    assert source is not None
    highlights = navigation.highlights(analysis, path, offset)
    lines = [(source.lines.position(highlight.span.start).line + 1, highlight.access.name) for highlight in highlights]
    assert lines == [(2, "WRITE"), (5, "READ"), (6, "WRITE")]


def test_search(tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    paths = analysis.files_of(str(tmp_path / "main.xml"))
    entries = {
        (result.symbol.kind.value, result.symbol.name, result.container) for result in search(analysis, paths, "PO")
    }
    assert entries == {("struct", "Pose", "")}
    assert ("state", "s", "A") in {
        (e.symbol.kind.value, e.symbol.name, e.container) for e in search(analysis, paths, "")
    }


GRAPH = """
a.ascxml event="g|o" target event go < machine A > machine A
a.ascxml name="|A" version machine A < event go, topic a__b > event go
a.ascxml name="in|put" topic topic a__b < machine Walk > machine A
tree.xml Wa|lk goal machine Walk < tree Main, tree Sub > topic a__b, topic c
tree.xml execute="Ma|in" tree Main < > machine Walk, tree Sub
tree.xml ID="|Sub" t tree Sub < tree Main > machine Walk
"""


def names(hierarchy_calls: Iterable[calls.HierarchyCall]) -> list[str]:
    return sorted(f"{call.item.symbol.kind.value} {call.item.symbol.name}" for call in hierarchy_calls)


@pytest.mark.parametrize("row", GRAPH.strip().splitlines())
def test_calls(row: str, tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    asked, callers, called = re.split(r" [<>]", row)
    file, rest = asked.split(maxsplit=1)
    *piece, kind, name = rest.split()
    place = caret(tmp_path, file, " ".join(piece))
    (item,) = calls.items_at(analysis, *place)
    assert (item.symbol.kind.value, item.symbol.name) == (kind, name)
    incoming, outgoing = calls.incoming(analysis, item.symbol), calls.outgoing(analysis, item.symbol)
    assert names(incoming) == sorted(filter(None, map(str.strip, callers.split(","))))
    assert names(outgoing) == sorted(filter(None, map(str.strip, called.split(","))))
    for call in incoming:
        assert call.places, call
        assert len(analysis.source(call.item.path).text) >= max(span.end for span in call.places)  # type: ignore[union-attr]
