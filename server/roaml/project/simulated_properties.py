# SPDX-License-Identifier: Apache-2.0
"""What is nearly certain about the properties of a system that has too many states to explore all of them, from
simulated runs: which properties nothing tests, which no run meets, and which miss their expectations.

Each property is judged by its observer, as `verify` does. A property that no run tests or meets is also judged in runs
with equal probabilities, and with machines that react at once.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from roaml.comparison import Comparison
from roaml.diagnostics import Finding
from roaml.jani.model import Model
from roaml.jani.operators import BinaryOperator
from roaml.project.analysis import Analysis
from roaml.project.asked_properties import (
    RELATIONS,
    Asked,
    asked_of,
    can_be,
    can_meet,
    findings_of_doubts,
    wanted_of,
)
from roaml.project.exploration import with_reactions
from roaml.project.property_runs import RUNS, PropertyRuns, RunOutcome, outcomes, varied
from roaml.project.property_search import Doubt, Doubted
from roaml.record import Record
from roaml.smc.goal import Activity, CompiledProperty
from roaml.smc.statistics import Bounds, confidence_sequence
from roaml.views.ends import observer_outputs

MIN_FAILED = 25
"""The number of runs that must violate a property, if the others do not test it."""
CONFIDENCE = 0.999
"""The confidence with which the runs must exclude an expectation."""


def findings_about_simulated_properties(
    analysis: Analysis, path: str, expected: Mapping[str, Comparison]
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and the findings in them, for a system without errors.

    Args:
        expected: name of a property -> the result that the settings of the user expect.
    """
    asked = asked_of(analysis, path, expected)
    if asked is not None:
        yield from findings_in_runs(analysis, path, asked, expected, {p.name for p in asked.model.properties})


def findings_in_runs(
    analysis: Analysis, path: str, asked: Asked, expected: Mapping[str, Comparison], names: Collection[str]
) -> Iterator[tuple[str, Finding]]:
    """The same for the properties in `names`."""
    doubts = list(_Judge(asked, expected).doubts(names))
    owners = {a.name: a.thread_of for a in asked.network.automata if a.thread_of}
    yield from findings_of_doubts(analysis, path, asked, doubts, PropertyRuns(owners))


class _Judge(Record, frozen=True, eq=False):
    asked: Asked
    expected: Mapping[str, Comparison]

    def doubts(self, names: Collection[str]) -> Iterator[Doubted]:
        """The properties in `names` about which all runs raise the same doubt."""
        model = self.asked.model
        found = self._in(model, names)
        doubts = {name: self._doubt(*judged) for name, judged in found.items()}
        # An expectation is about the probabilities of the model itself.
        unsure = {name for name, doubt in doubts.items() if doubt is not Doubt.UNMET}
        others = (other for other, assumes_more in with_reactions(model) if assumes_more)
        for variant in [v for each in (model, *others) for v in varied(each) if v is not model]:
            again = self._in(variant, unsure) if unsure else {}
            unsure = {name for name, judged in again.items() if self._doubt(*judged) is doubts[name]}
        for name, (compiled, outcome) in found.items():
            doubt = doubts[name]
            is_sure = name in unsure and (doubt is not Doubt.NEVER or outcome.failed >= MIN_FAILED)
            if doubt is not None and (doubt is Doubt.UNMET or is_sure):
                share = Bounds(outcome.passed / outcome.runs, outcome.passed / outcome.runs)
                own = self.asked.observed.get(name)
                unmet = next((c for c in self._wanted(name) if not can_meet(c, _bounds(outcome))), None)
                runs = outcome.failed if doubt is Doubt.NEVER else outcome.runs
                yield Doubted(doubt, share, compiled.property, own, unmet, is_instant=False, simulated=runs)

    def _in(self, model: Model, names: Collection[str]) -> Mapping[str, tuple[CompiledProperty, RunOutcome]]:
        """The properties about which all runs of a model raise a doubt, with their outcomes."""
        properties = {p.name: p for p in model.properties if p.name in names}
        return outcomes(model, properties, observer_outputs(model), lambda *judged: self._doubt(*judged) is not None)

    def _wanted(self, name: str) -> list[Comparison]:
        return wanted_of(name, self.asked.observed, self.expected)

    def _doubt(self, property_: CompiledProperty, outcome: RunOutcome) -> Doubt | None:
        """The doubt that the outcome of some runs raises; `None` if there is none."""
        question, own = property_.question, self.asked.observed.get(property_.property.name)
        if question.is_conditional or question.is_reward or question.asks_for_extreme_state:
            return None
        wanted = self._wanted(question.name)
        # Runs with uniform choices say nothing about the minimum and the maximum of a formula on their other sides.
        limits = [(RELATIONS[each.relation], each.number, own is not None) for each in wanted]
        if question.threshold is not None:
            limits.append((question.threshold.relation, question.threshold.number, False))
        for relation, number, is_about_runs in limits:
            is_lower = relation in (BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL)
            is_judged = is_about_runs or (is_lower is question.is_minimised and relation is not BinaryOperator.EQUAL)
            if is_judged and not can_be(relation, number, _bounds(outcome)):
                return Doubt.UNMET
        if own is None or outcome.undecided:
            return None
        if outcome.tested or (outcome.passed and not question.can_be_vacuous):
            return None
        if outcome.failed:
            return None if wanted else Doubt.NEVER
        return Doubt.SCOPE if outcome.activity is Activity.CLOSED else Doubt.TRIGGER


def _bounds(outcome: RunOutcome) -> Bounds:
    """The bounds of the probability of a property. As long as there are few runs, they are the share of these runs, so
    that the doubt remains until there are more."""
    if outcome.runs < RUNS:
        return Bounds(outcome.passed / outcome.runs, (outcome.passed + outcome.undecided) / outcome.runs)
    return confidence_sequence(outcome.passed, outcome.runs, CONFIDENCE, outcome.undecided)
