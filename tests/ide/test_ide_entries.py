# SPDX-License-Identifier: Apache-2.0
"""How often a check asks the analysis: once for the file, and once for the contexts of the rules if something has
changed on which its findings depend."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest

from roaml.project import analysis
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

ROBOT = Path(__file__).parents[2] / "examples" / "delivery_robot"
INSIDE = os.path.dirname(analysis.__file__) + os.sep


def entries(call: Callable[[], object]) -> list[str]:
    """The functions of `roaml.project.analysis` that are called from outside while none of them is executed."""
    called: list[str] = []

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and _is_inside(frame):
            outer = frame.f_back
            while outer is not None and not _is_inside(outer):
                outer = outer.f_back
            if outer is None:
                called.append(frame.f_code.co_name)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        call()
    finally:
        sys.setprofile(before)
    return called


def _is_inside(frame: FrameType) -> bool:
    return frame.f_code.co_filename.startswith(INSIDE)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("plugins/battery_above.ascxml", "SUCCESS", "FAILURE"),
        ("nodes/battery.ascxml", "/>", "/> "),
        ("tree.xml", 'parcels="3"', 'parcels="4"'),
        ("main.xml", 'value="', 'value="1'),
        ("properties.xml", "/>", "/> "),
        ("properties.jani", "{", "{ "),
    ],
)
def test_a_key_asks_the_analysis_twice(name: str, old: str, new: str) -> None:
    workspace = Workspace((str(ROBOT),), Settings())
    before = workspace.snapshot()
    files = before.files()
    for path in files:
        before.checker.diagnostics(path)
    path = str(ROBOT / name)
    text = Path(path).read_text("utf-8")
    assert old in text
    workspace.open(path, text.replace(old, new, 1))
    snapshot = workspace.snapshot()
    assert entries(lambda: snapshot.checker.diagnostics(path)) == ["checked_file", "contexts"]
    assert entries(lambda: snapshot.checker.diagnostics(path)) == ["checked_file"]
    assert entries(snapshot.files) == ["present"]
    assert set(snapshot.files()) == set(files)
    for other in files:
        assert len(entries(lambda other=other: snapshot.checker.diagnostics(other))) <= 2  # type: ignore[misc]


def test_a_place_in_another_file_is_one_call_more() -> None:
    """The declaration of the port that the tree does not set."""
    workspace = Workspace((str(ROBOT),), Settings())
    path = str(ROBOT / "tree.xml")
    workspace.open(path, Path(path).read_text("utf-8").replace("parcels=", "parcel="))
    snapshot = workspace.snapshot()
    assert entries(lambda: snapshot.checker.diagnostics(path)) == ["checked_file", "contexts", "machine"]
