# SPDX-License-Identifier: Apache-2.0
"""The examples have the results that the documents describe, and the page on verification shows the actual output."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.explicit.space import StateLimits
from roaml.smc.run import Options
from roaml.verification.exhaustive import exact_values

ROOT = Path(__file__).resolve().parents[2]
EXPECTED = {
    "delivery_robot/main.xml": {
        "all_delivered": 1.0,
        "never_empty": 1.0,
        "docks_only_when_low": 1.0,
        "never_delivers_when_empty": 1.0,
    },
    "assembly_robot/main.xml": {"block_placed": 1.0, "never_placed_empty": 1.0, "block_dropped": 0.5},
    "assembly_robot/main_with_bug.xml": {"block_placed": 0.5, "never_placed_empty": 0.5, "block_dropped": 0.5},
    "case_study/main.xml": {"recovers_or_succeeds": 1.0},
    "case_study/main_with_bug.xml": {"recovers_or_succeeds": 0.7},
    "grid_world/main.xml": {"arrives": 0.914925},
    "fleet/main.xml": {
        "anna_delivers": 0.891,
        "bert_delivers": 0.891,
        "carl_delivers": 0.675,
        "all_deliver": 0.891 * 0.891 * 0.675,
    },
}


def test_every_example_is_here() -> None:
    paths = {path.relative_to(ROOT / "examples").as_posix() for path in (ROOT / "examples").glob("*/main*.xml")}
    # The battery is the subject of experiments, and traces of the warehouse are long: other tests verify them.
    assert paths == {*EXPECTED, "battery/main.xml", "warehouse/main.xml"}


@pytest.mark.parametrize("name", EXPECTED)
def test_examples_have_the_expected_probabilities(name: str) -> None:
    model = api.to_jani(api.load(str(ROOT / "examples" / name)))
    results = api.verify(model, options=Options(epsilon=0.015, seed=4), only_uniform=True)
    values = {result.name: result.answer.value for result in results if result.answer is not None}
    assert set(values) == set(EXPECTED[name])
    for property_, expected in EXPECTED[name].items():
        if expected == 1:
            assert values[property_] == 1
        else:
            assert values[property_] == pytest.approx(expected, abs=0.02)


def test_the_grid_world_exact_values() -> None:
    checker = api.checker(api.to_jani(api.load(str(ROOT / "examples/grid_world/main.xml"))))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits(5000))
    assert (exact.least, exact.greatest) == (pytest.approx(0.914925, abs=1e-6), pytest.approx(0.914925, abs=1e-6))


def test_the_page_shows_what_is_printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A line `…` replaces lines that are not shown."""
    monkeypatch.chdir(ROOT)
    page = (ROOT / "docs/verification.md").read_text(encoding="utf-8")
    commands = re.findall(r"^\$ (.*)\n((?:(?!\$ |```).*\n)*)", page, re.MULTILINE)
    assert len(commands) == 11
    for command, shown in commands:
        program, *arguments = shlex.split(command)
        if program == "cd":
            monkeypatch.chdir(*arguments)
            continue
        assert run(arguments) == 0
        rest = timeless(capsys.readouterr().out)
        for part in timeless(shown).split("…\n"):
            assert part in rest
            rest = rest[rest.index(part) + len(part) :]
        assert "…\n" in shown or not rest


def timeless(text: str) -> str:
    return re.sub(r", [\d.]+ s$", "", text, flags=re.MULTILINE)
