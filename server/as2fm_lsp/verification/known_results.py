# SPDX-License-Identifier: Apache-2.0
"""The known results of the properties of the systems in an editor, in memory while the server runs.

A result is valid for the texts for which it was computed: it is stale while a file of the system differs, and valid
again when the change is undone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from as2fm_lsp.verification.settings import verification_settings
from roaml.comparison import Comparison, UniformPolicy
from roaml.ide.verifiable import Texts, expected_beside, fingerprint
from roaml.project.analysis import Analysis
from roaml.project.workspace import Snapshot
from roaml.record import Record, field, replace
from roaml.verification.expectations import expectation_of
from roaml.verification.headline import headline
from roaml.verification.results import Result
from roaml.verification.target import VerificationTarget
from roaml.verification.verifier import with_expectations


class KnownResult(Record, frozen=True):
    """A result, with the model and the texts for which it was computed. `options` are the options of the call, as the
    client sent them."""

    result: Result
    analysis: Analysis
    texts: Texts
    options: object = None


class ExpectedNow(Record, frozen=True):
    """The expected values of the properties of a system, except those in the options of calls.

    Attributes:
        client_settings: the client's settings, as received.
        beside: property -> the expectation in the file of the property.
        configured: property -> the expectation in the configuration.
        uniform: what an expectation is worth that is met under uniform choices only.
    """

    client_settings: object
    beside: Mapping[str, Comparison]
    configured: Mapping[str, Comparison]
    uniform: UniformPolicy = UniformPolicy.WARN

    def with_expectations(self, known: KnownResult) -> KnownResult:
        """A known result, compared with the expectations that are valid now."""
        name = known.result.name
        given = verification_settings(self.client_settings, known.options).expectations
        written = (self.beside.get(name), self.configured.get(name))
        more = [expectation_of(name, comparison) for comparison in written if comparison is not None]
        return replace(known, result=with_expectations(known.result, (*given, *more), self.uniform))


def expected_now(snapshot: Snapshot, system: str, client_settings: object) -> ExpectedNow:
    beside = expected_beside(snapshot.analysis, system)
    settings = snapshot.checker.settings
    return ExpectedNow(client_settings, beside, settings.expectations, settings.uniform)


class KnownResults(Record):
    """The known results: system -> property -> result; the system with the latest result is the last one. `changes` is
    the number of results that were added."""

    changes: int = 0
    _known: dict[str, dict[str, KnownResult]] = field(default_factory=dict)
    _target: tuple[Texts, VerificationTarget] | None = None

    def put(self, system: str, known: KnownResult) -> None:
        self._known[system] = {**self._known.pop(system, {}), known.result.name: known}
        self.changes += 1

    def get(self, system: str, name: str) -> KnownResult | None:
        return self._known.get(system, {}).get(name)

    def of(self, system: str) -> tuple[KnownResult, ...]:
        """The results of a system."""
        return tuple(self._known.get(system, {}).values())

    def is_stale(self, known: KnownResult, analysis: Analysis, system: str) -> bool:
        return known.texts != fingerprint(analysis, system)

    def all(self) -> Iterator[tuple[str, KnownResult]]:
        """All results, with their systems."""
        for system, properties in self._known.items():
            yield from ((system, known) for known in properties.values())

    @property
    def systems(self) -> tuple[str, ...]:
        """The systems that have results."""
        return tuple(self._known)

    def has(self, system: str) -> bool:
        """Whether there is a result for a system."""
        return system in self._known

    # Properties that a user verifies one after the other share the translation.

    def target(self, texts: Texts) -> VerificationTarget | None:
        """The last translation, if it was made from these texts; otherwise `None`."""
        return self._target[1] if self._target and self._target[0] == texts else None

    def keep_target(self, texts: Texts, target: VerificationTarget) -> None:
        self._target = (texts, target)


def short(result: Result) -> str:
    """A short form of a result, such as `0.48 [0.47, 0.49]`, `0.4832, exact` or `undecided`; "" if there is none."""
    return headline(result).short


def missed(result: Result) -> str:
    """The texts of the expectations that do not hold, joined by `and`; "" if all hold, or may hold."""
    return " and ".join(v.expectation.text for v in result.verdicts if not (v.is_met or v.is_undecided))
