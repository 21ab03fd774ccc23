# SPDX-License-Identifier: Apache-2.0
"""unknown-element: see unknown_element.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import HL_SCXML, PLAIN_SCXML
from roaml.language.validate import UnknownElement
from roaml.rules.elements import child_count
from roaml.rules.rule import FileContext, Rule, close_names, did_you_mean
from roaml.text import Span, TextEdit
from roaml.xml import Element


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, UnknownElement):
            continue
        element, parent = violation.element, violation.parent
        assert context.grammar is not None
        if context.grammar is HL_SCXML and element.name in PLAIN_SCXML.elements:
            continue  # unsupported-scxml-element says more
        if child_count.tells(parent):
            continue
        close = close_names(element.name, parent.children) or close_names(element.name, context.grammar.elements)
        fits = [name for name in close if name in parent.children]
        fixes = [rename_tag(element, name, preferred=name in fits[:1]) for name in close]
        hint = did_you_mean(tuple(f"<{name}>" for name in close))
        yield RULE.at(element.name_span, f"there is no element `<{element.name}>`{hint}", *fixes)


def rename_tag(element: Element, name: str, *, preferred: bool = True) -> Fix:
    """Change the name of an element in its start tag and its end tag."""
    spans: list[Span] = [element.name_span, *([element.close_name_span] if element.close_name_span else [])]
    return Fix(f"Change to `<{name}>`", tuple(TextEdit(span, name) for span in spans), preferred)


RULE = Rule("unknown-element", Severity.ERROR, "The language has no such element.", file=check)
