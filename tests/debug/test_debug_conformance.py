# SPDX-License-Identifier: Apache-2.0
"""Traces of `verify` on conformance systems, in the debugger: the same verdict, and backwards the same states."""

from __future__ import annotations

from pathlib import Path

import pytest

from conformance import INTERFACES, ROOT
from roaml import api
from roaml.debugging.debugger import Unit
from roaml.debugging.sources import Sources
from roaml.debugging.start import Start, start
from roaml.smc.record import VERDICTS, Recorder, Recording

SYSTEMS = ("ros_add_int_srv_example", "probabilistic_transitions", "robot_navigation_tutorial", "bt_test_models")
MAX_STEPS = 600


@pytest.mark.parametrize("folder", SYSTEMS)
def test_traces_are_the_same_forwards_and_backwards(folder: str) -> None:
    main = next(path for path in sorted((ROOT / "models" / folder).glob("*.xml")) if _is_system(path))
    system = api.load(str(main), [str(INTERFACES)])
    sources = Sources(api.as_target(system), system.analysis)
    checker = api.checker(sources.target.model)
    for asked in checker.asked[:2]:
        name = asked.question.name
        for trace in range(2):
            recording = Recording(trace)
            Recorder(checker, asked, 5, MAX_STEPS).rush(recording)
            debugger = start(sources, Start(name, 5, trace), lambda *_: None)
            session = debugger.session
            states = [session.state()]
            while not session.is_decided and len(states) <= MAX_STEPS:
                debugger.begin(Unit.STEP)
                while debugger.advance() is None:
                    pass
                if session.position < len(states):
                    break
                states.append(session.state())
            assert debugger.verdicts[name] == session.verdict == VERDICTS[recording.verdict]
            for state in states[-2::-1]:
                debugger.begin(Unit.STEP, forwards=False)
                while debugger.advance() is None:
                    pass
                assert session.state() == state


def _is_system(path: Path) -> bool:
    return "<roaml" in (text := path.read_text(encoding="utf-8")) or "<convince_mc_tc" in text
