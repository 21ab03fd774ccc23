# SPDX-License-Identifier: Apache-2.0
"""`<random_values>`: how many values `Math.random()` has in a system."""

from __future__ import annotations

import pytest
from translating import errors, lowered, translated

from roaml.jani.model import Model
from roaml.scxml.writer import write

MAIN = """
<roaml>
    <parameters><max_time value="1" unit="s"/>{parameter}</parameters>
    <node_models><input type="node-ascxml" src="world.ascxml"/></node_models>
    <properties><input type="jani" src="properties.jani"/></properties>
</roaml>
"""
WORLD = """
<ascxml name="World" version="1.0" initial="start">
    <datamodel><data id="x" type="float64" expr="0.0"/></datamodel>
    <state id="start"><onentry><assign location="x" expr="{value}"/></onentry></state>
</ascxml>
"""


def files(parameter: str, value: str = "Math.random()") -> dict[str, str]:
    texts = {"main.xml": MAIN.format(parameter=parameter), "world.ascxml": WORLD.format(value=value)}
    return {**texts, "properties.jani": '{"properties": []}'}


def most_ways(model: Model) -> int:
    return max(len(edge.destinations) for automaton in model.automata for edge in automaton.edges)


@pytest.mark.parametrize(
    ("parameter", "count"), [("", 100), ('<random_values value="500"/>', 500), ('<random_values value="1"/>', 1)]
)
def test_each_value_is_a_destination(parameter: str, count: int) -> None:
    model = translated(files(parameter))
    assert most_ways(model) == count


def test_combinations_are_bounded() -> None:
    """Two numbers of 500 values each would be 250,000 destinations: they are drawn one after the other."""
    parameter = '<random_values value="500"/>'
    assert most_ways(translated(files(parameter, "Math.random() - Math.random()"))) == 500
    assert most_ways(translated(files("", "Math.random() - Math.random()"))) == 10_000


@pytest.mark.parametrize("value", ["0", "10001", "-5", "many", "2.5"])
def test_counts_that_are_refused(value: str) -> None:
    assert [d.code for d in errors(files(f'<random_values value="{value}"/>'))] == ["invalid-value"]


@pytest.mark.parametrize(
    ("value", "named"), [("Math.random()", "float64"), ("Math.floor(Math.random() * 10)", "int64")]
)
def test_what_is_drawn_for_a_parameter_has_a_type_of_the_language(value: str, named: str) -> None:
    sender = WORLD.replace(
        '<assign location="x" expr="{value}"/>', f'<send event="e"><param name="p" expr="{value}"/></send>'
    )
    receiver = """
<ascxml name="Receiver" version="1.0" initial="wait">
    <state id="wait"><transition event="e" target="wait"/></state>
</ascxml>
"""
    texts = files("") | {"world.ascxml": sender, "receiver.ascxml": receiver}
    texts["main.xml"] = texts["main.xml"].replace(
        "</node_models>", '<input type="node-ascxml" src="receiver.ascxml"/></node_models>'
    )
    written = "".join(text for _, text in write(lowered(texts)))
    assert f"<!-- TYPE random_0:{named} -->" in written
