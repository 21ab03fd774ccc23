# SPDX-License-Identifier: Apache-2.0
"""The rule `script-syntax`, which script_syntax.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.scripts import fixes, scripts
from roaml.script.infer import statements_without_effect


def check(context: TreeContext) -> Iterator[Finding]:
    for _, use, script, problems in scripts(context):
        for problem in problems:
            message = f"script of `{use.attribute.name}`: {problem.message}"
            yield RULE.at(problem.span, message, *fixes(context, use.attribute, problem))
        if not problems:
            for problem in statements_without_effect(script, has_value=use.is_condition):
                own_fixes = fixes(context, use.attribute, problem)
                yield RULE.at(problem.span, problem.message, *own_fixes, severity=Severity.WARNING)


RULE = Rule("script-syntax", Severity.ERROR, "A script does not follow the grammar of scripts.", tree=check)
