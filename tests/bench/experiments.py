# SPDX-License-Identifier: Apache-2.0
"""The CPU time of experiments with 100 points, compared with a single run, for the assembly robot whose arm drops the
block with a probability that is a parameter."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from bench.report import Benchmark, Row, listed, seconds
from bench.verify import call

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "assembly_robot"
POINTS = "drops=0.005:0.995:0.01"
DECLARATION = '<parameter_declarations><parameter name="drops" type="float64" value="0.5" /></parameter_declarations>'
EXACT = ("--exhaustive",)
SAMPLED = ("--method", "adaptive", "--epsilon", "0.01", "--confidence", "0.95")
RUNS = 3


def write_robot(folder: Path) -> Path:
    """Write the assembly robot with the bug, with the parameter, into a new folder. Returns its system file."""
    shutil.copytree(ROBOT, folder)
    for name, old, new in (
        ("arm.ascxml", 'prob="0.5"', 'prob="drops"'),
        ("main_with_bug.xml", "<parameters>", f"{DECLARATION}<parameters>"),
    ):
        text = (folder / name).read_text(encoding="utf-8")
        if text.count(old) != 1:
            raise ValueError(f"`{old}` is not once in {name}")
        (folder / name).write_text(text.replace(old, new), encoding="utf-8")
    return folder / "main_with_bug.xml"


def exact() -> list[Row]:
    """100 exact points and one run of `verify`."""
    with tempfile.TemporaryDirectory() as folder:
        main = write_robot(Path(folder) / "robot")
        question = (str(main), "--property", "block_dropped", *EXACT, "--jobs", "1")
        one = _least("verify", *question)
        many = _least("experiment", *question, "--set", POINTS)
    method = (
        "100 exact points of the assembly robot with the bug, for the probability with which the arm drops the block, "
        f"compared with one `verify --exhaustive` ({seconds(many)}, {seconds(one)}); CPU time of the whole commands, "
        f"minimum of {RUNS} runs"
    )
    return [Row("`experiment`, 100 exact points", f"{many / one:.1f} times", "at most 3 times", method)]


def sampled() -> list[Row]:
    """100 estimates and one of them."""
    ratios, times = [], []
    with tempfile.TemporaryDirectory() as folder:
        main = write_robot(Path(folder) / "robot")
        for name in ("block_dropped", "block_placed"):
            question = (str(main), "--property", name, *SAMPLED, "--jobs", "1")
            one = _least("experiment", *question, "--set", "drops=0.5")
            many = _least("experiment", *question, "--set", POINTS)
            ratios.append(f"{many / one:.0f}")
            times += [seconds(many), seconds(one)]
    method = (
        "100 estimates (± 0.01, 0.95) for the same robot, properties `block_dropped` and `block_placed`, compared with "
        f"the one at 0.5 ({listed(times)}); CPU time of the whole commands, minimum of {RUNS} runs"
    )
    return [Row("`experiment`, 100 estimates", f"{listed(ratios)} times", "at most 30 times", method)]


def _least(subcommand: str, *arguments: str) -> float:
    """The CPU time of a command in s, the minimum of several runs."""
    return min(call(*arguments, subcommand=subcommand).processor for _ in range(RUNS))


BENCHMARKS: dict[str, Benchmark] = {"experiment-exact": exact, "experiment-sampled": sampled}
