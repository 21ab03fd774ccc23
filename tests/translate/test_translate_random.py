# SPDX-License-Identifier: Apache-2.0
"""`<random_values>`: how many values `Math.random()` has in a system."""

from __future__ import annotations

import pytest
from translating import errors, translated

from roaml.jani.model import Model

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
