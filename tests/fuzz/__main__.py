# SPDX-License-Identifier: Apache-2.0
"""Runs hostile input and reports failures. The exit status is 1 if there are any.

A case may take 2 s of the CPU time of its process for each command that it runs, and 500 MB. CPU time is measured
instead of elapsed time, because other work on the machine makes a case wait. Other work also makes a case slower
(shared caches, hyperthreads). So a case that runs out of time is run again, and is a failure only if it runs out of
time each time. A process that does not return within 300 s of elapsed time hangs and is ended.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from as2fm_lsp.collector import spare_the_collector
from fuzz.pairs import Outcome, choose, outcome
from fuzz.runner import Ran, run, run_all
from fuzz.strategies import plan, strategies
from fuzz.strategy import Case, Failure, Strategy


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="run.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cases", type=int, default=1000, help="how many, of all strategies together (1000)")
    parser.add_argument("--seed", type=int, default=0, help="the seed of the first of each; the others follow (0)")
    parser.add_argument(
        "--strategy",
        action="append",
        choices=list(strategies()),
        metavar="NAME",
        help=f"only this one, may be repeated; there are {', '.join(strategies())}",
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (one for each processor)")
    parser.add_argument("--case", metavar="NAME:SEED", help="only this case, with all that is known about it")
    parser.add_argument("--unlimited", action="store_true", help="with --case: let it take what it takes")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="with --case: write its files there")
    parser.add_argument("--pairs", type=int, metavar="N", help="this many pairs of mistakes instead, from --seed on")
    parser.add_argument("--slowest", type=int, default=3, metavar="N", help="name the slowest cases (3)")
    arguments = parser.parse_args()
    spare_the_collector()  # as the server does
    if arguments.case is not None:
        name, _, seed = arguments.case.rpartition(":")
        if name not in strategies() or not seed.isdecimal():
            parser.error(f"{arguments.case} is not NAME:SEED; there are {', '.join(strategies())}")
        return one(name, int(seed), not arguments.unlimited, arguments.keep)
    if arguments.pairs is not None:
        return pairs(range(arguments.seed, arguments.seed + arguments.pairs))
    chosen = tuple(strategies()[name] for name in arguments.strategy or strategies())
    return many(chosen, arguments.cases, arguments.seed, arguments.jobs, arguments.slowest)


def many(chosen: Sequence[Strategy], cases: int, first: int, jobs: int, slowest: int) -> int:
    for strategy in chosen:
        strategy.make(first)  # what it reads is read once, before there are several processes
    shares = plan(cases, tuple(chosen))
    print(f"{', '.join(f'{count} {name}' for name, count in shares)}; seeds from {first}", flush=True)
    kinds: dict[str, list[tuple[Ran, Failure]]] = {}
    done: list[Ran] = []
    started = time.perf_counter()
    for ran in run_all(_in_turn(shares, first), jobs):
        done.append(ran)
        for failure in ran.failures:
            details = f"\n{failure.details}" if failure.kind not in kinds else ""
            print(f"{ran.name}, {ran.title}: {failure.kind}{details}", flush=True)
            kinds.setdefault(failure.kind, []).append((ran, failure))
        if len(done) % 1000 == 0:
            rate = len(done) / (time.perf_counter() - started)
            print(f"{len(done)} cases, {rate:.0f} a second, {len(kinds)} kinds of failure", flush=True)
    spent = time.perf_counter() - started
    print(f"{len(done)} cases in {spent:.0f} s on {jobs} processes: {len(done) / spent:.0f} a second")
    for ran in sorted(done, key=lambda case: -case.seconds)[:slowest]:
        print(f"{ran.name} took {ran.seconds:.2f} s")
    for kind, failures in kinds.items():
        smallest = min(failures, key=lambda case: case[0].size)[0].name
        print(f"{len(failures)} cases, the smallest is {smallest}: {kind}")
    return 1 if kinds else 0


def pairs(seeds: range) -> int:
    """The number of pairs of errors that are reported as each error alone, and a description of the other pairs."""
    counts = dict.fromkeys(Outcome, 0)
    for number, seed in enumerate(seeds, 1):
        mistakes = choose(seed)
        result, details = outcome(*mistakes)
        counts[result] += 1
        if result is not Outcome.BOTH:
            shown = " and ".join(f"{mistake.file}, {mistake.what}" for mistake in mistakes)
            print(f"seed {seed}: {result.value}: {details}\n    {shown}", flush=True)
        if number % 500 == 0 or number == len(seeds):
            print(
                f"{number} pairs: " + ", ".join(f"{count} {kind.value}" for kind, count in counts.items()), flush=True
            )
    return 1 if counts[Outcome.LOST] else 0


def _in_turn(shares: Sequence[tuple[str, int]], first: int) -> Iterator[tuple[str, int]]:
    """The cases of all strategies, mixed so that each strategy is distributed evenly over the run."""
    cases = [((number + 0.5) / count, name, first + number) for name, count in shares for number in range(count)]
    return ((name, seed) for _, name, seed in sorted(cases))


def one(name: str, seed: int, bounded: bool, folder: Path | None) -> int:
    case = strategies()[name].make(seed)
    print(*case.description(), sep="\n    ")
    _show(case)
    if folder is not None:
        _keep(case, folder)
    ran = run(name, seed, bounded)
    for failure in ran.failures:
        print(f"{failure.kind}\n{failure.details}")
    print(f"{ran.seconds:.2f} s")
    return 1 if ran.failures else 0


def _show(case: Case) -> None:
    for path, text in case.files().items():
        if len(text) < 3000:
            plain = isinstance(text, str) and (text.isprintable() or "\n" in text)
            print(f"-- {path} --\n{text if plain else ascii(text)}")


def _keep(case: Case, folder: Path) -> None:
    paths = list(case.files())
    base = os.path.commonpath([os.path.dirname(path) for path in paths]) if paths else ""
    for path, text in case.files().items():
        target = folder / os.path.relpath(path, base)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text)


if __name__ == "__main__":
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    sys.exit(main())
