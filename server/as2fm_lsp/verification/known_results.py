# SPDX-License-Identifier: Apache-2.0
"""What is known of the properties of an editor's systems: for as long as the server runs, in memory.

A result belongs to the texts that it was computed for: it is stale as long as a file of the system differs, and is not
when that is taken back.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from roaml.ide.verifiable import Texts, fingerprint
from roaml.project.analysis import Analysis
from roaml.verification.results import Result
from roaml.verification.target import Target


@dataclass(frozen=True, slots=True)
class KnownResult:
    """A result, with the models and the texts that it was computed for."""

    result: Result
    analysis: Analysis
    texts: Texts


@dataclass(slots=True)
class KnownResults:
    """System -> property -> what is known of it. `changes` is the number of results that were added."""

    changes: int = 0
    _known: dict[str, dict[str, KnownResult]] = field(default_factory=dict)
    _target: tuple[Texts, Target] | None = None

    def put(self, system: str, known: KnownResult) -> None:
        self._known.setdefault(system, {})[known.result.name] = known
        self.changes += 1

    def get(self, system: str, name: str) -> KnownResult | None:
        return self._known.get(system, {}).get(name)

    def is_stale(self, known: KnownResult, analysis: Analysis, system: str) -> bool:
        return known.texts != fingerprint(analysis, system)

    def all(self) -> Iterator[tuple[str, KnownResult]]:
        """All that is known, with the system that it is known of."""
        for system, properties in self._known.items():
            yield from ((system, known) for known in properties.values())

    def has(self, system: str) -> bool:
        """Whether anything is known of a system."""
        return system in self._known

    # A user asks for one property after the other: the translation for the first serves the others.

    def target(self, texts: Texts) -> Target | None:
        """The last translation, if it was made from these texts."""
        return self._target[1] if self._target and self._target[0] == texts else None

    def keep_target(self, texts: Texts, target: Target) -> None:
        self._target = (texts, target)


def short(result: Result) -> str:
    """A result in a few characters: `0.48 [0.47, 0.49]`."""
    answer = result.answer
    if answer is None or answer.tally.traces == 0:
        return ""
    lower, upper = answer.bounds
    return f"{_number(answer.value)} [{_number(lower)}, {_number(upper)}]"


def missed(result: Result) -> str:
    """What was expected and is not met; empty if all is."""
    return " and ".join(verdict.expectation.text for verdict in result.verdicts if not verdict.is_met)


def _number(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.3g}"
