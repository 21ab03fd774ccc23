# SPDX-License-Identifier: Apache-2.0
"""Going back restores a snapshot; the state, the verdict and all later steps are those of a run without snapshots."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from roaml import api
from roaml.simulation import Session
from roaml.simulation.run import SNAPSHOT_INTERVAL

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def _state(session: Session) -> tuple[object, ...]:
    return session.state(), session.verdict, session.is_decided, session.end, session.choices()


@pytest.mark.parametrize("system", ["assembly_robot/main_with_bug.xml", "assembly_robot/main.xml"])
def test_every_jump_leads_to_the_state_of_a_replay(system: str) -> None:
    target = api.target(str(EXAMPLES / system))
    for name in [property_.name for property_ in target.model.properties]:
        chance = random.Random(name)
        session, replay = (api.session(target, name, seed=4) for _ in range(2))
        states = [_state(replay)]
        while replay.step() is not None:
            states.append(_state(replay))
        assert len(states) > SNAPSHOT_INTERVAL + 1
        session.jump(len(states))
        for _ in range(20):
            position = chance.randrange(len(states))
            session.jump(position)
            assert _state(session) == states[position]
        session.jump(SNAPSHOT_INTERVAL + 1)
        assert session.steps == replay.steps


def test_another_choice_discards_snapshots_after_it() -> None:
    target = api.target(str(EXAMPLES / "delivery_robot/main.xml"))
    session = api.session(target, seed=4)
    session.jump(SNAPSHOT_INTERVAL + 50)
    session.jump(100)
    session.step(session.choices()[-1])
    session.jump(SNAPSHOT_INTERVAL + 40)
    saved = session.save()
    replay = api.session(target, saved=saved)
    assert _state(session) == _state(replay)
    session.jump(SNAPSHOT_INTERVAL + 5)
    replay.jump(SNAPSHOT_INTERVAL + 5)
    assert _state(session) == _state(replay)
