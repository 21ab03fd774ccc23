# SPDX-License-Identifier: Apache-2.0
"""missing-file: see missing_file.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, SystemContext


def check(context: SystemContext) -> Iterator[Finding]:
    for listed in context.files:
        src = listed.input.src
        if src is not None and listed.problem:
            yield RULE.at(src.span, f"`{src.value}` cannot be used: {listed.problem}")


RULE = Rule("missing-file", Severity.ERROR, "A system lists a file that cannot be read.", system=check)
