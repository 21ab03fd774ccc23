# SPDX-License-Identifier: Apache-2.0
"""How the time of a verification grows with the size of a model: `python run.py [SIZE...]`.

A robot on a grid of SIZE × SIZE cells and the behavior tree that brings it to its goal, verified by `as2fm-lsp verify`
(folder `robot`) and by BehaVerify with NuSMV (`grid.tree`). Each row of the table is the CPU time of whole commands,
with all processes that they start. `--plot` also draws these times. `--tools` installs what is missing of the other
tools into a folder: BehaVerify from PyPI, and NuSMV with `nusmv.sh`. Without it, tools that are not installed are
omitted, and the table says so.

    python run.py 10 20 40 80 160 --tools build/tools --plot scaling.svg
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import venv
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from roaml.figures.plot import LinePlot, PlotAxis, PlotPoint, Series, plot_svg
from roaml.figures.scales import ScaleKind

HERE = Path(__file__).resolve().parent
MAX_SIZE = 10_000
"""The maximum size: the parameter `size` of the robot allows no greater one."""
NOTES = (
    "as2fm-lsp estimates the probability to arrive to 0.01 with 95 percent confidence",
    "NuSMV explores all states of a model without ROS and time",
    "the abstract of the paper states, without numbers: linear growth for statistical model checking, exponential "
    "growth for exact model checking",
)


class Row(NamedTuple):
    """What was measured for one size: answers, and times in s; `None` for a tool that is not installed, and for a
    command without an answer."""

    size: int
    estimate: str
    time: float | None
    verdict: str = "not installed"
    translation: float | None = None
    exact_time: float | None = None

    def __str__(self) -> str:
        cells = f"{self.size} × {self.size}", *self[1:]
        return f"| {' | '.join(map(_cell, cells))} |"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sizes", nargs="*", type=int, default=[10, 20, 40, 80], metavar="SIZE")
    parser.add_argument("--as2fm", default=_beside(Path(sys.executable).parent, "as2fm-lsp"), metavar="COMMAND")
    parser.add_argument("--behaverify", default=shutil.which("behaverify"), metavar="COMMAND")
    parser.add_argument("--nusmv", default=shutil.which("NuSMV"), metavar="COMMAND")
    parser.add_argument("--tools", type=Path, metavar="DIR", help="install missing tools there")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw the times, as SVG")
    options = parser.parse_args(arguments)
    if any(not 2 <= size <= MAX_SIZE for size in options.sizes):
        parser.error(f"a size from 2 to {MAX_SIZE} is expected")
    if options.tools:
        try:
            options.behaverify, options.nusmv = installed(options.tools, options.behaverify, options.nusmv)
        except subprocess.CalledProcessError as error:
            print(f"BehaVerify or NuSMV cannot be installed: {error}; it is omitted without --tools", file=sys.stderr)
            return 1
    print("| cells | as2fm-lsp: estimate | time | BehaVerify with NuSMV: AF | translation | time |")
    print("| --- | --- | --- | --- | --- | --- |")
    rows = []
    for size in sorted(set(options.sizes)):
        row = Row(size, *estimated(size, options.as2fm))
        if options.behaverify and options.nusmv:
            row = row._replace(**model_checked(size, options.behaverify, options.nusmv))
        print(row, flush=True)
        rows.append(row)
    if options.plot:
        options.plot.write_text(plot_svg(plot(rows)), encoding="utf-8")
    return 0


def installed(folder: Path, behaverify: str | None, nusmv: str | None) -> tuple[str, str]:
    """The commands of both tools, installed into `folder` if they are missing."""
    program, built = folder / "behaverify/bin/behaverify", folder / "NuSMV"
    if not behaverify and not program.exists():
        venv.create(folder / "behaverify", with_pip=True)
        subprocess.run([folder / "behaverify/bin/python", "-m", "pip", "install", "-q", "behaverify"], check=True)
    if not nusmv and not built.exists():
        subprocess.run(["sh", HERE / "nusmv.sh", folder], check=True, stdout=sys.stderr)
    return behaverify or str(program.absolute()), nusmv or str(built.absolute())


def estimated(size: int, command: str) -> tuple[str, float | None]:
    """The estimate with its interval, and the time in s that it took."""
    options = ("--set", f"size={size}", "--method", "adaptive", "--scheduler", "uniform")
    seconds, output = timed([command, "verify", str(HERE / "robot/main.xml"), *options])
    found = re.search(r"^arrives: (.*?) from", output, re.MULTILINE)
    return (found[1], seconds) if found else ("no answer", None)


def model_checked(size: int, behaverify: str, nusmv: str) -> dict[str, object]:
    """The verdict, and the times in s of the translation and of the model checker."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = (HERE / "grid.tree").read_text(encoding="utf-8")
        assert "last := 9" in text
        (folder / "grid.tree").write_text(text.replace("last := 9", f"last := {size - 1}"), encoding="utf-8")
        translation, _ = timed([behaverify, "nuxmv", str(folder / "grid.tree"), str(folder / "smv"), "--generate"])
        (model,) = folder.glob("smv/**/*.smv")
        seconds, output = timed([nusmv, str(model)])
    found = re.search(r"^-- specification .* is (true|false)$", output, re.MULTILINE)
    if found is None:
        return {"verdict": "no answer", "translation": translation}
    return {"verdict": found[1], "translation": translation, "exact_time": seconds}


def plot(rows: Sequence[Row]) -> LinePlot:
    """The times by the size, with logarithmic scales, so that growth by a power of the size is a straight line."""
    lines = {
        "as2fm-lsp verify": [(row.size, row.time) for row in rows],
        "NuSMV": [(row.size, row.exact_time) for row in rows],
    }
    series = (
        Series(name, tuple(PlotPoint(size, time) for size, time in points if time is not None))
        for name, points in lines.items()
    )
    kind = ScaleKind.LOGARITHMIC
    x, y = PlotAxis("cells in a row of the grid", kind), PlotAxis("CPU time (s)", kind)
    title = "Time of a verification by the size of the grid"
    return LinePlot(title, x, y, tuple(line for line in series if line.points), NOTES)


def timed(command: Sequence[str]) -> tuple[float, str]:
    """The CPU time of a command with its processes, in s, and what it printed."""
    before = os.times()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    return max(seconds, 0.01), done.stdout + done.stderr


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.2f} s" if isinstance(value, float) else str(value)


def _beside(folder: Path, name: str) -> str:
    """A command of the environment that runs this script, or else one on the path."""
    return str(folder / name) if (folder / name).exists() else name


if __name__ == "__main__":
    sys.exit(main())
