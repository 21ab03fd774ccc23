# SPDX-License-Identifier: Apache-2.0
"""Values from elsewhere beside the points of an experiment, and arguments that replace those of a file."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_cli_experiment import called
from test_grid import retry, write

from roaml.experiments.beside import BesideError, BesideValue, read_beside
from roaml.experiments.sweeps import Sweep

SWEEPS = (Sweep("p", ("0.25", "0.5")), Sweep("q", ("0",)))
GRID = ["--constant", "p=0.1:0.4:0.9", "--constant", "q=0", "--constant", "tries=2,3", "--property", "most"]
PAPER = (
    "# of a publication\np, tries, property, value, low, high\n0.50, 2, most, 0.7, 0.6, 0.8\n1/10, 3, most, 0.25,,\n"
)


def test_values_are_read() -> None:
    text = "p,q,property,value,low,high,note\n1/4,0,most,0.5,0.4,0.6,x\n0.5,1,most,0.7,,,\n0.5,0.0,most,0.8,,,\n"
    values = read_beside(text, "paper", SWEEPS, ("most",))
    assert values == (
        BesideValue("paper", "most", (("p", "1/4"), ("q", "0")), 0.5, 0.4, 0.6),
        BesideValue("paper", "most", (("p", "0.5"), ("q", "0.0")), 0.8),
    )
    assert [value.is_at((("p", "0.25"), ("q", "0"))) for value in values] == [True, False]
    (value,) = read_beside("p,property,value,source\n0.5,most,1,robot\n0.5,least,1,\n", "paper", SWEEPS, ("most",))
    assert (value.source, value.setting) == ("robot", (("p", "0.5"),))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "there is no column `value`"),
        ("pp,property,value\n", "there is no column `p`; did you mean `pp`?"),
        ("p,property,value\n0.5,most,high\n", "the value `high` is not a number"),
        ("p,property,value\n0.5,least,1\n", "no row has the property `most`"),
    ],
)
def test_values_that_cannot_be_used(text: str, reason: str) -> None:
    with pytest.raises(BesideError, match=reason):
        read_beside(text, "paper", SWEEPS, ("most",))


def test_tables_and_plots_contain_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, paper, svg = write(tmp_path, retry()), tmp_path / "paper.csv", tmp_path / "plot.svg"
    paper.write_text(PAPER, encoding="utf-8")
    beside = ["--beside", str(paper)]
    status, text, _ = called(capsys, model, *GRID, *beside, "--plot", str(svg))
    assert status == 0
    lines = text.splitlines()
    assert lines[0].split() == ["p", "q", "tries", "most", "paper"]
    assert lines[2].split() == ["0.1", "0", "3", "0.271", "0.25"]
    assert lines[3].split("0.75")[1].strip() == "0.7 in [0.6, 0.8]"
    assert lines[4].split() == ["0.5", "0", "3", "0.875"]
    drawn = svg.read_text(encoding="utf-8")
    assert "paper, tries = 2: 0.7 in [0.6, 0.8] at 0.5; paper, tries = 3: 0.25 at 0.1." in drawn
    assert "paper: most 0.25 at p = 1/10, tries = 3" in drawn
    _, markdown, _ = called(capsys, model, *GRID, *beside, "--format", "markdown")
    assert markdown.startswith("| p | q | tries | `most` | paper |\n")
    # A heat map has no marks.
    many = ["--set", "p=0.1:0.1:0.9", "--set", "q=0", "--set", "tries=1:8", "--property", "most"]
    assert called(capsys, model, *many, *beside, "--plot", str(svg))[0] == 0
    assert "paper: 0.7 in [0.6, 0.8] at p = 0.50, tries = 2; 0.25 at p = 1/10, tries = 3." in svg.read_text("utf-8")
    # The table of an experiment is a file of values, too.
    table = tmp_path / "before.csv"
    assert called(capsys, model, *GRID, "--format", "csv", "-o", str(table))[0] == 0
    _, text, _ = called(capsys, model, *GRID, "--beside", str(table))
    assert text.splitlines()[1].split() == ["0.1", "0", "2", "0.19", "0.19", "in", "[0.19,", "0.19]"]
    paper.write_text("p,tries\n", encoding="utf-8")
    status, _, error = called(capsys, model, *GRID, *beside)
    assert (status, error) == (2, f"as2fm-lsp: {paper}: there is no column `value`; add it to the first line\n")


def test_the_command_line_replaces_values_in_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, retry())
    (tmp_path / "paper.csv").write_text(PAPER, encoding="utf-8")
    file = tmp_path / "tries.experiment.toml"
    file.write_text(
        'model = "model.jani"\nproperty = ["least"]\nplot = ["file.svg"]\nbeside = ["paper.csv"]\n'
        '[set]\np = [0.1, 0.5]\nq = 0\ntries = "2:4"\n',
        encoding="utf-8",
    )
    own = tmp_path / "own.svg"
    status, text, _ = called(
        capsys, str(file), "--set", "tries=3", "--set", "p=0.5", "--property", "most", "--plot", str(own)
    )
    assert status == 0
    assert len(text.splitlines()) == 3
    assert (own.exists(), (tmp_path / "file.svg").exists()) == (True, False)
    status, text, _ = called(capsys, str(file), "--find", "tries", "--meets", "most >= 0.8", "--set", "p=0.5")
    assert status == 0
    assert "most ≥ 0.8 is met from tries = 3 on" in text
