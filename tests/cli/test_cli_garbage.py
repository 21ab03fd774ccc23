# SPDX-License-Identifier: Apache-2.0
"""The objects in cycles that a command leaves do not grow with its work, because it runs without the collector."""

from __future__ import annotations

import gc
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from command import Command

import clock

MARGIN = 100
"""The objects in cycles that may differ between two commands: those of messages and caches of a few names."""


def coin(folder: Path, edges: int) -> None:
    """A model whose automaton has a number of edges."""
    tossed = [{"location": "t", "probability": {"exp": 0.5}}, {"location": "h", "probability": {"exp": 0.5}}]
    names = [{"name": name} for name in ("s", "t", "h")]
    reached = {"op": "F", "exp": {"op": "=", "left": "x", "right": 1}}
    values = {"op": "filter", "fun": "values", "values": {"op": "Pmax", "exp": reached}, "states": {"op": "initial"}}
    automaton = {
        "name": "A",
        "locations": names,
        "initial-locations": ["s"],
        "edges": [
            {"location": "s", "guard": {"exp": {"op": "=", "left": "x", "right": i}}, "destinations": tossed}
            for i in range(edges)
        ],
    }
    model = {
        "jani-version": 1,
        "name": "m",
        "type": "mdp",
        "variables": [{"name": "x", "type": "int", "initial-value": 0}],
        "automata": [automaton],
        "system": {"elements": [{"automaton": "A"}]},
        "properties": [{"name": "p", "expression": values}],
    }
    (folder / "m.jani").write_text(json.dumps(model))


def machines(folder: Path, number: int) -> None:
    """A system with a number of machines."""
    clock.write(folder)
    copies = ""
    for i in range(number):
        (folder / f"c{i}.ascxml").write_text(clock.CLOCK.replace('name="Clock"', f'name="Clock{i}"'))
        copies += f'<input type="node-ascxml" src="c{i}.ascxml" />'
    (folder / "main.xml").write_text(clock.MAIN.replace("<node_models>", f"<node_models>{copies}"))


WORK: dict[str, tuple[Callable[[Path, int], None], int, Callable[[int], list[str]]]] = {
    "edges": (coin, 40, lambda _: ["verify", "m.jani"]),
    "traces": (coin, 2000, lambda n: ["verify", "m.jani", "--method=fixed", f"--max-traces={n}", "--jobs=1"]),
    "checked machines": (machines, 4, lambda _: ["--check", "."]),
    "translated machines": (machines, 4, lambda _: ["translate", "main.xml", "-o", "model.jani"]),
}
"""What grows -> what writes the files, the smaller size, and the arguments for a size."""


@pytest.mark.parametrize("name", WORK)
def test_cycles_do_not_grow(command: Command, tmp_path: Path, name: str) -> None:
    write, size, arguments = WORK[name]
    left = []
    for length in (size, size, 10 * size):  # the first command fills caches
        write(tmp_path, 1 if name == "traces" else length)
        gc.collect()
        gc.disable()
        try:
            assert command(*arguments(length)).status in (0, 1)
            left.append(gc.collect())
        finally:
            gc.enable()
    assert left[2] <= left[1] + MARGIN, left
