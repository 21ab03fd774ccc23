# SPDX-License-Identifier: Apache-2.0
"""Checks damaged models and says what went wrong. Exit code 1 if anything did."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from fuzz.cases import Case, Failure, make, run
from fuzz.corpus import snippets, systems
from fuzz.pairs import Outcome, choose, outcome


def main() -> int:
    parser = argparse.ArgumentParser(prog="run.py", description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="how many (1000)")
    parser.add_argument("--seed", type=int, default=0, help="the seed of the first; the others follow (0)")
    parser.add_argument("--case", type=int, metavar="SEED", help="only this one, with all that is known about it")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="with --case: write its files there")
    parser.add_argument("--pairs", type=int, metavar="N", help="this many pairs of mistakes instead, from --seed on")
    parser.add_argument("--slowest", type=int, default=3, metavar="N", help="name the slowest cases (3)")
    arguments = parser.parse_args()
    if arguments.case is not None:
        return one(make(arguments.case), arguments.keep)
    if arguments.pairs is not None:
        return pairs(range(arguments.seed, arguments.seed + arguments.pairs))
    return many(range(arguments.seed, arguments.seed + arguments.cases), arguments.slowest)


def many(seeds: range, slowest: int) -> int:
    print(f"{len(systems())} systems, {len(snippets())} snippets; seeds {seeds.start} to {seeds.stop - 1}", flush=True)
    kinds: dict[str, list[tuple[Case, Failure]]] = {}
    times: list[tuple[float, int]] = []
    started = time.perf_counter()
    for number, seed in enumerate(seeds, 1):
        before = time.perf_counter()
        case = make(seed)
        failures = run(case)
        times = sorted([*times, (time.perf_counter() - before, seed)], reverse=True)[:slowest]
        for failure in failures:
            if failure.kind not in kinds:
                print(f"seed {seed}, {case.model.name}: {failure.kind}\n{failure.details}", flush=True)
            kinds.setdefault(failure.kind, []).append((case, failure))
        if number % 1000 == 0:
            rate = number / (time.perf_counter() - started)
            print(f"{number} cases, {rate:.0f} a second, {len(kinds)} kinds of failure", flush=True)
    spent = time.perf_counter() - started
    print(f"{len(seeds)} cases in {spent:.0f} s: {len(seeds) / spent:.0f} a second")
    for seconds, seed in times:
        print(f"seed {seed} took {seconds:.2f} s")
    for kind, found in kinds.items():
        smallest = min(found, key=lambda f: sum(map(len, f[0].texts.values())))[0].seed
        print(f"{len(found)} cases, the smallest with seed {smallest}: {kind}")
    return 1 if kinds else 0


def pairs(seeds: range) -> int:
    """How many pairs of mistakes are reported as each is alone; those that are not, in words."""
    counts = dict.fromkeys(Outcome, 0)
    for number, seed in enumerate(seeds, 1):
        mistakes = choose(seed)
        found, details = outcome(*mistakes)
        counts[found] += 1
        if found is not Outcome.BOTH:
            shown = " and ".join(f"{mistake.file}, {mistake.what}" for mistake in mistakes)
            print(f"seed {seed}: {found.value}: {details}\n    {shown}", flush=True)
        if number % 500 == 0 or number == len(seeds):
            print(
                f"{number} pairs: " + ", ".join(f"{count} {each.value}" for each, count in counts.items()), flush=True
            )
    return 1 if counts[Outcome.LOST] else 0


def one(case: Case, folder: Path | None) -> int:
    failures = run(case)
    print(f"{case.model.name}: check of {case.main}", *case.damage, sep="\n    ")
    for path, text in case.texts.items():
        if case.model.texts.get(path) != text and len(text) < 3000:
            print(f"-- {path} --\n{text!a}" if not text.isprintable() and "\n" not in text else f"-- {path} --\n{text}")
    for failure in failures:
        print(f"{failure.kind}\n{failure.details}")
    if folder is not None:
        for path, text in case.texts.items():
            target = folder / Path(path).name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(text.encode("utf-8", "surrogatepass"))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    sys.exit(main())
