# SPDX-License-Identifier: Apache-2.0
"""The rule `ignored-encoding`, which ignored_encoding.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import FileContext, Rule


def check(context: FileContext) -> Iterator[Finding]:
    source, place = context.source, context.source.ignored_encoding
    if place is not None:
        declared, real = source.text[place.start : place.end], source.encoding.upper()
        reason = "begins with a byte order mark" if source.mark else "does not begin with its byte order mark"
        yield RULE.at(place, f"`{declared}` is ignored: the file {reason}, so it is read as {real}; declare {real}")


RULE = Rule(
    "ignored-encoding", Severity.WARNING, "A file is read with an encoding other than the declared one.", file=check
)
