#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renames each symbol of the examples, the conformance models and further systems. The exit status is 1 if an invariant
is violated.

    python tests/ide/sweep.py [MAIN.xml ...]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "ide"), str(TESTS.parent / "server")]


def main(named: list[str]) -> int:
    from ide_sweep import System  # noqa: PLC0415

    import conformance  # noqa: PLC0415 - the folders above come first

    mains = named or [
        *map(str, sorted((TESTS.parent / "examples").glob("*/main.xml"))),
        *map(str, conformance.systems()),
    ]
    count, failed, started = 0, 0, time.perf_counter()
    for path in mains:
        system = System(path, (str(conformance.INTERFACES),) if conformance.PRESENT else ())
        for case in system.cases():
            count += 1
            for failure in system.failures(case):
                failed += 1
                print(f"{path}: {case.name}: {failure}", flush=True)
    print(f"{count} things in {len(mains)} systems, {failed} failures, {time.perf_counter() - started:.0f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
