# SPDX-License-Identifier: Apache-2.0
"""How often a check asks the analysis: once for the findings of a file, and once for the places in other files to which
they refer."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest

import roaml.rules
from as2fm_lsp.session import Moment, Session
from roaml.project import analysis, checking
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

ROBOT = Path(__file__).parents[2] / "examples" / "delivery_robot"
INSIDE = os.path.dirname(analysis.__file__) + os.sep
RULES = (checking.__file__, os.path.dirname(roaml.rules.__file__) + os.sep)
"""The analysis calls the rules; what these ask is counted, too."""


def entries(call: Callable[[], object]) -> list[str]:
    """The functions of `roaml.project.analysis` that are called while none of them is executed, or by the rules."""
    called: list[str] = []

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and _is_inside(frame):
            outer = frame.f_back
            while outer is not None and not _is_inside(outer) and not outer.f_code.co_filename.startswith(RULES):
                outer = outer.f_back
            if outer is None or not _is_inside(outer):
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
def test_a_key_asks_the_analysis_once_for_a_file(name: str, old: str, new: str) -> None:
    session = Session()
    session.set_folders([str(ROBOT)])
    path = str(ROBOT / name)
    text = Path(path).read_text("utf-8")
    assert old in text
    session.open(path, text, 1)
    moment = session.moment()
    files = moment.files()
    for file in files:
        moment.snapshot(file).checker.diagnostics(file)
    session.open(path, text.replace(old, new, 1), 2)
    moment = session.moment()
    assert entries(lambda: _check(moment, path)) == ["__init__", "checked_file"]
    assert entries(lambda: _check(moment, path)) == ["checked_file"]
    assert sorted(entries(moment.files)) == ["files_of", "memberships", "present"]
    assert set(moment.files()) == set(files)
    for other in files:
        assert entries(lambda other=other: _check(moment, other)) == ["checked_file"]  # type: ignore[misc]


def _check(moment: Moment, path: str) -> None:
    moment.snapshot(path).checker.diagnostics(path)


def test_a_place_in_another_file_is_one_call_more() -> None:
    """The declaration of the port that the tree does not set."""
    workspace = Workspace((str(ROBOT),), Settings())
    path = str(ROBOT / "tree.xml")
    workspace.open(path, Path(path).read_text("utf-8").replace("parcels=", "parcel="))
    snapshot = workspace.snapshot()
    assert entries(lambda: snapshot.checker.diagnostics(path)) == ["checked_file", "places"]
