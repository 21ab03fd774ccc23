# SPDX-License-Identifier: Apache-2.0
"""missing-parameter: see missing_parameter.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import SYSTEM
from roaml.rules import misspelled
from roaml.rules.rule import Rule, SystemContext
from roaml.text import Span, TextEdit
from roaml.xml import Element

MAX_TIME = '<max_time value="100" unit="s" />'


def check(context: SystemContext) -> Iterator[Finding]:
    root = context.file.element
    section = root.find("parameters") or root.find("mc_parameters")
    if section is None:
        if not misspelled.among(root.elements, "parameters", SYSTEM):
            fix = _insert(root, f"<parameters>\n        {MAX_TIME}\n    </parameters>", "    ")
            yield RULE.at(root.name_span, "the system has no `<parameters>`: `<max_time>` must be given", *fix)
    elif section.find("max_time") is None and not misspelled.among(section.elements, "max_time", SYSTEM):
        fix = _insert(section, MAX_TIME, "        ")
        yield RULE.at(section.name_span, "`<max_time>` must be given: how long the clock runs", *fix)


def _insert(parent: Element, text: str, indent: str) -> Iterator[Fix]:
    """Put `text` on a line of its own at the beginning of an element."""
    title = f"Add `{text.partition('>')[0].partition(' ')[0]}>`"
    at = parent.open_span.end
    if not parent.self_closing:
        yield Fix(title, (TextEdit(Span(at, at), f"\n{indent}{text}"),))
    elif parent.complete:
        end = f"\n{indent.removesuffix('    ')}</{parent.name}>"
        yield Fix(title, (TextEdit(Span(at - 2, at), f">\n{indent}{text}{end}"),))


RULE = Rule("missing-parameter", Severity.ERROR, "A parameter that the translation needs is missing.", system=check)
