# SPDX-License-Identifier: Apache-2.0
"""The rule `ignored-element`, which ignored_element.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity, Tag
from roaml.edit.elements import removal
from roaml.model.machine import NoEffect
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.elements import stands_alone
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        ignored: list[Element] = [s.element for s in chart.statements if isinstance(s, NoEffect)]
        ignored += [h.element for state in chart.states for h in state.handlers if not h.effective]
        for element in ignored:
            # If the element is the only content of a branch, its removal leaves an empty branch (empty-branch).
            alone = stands_alone(context.document, element)
            edit = removal(context.source.text, element.span)
            remove = Fix(f"Remove `<{element.name}>`", (edit,), preferred=not alone, safe=not alone)
            yield RULE.at(
                element.name_span,
                f"`<{element.name}>` has no effect on the model",
                remove,
                severity=None if context.older or element.name == "log" else Severity.ERROR,
                tags=(Tag.UNNECESSARY,),
            )


RULE = Rule("ignored-element", Severity.HINT, "An element has no effect on the model.", machine=check)
