# SPDX-License-Identifier: Apache-2.0
"""What is told about the thing under the mouse."""

from __future__ import annotations

from pathlib import Path

import pytest
from ide_models import ROBOT, load

from fixture import split_files
from fuzz.corpus import systems
from roaml import api
from roaml.ide.hover import hover
from roaml.project.settings import Settings

FILES = split_files(ROBOT)

# file, a piece of its text with a caret, what is among the text that is shown
CASES = """
a.ascxml  <sta|te id  a state of the machine
a.ascxml  id="|p" type  p : Pose
a.ascxml  event="g|o" target  sent by `A` | received by `A`
a.ascxml  topic="/|a/b"  topic a/b : std_msgs/Int32 | published by | in properties: `topic_a__b_msg.valid`
a.ascxml  type="std_msgs/|Int32"  # std_msgs/Int32 | int32 data
a.ascxml  target="|s"><assign  state `s` | from | to
tree.xml  goal="{|g}" out  blackboard `g` | written by | read by
"""


@pytest.mark.parametrize("case", CASES.strip().splitlines())
def test_text(tmp_path: Path, case: str) -> None:
    name, marked, expected = case.split("  ")
    analysis = load(tmp_path, FILES)
    before, _, after = marked.partition("|")
    path = str(tmp_path / name)
    source = analysis.source(path)
    assert source is not None
    at = source.text.index(before + after) + len(before)
    found = hover(analysis, path, at)
    assert found is not None
    assert found.span.start <= at <= found.span.end
    for part in expected.split(" | "):
        assert part.lower() in found.text.lower(), found.text


def test_every_place_of_some_systems() -> None:
    """No place gives an exception or a range outside of the file, and many places say something."""
    told = 0
    for model in systems()[-3:]:
        analysis = api.check([model.main], model.ros_paths, Settings(), model.texts).snapshot.analysis
        for path, text in model.texts.items():
            for offset in range(0, len(text) + 1, 7):
                found = hover(analysis, path, offset)
                if found is not None:
                    assert 0 <= found.span.start <= offset <= found.span.end <= len(text)
                    told += 1
    assert told > 100
