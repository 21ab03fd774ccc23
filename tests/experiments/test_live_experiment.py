# SPDX-License-Identifier: Apache-2.0
"""`experiment --live`, what editors show while an experiment runs; and what they ask before it."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from test_grid import retry, write

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.ide.code_actions.new_parameter import actions
from roaml.ide.experiment import numbers_of, parameters_of, properties_of
from roaml.text import Span

EXAMPLES = Path(__file__).parents[2] / "examples"


def lines(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, list[dict[str, Any]]]:
    capsys.readouterr()
    status = run(["experiment", *arguments, "--live"])
    return status, [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def keys_of(plot: dict[str, Any]) -> set[str]:
    return {key for group in ET.fromstring(plot["scene"]).iter() if (key := group.get("data-key"))}


def texts_of(plot: dict[str, Any], role: str) -> set[str]:
    groups = (group for group in ET.fromstring(plot["scene"]).iter() if role in group.get("class", "").split())
    return {text for group in groups for text in group.itertext()}


def test_an_experiment_grows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first line has the axes and the legend, the last one all points, whose keys are those of the marks."""
    model = write(tmp_path, retry())
    grid = ["--constant", "p=0.1:0.4:0.9", "--constant", "q=0", "--constant", "tries=2,3", "--property", "most"]
    status, (first, *_, last) = lines(capsys, model, *grid)
    assert status == 0
    assert (first["done"], first["total"], first["rows"]) == (0, 6, [])
    assert last["done"] == 6
    (empty,), (plot,) = first["plots"], last["plots"]
    assert (plot["width"], plot["title"]) == (empty["width"], empty["title"])
    assert {"tries = 2", "tries = 3"} <= texts_of(empty, "legend")
    assert texts_of(empty, "axis") == texts_of(plot, "axis") > {"p", "0.2"}
    assert keys_of(empty) == set()
    points = [point for row in last["rows"] for point in row["points"]]
    assert keys_of(plot) == {point["key"] for point in points}
    assert last["rows"][0]["setting"] == {"p": "0.1", "q": "0", "tries": "2"}
    assert points[0]["value"] == pytest.approx(0.19)
    assert last["model"] == model
    assert [len(line["files"]["csv"].splitlines()) for line in (first, last)] == [1, 7]
    (svg,) = last["files"]["svg"]
    assert {"tries = 2", "tries = 3"} <= set(ET.fromstring(svg).itertext())
    assert last["files"]["html"].count("<tr>") == 1 + len(last["rows"]) == 7


def test_a_heat_map_grows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    grid = ["--constant", "p=0.1:0.1:0.9", "--constant", "q=0", "--constant", "tries=1:8", "--property", "most"]
    _, (first, *_, last) = lines(capsys, model, *grid)
    assert len(keys_of(first["plots"][0])) == len(keys_of(last["plots"][0])) == 72


def test_which_value_is_enough(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    grid = ["--constant", "p=0.1:0.1:0.9", "--constant", "q=0", "--constant", "tries=2"]
    status, (first, *_, last) = lines(capsys, model, *grid, "--find", "p", "--meets", "most >= 0.5")
    assert status == 0
    assert first["answers"] == []
    assert last["answers"][0].startswith("q = 0, tries = 2: most ≥ 0.5 is met from p = 0.3 on")
    assert "≥ 0.5" in last["plots"][0]["scene"]


def test_what_is_asked_of_a_system_with_parameters() -> None:
    system = str(EXAMPLES / "battery/main.xml")
    analysis = api.check([system]).snapshot.analysis
    capacity, present = parameters_of(analysis, system)
    assert (capacity.name, capacity.value, capacity.proposed) == ("capacity", "100", "20:200:20")
    assert capacity.limits == "at least 20 and at most 200"
    assert (present.name, present.proposed) == ("present", "0:1:0.1")
    assert [property_.name for property_ in properties_of(analysis, system)] == ["all_delivered", "never_empty"]


def test_a_number_becomes_a_parameter() -> None:
    """Every number that is offered can become a parameter."""
    system = str(EXAMPLES / "delivery_robot/main.xml")
    analysis = api.check([system]).snapshot.analysis
    assert parameters_of(analysis, system) == ()
    numbers = list(numbers_of(analysis, system))
    # The robot and its environment come before the plugins, each number with the comment about it.
    assert numbers[0].line == '<data id="capacity" type="uint8" expr="100" />'
    assert numbers[0].comment == "The charge of a full battery. Driving uses 10 of it in a second."
    assert [number.line.startswith("<data") for number in numbers] == [True, True, True, False, False]
    for place in numbers:
        if len(analysis.systems_of(place.path)) == 1:
            (action,) = actions(analysis, place.path, Span(place.span.start, place.span.start))
            assert f"Make {place.text} the parameter" in action.title
