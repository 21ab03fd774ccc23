# SPDX-License-Identifier: Apache-2.0
"""Expectations move from a property file to the configuration, and mean the same there."""

from __future__ import annotations

import json
import os

import pytest
from ide_case import path_of
from test_ide_actions import opened

import clock
from mending import applied
from property_robot import ROBOT
from roaml.ide.code_actions.move_expectation import movable_expectations, moved
from roaml.project.workspace import Snapshot

TOML = path_of("as2fm.toml")
PROBABILITY = {"op": "Pmin", "exp": {"op": "F", "exp": "topic_clock_msg.valid"}}


def compared(name: str, operator: str, left: object, right: object, function: str = "values") -> dict[str, object]:
    values = {"op": operator, "left": left, "right": right}
    return {"name": name, "expression": {"op": "filter", "fun": function, "values": values, "states": INITIAL}}


INITIAL = {"op": "initial"}
PROPERTIES = [
    compared("a", "≥", PROBABILITY, 0.9),
    compared("b c", "<", 0.25, PROBABILITY, "∀"),
    compared("d", "≤", PROBABILITY, {"op": "+", "left": 0.1, "right": 0.2}),
    {"name": "e", "expression": {"op": "filter", "fun": "values", "values": PROBABILITY, "states": INITIAL}},
]


def of_system(properties: object, configuration: str | None) -> Snapshot:
    files = {**clock.FILES, "properties.jani": json.dumps({"properties": properties}, indent=1, ensure_ascii=False)}
    if configuration is not None:
        files["as2fm.toml"] = configuration
    return opened("".join(f"-- {name} --\n{text}\n" for name, text in files.items()))[0]


@pytest.mark.parametrize("configuration", [None, '[verify.expect]\ne = "< 1"\n', "roots = []\n"])
def test_from_jani(configuration: str | None) -> None:
    snapshot, path = of_system(PROPERTIES, configuration), path_of("properties.jani")
    expectations = movable_expectations(snapshot.analysis, path)
    assert [(e.name, e.expected) for e in expectations] == [("a", ">= 0.9"), ("b c", "> 0.25")]
    change = moved(snapshot.analysis, path, expectations, TOML)
    assert set(change.created) == ({TOML} if configuration is None else set())
    texts = applied(snapshot, change)
    a, b, d, e = json.loads(texts[path])["properties"]
    for property_ in (a, b, e):
        assert property_["expression"] == PROPERTIES[3]["expression"]
    assert d == PROPERTIES[2]
    settings = snapshot.with_texts(texts).analysis.configuration(TOML)
    assert settings is not None
    assert settings.table is not None
    assert not settings.findings
    expected = settings.table["verify"]["expect"]
    assert {"a": ">= 0.9", "b c": "> 0.25"}.items() <= expected.items()


def test_from_xml() -> None:
    text = ROBOT.replace('<property id="charges"', '<property id="charges" expect="&gt;= 0.9"', 1)
    assert text != ROBOT
    snapshot, path = opened(text)[0], path_of("properties.xml")
    expectations = movable_expectations(snapshot.analysis, path)
    assert [(e.name, e.expected) for e in expectations] == [("charges", ">= 0.9")]
    texts = applied(snapshot, moved(snapshot.analysis, path, expectations, TOML))
    assert texts[TOML] == '[verify.expect]\ncharges = ">= 0.9"\n'
    source = opened(ROBOT)[0].analysis.source(path)
    assert source is not None
    assert texts[path] == source.text


def test_a_configuration_that_cannot_be_read_stays_as_it_is() -> None:
    snapshot, path = of_system(PROPERTIES, "verify = 3\n"), path_of("properties.jani")
    assert not moved(snapshot.analysis, path, movable_expectations(snapshot.analysis, path), TOML)
    assert os.path.basename(TOML) == "as2fm.toml"
