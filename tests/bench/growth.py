# SPDX-License-Identifier: Apache-2.0
"""The growth of the time of a check with each dimension of a system, and of whole commands with the length of a file:
the second size is ten times the first one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from bench.report import Benchmark, Row, seconds
from fuzz.corpus import NOWHERE
from fuzz.growth import DIMENSIONS, Dimension
from roaml import api
from roaml.project.settings import Settings

LARGEST = 2000
"""The larger of the two sizes. Enormous systems are rejected, which takes no time at any size."""


def growth() -> list[Row]:
    rows = []
    for dimension in DIMENSIONS:
        size = min(LARGEST, dimension.most)
        small, large = (_time(dimension, length) for length in (max(1, size // 10), size))
        method = f"{dimension.name}: {size // 10:,} and {size:,}; `api.check` of one system"
        rows.append(Row("check, growth", f"{seconds(small)}, {seconds(large)}", "at most ten times", method))
    return rows


def _time(dimension: Dimension, size: int) -> float:
    """CPU time in s, the best of three runs."""
    texts = dimension.texts(size)
    times = []
    for _ in range(3):
        before = time.process_time()
        api.check([os.path.join(NOWHERE, "main.xml")], [], Settings(), texts)
        times.append(time.process_time() - before)
    return min(times)


class LongFile(NamedTuple):
    """A file that a command reads. `text` is the text of a file with a number of parts."""

    name: str
    parts: str
    text: Callable[[int], str]
    most: int
    arguments: tuple[str, ...]


def long_files() -> list[Row]:
    """Files that people do not write, but that may come with a workspace that is not trusted."""
    rows = []
    for file in _FILES:
        small, large = _command_time(file, file.most // 10), _command_time(file, file.most)
        method = f"`{' '.join(file.arguments)}`: {file.most // 10:,} and {file.most:,} {file.parts}; CPU time, whole"
        rows.append(Row("long files", f"{seconds(small)}, {seconds(large)}", "at most ten times", method))
    return rows


def _command_time(file: LongFile, parts: int) -> float:
    """CPU time of a command in s, the best of three runs."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, file.name).write_text(file.text(parts), encoding="utf-8")
        times = []
        for _ in range(3):
            command = [sys.executable, "-m", "as2fm_lsp", *file.arguments]
            process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            _, _, usage = os.wait4(process.pid, 0)
            times.append(usage.ru_utime + usage.ru_stime)
    return min(times)


def _keys(number: int) -> str:
    return "[verify.expect]\n" + "".join(f'a{i}.b.c = ">= 1"\n' for i in range(number))


def _branches(number: int) -> str:
    branches = "".join(f'<elseif cond="x == {i}"/><assign location="x" expr="{i}"/>' for i in range(1, number))
    return (
        '<ascxml name="A" version="1.0" initial="a"><datamodel><data id="x" type="int32" expr="0"/></datamodel>'
        '<state id="a"><transition event="go" target="a"><if cond="x == 0"><assign location="x" expr="1"/>'
        f"{branches}</if></transition></state></ascxml>"
    )


def _repeated(number: int) -> str:
    times = '<max_time value="1" unit="s"/>' * number
    return f"<convince_mc_tc><mc_parameters>{times}</mc_parameters></convince_mc_tc>"


def _edges(number: int) -> str:
    def edge(i: int) -> dict[str, object]:
        guard = {"op": "=", "left": "x", "right": i}
        way = {"location": "s", "assignments": [{"ref": "x", "value": i + 1}]}
        return {"location": "s", "guard": {"exp": guard}, "destinations": [way]}

    reached = {"op": "Pmax", "exp": {"op": "F", "exp": {"op": "=", "left": "x", "right": 5}}}
    expression = {"op": "filter", "fun": "values", "values": reached, "states": {"op": "initial"}}
    automaton = {
        "name": "A",
        "locations": [{"name": "s"}],
        "initial-locations": ["s"],
        "edges": [edge(i) for i in range(number)],
    }
    model = {
        "jani-version": 1,
        "name": "edges",
        "type": "mdp",
        "variables": [{"name": "x", "type": "int", "initial-value": 0}],
        "automata": [automaton],
        "system": {"elements": [{"automaton": "A"}]},
        "properties": [{"name": "p", "expression": expression}],
    }
    return json.dumps(model)


_FILES = (
    LongFile("as2fm.toml", "dotted keys", _keys, 20_000, ("--check", "as2fm.toml")),
    LongFile("a.ascxml", "branches of one `<if>`", _branches, 20_000, ("--check", "a.ascxml")),
    LongFile("main.xml", "repeated parameters", _repeated, 30_000, ("migrate", "main.xml", "--diff")),
    LongFile("model.jani", "edges", _edges, 100_000, ("verify", "model.jani")),
)

BENCHMARKS: dict[str, Benchmark] = {"dimensions": growth, "long-files": long_files}
