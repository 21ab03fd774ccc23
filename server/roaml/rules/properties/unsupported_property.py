# SPDX-License-Identifier: Apache-2.0
"""The rule `unsupported-property`, which unsupported_property.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.jani.expressions import Missing
from roaml.jani.properties import walk
from roaml.model.property_links import clock_step
from roaml.rules.rule import PropertiesContext, Rule
from roaml.smc.forms import UNSUPPORTED, faults_in


def check(context: PropertiesContext) -> Iterator[Finding]:
    step = None if context.system is None else clock_step(context.system)
    for property_ in context.properties:
        if any(isinstance(part, Missing) for part in walk(property_.expression)):
            continue  # other rules report missing and invalid parts
        for fault in faults_in(property_, step):
            # ignored-bounds reports bounds on time and rewards
            if fault.code == UNSUPPORTED and fault.origin is not None:
                yield RULE.at(fault.origin.span, f"`verify` cannot decide this: {fault.message}")


RULE = Rule(
    UNSUPPORTED,
    Severity.WARNING,
    "A property has a form that `verify` cannot decide.",
    properties=check,
)
