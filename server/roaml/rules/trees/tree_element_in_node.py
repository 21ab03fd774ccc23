# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-element-in-node`, which tree_element_in_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import remove
from roaml.model.system_file import SystemSection
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.elements import own_elements


def check(context: MachineContext) -> Iterator[Finding]:
    if SystemSection.NODE_MODELS not in context.listed_as or SystemSection.BEHAVIOR_TREE in context.listed_as:
        return
    for element in own_elements(context.document):
        if not element.name.startswith("bt_"):
            continue
        if element.name.startswith("bt_declare_port"):
            message = (
                "a ROS node has no ports, so this has no effect; list the file in `<behavior_tree>` if it is a plugin"
            )
            drop = remove(context.document, element)
            yield RULE.at(element.name_span, message, drop, severity=Severity.WARNING)
        else:
            message = (
                f"`<{element.name}>` is only allowed in a plugin of the behavior tree, and this file is "
                "listed as a node"
            )
            yield RULE.at(element.name_span, message)


RULE = Rule("tree-element-in-node", Severity.ERROR, "A node uses an element of behavior tree plugins.", machine=check)
