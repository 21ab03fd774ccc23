# SPDX-License-Identifier: Apache-2.0
"""Whole systems with the contents of real ones, whose properties have known values: the check finds no error, the
translation is valid, and all traces of both kernels fulfil the properties."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from both_kernels import difference
from corpus.generated import Generated
from corpus.parts import compose
from fuzz.checked import problems_of_check
from fuzz.limits import restart
from fuzz.strategy import Failure, Strategy
from roaml import api
from roaml.diagnostics import Severity
from roaml.smc.pool import Alone
from roaml.smc.run import EstimationMethod, Options

FOLDER = "/generated"
TRACES = 5
STEPS = 60
"""The number of steps that the slow kernel takes, too."""


@dataclass(frozen=True)
class Composed:
    seed: int
    system: Generated

    def description(self) -> Iterable[str]:
        yield from (f"{name} has the value {value}" for name, value in self.system.values.items())

    def files(self) -> Mapping[str, str | bytes]:
        return {f"{FOLDER}/{name}": text for name, text in self.system.files.items()}

    def run(self) -> Iterator[Failure]:
        texts = {f"{FOLDER}/{name}": text for name, text in self.system.files.items()}
        main = f"{FOLDER}/main.xml"
        errors = [d for d in api.check([main], texts=texts).diagnostics if d.severity is Severity.ERROR]
        for error in errors:
            yield Failure(f"a false error: {error.code}", f"{error.path}: {error.message}")
        yield from problems_of_check(main, texts)
        if errors:
            return
        restart()
        checker = api.verifier(api.load(main, texts=texts)).checker
        options = Options(method=EstimationMethod.FIXED, max_traces=TRACES, seed=self.seed)
        for property_ in checker.compiled_properties:
            restart()
            tally = checker.answer(property_, options, Alone(checker.compiled(property_))).tally
            if tally.successes != TRACES:
                yield Failure("a property does not have its known value", f"{property_.question.name}: {tally}")
            for scheduler in (0, 1 + self.seed % 7):
                details = difference(checker, property_, self.seed, 1, STEPS, scheduler)
                if details:
                    yield Failure("the kernels disagree", details)


def make(seed: int) -> Composed:
    return Composed(seed, compose(seed))


STRATEGY = Strategy("parts", "checks, translates and verifies systems of services, actions, structs and trees", make)
