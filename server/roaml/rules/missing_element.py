# SPDX-License-Identifier: Apache-2.0
"""missing-element: see missing_element.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.language import HL_SCXML
from roaml.language.validate import MissingElement
from roaml.model.system import builtin_plugins
from roaml.rules import misspelled
from roaml.rules.rule import FileContext, MachineContext, Rule


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, MissingElement):
            continue
        element, wanted = violation.element, violation.type.any_child
        assert context.grammar is not None
        if wanted is None:
            if not misspelled.among(element.elements, violation.names[0], context.grammar):
                yield RULE.at(element.name_span, f"`<{element.name}>` needs a `<{violation.names[0]}>`")
        elif element.name not in builtin_plugins():  # of these, child-count tells
            children = "a child" if wanted.least == 1 else f"at least {wanted.least} children"
            yield RULE.at(element.name_span, f"`<{element.name}>` needs {children}")


def check_machine(context: MachineContext) -> Iterator[Finding]:
    """What the schema cannot say, because children may stand in any order."""
    for chart in context.machine.charts:
        element = chart.element
        states = any(child.name == "state" for child in element.elements)
        if element.complete and not states and not misspelled.among(element.elements, "state", HL_SCXML):
            yield RULE.at(element.name_span, f"`<{element.name}>` needs at least one `<state>`")


RULE = Rule(
    "missing-element", Severity.ERROR, "An element lacks a child that it needs.", file=check, machine=check_machine
)
