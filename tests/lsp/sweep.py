#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sends every request that the server supports at every 7th character of the examples, the conformance models and
further systems. The exit status is 1 if an answer is wrong.

    python tests/lsp/sweep.py [MAIN.xml ...]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "lsp"), str(TESTS.parent / "server")]


def main(named: list[str]) -> int:
    from lsp_sweep import Sweep  # noqa: PLC0415 - the folders above come first

    import conformance  # noqa: PLC0415

    mains = [Path(name).resolve() for name in named] or [
        *sorted((TESTS.parent / "examples").glob("*/main.xml")),
        *conformance.systems(),
    ]
    ros_paths = [str(conformance.INTERFACES)] if conformance.PRESENT else []
    asked = failed = 0
    started = time.perf_counter()
    for path in mains:
        sweep = Sweep(path, ros_paths)
        for failure in sweep.failures():
            failed += 1
            print(failure, flush=True)
        asked += sweep.asked
        print(f"{path}: {sweep.asked} requests of {len(sweep.methods)} methods", file=sys.stderr, flush=True)
    spent = time.perf_counter() - started
    print(f"{asked} requests about {len(mains)} systems, {failed} failures, {spent:.0f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
