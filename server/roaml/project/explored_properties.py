# SPDX-License-Identifier: Apache-2.0
"""What is certain about the properties of a system before they are verified, from all states that it can reach: which
properties nothing tests, which no run meets, and which expectations no value meets.

Each property is judged by its observer, as `verify` does. A few random traces come first: one of them tests and
satisfies most properties, which need no search. As in `roaml.project.exploration`, the next search is that for machines
that react at once. The search with the reaction time of the system confirms or refutes what it has found; if that is
too long, the finding says what it assumes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from roaml.comparison import Comparison
from roaml.diagnostics import Finding
from roaml.jani.expressions import Name
from roaml.jani.model import Model
from roaml.jani.properties import eventually
from roaml.project.analysis import Analysis
from roaml.project.asked_properties import asked_of, can_be, can_meet, findings_of_doubts, wanted_of
from roaml.project.exploration import with_reactions
from roaml.project.property_search import MAX_CAUSE_STEPS, MAX_STEPS, Doubt, Doubted, PropertySearch
from roaml.scxml.observed import ObservedProperty
from roaml.smc.fault import FaultError
from roaml.smc.goal import NO_OUTPUTS, CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import TRUE, UNKNOWN
from roaml.views.ends import marks, observer_outputs

TRACES, TRACE_STEPS = 20, 10_000
"""The number of random traces of each property, and their maximum length."""


def findings_about_properties(
    analysis: Analysis, path: str, expected: Mapping[str, Comparison]
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and the findings in them, for a system without errors.

    Args:
        expected: name of a property -> the result that the settings of the user expect.
    """
    asked = asked_of(analysis, path, expected)
    if asked is None:
        return
    model, observed = asked.model, asked.observed
    search = PropertySearch(MAX_STEPS)
    doubted: dict[str, Doubted] | None = None
    unknown: set[str] = set()
    for variant, is_instant in with_reactions(model):
        judged = dict(_judged(variant, search, observed, expected, doubted, unknown, is_instant=is_instant))
        doubted = {name: doubt for name, doubt in {**(doubted or {}), **judged}.items() if doubt is not None}
        if not doubted:
            break
    known = doubted or {}
    yield from findings_of_doubts(analysis, path, asked, known.values(), PropertySearch(MAX_CAUSE_STEPS))
    if unknown - known.keys():
        from roaml.project.simulated_properties import findings_in_runs  # noqa: PLC0415 - few searches are too long

        yield from findings_in_runs(analysis, path, asked, expected, unknown - known.keys())


def _judged(
    model: Model,
    search: PropertySearch,
    observed: Mapping[str, ObservedProperty],
    expected: Mapping[str, Comparison],
    names: Collection[str] | None,
    unknown: set[str],
    *,
    is_instant: bool,
) -> Iterator[tuple[str, Doubted | None]]:
    """The names of properties of a model, each with its doubt; `None` if there is none. Those about which nothing is
    known are left out.

    Args:
        names: the names of the properties that are judged; `None` for all.
        unknown: the names of those about which nothing is known are added.
        is_instant: whether the model assumes that machines react at once.
    """
    chosen = [p for p in model.properties if names is None or p.name in names]
    try:
        checker = ModelChecker(model, chosen, marks(model), outputs=observer_outputs(model))
    except FaultError:
        return
    for compiled in checker.compiled_properties:
        property_, question = compiled.property, compiled.question
        own, wanted = observed.get(property_.name), wanted_of(property_.name, observed, expected)
        if question.is_conditional or not (wanted or question.threshold or not _is_tested(checker, compiled)):
            continue
        values = search.values(checker, compiled)
        if values is None:
            unknown.add(property_.name)
            continue
        doubt = _untested(checker, compiled, search) if values.lower == 1.0 and not question.is_reward else None
        unmet = next((c for c in wanted if not can_meet(c, values)), None)
        if (
            question.threshold is not None
            and not can_be(question.threshold.relation, question.threshold.number, values)
        ) or unmet is not None:
            doubt = Doubt.UNMET
        elif own is not None and values.upper == 0.0 and not wanted:
            doubt = Doubt.NEVER
        found = None if doubt is None else Doubted(doubt, values, property_, own, unmet, is_instant)
        yield property_.name, found


def _is_tested(checker: ModelChecker, property_: CompiledProperty) -> bool:
    """Whether a random trace tests and satisfies a property."""
    compiled = checker.compiled(property_)
    kernel = Kernel(compiled.program, compiled.goal)
    outputs = checker.outputs.get(property_.property.name, NO_OUTPUTS)
    registers = {storage.name: storage.base for storage in checker.legend.layout.shared}
    happens = [e for e in (outputs.opened, outputs.triggered) if isinstance(e, Name)]
    for trace in range(TRACES):
        verdict = kernel.begin(0, trace, 0)
        if verdict == UNKNOWN:
            verdict = kernel.advance(TRACE_STEPS)
        if verdict == TRUE and all(kernel.integer(registers[e.identifier]) for e in happens):
            return True
    return False


def _untested(checker: ModelChecker, property_: CompiledProperty, search: PropertySearch) -> Doubt | None:
    """Why nothing tests a property that always holds; `None` if something does."""
    outputs = checker.outputs.get(property_.property.name, NO_OUTPUTS)
    for doubt, happens in ((Doubt.SCOPE, outputs.opened), (Doubt.TRIGGER, outputs.triggered)):
        if happens is not None and search.is_impossible(checker, eventually(property_.property.name, happens)):
            return doubt
    return None
