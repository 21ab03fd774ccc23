# SPDX-License-Identifier: Apache-2.0
"""Rewards of systems (time, messages, ticks), and values under the condition that a path holds: compared with closed
forms."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from smc_models import automaton, document, edge, variable, way

from roaml import api
from roaml.jani.property_text import PropertyTextError
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.results import Computed, Estimated, Refused, Result

SENSOR = """\
<ascxml name="Sensor" version="1.0" initial="measure">
    <ros_time_rate name="sample" rate_hz="2" />
    <ros_topic_publisher name="bump" topic="/bump" type="std_msgs/Bool" />
    <state id="measure">
        <ros_rate_callback name="sample">
            <target id="measure" prob="0.1">
                <ros_topic_publish name="bump"><field name="data" expr="true" /></ros_topic_publish>
            </target>
            <target id="measure" />
        </ros_rate_callback>
    </state>
</ascxml>
"""
GUARD = """\
<ascxml name="Guard" version="1.0" initial="watch">
    <ros_topic_subscriber name="bump" topic="/bump" type="std_msgs/Bool" />
    <state id="watch"><ros_topic_callback name="bump" target="watch" /></state>
</ascxml>
"""
MAIN = """\
<roaml>
    <parameters><max_time value="10" unit="s" reaction_time="instant" /></parameters>
    <node_models>
        <input type="node-ascxml" src="sensor.ascxml" />
        <input type="node-ascxml" src="guard.ascxml" />
    </node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
BUMP = "topic_bump_msg.valid"


@pytest.fixture(scope="module")
def sensor(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A sensor that reports a bump in one of ten samples, which it takes at 0.5 s, 1 s, ..., 10 s."""
    folder = tmp_path_factory.mktemp("sensor")
    files = {"sensor.ascxml": SENSOR, "guard.ascxml": GUARD, "main.xml": MAIN, "properties.jani": '{"properties": []}'}
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return str(folder / "main.xml")


def result(path: str, text: str, options: Options | None = None, *, is_exact: bool = False) -> Result:
    target = api.target(path, mocks={"A": "0.6", "B": "0.5"} if path.endswith("tree.xml") else None)
    (answer,) = api.verify(target, [text], options, exact_if_small=is_exact)
    return answer


def exact(path: str, text: str) -> float:
    outcome = result(path, text, is_exact=True).outcome
    assert isinstance(outcome, Computed)
    assert outcome.exact.least == pytest.approx(outcome.exact.greatest)
    return outcome.exact.least


def interval(path: str, text: str) -> tuple[float, float]:
    outcome = result(path, text, Options(confidence=0.999)).outcome
    assert isinstance(outcome, Estimated)
    return outcome.answer.bounds


def test_messages(sensor: str) -> None:
    """Of the samples before the clock shows t, each leads to a message with the probability 0.1."""
    assert exact(sensor, 'R{"messages /bump"}=? [ C<=5 s ]') == pytest.approx(0.9)
    assert exact(sensor, 'R{"messages /bump"}=? [ C<=10 s ]') == pytest.approx(1.9)
    assert exact(sensor, 'Rmax{"messages /bump"}=? [ C<=700 ms ]') == pytest.approx(0.1)
    assert exact(sensor, 'R{"messages /clock"}=? [ F topic_bump_msg.valid ]') == float("inf")


def test_time(sensor: str) -> None:
    """The first bump is in sample k with the probability 0.1 · 0.9^(k - 1); 12 of 100 traces have none."""
    assert exact(sensor, f'R{{"time"}}=? [ F {BUMP} ]') == float("inf")
    chances = [0.1 * 0.9 ** (k - 1) for k in range(1, 21)]
    mean = sum(0.5 * k * chance for k, chance in enumerate(chances, 1)) / sum(chances)
    low, high = interval(sensor, f'R{{"time"}}=? [ F {BUMP} || F {BUMP} ]')
    assert low <= mean <= high
    assert high - low < 0.1
    low, high = interval(sensor, f"P=? [ F<=5 s {BUMP} || F {BUMP} ]")
    assert low <= sum(chances[:10]) / sum(chances) <= high


def test_ticks(tmp_path: Path) -> None:
    """A is ticked until it succeeds, at most three times; B only then."""
    path = tmp_path / "tree.xml"
    tree = '<Sequence><RetryUntilSuccessful num_attempts="3"><A/></RetryUntilSuccessful><B/></Sequence>'
    path.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="M">{tree}</BehaviorTree></root>', encoding="utf-8")
    assert exact(str(path), 'R{"ticks A"}=? [ F succeeds | fails ]') == pytest.approx(1 + 0.4 + 0.4**2)
    assert exact(str(path), 'R{"ticks B"}=? [ F (succeeds | fails) ]') == pytest.approx(1 - 0.4**3)
    assert exact(str(path), 'R{"ticks A"}=? [ F succeeds ]') == float("inf")
    attempts = sum(k * 0.6 * 0.4 ** (k - 1) for k in (1, 2, 3)) / (1 - 0.4**3)
    low, high = interval(str(path), 'R{"ticks A"}=? [ F succeeds || F succeeds ]')
    assert low <= attempts <= high < low + 0.1


def test_conditions_on_steps(tmp_path: Path) -> None:
    """A robot succeeds in each step with 0.2 and breaks with 0.1: the number of steps is geometric with 0.3."""
    steps = edge("run", way("good", 0.2, done=1), way("bad", 0.1), way("run", 0.7))
    robot = automaton("robot", "run good bad", [steps])
    path = tmp_path / "model.jani"
    written = document(robot, variables=[variable("done")])
    path.write_text(json.dumps(written), encoding="utf-8")
    low, high = interval(str(path), 'R{"steps"}=? [ F done=1 || F done=1 ]')
    assert low <= 1 / 0.3 <= high < low + 0.2
    missed = 0
    for seed in range(300):
        options = Options(confidence=0.9, method=EstimationMethod.FIXED, max_traces=300, seed=seed)
        outcome = result(str(path), "P=? [ F<=2 done=1 || F done=1 ]", options).outcome
        assert isinstance(outcome, Estimated)
        low, high = outcome.answer.bounds
        missed += not low <= 0.34 / (0.2 / 0.3) <= high
    assert missed <= 48, "more than 48 of 300 misses have a probability below 0.001 at a confidence of 0.9"
    other = result(str(path), 'R{"steps"}=? [ F done=1 || F done=0 ]').outcome
    assert isinstance(other, Refused)
    assert "can only be restricted to traces that reach this condition" in other.reason.message


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ('R{"messages /bumb"}=? [ C<=5 s ]', "nothing sends messages on the topic `/bumb`"),
        ('R{"ticks Guard"}=? [ C<=5 s ]', "the tree has no node `Guard` that is ticked"),
    ],
)
def test_mistakes(sensor: str, text: str, problem: str) -> None:
    with pytest.raises(PropertyTextError, match=problem):
        result(sensor, text)
