# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-element`, which unknown_element.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import rename_tag
from roaml.language import HL_SCXML, PLAIN_SCXML
from roaml.language.validate import UnknownElement
from roaml.rules.rule import FileContext, Rule, close_names, did_you_mean
from roaml.rules.support.children import has_counted_children


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, UnknownElement):
            continue
        element, parent = violation.element, violation.parent
        assert context.grammar is not None
        if context.grammar is HL_SCXML and element.name in PLAIN_SCXML.elements:
            continue  # unsupported-scxml-element reports this with more detail
        if has_counted_children(parent):
            continue
        if element.name in _PORTS and "inout_port" in parent.children:
            instead = _PORTS[element.name]
            message = f"there is no element `<{element.name}>`; a port that is read and written is an `<{instead}>`"
            yield RULE.at(element.name_span, message, rename_tag(element, instead))
            continue
        close = close_names(element.name, parent.children) or close_names(element.name, context.grammar.elements)
        fits = [name for name in close if name in parent.children]
        fixes = [rename_tag(element, name, preferred=name in fits[:1]) for name in close]
        hint = did_you_mean(tuple(f"<{name}>" for name in close))
        yield RULE.at(element.name_span, f"unknown element `<{element.name}>`{hint}", *fixes)


_PORTS = {"bidirectional_port": "inout_port"}
"""Element names for ports in models that BehaviorTree.CPP does not support, with the supported names."""

RULE = Rule("unknown-element", Severity.ERROR, "The language does not define an element.", file=check)
