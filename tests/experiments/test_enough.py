# SPDX-License-Identifier: Apache-2.0
"""Which value of a parameter is enough."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_cli_experiment import called
from test_grid import retry, write

from roaml import api
from roaml.experiments.enough import Met, Trend
from roaml.experiments.grid import ExperimentOptions
from roaml.smc.run import Options
from roaml.verification.expectations import parse

TRIES = ["p=0.5", "q=0", "tries=1:8"]
"""With n tries, the robot succeeds with a probability of 1 - 0.5^n: 0.875 for 3, 0.9375 for 4."""


def grid(path: str, sweeps: list[str], name: str = "most", **options: object) -> api.Grid:
    return api.grid_of(path, sweeps, [name], ExperimentOptions(**options))  # type: ignore[arg-type]


def test_all_values_are_computed(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    (answer,), result = api.find_enough(grid(path, TRIES), "tries", parse("most >= 0.9"))
    assert [value for value, met in answer.verdicts if met is Met.YES] == ["4", "5", "6", "7", "8"]
    assert (answer.first, answer.last, answer.trend, len(result.points)) == ("4", None, Trend.RISING, 8)
    assert answer.text("most ≥ 0.9").startswith(
        "p = 0.5, q = 0: most ≥ 0.9 is met from tries = 4 on, and for no smaller value (all 8 values were computed"
    )
    (answer,), _ = api.find_enough(grid(path, TRIES, "never"), "tries", parse("never >= 0.9"))
    assert answer.text("x").count("x is met for no value of tries from 1 to 8") == 1
    (answer,), _ = api.find_enough(grid(path, TRIES), "tries", parse("most >= 0.1"))
    assert answer.text("x").count("x is met for all values of tries from 1 to 8") == 1
    (answer,), _ = api.find_enough(grid(path, TRIES), "tries", parse("most <= 0.9"))
    assert answer.last == "3"
    assert "up to tries = 3, and for no greater value" in answer.text("x")


def test_one_answer_for_each_other_setting(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    answers, _ = api.find_enough(grid(path, ["p=0.5,0.8", "q=0", "tries=1:8"]), "tries", parse("most >= 0.9"))
    assert {dict(answer.others)["p"]: answer.first for answer in answers} == {"0.5": "4", "0.8": "2"}


def test_an_assumption_saves_points_and_is_stated(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    sweeps = ["p=0.5", "q=0", "tries=1:64"]
    (answer,), result = api.find_enough(grid(path, sweeps), "tries", parse("most >= 0.9"), is_assumed=True)
    assert answer.first == "4"
    assert len(result.points) <= 9
    assert "assumed: the property only rises or only falls" in answer.text("x")


def test_a_property_that_rises_and_falls(tmp_path: Path) -> None:
    """The probability of exactly one loss, which is greatest in the middle."""
    written = retry()
    written["automata"][0]["edges"][0]["destinations"][0]["probability"] = {
        "exp": {"op": "*", "left": 4, "right": {"op": "*", "left": "p", "right": {"op": "-", "left": 1, "right": "p"}}}
    }
    rest = {
        "op": "-",
        "left": 1,
        "right": {
            "op": "*",
            "left": 4,
            "right": {"op": "*", "left": "p", "right": {"op": "-", "left": 1, "right": "p"}},
        },
    }
    written["automata"][0]["edges"][0]["destinations"][1:] = [
        {"location": "idle", "probability": {"exp": rest}, "assignments": []}
    ]
    path = write(tmp_path, written)
    (answer,), _ = api.find_enough(grid(path, ["p=0.1:0.1:0.9", "q=0", "tries=1"]), "p", parse("most >= 0.9"))
    assert answer.trend is Trend.MIXED
    assert [value for value, met in answer.verdicts if met is Met.YES] == ["0.4", "0.5", "0.6"]
    assert "is met for p = 0.4, 0.5, 0.6" in answer.text("x")


def test_estimates_are_open_near_the_border(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    options = {"exact": False, "sampling": Options(epsilon=0.05)}
    # Under uniform choices, the robot succeeds with a probability of 0.5, 0.75, 0.8125, …
    (answer,), result = api.find_enough(grid(path, TRIES, **options), "tries", parse("most >= 0.8125"))
    verdicts = dict(answer.verdicts)
    assert verdicts["1"] is Met.NO
    assert verdicts["3"] is Met.OPEN
    assert result.options.sampling.confidence == pytest.approx(1 - 0.05 / 8)
    assert "open for" in answer.text("x")
    (answer,), _ = api.find_enough(grid(path, TRIES, **options), "tries", parse("most >= 0.6"))
    assert [met for _, met in answer.verdicts] == [Met.NO, *[Met.YES] * 7]
    assert answer.trend is Trend.UNKNOWN


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    sweeps = ["--set", "p=0.5", "--set", "q=0", "--set", "tries=1:8"]
    status, text, _ = called(capsys, model, *sweeps, "--find", "tries", "--meets", "most >= 0.9")
    assert status == 0
    assert "most ≥ 0.9 is met from tries = 4 on, and for no smaller value" in text
    assert called(capsys, model, *sweeps, "--find", "tries", "--meets", "most >= 0.9999")[0] == 1
    for wrong, message in (
        (["--find", "tries"], "need each other"),
        (["--find", "p", "--meets", "most >= 0.9"], "give it a range of numbers"),
        (["--find", "tries", "--meets", "most >= x"], "an expectation must have a form"),
        (["--assume-monotone"], "--assume-monotone needs --find"),
    ):
        status, _, error = called(capsys, model, *sweeps, *wrong)
        assert status == 2
        assert message in error
