# SPDX-License-Identifier: Apache-2.0
"""Traces of `verify` on conformance systems in the debugger; `replay.py` replays those of all systems."""

from __future__ import annotations

import pytest
from replay import replay, sources_of

from conformance import ROOT, systems
from roaml import api
from roaml.debugging.by_hand import sendable, sending
from roaml.debugging.start import Start, start

FOLDERS = ("ros_add_int_srv_example", "probabilistic_transitions", "robot_navigation_tutorial", "bt_test_models")


@pytest.mark.parametrize("folder", FOLDERS)
def test_traces_are_the_same_forwards_and_backwards(folder: str) -> None:
    sources = sources_of(next(path for path in systems() if path.parent == ROOT / "models" / folder))
    checker = api.checker(sources.target.model)
    for property_ in checker.compiled_properties[:2]:
        for trace in range(2):
            assert list(replay(sources, checker, property_, trace)) == [], (
                property_.question.name,
                trace,
            )


@pytest.mark.parametrize("folder", ["array_of_strings", "array_of_data_structs", "ros_add_int_srv_example"])
def test_every_event_is_sent_by_hand_and_received(folder: str) -> None:
    sources = sources_of(next(path for path in systems() if path.parent == ROOT / "models" / folder))
    debugger = start(sources, Start(), lambda *_: None)
    session = debugger.session
    events = list(sendable(session, sources))
    assert events
    for form in events:
        debugger.intervene(sending(session, sources, form.event, dict(form.template)))
        assert session.is_changed
        for _ in range(3):
            session.step()
        before = session.state()
        debugger.go_to(session.position)
        assert session.state() == before
        debugger.go_to(0)
