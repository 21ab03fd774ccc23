# SPDX-License-Identifier: Apache-2.0
"""The example of the battery has the answers on the page, and shares what it can."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from test_cli_experiment import called

from roaml import api
from roaml.api.experimenting import parametric_model
from roaml.experiments.grid import ExperimentOptions
from roaml.experiments.points import PointKind
from roaml.smc.run import EstimationMethod, Options

ROOT = Path(__file__).resolve().parents[2]
BATTERY = ROOT / "examples/battery"
PAGE = (ROOT / "docs/experiments.md").read_text(encoding="utf-8")


def test_the_page(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(BATTERY)
    ((command, printed),) = re.findall(r"^\$ as2fm-lsp experiment (main.*)\n((?:.*\n)*?)```", PAGE, re.MULTILINE)
    status, out, _ = called(capsys, *shlex.split(command), "--jobs", "1")
    assert (status, out) == (0, printed)


def test_probabilities_share_states_and_programs() -> None:
    """`present` is only a probability; `capacity` is not."""
    path = str(BATTERY / "main.xml")
    model = parametric_model(path)
    assert model.chances({"present": (0.5, 0.9)}, (("capacity", "50"),)) is not None
    assert model.chances({"capacity": (40, 90)}, ()) is None
    sweeps = ["capacity=50", "present=0.5,0.6,0.7"]
    grid = api.grid_of(path, sweeps, ["all_delivered"])
    assert grid._parametric("all_delivered", grid.settings) is not None
    together = {point.setting: point for point in grid.points()}
    for setting, point in together.items():
        alone = api.grid_of(path, [f"{name}={value}" for name, value in setting], ["all_delivered"])
        (other,) = alone.points()
        assert point.value == pytest.approx(other.value, abs=1e-9)
        assert point.kind is other.kind is PointKind.EXACT


def test_estimates_with_a_shared_program_are_the_same() -> None:
    path = str(BATTERY / "main.xml")
    options = ExperimentOptions(Options(method=EstimationMethod.FIXED, max_traces=300), exact=False)
    grid = api.grid_of(path, ["capacity=50", "present=0.5,0.6,0.7"], ["all_delivered"], options)
    tasks = grid._tasks({setting: ["all_delivered"] for setting in grid.settings})
    assert all(task.compiled is not None for task in tasks)
    for point in grid.points():
        (other,) = api.grid_of(path, [f"{n}={v}" for n, v in point.setting], ["all_delivered"], options).points()
        assert point == other


def test_unknown_and_impossible_values(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(BATTERY / "main.xml")
    with pytest.raises(ValueError, match="declares no parameter `capacty`"):
        api.grid_of(path, ["capacty=50"])
    status, _, error = called(capsys, path, "--set", "capacty=50")
    assert (status, error.count("did you mean `capacity`?")) == (2, 1)
    status, _, error = called(capsys, path, "--set", "x=0.8:0.9")
    assert (status, error.count("no parameter `x`; it declares `capacity` and `present`")) == (2, 1)
    assert "fewer than two numbers with the step 1" in called(capsys, path, "--set", "present=0.8:0.9")[2]
    assert called(capsys, path, "--set", "capacity=2000")[0] == 1
    points = {
        dict(p.setting)["capacity"]: p for p in api.grid_of(path, ["capacity=50,5000"], ["all_delivered"]).points()
    }
    assert points["50"].has_value
    assert not points["5000"].has_value
    assert "capacity" in points["5000"].note
