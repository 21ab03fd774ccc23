# SPDX-License-Identifier: Apache-2.0
"""Compares the layouts of graphs with those of ELK (`elkjs`, layered, with wrapping): crossings, area, length of lines.

    npm install elkjs                               in any folder
    PYTHONPATH=tests python -m bench.layouts FOLDER  FOLDER contains node_modules/elkjs

Both lay out the same 20 graphs, of 5 to 200 nodes, with the same sizes of nodes and labels.
"""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from itertools import combinations, pairwise
from pathlib import Path
from typing import NamedTuple, TypeAlias

from roaml.figures.geometry import Extent
from roaml.figures.layout import LayoutDirection, Link, layered

ASPECT = 1.3
NODE, LABEL = Extent(110, 44), Extent(80, 24)
Graph: TypeAlias = tuple[int, list[tuple[int, int]]]
Line: TypeAlias = Sequence[tuple[float, float]]


class Quality(NamedTuple):
    """The number of crossings of lines, the area in megapixels, the length of all lines in pixels, and the ratio of the
    longer to the shorter side."""

    crossings: int
    area: float
    length: float
    ratio: float


def graphs() -> dict[str, Graph]:
    """20 graphs: chains, rings, stars, trees, grids, and random ones as of state machines."""
    made: dict[str, Graph] = {}
    for count in (5, 12, 30, 64, 200):
        made[f"chain {count}"] = (count, [(n, n + 1) for n in range(count - 1)])
    for count in (12, 30, 64):
        made[f"ring {count}"] = (count, [(n, (n + 1) % count) for n in range(count)])
    for count in (12, 30):
        made[f"star {count}"] = (count, [(0, n) for n in range(1, count)])
    for count in (30, 64):
        made[f"tree {count}"] = (count, [((n - 1) // 3, n) for n in range(1, count)])
    for side in (4, 6):
        across = [(n, n + 1) for n in range(side * side) if n % side < side - 1]
        made[f"grid {side * side}"] = (side * side, across + [(n, n + side) for n in range(side * (side - 1))])
    for count in (8, 16, 24, 40, 64, 100):
        chance = random.Random(count)
        forwards = [(chance.randrange(max(0, n - 4), n), n) for n in range(1, count)]
        back = [(n, chance.randrange(n)) for n in range(1, count) if chance.random() < 0.3]
        made[f"random {count}"] = (count, forwards + [pair for pair in back if pair not in forwards])
    return made


def compare(folder: str) -> list[tuple[str, Quality, Quality]]:
    """Each graph with the quality of our layout and of that of ELK."""
    named = graphs()
    asked = [
        {
            "nodes": [[str(n), *NODE] for n in range(count)],
            "links": [[str(a), str(b), *LABEL] for a, b in ends],
            "aspect": ASPECT,
        }
        for count, ends in named.values()
    ]
    node = shutil.which("node")
    if node is None:
        raise SystemExit("Node.js is needed")
    script = Path(__file__).with_name("layouts.mjs")
    done = subprocess.run(
        [node, script], input=json.dumps(asked), cwd=folder, capture_output=True, text=True, check=True
    )
    rows = []
    for (name, (count, ends)), elk in zip(named.items(), json.loads(done.stdout), strict=True):
        links = [Link(str(a), str(b), LABEL) for a, b in ends]
        layout = layered({str(n): NODE for n in range(count)}, links, LayoutDirection.DOWN, ASPECT)
        ours = [[[(p.x, p.y) for p in part] for part in route.parts] for route in layout.routes]
        rows.append((name, quality(*layout.size, ours), quality(elk["width"], elk["height"], elk["lines"])))
    return rows


def quality(width: float, height: float, lines: Iterable[Iterable[Line]]) -> Quality:
    links = [[piece for part in parts for piece in pairwise(part)] for parts in lines]
    crossings = sum(_cross(a, b) for one, other in combinations(links, 2) for a in one for b in other)
    length = sum(abs(x - u) + abs(y - v) for link in links for (x, y), (u, v) in link)
    return Quality(crossings, width * height / 1e6, length, max(width / height, height / width))


def _cross(one: Sequence[Sequence[float]], other: Sequence[Sequence[float]]) -> bool:
    """Whether a horizontal and a vertical piece cross."""
    flat, steep = (one, other) if one[0][1] == one[1][1] else (other, one)
    if flat[0][1] != flat[1][1] or steep[0][0] != steep[1][0]:
        return False
    (left, right), (top, bottom) = sorted((flat[0][0], flat[1][0])), sorted((steep[0][1], steep[1][1]))
    return left < steep[0][0] < right and top < flat[0][1] < bottom


def main(folder: str) -> None:
    rows = compare(folder)
    print(f"{'graph':<12}{'crossings':>16}{'area, Mpx':>18}{'length, px':>20}{'ratio':>14}")
    for name, ours, elk in rows:
        print(
            f"{name:<12}{ours.crossings:>8}{elk.crossings:>8}{ours.area:>10.2f}{elk.area:>8.2f}"
            f"{ours.length:>12,.0f}{elk.length:>10,.0f}{ours.ratio:>8.1f}{elk.ratio:>6.1f}"
        )
    for index, what in enumerate(("crossings", "area", "length")):
        better = sum(ours[index] <= elk[index] for _, ours, elk in rows)
        print(f"{what}: at most that of ELK in {better} of {len(rows)}")


if __name__ == "__main__":
    main(sys.argv[1])
