# SPDX-License-Identifier: Apache-2.0
"""Sends complete systems through every command, as a user would: check, translate, verify with all methods, simulate,
draw, and the start of the debugger. The results are compared with each other, with Storm, with the kernel as plain
Python, and with the values that are known. Internal errors, refusals of systems without errors, and differences are
printed, and the exit status is then 1.

The systems are the examples, generated ones of several sizes, trees without a system, and those beside the project, if
they are present: the conformance models and the museum guide; with --networks also random networks in JANI, which have
only the steps `kernels` and `storm`.

The step `storm` compares the minimum and the maximum of each property for the reaction times `any`, `instant`, and one
and two steps of the clock. What is too large for it, or is refused by Storm, is printed and counted. All conformance
models within 10 minutes and 16 GB for each property, and 300 networks:

  run.py --step storm --storm-seconds 600 --storm-memory 16 --max-states 5000000 --networks 300 --resume FILE

This writes a page of the documentation from such files:

  run.py --page docs/spec/storm.md --resume FILE --resume FILE
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dap_client import Client

import conformance
import prefork
from both_kernels import difference
from corpus.forest import grow
from corpus.generated import generate
from corpus.judgements import COLUMNS, DIFFERENT, EQUAL, REFUSED, TOO_LARGE, Judgement, page, read
from corpus.parts import PARTS, compose
from corpus.robots import Make
from roaml import api
from roaml.durations import ANY_TIME, AT_ONCE, ReactionTime
from roaml.jani.reaction import reacting
from roaml.record import replace
from roaml.smc import kernel

if TYPE_CHECKING:
    from storm import Exact

ROOT = Path(__file__).resolve().parents[2]
REAL = ROOT.parent / "shared" / "real"
TRUE_MISTAKES = (
    "SetTurnedSkill.ascxml:55",
    "GoToChargingStationSkill.ascxml:54",
    "PeopleDetectorFilterComponent.ascxml:51",
)
"""The mistakes in `uc3` that its authors made; an answer is missing where the request is lost."""
COMPOSED = 40
"""The number of systems of several independent parts."""
TREES = 100
"""The number of trees without a system."""
OF_TREES = ("exhaustive", "default", "fixed")
"""The methods of trees: the exact value, if there is one, is compared with the estimates."""
TOLERANCE = 1e-6
MAX_SECONDS = 1800
"""The time in s after which a command counts as one that does not end."""
IS_PLAIN = (kernel.__file__ or "").endswith(".py")
"""Whether the library runs as plain Python, which takes 50 times as long."""
SCHEDULERS = "lss"
"""The method that tries hundreds of schedulers with many traces each, so its traces are short, of one property."""
METHODS: Mapping[str, tuple[str, ...]] = {
    "default": (),
    "fixed": ("--method", "fixed", "--max-traces", "20"),
    "adaptive": ("--method", "adaptive", "--epsilon", "0.2"),
    "okamoto": ("--method", "okamoto", "--epsilon", "0.2"),
    "separate": ("--method", "fixed", "--max-traces", "20", "--separate"),
    SCHEDULERS: ("--scheduler", "lss", "--method", "fixed", "--max-traces", "20"),
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
        judged: the comparisons with Storm.
        seconds: step -> its elapsed time in s.
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
        self.judged: list[Judgement] = []
        self.seconds: dict[str, float] = {}

    @property
    def paths(self) -> tuple[str, ...]:
        """The options that name folders with interfaces."""
        is_conformance = conformance.ROOT in self.main.parents
        return ("--ros-path", str(conformance.INTERFACES)) if is_conformance else ()

    def limits(self, method: str) -> Iterator[str]:
        """The options that keep a method short."""
        steps = 300 if method == SCHEDULERS else 2_000 if self.is_large else 20_000
        states = 2_000 if self.is_large else 30_000
        if IS_PLAIN:
            steps, states = steps // 20, states // 20
        if "--exhaustive" in METHODS[method]:
            yield from ("--max-states", str(states))
            return
        yield from ("--max-steps", str(steps), "--confidence", "0.9999")
        if method == "default":
            yield from ("--max-states", str(states), *(("--max-traces", "20") if self.is_large or IS_PLAIN else ()))
        else:
            yield from ("--jobs", "1")
        if method == SCHEDULERS:
            yield from ("--property", self.names[0])

    @cached_property
    def names(self) -> list[str]:
        """The names of the properties that have a probability."""
        checker = api.verifier(self.subject(ANY_TIME)).checker
        return [p.question.name for p in checker.compiled_properties if not p.question.is_reward]

    def subject(self, time: ReactionTime) -> api.LoadedSystem | api.Model:
        """The system with a reaction time."""
        return api.load(str(self.main), self.paths[1:], overrides=api.Overrides(reaction_time=time))

    @cached_property
    def times(self) -> dict[str, ReactionTime]:
        """Column of the page -> the reaction time; `any` alone if the system has no clock."""
        subject = self.subject(ANY_TIME)
        model = subject if isinstance(subject, api.Model) else api.to_jani(subject, [])
        if model.metadata is None or model.metadata.clock is None:
            return {COLUMNS[0]: ANY_TIME}
        step = model.metadata.clock.step
        return dict(zip(COLUMNS, (ANY_TIME, ReactionTime(2 * step), ReactionTime(step), AT_ONCE), strict=True))


class LoneTree(System):
    """A tree without a system, with mocks in the file beside it (`forest`)."""


class RandomNetwork(System):
    """A random network with a clock (`clocked_networks`)."""

    def __init__(self, number: int, model: api.Model, *, is_local: bool) -> None:
        super().__init__(f"network {number}", Path())
        self.model, self.is_local = model, is_local

    def subject(self, time: ReactionTime) -> api.Model:
        return reacting(self.model, time)

    @cached_property
    def times(self) -> dict[str, ReactionTime]:
        """Durations only if guards read only variables of their automaton, as in systems."""
        return super().times if self.is_local else {COLUMNS[0]: ANY_TIME, COLUMNS[-1]: AT_ONCE}


def networks(count: int) -> Iterator[RandomNetwork]:
    """The same networks each time."""
    if not count:
        return
    from clocked_networks import clocked  # noqa: PLC0415 - imports hypothesis
    from hypothesis import HealthCheck, Phase, given, seed, settings  # noqa: PLC0415
    from test_reaction_time import is_local  # noqa: PLC0415 - a module of the same folder

    models: list[api.Model] = []

    @seed(1)
    @settings(max_examples=count, database=None, deadline=None, phases=[Phase.generate],
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(clocked())
    def collect(model: api.Model) -> None:
        # Storm refuses vectors in which no automaton takes part.
        vectors = tuple(sync for sync in model.system.syncs if sync.participants)
        models.append(replace(model, system=replace(model.system, syncs=vectors)))

    collect()
    yield from (RandomNetwork(number, model, is_local=is_local(model)) for number, model in enumerate(models))


def systems(folder: Path, sizes: Mapping[int, int]) -> Iterator[System]:
    """
    Args:
        folder: where generated systems are written.
        sizes: seed of a generated system -> the number of its copies of one machine.
    """
    for main in sorted((ROOT / "examples").glob("*/main*.xml")):
        yield System(f"{main.parent.name}/{main.name}", main)
    yield from generated(folder, sizes)
    yield from alone(folder, PARTS)
    yield from composed(folder, range(COMPOSED))
    yield from lone_trees(folder, range(TREES))
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


def alone(folder: Path, parts: Iterable[Make]) -> Iterator[System]:
    """A system of each part alone, which is small enough for Storm."""
    for make in parts:
        name = make.__name__.strip("_")
        made = compose(1, make)
        yield System(f"part {name}", made.write(folder / f"part_{name}"), made.values)


def lone_trees(folder: Path, seeds: Iterable[int]) -> Iterator[LoneTree]:
    for seed in seeds:
        yield LoneTree(f"tree {seed}", grow(seed).write(folder / f"tree_{seed}"), is_large=True)


def composed(folder: Path, seeds: Iterable[int]) -> Iterator[System]:
    for seed in seeds:
        made = compose(seed)
        yield System(f"composed {seed}", made.write(folder / f"composed_{seed}"), made.values)


# ----------------------------------------------------------------------- steps


def run(*arguments: str, accepted: tuple[int, ...] = (0,)) -> tuple[str, str]:
    """Run a command; return its standard output and what is wrong with it, "" if nothing is."""
    try:
        done = subprocess.run(
            [*prefork.command(), *arguments], capture_output=True, text=True, check=False, timeout=MAX_SECONDS
        )
    except subprocess.TimeoutExpired:
        return "", f"does not end within {MAX_SECONDS} s"
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
    for name in OF_TREES if isinstance(system, LoneTree) else names:
        arguments = [*METHODS[name], *system.limits(name)]
        out, problem = run("verify", str(system.main), *system.paths, "--format", "json", *arguments, accepted=(0, 1))
        if problem:
            yield f"{name}: {problem}"
            continue
        rows = json.loads(out)["results"]
        if not rows:
            yield f"{name}: no property has a result"
        for row in rows:
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
    for form in ("--tree",) if isinstance(system, LoneTree) else ("--graph", "--machines"):
        out, problem = run("draw", str(system.main), form, "-o", "-")
        if problem or "<svg" not in out:
            yield f"{form}: {problem or 'no picture'}"


def debug(system: System) -> Iterator[str]:
    with Client(validates=False) as client:
        options = {"rosPath": list(system.paths[1:])} if system.paths else {}
        try:
            client.begin(system.main, **options)
            if not client.ask("threads")["threads"]:
                yield "there are no threads"
        except (AssertionError, EOFError) as error:
            yield f"the session does not start: {error}"


def kernels(system: System) -> Iterator[str]:
    """The compiled kernel and the same code as plain Python generate the same traces."""
    checker = api.verifier(system.subject(ANY_TIME)).checker
    for property_ in checker.compiled_properties[:2]:
        for scheduler in (0, 3):
            found = difference(checker, property_, 1, 2, 150, scheduler)
            if found:
                yield found[:500]


def storm(system: System) -> Iterator[str]:
    """Storm, the search and traces agree for each reaction time; a shorter one does not widen the range of values."""
    for name in system.names:
        before: tuple[float, float] | None = None
        is_searched = True
        for column, reaction in system.times.items():
            if not is_searched and reaction != AT_ONCE:
                # Each state with the counters that a duration needs.
                system.judged.append(Judgement(name, column, TOO_LARGE, f"more than {JUDGE[0].states:,}, as before"))
                continue
            found, values = _judged(system, name, column, reaction)
            is_searched = values is not None
            yield from (f"{name}, reaction time {reaction.text}: {problem}" for problem in found)
            if before and values and (values[0] < before[0] - TOLERANCE or values[1] > before[1] + TOLERANCE):
                yield f"{name}: {values} for the reaction time {reaction.text}, {before} for a longer one"
            before = values or before


class JudgeLimits(NamedTuple):
    """Limits of the step `storm` for one property and reaction time: CPU time of Storm in s, memory in GB, and states
    of the search."""

    seconds: int = 10
    memory: int = 6
    states: int = 20_000

    @property
    def text(self) -> str:
        """As a sentence of the page."""
        return (
            f"Limits for each property and reaction time: {self.states:,} states of the search, {self.seconds} s of "
            f"CPU time, and {self.memory} GB for Storm.\nA cell without an answer names the limit that was reached, "
            "which is lower where a system was compared within less."
        )


def _judged(system: System, name: str, column: str, time: ReactionTime) -> tuple[list[str], tuple[float, float] | None]:
    """The differences, and the minimum and maximum of the search, if it has an answer."""
    from storm import RefusedError, StormLimits, TooLargeError, exact_within  # noqa: PLC0415 - imports Storm
    from three_answers import answers  # noqa: PLC0415

    limits, verdict, reason = JUDGE[0], EQUAL, ""
    before = after = _of_children()

    def storms_answer(model: api.Model, property_: str) -> Exact | None:
        nonlocal verdict, reason, before, after
        before = _of_children()
        try:
            return exact_within(model, property_, StormLimits(limits.seconds, limits.memory << 30))
        except TooLargeError as error:
            verdict, reason = TOO_LARGE, f"Storm: more than {limits.memory} GB"
            if error.is_time:
                reason = f"Storm: more than {limits.seconds} s"
        except RefusedError as error:
            verdict, reason = REFUSED, f"Storm: {error}"
        finally:
            after = _of_children()
        return None

    answer = answers(system.subject(time), name, limits.states, storms_answer)
    found = list(answer.differences())
    if found:
        verdict, reason = DIFFERENT, "; ".join(found)
    elif answer.undecided.startswith("stopped"):
        verdict, reason = TOO_LARGE, answer.undecided
    elif answer.storm is not None and answer.searched is None:
        verdict, reason = REFUSED, answer.undecided
    spent = round(after - before, 2)
    system.judged.append(Judgement(name, column, verdict, reason, answer.searched_states, answer.states, spent))
    return found, answer.searched


def _of_children() -> float:
    """The CPU time in s of all processes that this one has started and that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


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
JUDGE = [JudgeLimits()]
"""The limits of the step `storm`, which the command line replaces."""


def problems(system: System, steps: Mapping[str, Step] = STEPS) -> Iterator[str]:
    """What fails for a system. A system with mistakes is only checked and drawn; a network has only the last steps,
    and a tree is not a system that is translated."""
    for name, step in steps.items():
        if system.mistakes and name not in ("check", "draw"):
            continue
        if isinstance(system, RandomNetwork) and name not in ("kernels", "storm"):
            continue
        if isinstance(system, LoneTree) and name in ("translate", "kernels", "storm"):
            continue
        begun = time.monotonic()
        try:
            found = list(step(system))
        except Exception as error:  # whatever a step raises is what the gate looks for
            found = [f"{type(error).__name__}: {error}"]
        system.seconds[name] = round(time.monotonic() - begun, 1)
        yield from (f"{system.name}: {name}: {problem}" for problem in found)


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="run.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", metavar="TEXT", help="only systems whose name contains this")
    parser.add_argument("--step", action="append", choices=list(STEPS), help="only this step; may be repeated")
    parser.add_argument("--plain", action="store_true", help="with the compiled modules as plain Python")
    parser.add_argument("--resume", type=Path, action="append", metavar="FILE",
                        help="leave out systems that passed before; record more in the last file")  # fmt: skip
    parser.add_argument("--page", type=Path, metavar="FILE", help="write what --resume recorded of Storm as Markdown")
    parser.add_argument("--networks", type=int, default=0, metavar="N", help="also N random networks, for step storm")
    default = JudgeLimits()
    parser.add_argument("--storm-seconds", type=int, default=default.seconds, metavar="N", help="CPU time of Storm")
    parser.add_argument("--storm-memory", type=int, default=default.memory, metavar="GB", help="memory of Storm")
    parser.add_argument("--max-states", type=int, default=default.states, metavar="N", help="of searches beside Storm")
    options = parser.parse_args()
    if options.plain and not IS_PLAIN:
        return _run_plain()
    JUDGE[0] = JudgeLimits(options.storm_seconds, options.storm_memory, options.max_states)
    if options.page:
        names = map(conformance.label, conformance.systems())
        options.page.write_text(page(read(options.resume), JUDGE[0].text, names), encoding="utf-8")
        return 0
    steps = {name: step for name, step in STEPS.items() if not options.step or name in options.step}
    with tempfile.TemporaryDirectory() as folder:
        chosen = itertools.chain(systems(Path(folder), {1: 1, 2: 2, 3: 3, 4: 30, 5: 60}), networks(options.networks))
        return _run([system for system in chosen if options.only in system.name], steps, options.resume or [])


def _run(chosen: list[System], steps: Mapping[str, Step], records: list[Path]) -> int:
    """Print what fails; return the exit status."""
    lines = [line for record in records if record.exists() for line in record.read_text(encoding="utf-8").splitlines()]
    passed = {(row["system"], tuple(row["steps"])): row for row in map(json.loads, lines) if not row["problems"]}
    failures, judged, begun = 0, Counter[str](), time.monotonic()
    for system in chosen:
        if row := passed.get((system.name, tuple(steps))):
            judged.update(Judgement(*values).verdict for values in row["judged"])
            print(f"passed before: {system.name}", flush=True)
            continue
        since = time.monotonic()
        found = list(problems(system, steps))
        failures += len(found)
        judged.update(judgement.verdict for judgement in system.judged)
        print(f"{'FAILED' if found else 'passed'} {system.name} ({time.monotonic() - since:.1f} s)", flush=True)
        for text in (*found, *(f"left out: {row}" for row in system.judged if row.verdict in (TOO_LARGE, REFUSED))):
            print(f"  {text}", flush=True)
        row = {"system": system.name, "steps": list(steps), "problems": found, "judged": system.judged}
        if records:
            with records[-1].open("a", encoding="utf-8") as file:
                file.write(json.dumps({**row, "seconds": system.seconds}) + "\n")
    counts = ", ".join(f"{count} {verdict}" for verdict, count in sorted(judged.items()))
    print(
        f"{len(chosen)} systems, {failures} problems, {time.monotonic() - begun:.0f} s; Storm: {counts or 'not asked'}"
    )
    return 1 if failures or not chosen else 0


def _run_plain() -> int:
    """Run this program again, with a copy of the library that contains no compiled modules."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "server")
        shutil.copytree(ROOT / "server", copy, ignore=shutil.ignore_patterns("*.so", "*.pyd", "__pycache__"))
        environment = {**os.environ, "PYTHONPATH": str(copy)}
        return subprocess.run([sys.executable, *sys.argv], env=environment, check=False).returncode
