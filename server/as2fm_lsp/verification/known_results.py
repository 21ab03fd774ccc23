# SPDX-License-Identifier: Apache-2.0
"""The known results of the properties of an editor's systems, in memory while the server runs.

A result is valid for the texts for which it was computed: it is stale while a file of the system differs, and valid
again when the change is undone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from roaml.ide.verifiable import Texts, fingerprint
from roaml.project.analysis import Analysis
from roaml.verification.results import Result
from roaml.verification.target import VerificationTarget


@dataclass(frozen=True, slots=True)
class KnownResult:
    """A result, with the model and the texts for which it was computed."""

    result: Result
    analysis: Analysis
    texts: Texts


@dataclass(slots=True)
class KnownResults:
    """System -> property -> result. `changes` is the number of results that were added."""

    changes: int = 0
    _known: dict[str, dict[str, KnownResult]] = field(default_factory=dict)
    _target: tuple[Texts, VerificationTarget] | None = None

    def put(self, system: str, known: KnownResult) -> None:
        self._known.setdefault(system, {})[known.result.name] = known
        self.changes += 1

    def get(self, system: str, name: str) -> KnownResult | None:
        return self._known.get(system, {}).get(name)

    def is_stale(self, known: KnownResult, analysis: Analysis, system: str) -> bool:
        return known.texts != fingerprint(analysis, system)

    def all(self) -> Iterator[tuple[str, KnownResult]]:
        """All results, with their systems."""
        for system, properties in self._known.items():
            yield from ((system, known) for known in properties.values())

    def has(self, system: str) -> bool:
        """Whether there is a result for a system."""
        return system in self._known

    # A user verifies one property after the other: they share the translation.

    def target(self, texts: Texts) -> VerificationTarget | None:
        """The last translation, if it was made from these texts."""
        return self._target[1] if self._target and self._target[0] == texts else None

    def keep_target(self, texts: Texts, target: VerificationTarget) -> None:
        self._target = (texts, target)


def short(result: Result) -> str:
    """A short form of a result: `0.48 [0.47, 0.49]`."""
    answer = result.answer
    if answer is None or answer.tally.traces == 0:
        return ""
    lower, upper = answer.bounds
    return f"{_number(answer.value)} [{_number(lower)}, {_number(upper)}]"


def missed(result: Result) -> str:
    """The expectations that do not hold; empty if all hold."""
    return " and ".join(verdict.expectation.text for verdict in result.verdicts if not verdict.is_met)


def _number(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.3g}"
