# SPDX-License-Identifier: Apache-2.0
"""The rule `late-condition`, which late_condition.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.forest import Forest
from roaml.forest.names import READS_AS_CONDITION
from roaml.forest.statuses import statuses_of
from roaml.libraries.programs.statuses import RUNNING
from roaml.model.outline import MachineOutline
from roaml.model.tree import TreeNode
from roaml.roles import ProtocolPart
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of

REACTIVE = ("ReactiveSequence", "ReactiveFallback")
_COMMANDS = frozenset((ProtocolPart.MESSAGE, ProtocolPart.GOAL))
"""What a plugin sends for another purpose than its result."""


def check(context: TreeContext) -> Iterator[Finding]:
    """Report reactive nodes whose conditions all follow the action, so that nothing is checked while it is RUNNING."""
    forest = trees_of(context)
    for _, node in forest.own_nodes if forest is not None else ():
        if forest is None or node.plugin is None or node.plugin.value not in REACTIVE or len(node.children) < 2:
            continue
        first, *others = node.children
        if not _may_run(forest, first) or not _is_condition(forest, others[-1]):
            continue
        if all(_is_condition(forest, other) for other in others):
            message = (
                f"`{node.plugin.value}` checks this condition only after `{first.type_name}` has ended, not while it "
                "is RUNNING; put the condition before it"
            )
            related = [Related(first.element.name_span, "may be RUNNING")]
            yield RULE.at(others[0].element.name_span, message, related=related)


def _may_run(forest: Forest, node: TreeNode) -> bool:
    """Whether a node is known to return RUNNING at some time."""
    is_known = all(
        forest.calls_tree(inner) or forest.known_node(inner) is not None or inner.element.name == "Action"
        for inner in _inside(node)
    )
    return is_known and RUNNING in statuses_of(forest).statuses(node)[node].ever


def _is_condition(forest: Forest, node: TreeNode) -> bool:
    """Whether a node is a condition, possibly inverted: it never returns RUNNING."""
    while node.type_name == "Inverter" and len(node.children) == 1:
        node = node.children[0]
    if node.children or forest.calls_tree(node):
        return False
    known = forest.known_node(node)
    if known is not None and forest.is_machine(known):
        outline = forest.system.plugin(known.name)[1] if forest.system is not None else None
        is_named_so = node.element.name == "Condition" or READS_AS_CONDITION.match(known.name) is not None
        is_silent = outline is not None and _only_answers(outline, is_named_so=is_named_so)
        return is_silent and RUNNING not in statuses_of(forest).statuses(node)[node].ever
    return forest.is_condition(node)


def _only_answers(outline: MachineOutline, *, is_named_so: bool) -> bool:
    """Whether a plugin has no other effect than its status. A request may be a question or a command."""
    sends = {part for use in outline.interfaces for part in use.sends}
    has_effect = bool(outline.sent or sends & _COMMANDS) or any(port.written for port in outline.ports)
    return not has_effect and (is_named_so or ProtocolPart.REQUEST not in sends)


def _inside(node: TreeNode) -> Iterator[TreeNode]:
    yield node
    for child in node.children:
        yield from _inside(child)


RULE = Rule(
    "late-condition",
    Severity.WARNING,
    "A reactive node checks its conditions only after its action.",
    tree=check,
)
