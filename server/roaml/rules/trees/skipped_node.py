# SPDX-License-Identifier: Apache-2.0
"""The rule `skipped-node`, which skipped_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.tree import blackboard_variable, nodes
from roaml.rules.rule import Rule, TreeContext


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is None or context.system.is_library_tree:
        return
    for tree in context.file.trees:
        for node in nodes(tree):
            if node.plugin is not None and node.plugin.value == "RunOnce":
                skip = node.element.get("then_skip")
                variable = blackboard_variable(skip.value) if skip else None
                if skip is None or variable is not None or skip.value.strip() == "true":
                    when = f" if `{variable}` is true" if variable else ""
                    message = (
                        f"after its first run, this node returns SUCCESS in the model{when}, but BehaviorTree.CPP "
                        "skips it"
                    )
                    yield RULE.at(node.plugin.span, message)


RULE = Rule(
    "skipped-node", Severity.INFORMATION, "The model returns SUCCESS where BehaviorTree.CPP skips a node.", tree=check
)
