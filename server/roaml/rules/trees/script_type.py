# SPDX-License-Identifier: Apache-2.0
"""The rule `script-type`, which script_type.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.script_types import type_problems
from roaml.rules.support.scripts import fixes


def check(context: TreeContext) -> Iterator[Finding]:
    for use, problem, is_condition, severity in type_problems(context):
        message = f"`{use.attribute.name}` is a condition: {problem.message}" if is_condition else problem.message
        yield RULE.at(problem.span, message, *fixes(context, use.attribute, problem), severity=severity)


RULE = Rule("script-type", Severity.ERROR, "An operation of a script always fails.", tree=check)
