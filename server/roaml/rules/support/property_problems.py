# SPDX-License-Identifier: Apache-2.0
"""Makes the rules about property files in XML, which report the problems that `roaml.model.property_links` finds."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import after, first_in, removal, remove
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import Problem, ProblemKind, Remedy
from roaml.rules.rule import Rule, replacements


def problem_rule(kind: ProblemKind, severity: Severity, summary: str) -> Rule:
    """The rule that reports the problems of one kind."""
    holder: list[Rule] = []

    def check(file: LinkedFile) -> Iterator[Finding]:
        yield from problems(holder[0], kind, file)

    holder.append(Rule(kind.value, severity, summary, xml_properties=check))
    return holder[0]


def problems(rule: Rule, kind: ProblemKind, file: LinkedFile) -> Iterator[Finding]:
    """The problems of one kind in a property file, as findings of `rule`."""
    for problem in file.problems:
        if problem.kind is kind:
            fixes = (*replacements(problem.span, problem.close), *_remedies(file, problem))
            yield rule.at(
                problem.span, problem.message, *fixes, severity=Severity.WARNING if problem.harmless else None
            )


def _remedies(file: LinkedFile, problem: Problem) -> Iterator[Fix]:
    element, document = problem.element, file.file.document
    if element is None or problem.remedy is None:
        return
    match problem.remedy:
        case Remedy.REMOVE_ELEMENT:
            yield remove(document, element, preferred=False)
        case Remedy.REMOVE_ATTRIBUTE:
            for attribute in element.attributes:
                if attribute.span.contains(problem.span.start):
                    edit = removal(document.text, attribute.span)
                    yield Fix(f"Remove `{attribute.name}`", (edit,), preferred=True)
        case Remedy.ADD_SCOPE:
            line = '<scope type="globally" />'
            intervals = [child for child in element.elements if child.name != "time_interval"]
            place = after(document, intervals[-1], line) if intervals else first_in(document, element, line)
            yield Fix(f"Add `{line}`", (place,), preferred=True)
