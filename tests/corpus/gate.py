# SPDX-License-Identifier: Apache-2.0
"""Sends complete systems through every command, as a user would: check, translate, verify with all methods, simulate,
draw, and the start of the debugger. The results are compared with each other, with Storm, with the kernel as plain
Python, and with the values that are known. Internal errors, refusals of systems without errors, and differences are
printed, and the exit status is then 1.

The systems are the examples, generated ones of several sizes, and those beside the project, if they are present: the
conformance models and the museum guide.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from dap_client import Client

import conformance
import prefork
from both_kernels import difference
from corpus.generated import generate
from corpus.parts import compose
from roaml import api

ROOT = Path(__file__).resolve().parents[2]
REAL = ROOT.parent / "shared" / "real"
TRUE_MISTAKES = (
    "SetTurnedSkill.ascxml:55",
    "GoToChargingStationSkill.ascxml:54",
    "PeopleDetectorFilterComponent.ascxml:51",
)
"""The mistakes in `uc3` that its authors made; an answer is missing where the request is lost."""
COMPOSED = 6
"""The number of systems of independent parts."""
TOLERANCE = 1e-6
METHODS: Mapping[str, tuple[str, ...]] = {
    "default": (),
    "fixed": ("--method", "fixed", "--max-traces", "20"),
    "adaptive": ("--method", "adaptive", "--epsilon", "0.2"),
    "okamoto": ("--method", "okamoto", "--epsilon", "0.2"),
    "separate": ("--method", "fixed", "--max-traces", "20", "--separate"),
    "lss": ("--scheduler", "lss", "--max-traces", "20", "--epsilon", "0.2"),
    "exhaustive": ("--exhaustive",),
    "all states": ("--exhaustive", "--no-reductions"),
}
"""Ways to verify a system."""


class System:
    """A complete system.

    Attributes:
        values: the known values of properties.
        mistakes: the places at which a check must report errors; a system with errors is only checked and drawn.
        is_large: whether its traces are cut early and few states are explored.
    """

    def __init__(
        self,
        name: str,
        main: Path,
        values: Mapping[str, float] | None = None,
        mistakes: tuple[str, ...] = (),
        *,
        is_large: bool = False,
    ) -> None:
        self.name, self.main, self.values, self.mistakes = name, main, values or {}, mistakes
        self.is_large = is_large

    @property
    def paths(self) -> tuple[str, ...]:
        """The options that name folders with interfaces."""
        is_conformance = conformance.ROOT in self.main.parents
        return ("--ros-path", str(conformance.INTERFACES)) if is_conformance else ()

    @property
    def limits(self) -> tuple[str, ...]:
        steps, states = ("3000", "2000") if self.is_large else ("50000", "50000")
        return ("--max-steps", steps, "--max-states", states)


def systems(folder: Path, sizes: Mapping[int, int]) -> Iterator[System]:
    """
    Args:
        folder: where generated systems are written.
        sizes: seed of a generated system -> the number of its copies of one machine.
    """
    for main in sorted((ROOT / "examples").glob("*/main*.xml")):
        yield System(f"{main.parent.name}/{main.name}", main)
    yield from generated(folder, sizes)
    yield from composed(folder, range(COMPOSED))
    for main in conformance.systems():
        yield System(conformance.label(main), main, is_large=True)
    if REAL.is_dir():
        yield System("uc3", REAL / "uc3" / "main_with_properties.xml", mistakes=TRUE_MISTAKES, is_large=True)
        yield System("uc3_mended", REAL / "uc3_mended" / "main.xml", is_large=True)


def generated(folder: Path, sizes: Mapping[int, int]) -> Iterator[System]:
    for seed, guides in sizes.items():
        made = generate(seed, guides)
        main = made.write(folder / f"generated_{seed}")
        yield System(f"generated {seed} with {guides} guides", main, made.values, is_large=guides > 5)


def composed(folder: Path, seeds: Iterable[int]) -> Iterator[System]:
    for seed in seeds:
        made = compose(seed)
        yield System(f"composed {seed}", made.write(folder / f"composed_{seed}"), made.values)


# ----------------------------------------------------------------------- steps


def run(*arguments: str, accepted: tuple[int, ...] = (0,)) -> tuple[str, str]:
    """Run a command; return its standard output and what is wrong with it, "" if nothing is."""
    done = subprocess.run([*prefork.command(), *arguments], capture_output=True, text=True, check=False)
    if done.returncode in accepted and "Traceback" not in done.stderr and "internal error" not in done.stderr:
        return done.stdout, ""
    last = (done.stderr or done.stdout).strip().splitlines()[-3:]
    return done.stdout, f"exit status {done.returncode}: {' | '.join(last)}"


def check(system: System) -> Iterator[str]:
    out, problem = run("--check", "--format", "json", *system.paths, str(system.main), accepted=(0, 1))
    if problem:
        yield problem
        return
    errors = {f"{Path(row['file']).name}:{row['line']}" for row in json.loads(out) if row["severity"] == "error"}
    yield from (f"{place} is not reported" for place in system.mistakes if place not in errors)
    if not system.mistakes:
        yield from (f"false error at {place}" for place in sorted(errors))


def translate(system: System) -> Iterator[str]:
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "model.jani")
        _, problem = run("translate", str(system.main), *system.paths, "-o", str(target))
        if problem:
            yield problem
        elif not json.loads(target.read_text(encoding="utf-8"))["automata"]:
            yield "the model has no automata"


def verify(system: System, names: tuple[str, ...] = tuple(METHODS)) -> Iterator[str]:
    """All methods give answers, which do not contradict each other or the known values."""
    known: dict[str, list[tuple[str, float, float]]] = {
        name: [("by construction", value, value)] for name, value in system.values.items()
    }
    for name in names:
        options = METHODS[name]
        arguments = [*options, *system.limits]
        if "--exhaustive" not in options:
            arguments = [*arguments[: arguments.index("--max-states")], "--confidence", "0.9999"]
        if system.is_large and not options:
            arguments += ["--max-traces", "20"]
        out, problem = run("verify", str(system.main), *system.paths, "--format", "json", *arguments, accepted=(0, 1))
        if problem:
            yield f"{name}: {problem}"
            continue
        for row in json.loads(out)["results"]:
            yield from (f"{name}: {problem}" for problem in _contradictions(row, name, known))


def _contradictions(
    row: dict[str, Any], method: str, known: dict[str, list[tuple[str, float, float]]]
) -> Iterator[str]:
    """What is wrong with a result. An estimate must have values in common with the range of all schedulers."""
    name = row["property"]
    if "error" in row:
        yield f"{name} is refused: {row['error']}"
        return
    exact = row.get("exact") or {}
    low, high = (exact["least"], exact["greatest"]) if "least" in exact else (row.get("lower"), row.get("upper"))
    if not isinstance(low, (int, float)) or not isinstance(high, (int, float)):
        return
    for other, least, greatest in known.setdefault(name, []):
        if low > greatest + TOLERANCE or high < least - TOLERANCE:
            yield f"{name} is in [{low}, {high}], but {other} in [{least}, {greatest}]"
    if "least" in exact:
        known[name].append((method, low, high))


def simulate(system: System) -> Iterator[str]:
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder, "run.svg")
        arguments = ("--max-steps", "2000", "--svg", str(picture))
        _, problem = run("simulate", str(system.main), *system.paths, *arguments, accepted=(0, 1))
        if problem:
            yield problem
        elif not picture.is_file():
            yield "no timeline was written"


def draw(system: System) -> Iterator[str]:
    for form in ("--graph", "--machines"):
        out, problem = run("draw", str(system.main), form, "-o", "-")
        if problem or "<svg" not in out:
            yield f"{form}: {problem or 'no picture'}"


def debug(system: System) -> Iterator[str]:
    with Client(validates=False) as client:
        options = {"rosPath": [str(conformance.INTERFACES)]} if system.paths else {}
        try:
            client.begin(system.main, **options)
            if not client.ask("threads")["threads"]:
                yield "there are no threads"
        except (AssertionError, EOFError) as error:
            yield f"the session does not start: {error}"


def kernels(system: System) -> Iterator[str]:
    """The compiled kernel and the same code as plain Python generate the same traces."""
    loaded = api.load(str(system.main), [str(conformance.INTERFACES)] if system.paths else [])
    checker = api.verifier(loaded).checker
    for property_ in checker.compiled_properties[:2]:
        for scheduler in (0, 3):
            found = difference(checker, property_, 1, 2, 150, scheduler)
            if found:
                yield found[:500]


def storm(system: System) -> Iterator[str]:
    """Storm, the search and traces agree where Storm can build the states."""
    if system.is_large:
        return
    from fixed_point import NotExactError  # noqa: PLC0415 - a module beside that of the next import
    from three_answers import answers  # noqa: PLC0415 - imports Storm

    loaded = api.load(str(system.main))
    for name in _names(loaded):
        try:
            found = list(answers(loaded, name, 20_000).differences())
        except (RuntimeError, NotExactError):
            continue  # Storm refuses this form of property, or its integers cannot represent the real variables
        yield from (f"{name}: {difference_}" for difference_ in found)


def _names(loaded: Any) -> list[str]:
    return [p.question.name for p in api.verifier(loaded).checker.compiled_properties if not p.question.is_reward]


Step = Callable[[System], Iterator[str]]
STEPS: Mapping[str, Step] = {
    "check": check,
    "draw": draw,
    "translate": translate,
    "verify": verify,
    "simulate": simulate,
    "debug": debug,
    "kernels": kernels,
    "storm": storm,
}


def problems(system: System, steps: Mapping[str, Step] = STEPS) -> Iterator[str]:
    """What fails for a system; a system with mistakes is only checked and drawn."""
    for name, step in steps.items():
        if not system.mistakes or name in ("check", "draw"):
            try:
                found = list(step(system))
            except Exception as error:  # whatever a step raises is what the gate looks for
                found = [f"{type(error).__name__}: {error}"]
            yield from (f"{system.name}: {name}: {problem}" for problem in found)


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="run.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", metavar="TEXT", help="only systems whose name contains this")
    parser.add_argument("--step", action="append", choices=list(STEPS), help="only this step; may be repeated")
    options = parser.parse_args()
    steps = {name: step for name, step in STEPS.items() if not options.step or name in options.step}
    failures = tried = 0
    with tempfile.TemporaryDirectory() as folder:
        for system in systems(Path(folder), {1: 1, 2: 2, 3: 3, 4: 30, 5: 60}):
            if options.only not in system.name:
                continue
            begun = time.monotonic()
            found = list(problems(system, steps))
            tried, failures = tried + 1, failures + len(found)
            print(f"{'FAILED' if found else 'passed'} {system.name} ({time.monotonic() - begun:.1f} s)", flush=True)
            for problem in found:
                print(f"  {problem}", flush=True)
    print(f"{tried} systems, {failures} problems")
    return 1 if failures or not tried else 0
