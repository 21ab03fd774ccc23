# SPDX-License-Identifier: Apache-2.0
"""Runs benchmarks and prints a table in Markdown."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bench import (
    asked,
    check,
    debug,
    experiments,
    growth,
    observers,
    planted,
    qvbs,
    reductions,
    requests,
    scan,
    sharing,
    states,
    steps,
    storm,
    translate,
    trees,
    verify,
)
from bench.report import Benchmark, machine, table

BENCHMARKS: dict[str, Benchmark] = {
    **asked.BENCHMARKS,
    **check.BENCHMARKS,
    **debug.BENCHMARKS,
    **experiments.BENCHMARKS,
    **growth.BENCHMARKS,
    **observers.BENCHMARKS,
    **planted.BENCHMARKS,
    **qvbs.BENCHMARKS,
    **reductions.BENCHMARKS,
    **requests.BENCHMARKS,
    **scan.BENCHMARKS,
    **sharing.BENCHMARKS,
    **translate.BENCHMARKS,
    **states.BENCHMARKS,
    **steps.BENCHMARKS,
    **storm.BENCHMARKS,
    **trees.BENCHMARKS,
    **verify.BENCHMARKS,
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="run.py", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(BENCHMARKS)}; all if none is given")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw how translations grow, as SVG")
    parser.add_argument("--plots", type=Path, metavar="DIR", help="draw how verification grows, as SVG files")
    parser.add_argument("--record", type=Path, metavar="FILE",
                        help="keep the numbers of state-counts, and continue from them")  # fmt: skip
    parser.add_argument("--page", type=Path, metavar="FILE", help="replace the table of state-counts in a page")
    options = parser.parse_args()
    names = options.names or [name for name in BENCHMARKS if scan.program() or name not in scan.BENCHMARKS]
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        parser.error(f"there is no benchmark {', '.join(unknown)}")
    rows = []
    for name in names:
        print(f"{name} …", file=sys.stderr, flush=True)
        is_counted = name in reductions.BENCHMARKS
        rows += reductions.rows(options.record, options.page) if is_counted else BENCHMARKS[name]()
    if options.plot:
        options.plot.write_text(translate.diagram(), encoding="utf-8")
    for name, text in verify.diagrams().items() if options.plots else ():
        (options.plots / name).write_text(text, encoding="utf-8")
    print(f"{table(rows)}\n\nMeasured with {machine()}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
