# SPDX-License-Identifier: Apache-2.0
"""The rule `vacuous-expectation`, which vacuous_expectation.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.comparison import effect_on_probabilities, read_comparison
from roaml.diagnostics import Finding, Severity
from roaml.model.property_links import LinkedFile
from roaml.rules.rule import FileContext, Rule


def check(file: LinkedFile) -> Iterator[Finding]:
    for written in file.file.properties:
        comparison = read_comparison(written.expect.value) if written.expect is not None else None
        # property-form reports other numbers.
        is_probability = comparison is not None and 0 <= comparison.number <= 1
        effect = effect_on_probabilities(comparison) if comparison is not None and is_probability else ""
        if written.expect is not None and effect:
            yield RULE.at(
                written.expect.span, f"every probability is from 0 to 1, so this expectation is {effect}; change it"
            )


def in_configuration(context: FileContext) -> Iterator[Finding]:
    """The findings of `project.configuration`, which knows the systems of a configuration."""
    return (finding for finding in context.findings if finding.code == RULE.code)


RULE = Rule(
    "vacuous-expectation",
    Severity.WARNING,
    "Every probability meets an expectation, or none does.",
    file=in_configuration,
    xml_properties=check,
)
