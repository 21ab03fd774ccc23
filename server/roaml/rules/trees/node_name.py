# SPDX-License-Identifier: Apache-2.0
"""The rule `node-name`, which node_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.tree import nodes
from roaml.regex import regex
from roaml.rules.rule import Rule, TreeContext
from roaml.scxml.names import safe_name
from roaml.text import TextEdit

IDENTIFIER = regex(r"[A-Za-z0-9_.-]+\Z")


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for tree in context.file.trees:
        for node in nodes(tree):
            if node.name is not None and not node.is_subtree and not IDENTIFIER.match(node.name.value):
                safe = safe_name(node.name.value)
                message = f"`{node.name.value}` is not an identifier; generated names use `{safe}`"
                yield RULE.at(node.name.span, message, Fix(f"Rename to `{safe}`", (TextEdit(node.name.span, safe),)))


RULE = Rule("node-name", Severity.WARNING, "The name of a node is not an identifier.", tree=check)
