# SPDX-License-Identifier: Apache-2.0
"""The rule `untranslatable-tree`, which untranslatable_tree.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.script_types import type_problems


def check(context: TreeContext) -> Iterator[Finding]:
    if not context.refusals:
        return
    errors = [use.attribute.value_span for use, _, _, severity in type_problems(context) if severity is None]
    for refusal in context.refusals:
        # script-name reports a name that nothing sets, and script-type an operation that fails.
        if not refusal.unset and not any(span.start <= refusal.span.start < span.end for span in errors):
            yield RULE.at(refusal.span, refusal.reason)


RULE = Rule(
    "untranslatable-tree", Severity.ERROR, "A node or a script of a tree cannot be translated into a model.", tree=check
)
