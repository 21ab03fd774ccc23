# SPDX-License-Identifier: Apache-2.0
"""The rule `conflicting-value`, which conflicting_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import removal
from roaml.language import HL_SCXML
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.elements import known_elements
from roaml.xml_syntax import Attribute, Element, children_text

VALUE_ELEMENTS = ("expr", "lower_bound_incl", "upper_bound_incl", "topic", "service_name", "action_name", "rate_hz")


def check(context: MachineContext) -> Iterator[Finding]:
    for child, _, element in known_elements(context.document, HL_SCXML):
        if child.name in VALUE_ELEMENTS and element is not None:
            attribute = element.get(child.name)
            if attribute is not None and attribute.value.strip():
                yield _overruled(context, child, attribute)
            if children_text(child).strip() and child.find("bt_get_input"):
                yield RULE.at(
                    child.name_span,
                    f"`<{child.name}>` contains both text and a `<bt_get_input>`; remove one of them",
                    severity=Severity.ERROR,
                )


def _overruled(context: MachineContext, child: Element, attribute: Attribute) -> Finding:
    """Report a child element whose value is ignored, because the attribute with the same name takes precedence
    (docs/spec/files.md#attribute-or-child)."""
    return RULE.at(
        child.name_span,
        f"`<{child.name}>` is ignored, because the attribute `{attribute.name}` takes precedence; remove one of them",
        Fix(f"Remove `<{child.name}>`", (removal(context.source.text, child.span),), safe=True),
        related=(Related(attribute.name_span, "the attribute that is used"),),
    )


RULE = Rule("conflicting-value", Severity.WARNING, "A value is given in two ways.", machine=check)
