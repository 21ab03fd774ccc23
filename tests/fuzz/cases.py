# SPDX-License-Identifier: Apache-2.0
"""One case: a seed, what is damaged by it, and what must hold of the complete check of that."""

from __future__ import annotations

import logging
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from random import Random

from fuzz.corpus import Model, interfaces, snippets, systems
from fuzz.damage import ANY, ways
from fuzz.translation import problems
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.project.settings import Settings
from roaml.text import Span, apply_edits

SECONDS = 2.0
"""What one check may take, in seconds of processor time."""

_SLOW = "slow"

LONGEST = 300_000
"""Characters of one file. That greater ones take their time is no failure."""


@dataclass
class Case:
    """Attributes:
    model: what was damaged.
    texts: all files, damaged or not.
    main: the file that is checked.
    damage: how, in words.
    """

    seed: int
    model: Model
    texts: dict[str, str]
    main: str
    damage: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Failure:
    """`kind` tells equal failures of different cases."""

    kind: str
    details: str


def make(seed: int) -> Case:
    random = Random(seed)
    model = random.choice(systems() if random.random() < 0.5 else snippets())
    case = Case(seed, model, dict(model.texts), model.main)
    others = [text for each in (random.choice(systems()), random.choice(snippets())) for text in each.texts.values()]
    for _ in range(random.choice([1, 1, 2, 4])):
        path = random.choice(list(model.texts))
        if model.ros_paths and random.random() < 0.05 and interfaces():
            path = random.choice(list(interfaces()))
            case.texts.setdefault(path, interfaces()[path])
        way = random.choice(ways(path) if random.random() < 0.95 else ANY)
        case.texts[path] = way(random, case.texts[path], others)[:LONGEST]
        case.damage.append(f"{way.__name__} in {path}")
    if random.random() < 0.15:
        case.main = random.choice(list(model.texts))
    return case


def run(case: Case, timed: bool = True) -> list[Failure]:
    """What must hold and does not; `timed` counts the time, too."""
    with _Crashes() as crashes:
        failures: list[Failure] = []
        try:
            for failure in _check(case, case.texts):
                if timed or failure.kind != _SLOW:
                    failures.append(failure)
        except Exception as error:  # the very thing that is looked for
            failures.append(Failure(_place(error), traceback.format_exc()))
    return [
        *failures,
        *(Failure(_place(error), "".join(traceback.format_exception(error))) for error in crashes.errors),
    ]


def _check(case: Case, texts: dict[str, str], fix: bool = True) -> Iterator[Failure]:
    started = time.process_time()
    result = api.check([case.main], case.model.ros_paths, Settings(), texts)
    spent = time.process_time() - started
    if spent > SECONDS:
        yield Failure(_SLOW, f"{spent:.1f} s")
    for diagnostic in result.diagnostics:
        yield from _diagnostic(result, diagnostic)
    for system in result.snapshot.analysis.system_paths:
        yield from (Failure(kind, f"{system}: {kind}") for kind in problems(result.snapshot, system))
    if fix:
        yield from _fixed(case, texts, result.diagnostics)


def _diagnostic(result: api.CheckResult, diagnostic: Diagnostic) -> Iterator[Failure]:
    where = f"{diagnostic.code} in {diagnostic.path}: {diagnostic.message[:300]}"
    if diagnostic.code == "internal-error":
        yield Failure("internal-error", where)
    if not diagnostic.message.strip():
        yield Failure(f"no message: {diagnostic.code}", where)
    length = len(result.source(diagnostic.path).text)
    if not _inside(diagnostic.span, length):
        yield Failure(f"range outside: {diagnostic.code}", f"{diagnostic.span} of {length}: {where}")
    for fix in diagnostic.fixes:
        if not all(_inside(edit.span, length) for edit in fix.edits):
            yield Failure(f"fix outside: {diagnostic.code}", f"{fix} of {length}: {where}")
    for related in diagnostic.related:
        source = result.snapshot.analysis.source(related.location.path)
        if source is None or not _inside(related.location.span, len(source.text)):
            yield Failure(f"related place outside: {diagnostic.code}", f"{related}: {where}")


def _fixed(case: Case, texts: dict[str, str], diagnostics: tuple[Diagnostic, ...]) -> Iterator[Failure]:
    """Sometimes one fix is made and everything checked again."""
    random = Random(case.seed)
    fixes = [(d.path, fix) for d in diagnostics for fix in d.fixes if d.path in texts]
    if fixes and random.random() < 0.1:
        path, fix = random.choice(fixes)
        case.damage.append(f"then fixed: {fix.title}")
        yield from _check(case, {**texts, path: apply_edits(texts[path], fix.edits)}, fix=False)


def _inside(span: Span, length: int) -> bool:
    return 0 <= span.start <= span.end <= length


def _place(error: BaseException) -> str:
    """Where an exception comes from, without what differs from case to case."""
    frames = traceback.extract_tb(error.__traceback__)
    last = next((f for f in reversed(frames) if "roaml" in f.filename), frames[-1])
    return f"{type(error).__name__} at {last.filename.rpartition('/server/')[2]}:{last.lineno}"


class _Crashes(logging.Handler):
    """Collects the exceptions that the check caught, reported and survived."""

    def __init__(self) -> None:
        super().__init__()
        self.errors: list[BaseException] = []
        self.logger = logging.getLogger("roaml")

    def emit(self, record: logging.LogRecord) -> None:
        if record.exc_info and record.exc_info[1]:
            self.errors.append(record.exc_info[1])

    def __enter__(self) -> _Crashes:
        self.logger.addHandler(self)
        self.logger.propagate = False
        return self

    def __exit__(self, *_: object) -> None:
        self.logger.removeHandler(self)
        self.logger.propagate = True
