# SPDX-License-Identifier: Apache-2.0
"""The rule `unportable-expectation`, which unportable_expectation.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.comparison import read_comparison
from roaml.diagnostics import Finding, Severity
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import BinaryFormula, Expectation, Probability, Property, walk
from roaml.model.property_links import LinkedFile
from roaml.rules.rule import PropertiesContext, Rule
from roaml.text import Span

_COMPARISONS = (
    BinaryOperator.LESS,
    BinaryOperator.LESS_EQUAL,
    BinaryOperator.GREATER,
    BinaryOperator.GREATER_EQUAL,
    BinaryOperator.EQUAL,
)
IN_JANI = (
    "SMC Storm, the model checker of AS2FM, refuses a comparison of the probability with a number; write the "
    "expectation into `[verify.expect]` of `as2fm.toml` instead"
)
IN_XML = "AS2FM ignores `expect`; only as2fm-lsp compares the result with it"


def in_jani(context: PropertiesContext) -> Iterator[Finding]:
    yield from _reported([span for property_ in context.properties for span in _numbers(property_)], IN_JANI)


def _numbers(property_: Property) -> Iterator[Span]:
    """The number with which a property compares its probability or expected reward; nothing if there is none."""
    for formula in walk(property_.expression):
        if isinstance(formula, BinaryFormula) and formula.operator in _COMPARISONS:
            for value, number in ((formula.left, formula.right), (formula.right, formula.left)):
                if isinstance(value, (Probability, Expectation)) and number.origin is not None:
                    yield number.origin.span
                    return


def in_xml(file: LinkedFile) -> Iterator[Finding]:
    names = [written.expect for written in file.file.properties if written.expect is not None]
    expected = [
        name.span for name in names if read_comparison(name.value) is not None
    ]  # otherwise `property-form` reports it
    yield from _reported(expected, IN_XML)


def _reported(places: Sequence[Span], message: str) -> Iterator[Finding]:
    """One finding for all places in a file, reported at the first place."""
    if places:
        more = len(places) - 1
        also = f" (also at {more} more {'property' if more == 1 else 'properties'} of this file)" if more else ""
        yield RULE.at(places[0], f"{message}{also}")


RULE = Rule(
    "unportable-expectation",
    Severity.INFORMATION,
    "A property file contains an expectation that AS2FM does not read.",
    properties=in_jani,
    xml_properties=in_xml,
)
