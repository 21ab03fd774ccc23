# SPDX-License-Identifier: Apache-2.0
"""The rule `vacuous-expectation`, which vacuous_expectation.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.comparison import Comparison, read_comparison
from roaml.diagnostics import Finding, Severity
from roaml.model.property_links import LinkedFile
from roaml.rules.rule import Rule


def check(file: LinkedFile) -> Iterator[Finding]:
    for written in file.file.properties:
        comparison = read_comparison(written.expect.value) if written.expect is not None else None
        effect = _effect(comparison) if comparison is not None else ""
        if written.expect is not None and effect:
            yield RULE.at(
                written.expect.span, f"every probability is from 0 to 1, so this expectation is {effect}; change it"
            )


def _effect(comparison: Comparison) -> str:
    """What every probability does with an expectation: "always met" or "never met"; "" if it depends on the
    probability. property-form reports other numbers."""
    match comparison.relation, comparison.number:
        case (">=", 0.0) | ("<=", 1.0):
            return "always met"
        case (">", 1.0) | ("<", 0.0):
            return "never met"
    return ""


RULE = Rule(
    "vacuous-expectation",
    Severity.WARNING,
    "Every probability meets an expectation, or none does.",
    xml_properties=check,
)
