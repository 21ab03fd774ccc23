# SPDX-License-Identifier: Apache-2.0
"""The rule `hidden-failure`, which hidden_failure.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.forest import CPP, Forest
from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.forest.scripts import scripts_of
from roaml.forest.statuses import PossibleStatuses
from roaml.libraries import Node
from roaml.libraries.programs.statuses import FAILURE, SUCCESS
from roaml.model.tree import TreeNode
from roaml.roles import ProtocolPart
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of
from roaml.script.names import names_in

_FORCED = ("ForceSuccess", "ForceFailure")
_ALWAYS = ("AlwaysSuccess", "AlwaysFailure")
_SEQUENCES = ("Sequence", "ReactiveSequence", "SequenceWithMemory", "AsyncSequence")
_FALLBACKS = ("Fallback", "ReactiveFallback", "AsyncFallback")
_ENDS = frozenset((SUCCESS, FAILURE))


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    reported: set[TreeNode] = set()
    statuses = PossibleStatuses(forest, exact=True)
    for tree in context.file.trees:
        for root in tree.roots:
            if any(statuses.unreached(root)):
                continue  # another finding states why failures have no effect
            for retrying, hiding in statuses.hidden_failures(root):
                reported.add(hiding)
                message = (
                    f"`{hiding.type_name}` never fails although nodes below it can, so `{retrying.type_name}` above it "
                    f"never ticks its child again; remove `{hiding.type_name}`, or move it above `{retrying.type_name}`"
                )
                related = [Related(retrying.element.name_span, "waits for a failure")]
                yield RULE.at(hiding.element.name_span, message, related=related)
    results: dict[TreeNode, frozenset[int]] = {}
    for _, node in reversed(forest.own_nodes):
        results[node] = _combined(forest, node, [results[child] for child in node.children])
    for _, node in forest.own_nodes:
        ineffective = _ineffective(node, results) if node not in reported else None
        if ineffective is not None:
            yield RULE.at(node.element.name_span, _message(node, ineffective))


def _message(node: TreeNode, condition: TreeNode) -> str:
    if node.type_name in _FORCED:
        message = f"`{node.type_name}` hides what the condition `{condition.type_name}` returns, so it has no effect"
        return f"{message}; remove one of them"
    return (
        f"`{node.type_name}` always returns the same, whatever the condition `{condition.type_name}` returns, so the "
        "condition has no effect; remove it, or change the other children"
    )


def _ineffective(node: TreeNode, results: Mapping[TreeNode, frozenset[int]]) -> TreeNode | None:
    """The condition whose result has no effect, because a node above it that only combines conditions always returns
    the same."""
    if not node.children or len(results[node]) != 1:
        return None
    is_sequence = node.type_name in _SEQUENCES
    for child in node.children:
        statuses = results[child]
        if len(statuses) > 1:
            inner = child
            while inner.children:
                inner = next(below for below in inner.children if len(results[below]) > 1)
            return inner
        if node.type_name not in _FORCED and (FAILURE if is_sequence else SUCCESS) in statuses:
            return None  # unreached-node reports the children behind it
    return None


def _combined(forest: Forest, node: TreeNode, below: Sequence[frozenset[int]]) -> frozenset[int]:
    """The statuses with which a node without another effect may end, if all conditions below it may hold or not; none
    for other nodes."""
    name, declared = node.type_name, forest.known_node(node)
    if node.scripts or not all(below):
        return frozenset()
    if not node.children and _is_condition(forest, node):
        return _ENDS
    if declared is None or declared is not CPP.nodes.get(name):
        return frozenset()
    match name:
        case "AlwaysSuccess" | "ForceSuccess":
            return frozenset((SUCCESS,))
        case "AlwaysFailure" | "ForceFailure":
            return frozenset((FAILURE,))
        case "Inverter" if len(below) == 1:
            return frozenset(FAILURE if status == SUCCESS else SUCCESS for status in below[0])
    if not below or name not in (*_SEQUENCES, *_FALLBACKS):
        return frozenset()
    all_, one = (SUCCESS, FAILURE) if name in _SEQUENCES else (FAILURE, SUCCESS)
    ends = {one} if any(one in statuses for statuses in below) else set()
    return frozenset(ends | {all_} if all(all_ in statuses for statuses in below) else ends)


def _is_condition(forest: Forest, node: TreeNode) -> bool:
    """Whether a leaf has no other effect than its result: a condition, or a plugin that is like one."""
    known = forest.known_node(node)
    if known is not None and known is CPP.nodes.get(node.type_name) and node.type_name in _ALWAYS:
        return False
    is_condition = forest.is_condition(node)
    if not is_condition and not (known is not None and forest.is_machine(known) and _only_tells(forest, known)):
        return False
    return not _may_write(forest, node, known) and not _sends(forest, known)


def _only_tells(forest: Forest, known: Node) -> bool:
    """Whether a plugin returns SUCCESS or FAILURE at once, depending on what it has received, and sends nothing else.
    One that always returns the same is a dummy of an action."""
    outline = forest.system.plugin(known.name)[1] if forest.system is not None else None
    if outline is None or outline.plugin.statuses.ever != {"SUCCESS", "FAILURE"}:
        return False
    received = any(use.receives for use in outline.interfaces)
    return received and not any(use.sends for use in outline.interfaces) and not outline.timers


def _sends(forest: Forest, known: Node | None) -> bool:
    """Whether a plugin sends messages, goals or events, which is another purpose than its result."""
    if known is None or forest.system is None or not forest.is_machine(known):
        return False
    outline = forest.system.plugin(known.name)[1]
    if outline is None:
        return True
    return bool(outline.sent) or any(
        part in use.sends for use in outline.interfaces for part in (ProtocolPart.MESSAGE, ProtocolPart.GOAL)
    )


def _may_write(forest: Forest, node: TreeNode, known: Node | None) -> bool:
    """Whether a node may write to the blackboard, which is another purpose than its result."""
    for script in scripts_of(forest, node):
        if any(operator != "read" for _, operator in names_in(script.attribute.value)):
            return True
    for setting in ports_of(node):
        port = known.port(setting.attribute.name) if known is not None else None
        if entry_of(setting) is not None and (port is None or port.direction.writes):
            return True
    return False


RULE = Rule(
    "hidden-failure",
    Severity.WARNING,
    "A node hides the failures that a node above it waits for, or the result of a condition.",
    tree=check,
)
