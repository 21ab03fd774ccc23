# SPDX-License-Identifier: Apache-2.0
"""What is known of the properties of an editor's systems: for as long as the server runs, in memory.

An answer belongs to the texts that it was found for: it is stale as long as a file of the system says something else,
and is not when that is taken back.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from as2fm_lsp.verification.report import Result
from as2fm_lsp.verification.subject import Subject
from roaml.ide.verifiable import Texts, fingerprint
from roaml.project.analysis import Analysis
from roaml.smc.goal import Asked
from roaml.smc.model import Checker
from roaml.smc.run import Options


@dataclass(frozen=True, slots=True)
class Known:
    """An answer, and what it takes to tell why it is so."""

    result: Result
    subject: Subject
    analysis: Analysis
    checker: Checker
    asked: Asked
    options: Options
    texts: Texts


@dataclass(slots=True)
class Verified:
    """System -> property -> what is known of it. `changes` counts how often something was added."""

    changes: int = 0
    _known: dict[str, dict[str, Known]] = field(default_factory=dict)
    _subject: tuple[Texts, Subject] | None = None

    def put(self, system: str, known: Known) -> None:
        self._known.setdefault(system, {})[known.result.name] = known
        self.changes += 1

    def get(self, system: str, name: str) -> Known | None:
        return self._known.get(system, {}).get(name)

    def is_stale(self, known: Known, analysis: Analysis, system: str) -> bool:
        return known.texts != fingerprint(analysis, system)

    def all(self) -> Iterator[tuple[str, Known]]:
        """All that is known, with the system that it is known of."""
        for system, properties in self._known.items():
            yield from ((system, known) for known in properties.values())

    def has(self, system: str) -> bool:
        """Whether anything is known of a system."""
        return system in self._known

    # A user asks for one property after the other: the translation for the first serves the others.

    def subject(self, texts: Texts) -> Subject | None:
        """The last translation, if it was made from these texts."""
        return self._subject[1] if self._subject and self._subject[0] == texts else None

    def keep_subject(self, texts: Texts, subject: Subject) -> None:
        self._subject = (texts, subject)


def short(result: Result) -> str:
    """An answer in a few characters: `0.48 [0.47, 0.49]`."""
    answer = result.answer
    if answer is None or answer.tally.traces == 0:
        return ""
    lower, upper = answer.bounds
    return f"{_number(answer.value)} [{_number(lower)}, {_number(upper)}]"


def missed(result: Result) -> str:
    """What was expected and is not so; empty if all is."""
    return " and ".join(verdict.expectation.text for verdict in result.verdicts if not verdict.is_met)


def _number(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.3g}"
