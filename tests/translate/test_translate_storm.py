# SPDX-License-Identifier: Apache-2.0
"""Storm reads what we write, and computes from it what follows from the models by hand."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from storm import exact, read
from translating import loaded

from roaml import api

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*/main.xml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.parent.name)
def test_examples(path: Path) -> None:
    model = api.to_jani(api.load(str(path)))
    assert len(read(model).automata) == len(model.automata)


def reaches(variable: str, value: object) -> str:
    """A property file with one property `p`: the variable has the value at some time."""
    condition = {"op": "=", "left": variable, "right": value}
    formula = {"op": "Pmin", "exp": {"op": "F", "exp": condition}}
    expression = {"op": "filter", "fun": "values", "values": formula, "states": {"op": "initial"}}
    return json.dumps({"properties": [{"name": "p", "expression": expression}]})


def system(*machines: str, properties: str, seconds: int = 3) -> dict[str, str]:
    files = {f"machine_{number}.ascxml": machine for number, machine in enumerate(machines)}
    inputs = "".join(f'<input type="node-ascxml" src="{name}" />' for name in files)
    main = f"""<roaml>
    <parameters><max_time value="{seconds}" unit="s" /><max_array_size value="4" /></parameters>
    <node_models>{inputs}</node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>"""
    return {"main.xml": main, "properties.jani": properties, **files}


JUDGE = """<ascxml name="judge" version="1.0" initial="wait">
    <datamodel><data id="seen" type="int32" expr="0" /></datamodel>
    <state id="wait">
        <transition event="tossed" cond="_event.data.heads" target="wait">
            <assign location="seen" expr="seen + 1" />
            <send event="told"><param name="heads" expr="seen" /></send>
        </transition>
    </state>
</ascxml>"""
LISTENER = """<ascxml name="listener" version="1.0" initial="wait">
    <state id="wait"><transition event="told" target="wait" /></state>
</ascxml>"""


def tosses(count: int, body: str) -> str:
    return f"""<ascxml name="coin" version="1.0" initial="toss">
    <datamodel><data id="n" type="int32" expr="0" /><data id="x" type="int32" expr="0" /></datamodel>
    <state id="toss">
        <transition cond="n &lt; {count}" target="toss"><assign location="n" expr="n + 1" />{body}</transition>
    </state>
</ascxml>"""


SEND = '<send event="tossed"><param name="heads" expr="{}" /></send>'
WITH_TARGETS = """<ascxml name="coin" version="1.0" initial="toss">
    <datamodel><data id="n" type="int32" expr="0" /></datamodel>
    <state id="toss">
        <transition cond="n &lt; 3">
            <target id="toss" prob="0.25">
                <assign location="n" expr="n + 1" /><send event="tossed"><param name="heads" expr="true" /></send>
            </target>
            <target id="toss">
                <assign location="n" expr="n + 1" /><send event="tossed"><param name="heads" expr="false" /></send>
            </target>
        </transition>
    </state>
</ascxml>"""
ROLLED = "Math.random() &lt; 0.5"
SUM = "Math.random() + Math.random() + Math.random() &lt; 0.02"

COINS = {
    # coin: the probability that three tosses give heads three times, or one toss once
    "targets": (WITH_TARGETS, 3, Fraction(1, 4) ** 3),
    "draw in a parameter": (tosses(3, SEND.format(ROLLED)), 3, Fraction(1, 2) ** 3),
    "draw in a variable": (
        tosses(2, '<assign location="x" expr="Math.floor(Math.random() * 10)" />' + SEND.format("x == 3")),
        2,
        Fraction(1, 10) ** 2,
    ),
    "draw, floor and add": (
        tosses(1, '<assign location="n" expr="Math.floor(Math.random() * 4) + 1" />' + SEND.format("n == 4")),
        1,
        Fraction(1, 4),
    ),
    "ternary": (
        tosses(1, f'<assign location="x" expr="{ROLLED} ? 1 : 2" />' + SEND.format("x === 1")),
        1,
        Fraction(1, 2),
    ),
}


@pytest.mark.parametrize("name", COINS)
def test_probabilities(name: str) -> None:
    coin, count, expected = COINS[name]
    actual_exact = exact(
        api.to_jani(loaded(system(coin, JUDGE, LISTENER, properties=reaches("told__heads", count)))), "p"
    )
    assert actual_exact.least == pytest.approx(float(expected), abs=1e-9)
    assert actual_exact.greatest == pytest.approx(float(expected), abs=1e-9)


def test_a_probability_that_a_property_compares() -> None:
    """The file states that the probability is at least 0.1; Storm is asked for its value."""
    coin, count, expected = COINS["ternary"]
    properties = json.loads(reaches("told__heads", count))
    expression = properties["properties"][0]["expression"]
    expression.update(fun="∀", values={"op": "≥", "left": expression["values"], "right": 0.1})
    model = api.to_jani(loaded(system(coin, JUDGE, LISTENER, properties=json.dumps(properties))))
    assert exact(model, "p").greatest == pytest.approx(float(expected), abs=1e-9)


def test_many_draws_do_not_multiply() -> None:
    """Three numbers drawn for one value are 300 ways to go on, not a million."""
    assigned = f'<assign location="x" expr="{SUM} ? 1 : 0" />' + SEND.format("x == 1")
    coin = tosses(1, assigned + SEND.format(SUM))
    model = api.to_jani(loaded(system(coin, JUDGE, LISTENER, properties=reaches("told__heads", 1))))
    destinations = sum(len(edge.destinations) for automaton in model.automata for edge in automaton.edges)
    assert 600 < destinations < 800


TIMERS = """<ascxml name="ticker" version="1.0" initial="run">
    <datamodel><data id="n" type="int32" expr="0" /></datamodel>
    <ros_time_rate name="fast" rate_hz="4" />
    <ros_time_rate name="slow" rate_hz="1" />
    <state id="run">
        <ros_rate_callback name="fast" target="run"><assign location="n" expr="n + 1" /></ros_rate_callback>
        <ros_rate_callback name="slow" target="run">
            <send event="told"><param name="heads" expr="n" /></send>
        </ros_rate_callback>
    </state>
</ascxml>"""


def test_timers() -> None:
    """Four fast ticks in every second, at whatever side of the slow one that falls on the same instant."""
    for value, reached in ((8, 1), (20, 0)):
        model = api.to_jani(loaded(system(TIMERS, LISTENER, properties=reaches("told__heads", value))))
        assert exact(model, "p").greatest == reached
