# SPDX-License-Identifier: Apache-2.0
"""Rules about property files in XML, which report the problems of linking (`roaml.model.property_links`)."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.rules.rule import Rule, replacements


def problem_rule(kind: ProblemKind, severity: Severity, summary: str) -> Rule:
    """The rule that reports the problems of one kind."""
    holder: list[Rule] = []

    def check(file: LinkedFile) -> Iterator[Finding]:
        for problem in file.problems:
            if problem.kind is kind:
                yield holder[0].at(problem.span, problem.message, *replacements(problem.span, problem.close))

    holder.append(Rule(kind.value, severity, summary, xml_properties=check))
    return holder[0]
