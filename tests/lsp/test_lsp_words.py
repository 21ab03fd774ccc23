# SPDX-License-Identifier: Apache-2.0
"""The editor and the command line say the same about each property: lenses, hints, hovers of hints, the list of tests,
and the report in a terminal. The words may differ; the numbers and claims in them may not contradict each other."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from client import Client, connect
from lsprotocol import types
from test_lsp_verify import WHOLE, ask, lenses, verify

from as2fm_lsp.cli.main import run
from as2fm_lsp.handlers.results import PROPERTIES
from as2fm_lsp.verification.result_view import SYMBOLS
from corpus.parts import compose
from roaml.verification.headline import UNDECIDED

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
EPSILON = 0.2
LIMITED = {"epsilon": EPSILON, "silent": True}
FLAGS = {"epsilon": "--epsilon", "maxSteps": "--max-steps"}
KINDS = {"exact": {"silent": True}, "cut": {**LIMITED, "maxSteps": 150}, "few cut": {**LIMITED, "maxSteps": 300}}
"""Kinds of results -> the options with which a system has them: minimum and maximum differ; traces are undecided."""
SYSTEMS = ("assembly_robot/main.xml", "assembly_robot/main_with_bug.xml", "case_study/main.xml", "grid_world/main.xml")

NUMBER = re.compile(r"(?<![\w.])\d[\d,]*(?:\.\d+)?(?:e-?\d+)?(?![\w])")


def numbers(words: str) -> list[tuple[float, float]]:
    """The numbers in a text, each with the value of its last digit."""
    found = []
    for written in NUMBER.findall(words):
        text = written.rstrip(",").replace(",", "")
        digits = len(text.partition("e")[0].partition(".")[2])
        found.append((float(text), 10.0**-digits))
    return found


def contradictions(words: str, report: str) -> list[str]:
    """The numbers in short words that the report does not contain in any precision, and the claims that only one of
    both makes."""
    known = [value for value, _ in numbers(report)]
    wrong = [
        f"{value:g} is not in the report"
        for value, last in numbers(words)
        if not any(abs(value - other) <= last for other in known)
    ]
    if UNDECIDED in words and UNDECIDED not in report:
        wrong.append(f"only the editor says: {UNDECIDED}")
    if UNDECIDED in report.splitlines()[0] and UNDECIDED not in words:
        wrong.append(f"only the report says: {UNDECIDED}")
    return wrong


def blocks(report: str, names: list[str]) -> dict[str, str]:
    """Property -> the lines about it in a report."""
    found: dict[str, list[str]] = {}
    current: list[str] = []
    for line in report.splitlines():
        named = [name for name in names if line.startswith((f"{name}: ", f"{name} ("))]
        if named:
            current = found.setdefault(max(named, key=len), [])
        elif not line.startswith(" "):
            current = []
        current.append(line)
    return {name: "\n".join(lines) for name, lines in found.items()}


async def hinted(client: Client, path: Path) -> dict[str, str]:
    """Label of a hint -> the text that is shown when the mouse is on it."""
    params = types.InlayHintParams(types.TextDocumentIdentifier(path.as_uri()), WHOLE)
    shown = await client.text_document_inlay_hint_async(params) or ()
    return {str(hint.label): str(hint.tooltip) for hint in shown if hint.tooltip is not None}


async def compare(
    main: Path, capsys: pytest.CaptureFixture[str], ros_path: str = "", limits: Mapping[str, Any] = LIMITED
) -> list[str]:
    """The contradictions between all places that show the results of a system.

    Args:
        limits: the options of the editor's call. Those in `FLAGS` are also given to the command.
    """
    options = ["--ros-path", ros_path] if ros_path else []
    options += [text for name, flag in FLAGS.items() if name in limits for text in (flag, str(limits[name]))]
    run(["verify", str(main), *options])
    report = capsys.readouterr().out
    run(["verify", str(main), *options, "--format", "json"])
    rows = {row["property"]: row for row in json.loads(capsys.readouterr().out)["results"]}
    by_name = blocks(report, list(rows))
    wrong: list[str] = []
    settings: Any = {"rosPath": [ros_path]} if ros_path else {}
    async with connect(main.parent, options={"settings": settings}) as client:
        await verify(client, main, None, dict(limits))
        listed = await ask(client, PROPERTIES, {"textDocument": {"uri": main.as_uri()}})
        (own,) = (system for system in listed if system["uri"] == main.as_uri())
        properties = {row["name"]: row for row in own["properties"] if "view" in row}
        files = {Path(unquote(urlsplit(row["uri"]).path)) for row in properties.values()}
        titles = [title for file in files for title in await lenses(client, file)]
        labels = {label: tip for file in files for label, tip in (await hinted(client, file)).items()}
    assert set(properties) == set(rows) - {"stuck"}, "both verify the same properties"
    for name, row in properties.items():
        words, view, block = row["view"]["words"], row["view"], by_name[name]
        symbol = next(mark for kind, mark in SYMBOLS.items() if kind.value == view["mark"])
        places = {
            "the list of tests": "\n".join(view["lines"]),
            "the hover": labels.get(f"{symbol} {words}", ""),
            "the command line": block,
        }
        for place, shown in places.items():
            wrong += [f"{name}, {place}: {text}" for text in contradictions(words, shown or "-")]
        if "uniform choices" in block:
            means = "uniform choices: each step that is possible is equally probable"
            editor = ("the list of tests", "the hover")
            wrong += [f"{name}, {place}: no meaning" for place in editor if means not in places[place]]
        if f"Verify · {words}" not in titles:
            wrong.append(f"{name}: no lens shows `{words}`")
        if ("NOT MET" in block) != (view["mark"] == "failed"):
            wrong.append(f"{name}: {view['mark']} in the editor, but\n{block}")
    return wrong


@pytest.mark.parametrize("name", SYSTEMS)
async def test_examples(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, _, file = name.partition("/")
    shutil.copytree(EXAMPLES / folder, tmp_path / folder)
    main = tmp_path / folder / file
    for other in main.parent.glob("*.xml"):
        # Hints name the system if a property is in several ones.
        if other != main and "<roaml" in other.read_text(encoding="utf-8"):
            other.unlink()
    assert await compare(main, capsys) == []


@pytest.mark.parametrize("kind", KINDS)
async def test_kinds_of_results(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for folder in ("battery", "delivery_robot"):
        shutil.copytree(EXAMPLES / folder, tmp_path / folder)
    (tmp_path / "delivery_robot" / "main.xml").unlink()
    assert await compare(tmp_path / "battery" / "main.xml", capsys, limits=KINDS[kind]) == []


async def test_an_exact_value_names_its_extreme(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """If the minimum and the maximum differ, a number alone would not say which of both it is."""
    for folder in ("battery", "delivery_robot"):
        shutil.copytree(EXAMPLES / folder, tmp_path / folder)
    main = tmp_path / "battery" / "main.xml"
    async with connect(tmp_path) as client:
        await verify(client, main, ["all_delivered"], {"silent": True})
        hints = await hinted(client, tmp_path / "delivery_robot" / "properties.jani")
    assert any(label.startswith("= minimum almost 1, exact") for label in hints)


@pytest.mark.parametrize("seed", [0, 2])
async def test_composed_systems(seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert await compare(compose(seed).write(tmp_path), capsys) == []


def test_contradictions_are_found() -> None:
    report = "p: 0.4832 in [0.4701, 0.4912] from 1,000 traces: 483 passed, 517 failed, 0.1 s"
    assert contradictions("0.48 [0.47, 0.50]", report) == []
    assert contradictions("0.52 [0.47, 0.49]", report)
    assert contradictions(f"{UNDECIDED}; uniform 0.48", report)
    assert contradictions("0.48", f"p: {UNDECIDED}; under uniform choices: 0.4832")
