# SPDX-License-Identifier: Apache-2.0
"""The properties of a system that a check judges before they are verified, and what the judgements have in common."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from roaml.comparison import Comparison
from roaml.diagnostics import Finding
from roaml.jani.model import Model
from roaml.jani.nesting import is_nested
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import BinaryFormula, Filter, Property, walk
from roaml.model.property_links import clock_step
from roaml.project.analysis import Analysis
from roaml.project.property_search import Doubted
from roaml.project.translation import network_of, observed_properties_of, properties_of
from roaml.record import Record
from roaml.scxml.model import Network
from roaml.scxml.names import sent_by
from roaml.scxml.observed import ObservedProperty
from roaml.smc.statistics import Bounds
from roaml.to_jani import translate
from roaml.to_jani.state_observers import with_state_observers

if TYPE_CHECKING:
    from roaml.project.property_causes import Evidence

_SLACK = 1e-6
"""The difference between a value and the number of an expectation that is attributed to rounding."""
RELATIONS = {
    ">=": BinaryOperator.GREATER_EQUAL,
    "<=": BinaryOperator.LESS_EQUAL,
    ">": BinaryOperator.GREATER,
    "<": BinaryOperator.LESS,
    "==": BinaryOperator.EQUAL,
}


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
