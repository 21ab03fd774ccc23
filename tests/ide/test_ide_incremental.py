# SPDX-License-Identifier: Apache-2.0
"""Cached results about names while a user types are equal to newly computed ones."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from ide_models import CORNERS, ROBOT, system_file

from fixture import split_files
from roaml.ide.names.occurrences import occurrences
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace

WORDS = (
    "Pose",
    "Shape",
    "int32",
    "float64",
    "Int32",
    "go",
    "to",
    "small.sum",
    "topic",
    "/calc",
    "/a/b",
    "goal",
    "x",
    "n",
)
"""Texts that replace each other: types, events, parameters and topics, on which other files depend."""


PASSED_ON = (
    "-- main.xml --\n"
    + system_file(
        "data_declarations xml types.xml", "node_models node-ascxml a.ascxml", "node_models node-ascxml b.ascxml"
    )
    + """
-- types.xml --
<types>
  <struct id="Pose"><member id="x" type="float64"/></struct>
  <struct id="Shape"><member id="x" type="float64"/></struct>
</types>
-- a.ascxml --
<ascxml name="A" version="1.0" initial="s">
  <datamodel><data id="p" type="Pose" expr="{'x': 1.0}"/></datamodel>
  <state id="s"><onentry><send event="go"><param name="to" expr="p"/></send></onentry></state>
</ascxml>
-- b.ascxml --
<ascxml name="B" version="1.0" initial="s">
  <datamodel><data id="n" type="float64" expr="0.0"/></datamodel>
  <state id="s">
    <transition event="go" target="s"><assign location="n" expr="_event.data.to.x"/></transition>
  </state>
</ascxml>
"""
)
"""The first machine determines the struct to which the member `x` in the second machine belongs."""


def found(snapshot: Snapshot) -> dict[tuple[str, str | None], object]:
    analysis = snapshot.analysis
    files = snapshot.files()
    return {
        (path, system): occurrences(analysis, path, system) for path in files for system in analysis.systems_of(path)
    }


@pytest.mark.parametrize("written", [ROBOT, CORNERS, PASSED_ON], ids=["robot", "corners", "passed on"])
def test_edits(tmp_path: Path, written: str) -> None:
    texts = {str(tmp_path / name): text for name, text in split_files(written).items()}
    chance = Random(6)
    kept = Workspace([str(tmp_path)], Settings(), [str(tmp_path / "main.xml")])
    for path, text in texts.items():
        kept.open(path, text)
    before, different = found(kept.snapshot()), 0
    for _ in range(60):
        path = chance.choice([other_path for other_path in texts if not other_path.endswith("main.xml")])
        there = [word for word in WORDS if word in texts[path]]
        if not there:
            continue
        changed = texts[path].replace(chance.choice(there), chance.choice(WORDS), 1)
        kept.open(path, changed)
        fresh = Workspace([str(tmp_path)], Settings(), [str(tmp_path / "main.xml")])
        for other_path, text in {**texts, path: changed}.items():
            fresh.open(other_path, text)
        after = found(fresh.snapshot())
        assert found(kept.snapshot()) == after, (path, changed)
        different += any(before[key] != after.get(key) for key in before if key[0] != path)
        kept.open(path, texts[path])
        assert found(kept.snapshot()) == before
    assert different > 5, "what other files say must matter"
