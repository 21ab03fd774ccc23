# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp experiment`: its tables, plots, files of arguments, and kept points."""

from __future__ import annotations

import csv
import io
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from test_grid import retry, write

from as2fm_lsp.cli.main import run

GRID = ["--constant", "p=0.1:0.4:0.9", "--constant", "q=0", "--constant", "tries=2,3", "--property", "most"]


def called(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    status = run(["experiment", *arguments])
    printed = capsys.readouterr()
    return status, printed.out, printed.err


def test_formats(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    status, text, _ = called(capsys, model, *GRID)
    assert status == 0
    assert text.splitlines()[:2] == ["  p  q  tries  most", "0.1  0      2  0.19"]
    assert (
        "exact values from all states: the same for all schedulers; the maximum over all schedulers where these differ"
        in text
    )
    _, table, _ = called(capsys, model, *GRID, "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(table)))
    assert [(row["p"], row["tries"]) for row in rows[:2]] == [("0.1", "2"), ("0.1", "3")]
    assert [float(row["value"]) for row in rows[:2]] == pytest.approx([0.19, 0.271])
    assert [row["schedulers"] for row in rows[:2]] == ["all schedulers", "maximum over all schedulers"]
    _, markdown, _ = called(capsys, model, *GRID, "--format", "markdown")
    assert markdown.splitlines()[:3] == [
        "| p | q | tries | `most` |",
        "| --- | --- | --- | --- |",
        "| 0.1 | 0 | 2 | 0.19 |",
    ]
    _, written, _ = called(capsys, model, *GRID, "--format", "json")
    points = json.loads(written)["points"]
    assert len(points) == 6
    assert points[0]["setting"] == {"p": "0.1", "q": "0", "tries": "2"}
    assert points[0]["value"] == pytest.approx(0.19)


def test_estimates_are_not_those_of_all_schedulers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    sampled = ("--method", "fixed", "--max-traces", "100")
    _, text, _ = called(capsys, model, *GRID, *sampled)
    assert (
        "estimates from traces with uniform choices (the minimum and maximum over all schedulers are undecided): "
        in text
    )
    _, text, _ = called(capsys, model, *GRID, *sampled, "--scheduler", "uniform")
    assert "estimates from traces with uniform choices: 0.95 confidence" in text


def test_what_is_undecided_has_the_limit_that_ended_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    _, text, _ = called(capsys, model, *GRID, "--max-states", "1")
    reason = "because searches stopped at the limit max-states: raise it, or explore all states"
    assert f"(the minimum and maximum over all schedulers are undecided, {reason}): 0.95 confidence" in text
    _, text, _ = called(capsys, model, *GRID, "--method", "fixed", "--max-traces", "100", "--max-steps", "1")
    assert "100 traces undecided, because " in text
    assert " cut after 1 steps: raise max-steps, or explore all states (at " in text


def test_plots(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    svg, page, pdf = (tmp_path / f"plot.{suffix}" for suffix in ("svg", "html", "pdf"))
    plots = [argument for path in (svg, page, pdf) for argument in ("--plot", str(path))]
    assert called(capsys, model, *GRID, *plots, "--unit", "p=per attempt")[0] == 0
    root = ET.fromstring(svg.read_text(encoding="utf-8"))
    texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {"p (per attempt)", "probability", "tries = 2", "tries = 3", "with q = 0"} <= set(texts)
    description = root.findtext("{http://www.w3.org/2000/svg}desc") or ""
    assert "0.19 at 0.1" in description
    assert "prefers-color-scheme: dark" in svg.read_text(encoding="utf-8")
    assert "<table>" in page.read_text(encoding="utf-8")
    assert pdf.read_bytes().startswith(b"%PDF")
    # Many values of a second parameter are a heat map.
    grid = ["--constant", "p=0.1:0.1:0.9", "--constant", "q=0", "--constant", "tries=1:8", "--property", "most"]
    assert called(capsys, model, *grid, "--plot", str(svg))[0] == 0
    cells = [e for e in ET.fromstring(svg.read_text(encoding="utf-8")).iter() if "heat" in e.get("class", "").split()]
    assert len(cells) >= 72


def test_a_file_of_arguments(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, retry())
    file = tmp_path / "tries.experiment.toml"
    file.write_text(
        'model = "model.jani"\nproperty = ["most"]\nplot = ["tries.svg"]\nformat = "csv"\n'
        '[set]\np = [0.1, 0.5]\nq = 0\ntries = "2:4"\n',
        encoding="utf-8",
    )
    status, table, _ = called(capsys, str(file))
    assert (status, len(table.splitlines())) == (0, 7)
    assert (tmp_path / "tries.svg").exists()
    assert called(capsys, str(file), "--format", "json")[1].startswith("{")  # the command line takes precedence
    file.write_text('model = "model.jani"\nproprety = ["most"]\n', encoding="utf-8")
    status, _, error = called(capsys, str(file))
    assert status == 2
    assert "there is no option `proprety`; did you mean `property`?" in error
    file.write_text('property = ["most"]\n', encoding="utf-8")
    assert "names no model" in called(capsys, str(file))[2]
    file.write_text('model = "model.jani"\nproperty = ["most]\n', encoding="utf-8")
    assert f"{file}:2:18: Illegal character" in called(capsys, str(file))[2]


def test_kept_points(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    kept = tmp_path / "points.json"
    first = called(capsys, model, *GRID, "--resume", str(kept))
    data = json.loads(kept.read_text(encoding="utf-8"))
    assert len(data["points"]) == 6
    (first_point,) = (p for p in data["points"] if p["setting"] == {"p": "0.1", "q": "0", "tries": "2"})
    first_point |= dict.fromkeys(("value", "low", "high"), 0.5)  # so that the second run shows what it has read
    kept.write_text(json.dumps(data), encoding="utf-8")
    second = called(capsys, model, *GRID, "--resume", str(kept))
    assert first[1].replace("0.19", "0.5 ", 1).split() == second[1].split()
    status, _, error = called(capsys, model, *GRID, "--resume", str(kept), "--seed", "1")
    assert status == 2
    assert "was written for another model or other options" in error
    kept.write_text("{}", encoding="utf-8")
    assert "does not contain points" in called(capsys, model, *GRID, "--resume", str(kept))[2]


def test_exit_status(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = write(tmp_path, retry())
    assert called(capsys, model, *GRID, "--exhaustive", "--max-states", "2")[0] == 1
    status, _, error = called(capsys, model, *GRID, "--exhaustive", "--epsilon", "0.1")
    assert status == 2
    assert "leave one out" in error
    assert called(capsys, model, "--constant", "p=0.5,,1")[0] == 2
    assert called(capsys, model, *GRID, "--plot", "plot.png")[0] == 2
    assert called(capsys, str(tmp_path / "none.jani"), *GRID)[0] == 2
    assert "has no property `mots`" in called(capsys, model, *GRID, "--property", "mots")[2]
