# SPDX-License-Identifier: Apache-2.0
"""What is certain about the properties of a system before they are verified, from all states that it can reach: which
properties nothing tests, which no run meets, and which expectations no value meets.

Each property is judged by its observer, as `verify` does. A few random traces come first: one of them tests and
satisfies most properties, which need no search. As in `roaml.project.exploration`, the next search is that for machines
that react at once. The search with the reaction time of the system confirms or refutes what it has found; if that is
too long, the finding says what it assumes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from roaml.comparison import Comparison
from roaml.diagnostics import Finding
from roaml.jani.expressions import Name
from roaml.jani.model import Model
from roaml.jani.nesting import is_nested
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import BinaryFormula, Filter, Property, eventually, walk
from roaml.model.property_links import clock_step
from roaml.project.analysis import Analysis
from roaml.project.exploration import with_reactions
from roaml.project.property_search import MAX_CAUSE_STEPS, MAX_STEPS, Doubt, Doubted, PropertySearch
from roaml.project.translation import network_of, observed_properties_of, properties_of
from roaml.record import Record
from roaml.scxml.model import Network
from roaml.scxml.names import sent_by
from roaml.scxml.observed import ObservedProperty
from roaml.smc.fault import FaultError
from roaml.smc.goal import NO_OUTPUTS, CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import TRUE, UNKNOWN
from roaml.smc.statistics import Bounds
from roaml.to_jani import translate
from roaml.to_jani.state_observers import with_state_observers
from roaml.views.ends import marks, observer_outputs

if TYPE_CHECKING:
    from roaml.project.property_causes import Evidence

TRACES, TRACE_STEPS = 20, 10_000
"""The number of random traces of each property, and their maximum length."""
_SLACK = 1e-6
"""The difference between a value and the number of an expectation that is attributed to rounding."""
RELATIONS = {
    ">=": BinaryOperator.GREATER_EQUAL,
    "<=": BinaryOperator.LESS_EQUAL,
    ">": BinaryOperator.GREATER,
    "<": BinaryOperator.LESS,
    "==": BinaryOperator.EQUAL,
}


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
    for variant, is_instant in with_reactions(model):
        judged = dict(_judged(variant, search, observed, expected, doubted, is_instant=is_instant))
        doubted = {name: doubt for name, doubt in {**(doubted or {}), **judged}.items() if doubt is not None}
        if not doubted:
            return
    yield from findings_of_doubts(analysis, path, asked, (doubted or {}).values(), PropertySearch(MAX_CAUSE_STEPS))


class Asked(Record, frozen=True):
    """The properties of a system that are judged.

    Attributes:
        observed: the properties of XML files without assumptions, by name.
        network: the system.
        model: the system with its properties and their observers.
    """

    observed: Mapping[str, ObservedProperty]
    network: Network
    model: Model


def asked_of(analysis: Analysis, path: str, expected: Mapping[str, Comparison]) -> Asked | None:
    """The properties that are judged in a system without errors; `None` if there are none.

    Args:
        expected: see `findings_about_properties`.
    """
    observed = {p.name: p for p in observed_properties_of(analysis, path) if not p.assumptions}
    in_jani = tuple(p for p in properties_of(analysis, path) if p.name in expected or _says_more(p))
    system = analysis.system(path)
    if system is None or not (observed or in_jani):
        return None
    network = network_of(analysis, path)
    model = translate(network, in_jani, tuple(observed.values()), has_activity=True)
    return Asked(observed, network, with_state_observers(model, clock_step(system)))


def findings_of_doubts(
    analysis: Analysis, path: str, asked: Asked, doubts: Iterable[Doubted], evidence: Evidence
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and the findings about properties with doubts.

    Args:
        evidence: answers further questions.
    """
    sent = {sent_by(edge.action or "") for automaton in asked.model.automata for edge in automaton.edges}
    heard = [each for each in doubts if each.observed is None or _hears(each.observed, sent)]
    if heard:
        from roaml.project.property_causes import Causes  # noqa: PLC0415 - most properties have no doubt

        causes = Causes(analysis, path, asked.network, evidence)
        for each in heard:
            yield from causes.findings(each)


def wanted_of(
    name: str, observed: Mapping[str, ObservedProperty], expected: Mapping[str, Comparison]
) -> list[Comparison]:
    """The expectations about the property `name`: its own, and that of the settings."""
    own = observed.get(name)
    return [c for c in (own.expected if own else None, expected.get(name)) if c is not None]


def _hears(observed: ObservedProperty, sent: Collection[str]) -> bool:
    """Whether an event is sent to each port of a property. `unsent-port` reports the others."""
    return all(any(event.name in sent for event in port.events) for port in observed.ports)


def _says_more(property_: Property) -> bool:
    """Whether a property compares its value with a number, or contains nested formulas, such as a request and its
    response. Others may be about what must never happen."""
    formula = property_.expression
    values = formula.values if isinstance(formula, Filter) else formula
    return isinstance(values, BinaryFormula) or any(is_nested(part) for part in walk(formula))


def _judged(
    model: Model,
    search: PropertySearch,
    observed: Mapping[str, ObservedProperty],
    expected: Mapping[str, Comparison],
    names: Collection[str] | None,
    *,
    is_instant: bool,
) -> Iterator[tuple[str, Doubted | None]]:
    """The names of properties of a model, each with its doubt; `None` if there is none. Those about which nothing is
    known are left out.

    Args:
        names: the names of the properties that are judged; `None` for all.
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


def can_meet(expectation: Comparison, values: Bounds) -> bool:
    return can_be(RELATIONS[expectation.relation], expectation.number, values)


def can_be(relation: BinaryOperator, number: float, values: Bounds) -> bool:
    """Whether a value between bounds can have a relation to a number."""
    match relation:
        case BinaryOperator.EQUAL:
            return values.lower - _SLACK <= number <= values.upper + _SLACK
        case BinaryOperator.GREATER | BinaryOperator.GREATER_EQUAL:
            return bool(relation.function(values.upper, number)) or 0 < number - values.upper <= _SLACK
        case _:
            return bool(relation.function(values.lower, number)) or 0 < values.lower - number <= _SLACK
