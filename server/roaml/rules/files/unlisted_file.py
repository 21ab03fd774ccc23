# SPDX-License-Identifier: Apache-2.0
"""The rule `unlisted-file`, which unlisted_file.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import last_in
from roaml.model.system_file import SystemSection
from roaml.rules.rule import Rule, SystemContext


def check(context: SystemContext) -> Iterator[Finding]:
    section = context.file.element.find(SystemSection.PROPERTIES.value)
    is_unfinished = section is not None and not (section.complete and section.elements)
    if SystemSection.PROPERTIES in context.file.unread or is_unfinished:
        return
    for path in context.unlisted:
        message = (
            f"no system lists the property file `{path}` beside it, so its properties are not checked; list it or move "
            "it to another folder"
        )
        place = section or context.file.element
        fixes = []
        if section is not None:
            kind = "jani" if path.endswith(".jani") else "xml"
            edit = last_in(context.document, section, f'<input type="{kind}" src="{path}" />')
            fixes.append(Fix(f"List `{path}`", (edit,), preferred=False))
        yield RULE.at(place.name_span, message, *fixes)


RULE = Rule(
    "unlisted-file", Severity.WARNING, "A property file lies beside a system, and no system lists it.", system=check
)
