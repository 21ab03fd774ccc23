# SPDX-License-Identifier: Apache-2.0
"""The rule `untranslatable-tree`, which untranslatable_tree.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext


def check(context: TreeContext) -> Iterator[Finding]:
    for span, reason in context.refusals:
        yield RULE.at(span, reason)


RULE = Rule(
    "untranslatable-tree", Severity.ERROR, "A node or a script of a tree cannot be translated into a model.", tree=check
)
