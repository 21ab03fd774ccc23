# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-parameter`, which repeated_parameter.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import removal
from roaml.rules.rule import Rule, SystemContext
from roaml.xml_syntax import Element


def check(context: SystemContext) -> Iterator[Finding]:
    root = context.file.element
    newer, older = root.find("parameters"), root.find("mc_parameters")
    section = newer or older
    if newer is not None and older is not None:
        related = (Related(newer.name_span, "this section is used"),)
        fix = Fix("Remove `<mc_parameters>`", (removal(context.source.text, older.span),), safe=True)
        yield RULE.at(
            older.name_span, "`<mc_parameters>` is ignored: `<parameters>` takes precedence", fix, related=related
        )
    last: dict[str, Element] = {}
    for element in reversed(section.elements if section else []):
        if last.setdefault(element.name, element) is not element:
            related = (Related(last[element.name].name_span, "this value is used"),)
            remove = Fix(f"Remove this `<{element.name}>`", (removal(context.source.text, element.span),), safe=True)
            yield RULE.at(
                element.name_span,
                f"`<{element.name}>` is ignored: only the last value is used",
                remove,
                related=related,
            )


RULE = Rule("repeated-parameter", Severity.WARNING, "A parameter is given twice.", system=check)
