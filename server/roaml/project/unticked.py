# SPDX-License-Identifier: Apache-2.0
"""Nodes of a tree that are never ticked in any state that the system can reach."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from roaml.diagnostics import Finding, Related
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.model.expand import Instance, NodeSource, node_at
from roaml.model.node_effects import statuses
from roaml.model.system import System
from roaml.model.tree import TreeNode
from roaml.project.analysis import Analysis
from roaml.project.exploration import Reached, ReachedFaultError, explored
from roaml.project.optional_branches import ByNumber, ends_only_in_failure, is_required, reactive
from roaml.rules.support import next_child
from roaml.rules.trees import never_ticked
from roaml.text import Location

if TYPE_CHECKING:
    from roaml.project.blame import Blame


def never_ticked_nodes(
    analysis: Analysis,
    system: System,
    by_number: ByNumber,
    reached: Reached,
    missed: Callable[[Instance], bool],
    blame: Blame,
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and findings about nodes in them that are never ticked although their parents are. A place
    that several instances share is reported if none of them is ticked.

    Args:
        missed: whether a node would be ticked if the nodes around it were reactive.
    """
    ticked = {number for number, is_ticked in reached.ticks.items() if is_ticked}
    known = reached.ticks.keys()
    places = {instance.source for instance in system.instances if instance.number in ticked}
    for instance in system.instances:
        before = _before(instance, by_number)
        if before is None or instance.source in places or before.number not in ticked or instance.number not in known:
            continue
        parent = by_number[before.parent] if before.parent is not None else None
        needed = next_child.needed(parent.plugin) if parent is not None else None
        if needed is None or not all(
            _decides(system, leaf, is_condition=needed is next_child.FAILS) for leaf in _leaves(before, by_number)
        ):
            continue
        is_missed = not _is_needed(system, by_number, reached, instance, before)
        if is_missed and not missed(instance):
            continue
        is_harmless = is_missed and not _has_failing_action(system, by_number, reached)
        blame.is_tree_at_fault |= needed is next_child.FAILS
        node, earlier = _written(analysis, instance.source), _written(analysis, before.source)
        if node is None or earlier is None:
            continue
        related = [Related(Location(before.source.path, earlier.element.name_span), f"never returns {needed}")]
        effects = [*related, Related(Location(instance.source.path, node.element.name_span), "never ticked")]
        cause = None if is_missed else blame.for_status(before, needed, effects)
        yield cause or (
            instance.source.path,
            never_ticked.finding(
                node,
                earlier,
                needed,
                related,
                no_run=reached.no_run,
                is_instant=reached.is_instant,
                is_missed=is_missed,
                is_harmless=is_harmless,
            ),
        )


def _is_needed(system: System, nodes: ByNumber, reached: Reached, instance: Instance, before: Instance) -> bool:
    """Whether the tree cannot succeed because a node is never ticked, or whether the node follows an action that never
    succeeds. Other nodes may be for cases that the environment does not contain."""
    if is_required(system, instance, nodes) or ends_only_in_failure(system, nodes, reached.statuses, instance):
        return True
    return any(RUNNING in statuses(system, leaf) for leaf in _leaves(before, nodes))


def _has_failing_action(system: System, nodes: ByNumber, reached: Reached) -> bool:
    failing = (nodes[number] for number, found in reached.statuses.items() if FAILURE in found)
    return any(not node.children and RUNNING in statuses(system, node) for node in failing)


def is_missed(analysis: Analysis, path: str, nodes: ByNumber, instance: Instance) -> bool:
    """Whether a node that is never ticked would be ticked if the condition before it were checked again at every
    tick."""
    other = reactive(analysis, path, instance, nodes)
    try:
        return other is not None and any(again.ticks.get(instance.number, False) for again in explored(other, path))
    except ReachedFaultError:
        return False


def _written(analysis: Analysis, source: NodeSource) -> TreeNode | None:
    file = analysis.tree(source.path)
    return None if file is None else node_at(file, source)


def _before(instance: Instance, by_number: ByNumber) -> Instance | None:
    """The sibling before a node."""
    if instance.parent is None:
        return None
    siblings = by_number[instance.parent].children
    index = siblings.index(instance.number)
    return by_number[siblings[index - 1]] if index > 0 else None


def _leaves(instance: Instance, by_number: ByNumber) -> Iterator[Instance]:
    for child in instance.children:
        yield from _leaves(by_number[child], by_number)
    if not instance.children:
        yield instance


def _decides(system: System, leaf: Instance, *, is_condition: bool) -> bool:
    """Whether a leaf is written so that it may succeed or fail. One that cannot is a simplification of a node that can
    do both. An action that never fails is usual, too: its server represents an environment without failures."""
    possible = statuses(system, leaf)
    return possible.issuperset((SUCCESS, FAILURE)) and not (is_condition and RUNNING in possible)
