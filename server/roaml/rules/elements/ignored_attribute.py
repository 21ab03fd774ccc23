# SPDX-License-Identifier: Apache-2.0
"""The rule `ignored-attribute`, which ignored_attribute.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity, Tag
from roaml.edit.elements import removal
from roaml.language import AttributeType
from roaml.rules.rule import FileContext, Rule
from roaml.rules.support.elements import known_elements
from roaml.text import TextEdit
from roaml.xml_syntax import Attribute, Element

CHANGES_MEANING = ("delay", "delayexpr", "initial", "src")
EFFECTIVE_ATTRIBUTES = {("param", "location"): "expr"}
"""Ignored attributes, with the attributes in which their values would have an effect."""


def check(context: FileContext) -> Iterator[Finding]:
    """Report attributes that other tools read and that have no effect on the model."""
    if context.document is None or context.grammar is None:
        return
    for element, type_, _ in known_elements(context.document, context.grammar):
        for attribute in element.attributes:
            known = type_.attributes.get(attribute.name)
            if (
                known is not None and known.ignored is False and attribute.name != "after"
            ):  # reported by delayed-transition
                yield RULE.at(
                    attribute.span,
                    f"`{attribute.name}` has no effect: {_reason(known)}",
                    _fix(context, element, attribute),
                    severity=_severity(attribute.name, context),
                    tags=(Tag.UNNECESSARY,),
                )


def _fix(context: FileContext, element: Element, attribute: Attribute) -> Fix:
    instead = EFFECTIVE_ATTRIBUTES.get((element.name, attribute.name))
    if instead is not None and element.get(instead) is None:
        return Fix(f"Change to `{instead}`", (TextEdit(attribute.name_span, instead),))
    return Fix("Remove the attribute", (removal(context.source.text, attribute.span),), preferred=False)


def _severity(name: str, context: FileContext) -> Severity:
    if context.older:
        return Severity.HINT
    return Severity.WARNING if name in CHANGES_MEANING else Severity.INFORMATION


def _reason(attribute: AttributeType) -> str:
    """The reason why an attribute has no effect: the text after "Ignored:" or "Not supported:" in its documentation,
    otherwise the second sentence of the documentation, or the first if the second gives no reason."""
    text = attribute.documentation
    first, _, second = text.partition(". ")
    reason = text.partition("Ignored:")[2].strip() or second.partition("Not supported:")[2].strip()
    reason = (reason or (second if not second.startswith(("Ignored", "It has no effect")) else "") or first).rstrip(".")
    return reason[:1].lower() + reason[1:]


RULE = Rule("ignored-attribute", Severity.INFORMATION, "An attribute has no effect on the model.", file=check)
