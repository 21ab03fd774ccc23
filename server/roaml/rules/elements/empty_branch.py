# SPDX-License-Identifier: Apache-2.0
"""The rule `empty-branch`, which empty_branch.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.model.machine import If
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.elements import stands_alone
from roaml.xml_syntax import Element

MARKERS = ("elseif", "else")


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, If):
                yield from _check(context, statement)


def _check(context: MachineContext, choice: If) -> Iterator[Finding]:
    parts = [child for child in choice.element.elements if not child.is_foreign]
    remove = Fix("Remove the `<if>`", (removal(context.source.text, choice.element.span),), preferred=False)
    useless = all(part.name in MARKERS for part in parts) and not stands_alone(context.document, choice.element)
    fixes = [remove] if useless else []
    for branch in choice.branches:
        if not branch.body and not _content(parts, branch.element):
            message = f"`<{branch.element.name}>` has no content; a branch with a condition needs content"
            yield RULE.at(branch.element.name_span, message, *fixes)


def _content(parts: list[Element], marker: Element) -> bool:
    """Whether an element, even a misspelled one, follows `marker` before the next marker."""
    following = parts[parts.index(marker) + 1 :] if marker in parts else parts
    return bool(following) and following[0].name not in MARKERS


RULE = Rule("empty-branch", Severity.ERROR, "A branch of an `<if>` has no content.", machine=check)
