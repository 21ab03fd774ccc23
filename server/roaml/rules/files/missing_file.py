# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-file`, which missing_file.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.disk import UnreadableReason
from roaml.facts import Facts
from roaml.rules.rule import Rule, SystemContext


class UnusableFile(Facts, frozen=True):
    problem: UnreadableReason


def check(context: SystemContext) -> Iterator[Finding]:
    for listed in context.files:
        src = listed.input.src
        if src is not None and listed.problem is not None:
            message = f"`{src.value}` cannot be used: {listed.problem.value}"
            yield RULE.at(src.span, message, facts=UnusableFile(listed.problem))


RULE = Rule(
    "missing-file", Severity.ERROR, "A system lists a file that cannot be read.", system=check, facts=UnusableFile
)
