# SPDX-License-Identifier: Apache-2.0
"""Builds the executed tree of a forest: it contains each node once for each use of its tree, with the blackboard
entries to which names in this use refer (docs/spec/mocks.md#blackboard)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.forest.expanded import forest_outlines
from roaml.forest.forest import Forest
from roaml.libraries.programs.assembly import reads_world
from roaml.libraries.version import Version
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree, FrameNames, TreeLinks, identifier
from roaml.lower.programs.nodes import is_own_parent
from roaml.lower.programs.refusal import TreeRefusal
from roaml.mocks.mock import Mock, MockableWords, likeness_for
from roaml.model.expand import (
    MAX_NODES,
    MAX_SUBTREES,
    ROOT_NUMBER,
    Expansion,
    PortConstant,
    entered_uses,
    expand,
)
from roaml.model.tree import Tree
from roaml.record import replace
from roaml.text import Location

UNNAMED = "BehaviorTree_0"
"""The name that BehaviorTree.CPP gives to the only tree of a file if it has no `ID`."""


class _Names(FrameNames, frozen=True, eq=False):
    """The names in one use of a tree, which may have characters that the names of variables do not have."""

    def entry(self, name: str) -> str:
        return identifier(super().entry(name))


def unfold(forest: Forest, mocks: Sequence[Mock] = ()) -> ExecutedTree:
    """The executed tree of the analysed file.

    Args:
        mocks: those that state like which nodes of libraries other nodes with children are executed are applied.

    The nodes have the numbers of a system's tree and of pictures, which do not number `<SubTree>`; these have the
    numbers after the last node.

    Raises:
        TreeRefusal: the file has no executed tree, it is not clear which tree is executed, or the tree is invalid.
    """
    tree = main_tree(forest)
    name = tree.id.value if tree.id is not None else ""
    files = forest_outlines(forest)
    main = next(each for file in files for each in file.trees if each.id == name and (name or file.path == forest.path))
    expansion = expand(files, main, takes_all=True)
    links = TreeLinks(dict(forest.files), {}, _Names)
    _check(forest, tree, expansion, links)
    for value in (value for frame in expansion.frames for value in frame.remapped.values()):
        if isinstance(value, PortConstant):
            links.initial[identifier(value.variable)] = value.text
    version = forest.settings.version
    nodes = tuple(_like_library(node, mocks, version) for node in _nodes(forest, expansion, links))
    return ExecutedTree(name or UNNAMED, nodes, links.initial, forest.settings.version)


def _nodes(forest: Forest, expansion: Expansion, links: TreeLinks) -> Iterator[ExecutedNode]:
    """The nodes in pre-order, with those that stand for subtrees."""
    instances, uses = expansion.instances, expansion.uses
    use_of = {instance.number: instance.use for instance in instances}
    before = ROOT_NUMBER + len(instances) - 1
    entered = {each.number: entered_uses(uses, each.use, use_of.get(each.parent or 0)) for each in instances}
    for instance in instances:
        inside = entered[instance.number]
        for use, below in zip(inside, (*(before + use for use in inside[1:]), instance.number), strict=False):
            yield links.subtree(before + use, uses[use], below)
        children = tuple(before + entered[child][0] if entered[child] else child for child in instance.children)
        known = forest.known_node(links.source(instance.source))
        yield links.node(instance, uses[instance.use].frame, known, children)


def _like_library(node: ExecutedNode, mocks: Sequence[Mock], version: Version) -> ExecutedNode:
    """A node as it is executed: a node with children that no library describes like the one that a mock names."""
    if not is_own_parent(node, version):
        return node
    mock = likeness_for(mocks, node.name, node.type)
    if mock is None or mock.like is None:
        return node
    written = {port for port, _, _, _ in node.ports()}
    constants = tuple((port, value) for port, value in mock.like.ports if port not in written)
    return replace(node, type=mock.like.type, known=mock.like.node, constants=constants, own_type=node.type)


def mockable_words(tree: ExecutedTree) -> MockableWords:
    """What mocks can call the nodes of an executed tree. A node that is executed like one whose event depends on the
    world can have a mock for the event, too."""
    nodes: dict[str, None] = {}
    parents: dict[str, None] = {}
    for node in tree.nodes:
        if node.own_type:
            parents.update(dict.fromkeys((node.name, node.own_type)))
        if not node.own_type or reads_world(node.type):
            nodes.update(dict.fromkeys((node.name, node.own_type or node.type, node.type)))
    return MockableWords("the tree", tuple(nodes), tuple(parents))


def _check(forest: Forest, tree: Tree, expansion: Expansion, links: TreeLinks) -> None:
    """Check that a tree is expanded, with all subtrees.

    Raises:
        TreeRefusal: it is not, a tree has no root or several, or a port has lost its meaning.
    """
    trees = [(forest.path, tree), *(forest.trees[frame.tree.id] for frame in expansion.frames[1:])]
    for source in expansion.left_out:
        node = links.source(source)
        name = node.plugin.value if node.plugin else ""
        if name not in forest.trees:
            raise TreeRefusal(Location(source.path, node.element.name_span), f"there is no tree `{name}`")
        if forest.trees[name][1].roots:
            raise TreeRefusal(Location(source.path, node.element.name_span), f"the tree `{name}` contains itself")
        trees.append(forest.trees[name])
    for path, each in trees:
        if len(each.roots) != 1:
            reason = f"a tree needs exactly one root node, not {len(each.roots)}"
            raise TreeRefusal(Location(path, each.element.name_span), reason)
    if not expansion.instances:
        reason = f"the tree is too large: at most {MAX_NODES} nodes and {MAX_SUBTREES} subtrees inside each other"
        raise TreeRefusal(Location(forest.path, tree.element.name_span), reason)
    for instance in expansion.instances:
        node = links.source(instance.source)
        if instance.plugin == "Parallel" and node.element.get("threshold") and forest.is_of_version_3(node):
            reason = "`threshold` is the name of the port before version 3.5; write `success_threshold`"
            raise TreeRefusal(Location(instance.source.path, node.element.name_span), reason)


def main_tree(forest: Forest) -> Tree:
    """The tree that is executed.

    Raises:
        TreeRefusal: there is none, or it is not clear which one is executed.
    """
    file = forest.file
    named = [tree for tree in file.trees if tree.id is not None]
    if file.main is not None:
        if file.main.value in forest.trees:
            return forest.trees[file.main.value][1]
        raise TreeRefusal(Location(forest.path, file.main.span), f"there is no tree `{file.main.value}`")
    used = {node.plugin.value for _, _, node in forest.all_nodes if node.plugin is not None and forest.calls_tree(node)}
    candidates = named if len(named) == 1 else [tree for tree in named if tree.id and tree.id.value not in used]
    if len(candidates) == 1:
        return candidates[0]
    if len(file.trees) == 1:
        return file.trees[0]
    place = Location(forest.path, file.element.name_span)
    if not named:
        raise TreeRefusal(place, "the file has no tree with an `ID`")
    raise TreeRefusal(place, "it is not clear which tree is executed; set `main_tree_to_execute`")
