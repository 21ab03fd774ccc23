# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-parameter`, which missing_parameter.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import first_in
from roaml.language import SYSTEM
from roaml.rules.rule import Rule, SystemContext
from roaml.rules.support import misspelled
from roaml.xml_syntax import Element

MAX_TIME = '<max_time value="100" unit="s" />'


def check(context: SystemContext) -> Iterator[Finding]:
    root = context.file.element
    section = root.find("parameters") or root.find("mc_parameters")
    if section is None:
        if not misspelled.among(root.elements, "parameters", SYSTEM):
            fix = _insert(context, root, "<parameters>", f"    {MAX_TIME}", "</parameters>")
            yield RULE.at(root.name_span, "the system has no `<parameters>`; add them with `<max_time>`", *fix)
    elif section.find("max_time") is None and not misspelled.among(section.elements, "max_time", SYSTEM):
        fix = _insert(context, section, MAX_TIME)
        yield RULE.at(section.name_span, "`<max_time>` is missing; add it to limit the simulated time", *fix)


def _insert(context: SystemContext, parent: Element, *lines: str) -> Iterator[Fix]:
    if parent.complete:
        name = lines[0].partition(">")[0].partition(" ")[0]
        yield Fix(f"Add `{name}>`", (first_in(context.document, parent, *lines),))


RULE = Rule("missing-parameter", Severity.ERROR, "A required parameter is missing.", system=check)
