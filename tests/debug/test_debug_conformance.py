# SPDX-License-Identifier: Apache-2.0
"""Traces of `verify` on conformance systems in the debugger; `replay.py` replays those of all systems."""

from __future__ import annotations

import pytest
from replay import replay, sources_of

from conformance import ROOT, systems
from roaml import api

FOLDERS = ("ros_add_int_srv_example", "probabilistic_transitions", "robot_navigation_tutorial", "bt_test_models")


@pytest.mark.parametrize("folder", FOLDERS)
def test_traces_are_the_same_forwards_and_backwards(folder: str) -> None:
    sources = sources_of(next(path for path in systems() if path.parent == ROOT / "models" / folder))
    checker = api.checker(sources.target.model)
    for asked in checker.asked[:2]:
        for trace in range(2):
            assert list(replay(sources, checker, asked, trace)) == [], (asked.question.name, trace)
