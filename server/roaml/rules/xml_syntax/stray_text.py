# SPDX-License-Identifier: Apache-2.0
"""The rule `stray-text`, which stray_text.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language.validate import StrayText
from roaml.regex import regex
from roaml.rules.rule import FileContext, Rule
from roaml.text import TextEdit

DASHES = regex("-(?=-)")
"""Each hyphen before another hyphen; a comment may not contain `--`."""


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if isinstance(violation, StrayText):
            text = context.source.text[violation.span.start : violation.span.end]
            comment = Fix(
                "Convert to a comment", (TextEdit(violation.span, f"<!-- {DASHES.sub('- ', text)} -->"),), safe=True
            )
            yield RULE.at(
                violation.span,
                f"text in `<{violation.parent.name}>` has no effect; remove it or make it a comment",
                comment,
            )


RULE = Rule("stray-text", Severity.WARNING, "Text is in a place where only elements have a meaning.", file=check)
