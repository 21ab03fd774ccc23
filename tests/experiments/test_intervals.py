# SPDX-License-Identifier: Apache-2.0
"""Bounds for parameters in intervals: they enclose the values of all grids, and are equal to closed forms where one
end is worst in all steps."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.experiments.intervals import IntervalError, interval_of

UP, DOWN = ({"ref": "n", "value": {"op": op, "left": "n", "right": 1}} for op in "+-")
INSIDE = {"op": "∧", "left": {"op": "<", "left": "n", "right": 4}, "right": {"op": ">", "left": "n", "right": 0}}


def walk(up: object, down: object) -> dict[str, object]:
    """The gambler's ruin: from 2, up to 4 or down to 0."""
    destinations = [
        {"location": "l", "probability": {"exp": up}, "assignments": [UP]},
        {"location": "l", "probability": {"exp": down}, "assignments": [DOWN]},
    ]
    edge = {"location": "l", "guard": {"exp": INSIDE}, "destinations": destinations}
    wins = {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "n", "right": 4}}}
    value = {"op": "filter", "fun": "values", "states": {"op": "initial"}, "values": wins}
    bounded = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 4}
    return {
        "jani-version": 1,
        "name": "walk",
        "type": "dtmc",
        "constants": [{"name": "p", "type": "real"}, {"name": "q", "type": "real", "value": 0.5}],
        "variables": [{"name": "n", "type": bounded, "initial-value": 2}],
        "automata": [
            {"name": "A", "locations": [{"name": "l"}], "initial-locations": ["l"], "edges": [edge]},
        ],
        "system": {"elements": [{"automaton": "A"}], "syncs": [{"synchronise": [None]}]},
        "properties": [{"name": "wins", "expression": value}],
    }


def one_minus(expression: object) -> dict[str, object]:
    return {"op": "-", "left": 1, "right": expression}


PRODUCT = {"op": "*", "left": "p", "right": "q"}
SQUARE = {"op": "*", "left": "p", "right": "p"}
LIMITED = {"op": "max", "left": "p", "right": 0.5}


def model(folder: Path, up: object = "p") -> str:
    path = folder / "walk.jani"
    path.write_text(json.dumps(walk(up, one_minus(up))), encoding="utf-8")
    return str(path)


def bounds(capsys: pytest.CaptureFixture[str], path: str, *arguments: str) -> tuple[float, float]:
    capsys.readouterr()
    assert run(["verify", path, "--format", "json", *arguments]) == 0
    exact = json.loads(capsys.readouterr().out)["results"][0]["exact"]
    return exact["least"], exact["greatest"]


def wins(p: float) -> float:
    return 1 / (1 + ((1 - p) / p) ** 2)


def test_bounds_are_the_values_at_the_ends_if_one_is_worst_in_all_steps(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = bounds(capsys, model(tmp_path), "--constant", "p=[0.4,0.6]")
    assert found == pytest.approx((wins(0.4), wins(0.6)), abs=1e-9)


def test_several_intervals_and_values(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = model(tmp_path, PRODUCT)
    found = bounds(capsys, path, "--constant", "p=[0.6, 4/5]", "--constant", "q=[0.5,0.9]")
    assert found == pytest.approx((wins(0.3), wins(0.72)), abs=1e-9)
    found = bounds(capsys, path, "--constant", "p=[0.6,0.8]", "--constant", "q=1/4")
    assert found == pytest.approx((wins(0.15), wins(0.2)), abs=1e-9)


def test_a_probability_of_0_at_an_end_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", model(tmp_path), "--constant", "p=[0,0.6]"]) == 2
    assert "is 0 at one of their ends" in capsys.readouterr().err
    assert run(["verify", system(tmp_path), "--set", "loss=[0,0.5]"]) == 2
    assert "is 0 at one of their ends" in capsys.readouterr().err


@pytest.mark.parametrize("up", [SQUARE, LIMITED])
def test_probabilities_that_are_not_affine_are_refused(
    up: object, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["verify", model(tmp_path, up), "--constant", "p=[0.4,0.6]"]) == 2
    assert "a probability is not affine in one of them" in capsys.readouterr().err


MAIN = """<roaml>
    <parameter_declarations>
        <parameter name="loss" type="float64" value="0.1" min="0" max="1" />
        <parameter name="limit" type="int32" value="2" />
    </parameter_declarations>
    <parameters><max_time value="6" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="radio.ascxml" /></node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>
"""
RADIO = """<ascxml name="Radio" version="1.0" initial="sending">
    <datamodel>
        <data id="lost" type="int32" expr="0" />
        <data id="sent" type="int32" expr="0" />
    </datamodel>
    <ros_topic_publisher name="alarm" topic="alarm" type="std_msgs/Empty" />
    <ros_time_rate name="tick" rate_hz="1" />
    <state id="sending">
        <ros_rate_callback name="tick" cond="lost &lt; limit &amp;&amp; sent &lt; 5">
            <target id="sending" prob="LOSS">
                <assign location="lost" expr="lost + 1" />
                <assign location="sent" expr="sent + 1" />
            </target>
            <target id="sending">
                <assign location="lost" expr="0" />
                <assign location="sent" expr="sent + 1" />
            </target>
        </ros_rate_callback>
        <ros_rate_callback name="tick" cond="lost &gt;= limit" target="alarmed">
            <ros_topic_publish name="alarm" />
        </ros_rate_callback>
    </state>
    <state id="alarmed"><ros_rate_callback name="tick" target="alarmed" /></state>
</ascxml>
"""
PROPERTIES = """<properties>
    <ports>
        <ros_topic topic_name="alarm" type="std_msgs/Empty" event="publish"><event_var id="alarm" /></ros_topic>
    </ports>
    <guarantees>
        <property id="alarmed" pattern="existence"><event>alarm</event><scope type="globally" /></property>
    </guarantees>
</properties>
"""


def system(folder: Path, loss: str = "loss") -> str:
    for name, text in (
        ("main.xml", MAIN),
        ("radio.ascxml", RADIO.replace("LOSS", loss)),
        ("properties.xml", PROPERTIES),
    ):
        (folder / name).write_text(text, encoding="utf-8")
    return str(folder / "main.xml")


@pytest.mark.parametrize("loss", ["loss", "1 - 0.5 * loss"])
def test_bounds_enclose_all_values_of_a_grid(loss: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = system(tmp_path, loss)
    least, greatest = bounds(capsys, path, "--set", "loss=[0.1,0.3]")
    points = [Fraction(1, 10) + Fraction(i, 50) for i in range(11)]
    result = api.experiment(path, {"loss": [str(point) for point in points]}, ["alarmed"])
    values = [result.point("alarmed", loss=str(point)).value for point in points]
    assert all(least - 1e-9 <= value <= greatest + 1e-9 for value in values)
    # Two losses in succession are more probable the greater the probability is, so the bounds are attained.
    assert (least, greatest) == pytest.approx((min(values), max(values)), abs=1e-9)


def test_an_interval_of_the_parameter_of_an_instance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It has the same bounds as one of the system. An unused parameter changes nothing."""
    path = system(tmp_path)
    loss = '<parameter name="loss" type="float64" value="0.1" min="0" max="1" />'
    unused = loss.replace('"loss"', '"unused"')
    (tmp_path / "main.xml").write_text(
        MAIN.replace(loss, unused).replace('src="radio.ascxml"', 'src="radio.ascxml" name="near"'), encoding="utf-8"
    )
    radio = (tmp_path / "radio.ascxml").read_text(encoding="utf-8")
    count = '<parameter name="count" type="int32" value="5" />'
    radio = radio.replace("    <datamodel>", f"    {loss}\n    {count}\n    <datamodel>", 1).replace(
        "sent &lt; 5", "sent &lt; count"
    )
    (tmp_path / "radio.ascxml").write_text(radio, encoding="utf-8")
    assert bounds(capsys, path, "--set", "near.loss=[0.1,0.3]") == pytest.approx((0.03691, 0.27333), abs=1e-6)
    assert run(["verify", path, "--set", "near.count=[2,5]"]) == 2
    assert "not only probabilities depend on them" in capsys.readouterr().err


def test_what_users_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = system(tmp_path)
    assert run(["verify", path, "--set", "loss=[0.1,0.3]", "--expect", "alarmed <= 0.5"]) == 0
    text = capsys.readouterr().out
    assert "parameters: loss = [0.1, 0.3], limit = 2\n" in text
    assert "the minimum and maximum enclose the values for all parameters in the intervals" in text


@pytest.mark.parametrize(
    ("expected", "status"),
    [("<= 0.28", 0), ("<= 0.27", 1), (">= 0.03", 0), (">= 0.04", 1), ("= 0.04", 1), ("= 0.27", 1)],
)
def test_expectations_are_compared_with_the_worst_value(
    expected: str, status: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = system(tmp_path)
    assert bounds(capsys, path, "--set", "loss=[0.1,0.3]") == pytest.approx((0.03691, 0.27333), abs=1e-6)
    arguments = ["verify", path, "--set", "loss=[0.1,0.3]", "--expect", f"alarmed {expected}"]
    assert run(arguments) == status
    met = "met" if status == 0 else "NOT MET"
    capsys.readouterr()
    assert run([*arguments, "--verbose"]) == status
    assert f": {met}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--set", "limit=[1,3]"], "not only probabilities depend on them"),
        (["--set", "limit=[1,2]"], "not only probabilities depend on them"),
        (["--set", "loss=[0.3,0.1]"], "the smaller end first"),
        (["--set", "loss=[0.1]"], "is not an interval of `loss`"),
        (["--set", "loss=[0.1,0.3]", "--method", "adaptive"], "leave out the options for random traces"),
        (["--set", "loss=[0.1,0.3]", "--scheduler", "uniform"], "leave out the options for random traces"),
        (["--set", "los=[0.1,0.3]"], "los"),
    ],
)
def test_intervals_that_are_refused(
    arguments: list[str], reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["verify", system(tmp_path), *arguments]) == 2
    assert reason in capsys.readouterr().err


def test_intervals_are_read() -> None:
    assert interval_of("p", "0.5") is None
    interval = interval_of("p", " [1/4, 0.75]")
    assert interval is not None
    assert (interval.low, interval.high, interval.text) == (Fraction(1, 4), Fraction(3, 4), "[0.25, 0.75]")
    with pytest.raises(IntervalError):
        interval_of("p", "[a,b]")
