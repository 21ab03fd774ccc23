# SPDX-License-Identifier: Apache-2.0
"""The rule `untranslatable-tree`, which untranslatable_tree.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext


def check(context: TreeContext) -> Iterator[Finding]:
    for refusal in context.refusals:
        if not refusal.unset:  # script-name reports a name that nothing sets
            yield RULE.at(refusal.span, refusal.reason)


RULE = Rule(
    "untranslatable-tree", Severity.ERROR, "A node or a script of a tree cannot be translated into a model.", tree=check
)
