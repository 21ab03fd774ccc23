# SPDX-License-Identifier: Apache-2.0
"""The rule `foreign-namespace`, which foreign_namespace.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.language import HL_SCXML, PLAIN_SCXML
from roaml.rules.rule import FileContext, Rule
from roaml.text import TextEdit
from roaml.xml_syntax.names import SCXML_NAMESPACE


def check(context: FileContext) -> Iterator[Finding]:
    if context.document is None or context.document.root is None or context.grammar is None:
        return
    root = context.document.root
    declared = root.get(f"xmlns:{root.prefix}" if root.prefix else "xmlns")
    if declared is None or not declared.value.strip():
        return
    if context.grammar in (HL_SCXML, PLAIN_SCXML):
        if declared.value != SCXML_NAMESPACE:
            fix = Fix("Change to the namespace of SCXML", (TextEdit(declared.value_span, SCXML_NAMESPACE),), safe=True)
            yield RULE.at(declared.span, f"this is not the namespace of SCXML; write `{SCXML_NAMESPACE}`", fix)
    else:
        fix = Fix("Remove the attribute", (removal(context.source.text, declared.span),), safe=True)
        fixes = [] if root.prefix else [fix]
        yield RULE.at(
            declared.span,
            "this kind of file has no namespace, and other tools may not be able to read it; remove the attribute",
            *fixes,
        )


RULE = Rule("foreign-namespace", Severity.HINT, "The root has an unexpected namespace.", file=check)
