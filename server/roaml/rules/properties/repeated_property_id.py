# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-property-id`, which repeated_property_id.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.property_problems import ProblemKind
from roaml.record import replace
from roaml.rules.rule import PropertiesContext
from roaml.rules.support.property_problems import problem_rule


def in_jani(context: PropertiesContext) -> Iterator[Finding]:
    for property_ in context.properties:
        if property_.name in context.taken and property_.origin is not None:
            file = context.taken[property_.name]
            message = f"another property of the system is called `{property_.name}`, in {file}; rename one of them"
            yield RULE.at(property_.origin.span, message)


RULE = replace(
    problem_rule(
        ProblemKind.REPEATED_ID,
        Severity.ERROR,
        "Two properties of a system, or two variables of a file, have the same id.",
    ),
    properties=in_jani,
)
