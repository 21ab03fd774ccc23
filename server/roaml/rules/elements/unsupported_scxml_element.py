# SPDX-License-Identifier: Apache-2.0
"""The rule `unsupported-scxml-element`, which unsupported_scxml_element.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import rename_tag
from roaml.language import HL_SCXML, PLAIN_SCXML
from roaml.language.validate import UnknownElement
from roaml.rules.rule import FileContext, Rule

ADVICE = {
    "parallel": "states are flat; write a separate machine for each region",
    "final": "use a `<state>` without transitions, which is final",
    "history": "states are flat; store the history in a variable",
    "initial": "set the initial state in the attribute `initial` of the root",
    "raise": "use `<send>`, because there is no internal event queue",
    "script": "use `<assign>`",
    "foreach": "there are no loops; write a transition that leads back to its state",
    "cancel": "events are never delayed, so none can be cancelled",
    "invoke": "list the other machine in the system file and communicate by events",
    "finalize": "there is no `<invoke>`",
    "donedata": "send an event in the `<onentry>` of the last state",
    "content": "use `<param>`",
}

REPLACED = {"final": "state", "raise": "send"}


def check(context: FileContext) -> Iterator[Finding]:
    if context.grammar is not HL_SCXML:
        return
    for violation in context.violations:
        if isinstance(violation, UnknownElement) and violation.element.name in PLAIN_SCXML.elements:
            name = violation.element.name
            advice = f"; {ADVICE[name]}" if name in ADVICE else ""
            is_replaced = name in REPLACED and violation.element.find("donedata") is None
            fixes = [rename_tag(violation.element, REPLACED[name])] if is_replaced else []
            yield RULE.at(
                violation.element.name_span,
                f"`<{name}>` is an element of SCXML that HL-SCXML does not support{advice}",
                *fixes,
            )


RULE = Rule(
    "unsupported-scxml-element",
    Severity.ERROR,
    "An element of SCXML is not supported in HL-SCXML.",
    file=check,
)
