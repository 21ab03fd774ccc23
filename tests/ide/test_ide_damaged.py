# SPDX-License-Identifier: Apache-2.0
"""Every request about documents that are being typed: no exception, and no place outside of the texts."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from ide_models import CORNERS, load

from fixture import split_files
from roaml.ide import navigation
from roaml.ide.hierarchy import calls
from roaml.ide.rename import Renaming, prepare, rename
from roaml.project.analysis import Analysis
from roaml.text import Location

QUESTIONS = (
    navigation.definition,
    navigation.declaration,
    navigation.type_definition,
    navigation.implementation,
    navigation.references,
)


def ask(analysis: Analysis, path: str, offset: int) -> None:
    for question in QUESTIONS:
        for place in question(analysis, path, offset):
            within(analysis, place)
    for highlight in navigation.highlights(analysis, path, offset):
        within(analysis, Location(path, highlight.span))
    for item in calls.items_at(analysis, path, offset):
        for call in (*calls.incoming(analysis, item.symbol), *calls.outgoing(analysis, item.symbol)):
            within(analysis, Location(call.item.path, call.item.span))
    prepare(analysis, path, offset)
    renaming = rename(analysis, path, offset, "zqfresh")
    if isinstance(renaming, Renaming):
        for text, edits in renaming.edits.items():
            for edit in edits:
                within(analysis, Location(text, edit.span))


def within(analysis: Analysis, place: Location) -> None:
    source = analysis.source(place.path)
    assert source is not None
    assert 0 <= place.span.start <= place.span.end <= len(source.text)


@pytest.mark.parametrize("name", [name for name in split_files(CORNERS) if name != "main.xml"])
def test_cut_off(name: str, tmp_path: Path) -> None:
    files = split_files(CORNERS)
    chance = random.Random(name)
    for end in sorted(chance.sample(range(len(files[name])), 12)):
        analysis = load(tmp_path, {**files, name: files[name][:end]})
        for offset in (end, chance.randrange(end + 1), chance.randrange(end + 1)):
            ask(analysis, str(tmp_path / name), offset)
        ask(analysis, str(tmp_path / "tree.xml"), files["tree.xml"].index("Put"))


@pytest.mark.parametrize("name", split_files(CORNERS))
def test_every_seventh_place(name: str, tmp_path: Path) -> None:
    files = split_files(CORNERS)
    analysis = load(tmp_path, files)
    for offset in range(0, len(files[name]) + 1, 7):
        ask(analysis, str(tmp_path / name), offset)
