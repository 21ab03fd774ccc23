# SPDX-License-Identifier: Apache-2.0
"""Runs benchmarks and prints a table in Markdown."""

from __future__ import annotations

import argparse
import sys

from bench import check
from bench.report import Benchmark, machine, table

BENCHMARKS: dict[str, Benchmark] = {**check.BENCHMARKS}


def main() -> int:
    parser = argparse.ArgumentParser(prog="run.py", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(BENCHMARKS)}; all if none is given")
    names = parser.parse_args().names or list(BENCHMARKS)
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        parser.error(f"there is no benchmark {', '.join(unknown)}")
    rows = []
    for name in names:
        print(f"{name} …", file=sys.stderr, flush=True)
        rows += BENCHMARKS[name]()
    print(f"{table(rows)}\n\nMeasured with {machine()}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
