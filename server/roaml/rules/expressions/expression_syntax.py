# SPDX-License-Identifier: Apache-2.0
"""The rule `expression-syntax`, which expression_syntax.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.parse import SYNTAX
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule
from roaml.xml_syntax.names import SPACE


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        # invalid-value reports empty expressions
        if isinstance(value.value, Expression) and value.value.text.strip(SPACE):
            yield from (finding for finding in value.value.findings if finding.code == SYNTAX)


RULE = Rule("expression-syntax", Severity.ERROR, "An expression is not complete or not well-formed.", machine=check)
