# SPDX-License-Identifier: Apache-2.0
"""Whether `verify`, without options, answers what each property asks: its minimum or maximum over all schedulers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import conformance
from bench import asked_models
from bench.qvbs import FOLDER, STORM, expected, models
from bench.report import Benchmark, Row, megabytes, seconds
from fixture import write_files
from roaml.verification.reactions import ASSUMPTION

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
REAL = conformance.ROOT.parent / "real"


class Call(NamedTuple):
    """A call of `as2fm-lsp verify`: CPU time in s, maximum memory in bytes, and the document that it wrote."""

    processor: float
    memory: int
    document: Any


def call(*arguments: str) -> Call:
    """Call `as2fm-lsp verify --format json`."""
    command = [sys.executable, "-m", "as2fm_lsp", "verify", "--format", "json", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    document = json.loads(output) if output.startswith("{") else {"results": [], "errors": [{"message": output[:80]}]}
    return Call(usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, document)


def answer(result: Any) -> str:
    """The answer of a result: exact values, bounds of one side, or why there is none."""
    if "error" in result:
        return f"refused: {result['error']['message']}"
    conditional = [
        f"{under['assumption']}: {_extremes(under['exact'])}"
        for under in result.get("conditional", ())
        if "exact" in under
    ]
    if "exact" in result:
        return "; ".join([_extremes(result["exact"]), *conditional])
    if result.get("undecided"):
        counts = f"{result['passed']} of {result['traces']} traces passed, {result['undecided']} undecided"
        return f"between {result['lower']:.3g} and {result['upper']:.3g}, {counts}"
    known = [f"{side} {result[side]['value']:.6g}" for side in ("minimum", "maximum") if result.get(side)]
    value = result.get("probability", result.get("expected_value"))
    return "; ".join([f"NOT EXACT: {value} under uniform choices", *known, *conditional])


def _extremes(exact: Any) -> str:
    least, greatest = exact["least"], exact["greatest"]
    value = f"{least}" if least == greatest else f"{least} to {greatest}"
    return f"{value}, {exact['states']:,} states"


def rows(label: str, name: str, *arguments: str, known: dict[str, float] | None = None) -> list[Row]:
    """The answers for all properties of a target."""
    cost = call(*arguments)
    results = cost.document["results"]
    how = f"{seconds(cost.processor)} CPU, {megabytes(cost.memory)} for all {len(results)} properties"
    found = []
    for result in results:
        value = (known or {}).get(result["property"])
        target = "" if value is None else f"{value:.9g}"
        text = answer(result)
        if value is not None and "exact" in result:
            exact = result["exact"]
            if min(abs(number - value) for number in (exact["least"], exact["greatest"])) > STORM * max(1, abs(value)):
                target += ", NOT AS EXPECTED"
        found.append(Row(label, text, target, f"{name}, {result['property']}; {how}"))
    for error in cost.document.get("errors", ()):
        found.append(Row(label, f"refused: {error['message']}", "", f"{name}; {how}"))
    return found


class Asked(NamedTuple):
    """A property whose answer was once that to another question.

    Attributes:
        expected: the right answer, for readers.
        least, greatest: the right minimum and maximum, which `under` may assume; `None` if traces cannot decide them.
        under: the assumption under which the values are computed; "" for none.
        bound: the least value that the traces of an undecided property show.
    """

    label: str
    property: str
    arguments: tuple[str, ...]
    expected: str
    least: float | None = None
    greatest: float | None = None
    under: str = ""
    bound: float | None = None


def table(folder: Path) -> list[Asked]:
    """The questions, with their models; those of our own are written to a folder."""
    (folder / "cut.jani").write_text(asked_models.CUT, encoding="utf-8")
    write_files(folder, asked_models.ACTION)
    robot = str(EXAMPLES / "delivery_robot" / "main.xml")
    undecided = ("--method", "fixed", "--max-traces", "100", "--max-steps", "50", "--seed", "7")
    own = [
        Asked("delivery robot, minimum", "all_delivered", (robot,), "1 if nobody sleeps", 1, 1),
        Asked("a result of the action, minimum", "result", (str(folder / "main.xml"),), "1 at once", 1, 1, ASSUMPTION),
        Asked(
            "22 of 100 traces passed, 78 are undecided",
            "done",
            (str(folder / "cut.jani"), *undecided),
            "at least 0.139, the numbers of traces, and the remedy",
            bound=0.139,
        ),
    ]
    if not FOLDER.is_dir():
        return own
    return [
        Asked("resource-gathering, Pmax", "prgoldgem", (_qvbs("resource-gathering"),), "0.808", greatest=0.8080456),
        Asked("exploding-blocksworld, Pmax", "goal", (_qvbs("exploding-blocksworld"),), "0.9", greatest=0.9),
        Asked("wlan_dl, Pmin", "deadline", (_qvbs("wlan_dl"),), "0.8164", least=0.81640625),
        Asked("haddad-monmege, N = 100", "target", (_qvbs("haddad-monmege"), "--constant", "N=100"), "0.7", 0.7, 0.7),
        *own,
    ]


def _qvbs(name: str) -> str:
    return str(FOLDER / f"{name}.jani")


def questions() -> list[Row]:
    """A row for each question: what is asked, the answer with its states, what was expected, and the cost."""
    with tempfile.TemporaryDirectory() as folder:
        return [_row(asked) for asked in table(Path(folder))]


def _row(asked: Asked) -> Row:
    cost = call(*asked.arguments, "--property", asked.property)
    (result,) = cost.document["results"] or [{"error": cost.document["errors"][0]}]
    target = asked.expected if _is_right(asked, result) else f"{asked.expected}: NOT AS EXPECTED"
    return Row(asked.label, answer(result), target, f"{seconds(cost.processor)} CPU, {megabytes(cost.memory)}")


def _is_right(asked: Asked, result: Any) -> bool:
    if asked.bound is not None:
        return bool(result.get("undecided")) and asked.bound <= result["lower"] < result["upper"] == 1
    values = [result, *result.get("conditional", ())] if asked.under else [result]
    exact = next((v["exact"] for v in values if "exact" in v and v.get("assumption", "") == asked.under), None)
    known = (("least", asked.least), ("greatest", asked.greatest))
    return exact is not None and all(value is None or abs(exact[side] - value) <= STORM for side, value in known)


def qvbs() -> list[Row]:
    """All properties of the models of the Quantitative Verification Benchmark Set."""
    if not FOLDER.is_dir():
        return []
    known: dict[str, dict[str, float]] = {}
    for row in expected():
        known.setdefault(row["model"], {})[row["property"]] = row["asked"]
    found = []
    for name in models():
        found += rows("QVBS, as asked", name, str(FOLDER / f"{name}.jani"), known=known.get(f"{name}.jani"))
    return found


def complete_systems() -> Iterator[tuple[str, Path, list[str]]]:
    """Name, system file and interface folders of the conformance systems, of a real project, and of the examples."""
    for path in conformance.systems():
        yield conformance.label(path), path, [str(conformance.INTERFACES)]
    for path in [REAL / "uc3_mended" / "main.xml", *sorted(EXAMPLES.glob("*/main*.xml"))]:
        if path.is_file():
            yield f"{path.parent.name}/{path.name}", path, []


def systems() -> list[Row]:
    """All properties of all complete systems."""
    found = []
    for name, path, folders in complete_systems():
        options = [argument for folder in folders for argument in ("--ros-path", folder)]
        found += rows("systems, as asked", name, str(path), *options)
    return found


BENCHMARKS: dict[str, Benchmark] = {"asked": questions, "asked-qvbs": qvbs, "asked-systems": systems}
