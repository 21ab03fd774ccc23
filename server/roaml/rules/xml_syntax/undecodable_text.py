# SPDX-License-Identifier: Apache-2.0
"""The rule `undecodable-text`, which undecodable_text.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import FileContext, Rule


def check(context: FileContext) -> Iterator[Finding]:
    if context.source.undecodable is not None:
        yield RULE.at(context.source.undecodable, "not valid UTF-8 from here on; save the file as UTF-8")


RULE = Rule("undecodable-text", Severity.ERROR, "The bytes of the file are not valid in its encoding.", file=check)
