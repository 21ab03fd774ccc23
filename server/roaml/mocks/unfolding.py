# SPDX-License-Identifier: Apache-2.0
"""Builds the executed tree of a forest: it contains each node once for each use of its tree, with the blackboard
entries to which names in this use refer (docs/spec/mocks.md#blackboard)."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.forest.entries import entry_of, is_autoremapped, old_entry_of
from roaml.forest.forest import Forest
from roaml.forest.ports import ports_of
from roaml.lower.programs.executed import SUBTREE, ExecutedNode, ExecutedTree, identifier
from roaml.lower.programs.refusal import TreeRefusal
from roaml.model.expand import MAX_NODES, ROOT_NUMBER
from roaml.model.tree import Tree, TreeNode
from roaml.record import Record, field, replace
from roaml.text import Location

UNNAMED = "BehaviorTree_0"
"""The name that BehaviorTree.CPP gives to the only tree of a file if it has no `ID`."""

MAX_DEPTH = 200
"""The maximum nesting depth of nodes and subtrees."""


class TreeFrame(Record, frozen=True, eq=False):
    """One use of a tree, which determines the blackboard entries to which names in the tree refer.

    Attributes:
        prefix: the prefix of the full names of the entries that belong to this use.
        remapped: names in the tree, with the full names of the outer entries to which they refer.
        autoremap: whether all other names, except those that begin with `_`, refer to the entries of `outer`.
        outer: the frame of the tree that contains this one; `None` for the main tree.
        trees: the names of this tree and of the trees that contain it.
    """

    prefix: str
    remapped: Mapping[str, str]
    autoremap: bool
    outer: TreeFrame | None
    trees: frozenset[str]

    def entry(self, name: str) -> str:
        """The full name of the entry to which a name refers."""
        if name.startswith("@"):
            return identifier(name[1:])
        frame = self
        while name not in frame.remapped and frame.autoremap and frame.outer is not None and name[:1] != "_":
            frame = frame.outer
        return frame.remapped.get(name) or identifier(frame.prefix + name)


def unfold(forest: Forest) -> ExecutedTree:
    """The executed tree of the analysed file.

    Raises:
        TreeRefusal: the file has no executed tree, it is not clear which tree is executed, or the tree is invalid.
    """
    tree = main_tree(forest)
    unfolder = _Unfolder(forest)
    name = tree.id.value if tree.id is not None else UNNAMED
    unfolder.tree(forest.path, tree, TreeFrame("", {}, False, None, frozenset((name,))), 0)
    return ExecutedTree(name, _numbered(unfolder.nodes), unfolder.initial, forest.settings.version)


def _numbered(places: Mapping[int, ExecutedNode]) -> tuple[ExecutedNode, ...]:
    """The nodes in pre-order. They have the numbers of a system's tree and of pictures, which do not number
    `<SubTree>`; these have the numbers after the last node.

    Args:
        places: place in pre-order -> the node. The number and the children of a node are places.
    """
    order = sorted(places, key=lambda place: (places[place].is_subtree, place))
    numbers = {place: number for number, place in enumerate(order, ROOT_NUMBER)}
    return tuple(
        replace(node, number=numbers[place], children=tuple(numbers[child] for child in node.children))
        for place, node in sorted(places.items())
    )


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
    used = {
        node.plugin.value
        for _, _, node in forest.all_nodes
        if node.plugin is not None and (node.is_subtree or forest.names_tree(node))
    }
    candidates = named if len(named) == 1 else [tree for tree in named if tree.id and tree.id.value not in used]
    if len(candidates) == 1:
        return candidates[0]
    if len(file.trees) == 1:
        return file.trees[0]
    place = Location(forest.path, file.element.name_span)
    if not named:
        raise TreeRefusal(place, "the file has no tree with an `ID`")
    raise TreeRefusal(place, "it is not clear which tree is executed; set `main_tree_to_execute`")


class _Unfolder(Record):
    forest: Forest
    nodes: dict[int, ExecutedNode] = field(default_factory=dict)
    initial: dict[str, str] = field(default_factory=dict)
    count: int = 0
    prefixes: dict[str, int] = field(default_factory=dict)

    def tree(self, path: str, tree: Tree, frame: TreeFrame, depth: int) -> int:
        if len(tree.roots) != 1:
            place = Location(path, tree.element.name_span)
            raise TreeRefusal(place, f"a tree needs exactly one root node, not {len(tree.roots)}")
        return self.node(path, tree.roots[0], frame, depth)

    def node(self, path: str, node: TreeNode, frame: TreeFrame, depth: int) -> int:
        origin = Location(path, node.element.name_span)
        if self.count >= MAX_NODES or depth > MAX_DEPTH:
            raise TreeRefusal(
                origin, f"the tree is too large: at most {MAX_NODES} nodes and {MAX_DEPTH} levels of nesting"
            )
        place = self.count
        self.count += 1
        type_ = node.plugin.value if node.plugin else ""
        name = node.name.value if node.name else type_
        if node.is_subtree or self.forest.names_tree(node):
            if type_ not in self.forest.trees:
                raise TreeRefusal(origin, f"there is no tree `{type_}`")
            inner_path, inner = self.forest.trees[type_]
            child = self.tree(inner_path, inner, self.enter(node, name, type_, frame, origin), depth + 1)
            self.nodes[place] = ExecutedNode(place, SUBTREE, name, node, None, frame, (child,), origin)
            return place
        known = self.forest.known_node(node)
        if self.forest.is_version_3:
            self.refuse_old(node, origin)
            # Version 4 has other names for some nodes of version 3.
            type_ = known.name if known is not None else type_
        children = tuple(self.node(path, below, frame, depth + 1) for below in node.children)
        self.nodes[place] = ExecutedNode(place, type_, name, node, known, frame, children, origin)
        return place

    def refuse_old(self, node: TreeNode, origin: Location) -> None:
        """Refuse a port of version 3 whose meaning is not that of a port of version 4.

        Raises:
            TreeRefusal: the node has such a port.
        """
        if node.plugin is not None and node.plugin.value == "Parallel" and node.element.get("threshold"):
            reason = "`threshold` is the name of the port before version 3.5; write `success_threshold`"
            raise TreeRefusal(origin, reason)

    def enter(self, node: TreeNode, name: str, type_: str, frame: TreeFrame, origin: Location) -> TreeFrame:
        if type_ in frame.trees:
            raise TreeRefusal(origin, f"the tree `{type_}` contains itself")
        word = f"{frame.prefix}{identifier(name)}"
        count = self.prefixes[word] = self.prefixes.get(word, 0) + 1
        prefix = f"{word}__" if count == 1 else f"{word}_{count}__"
        remapped: dict[str, str] = {}
        model = self.forest.subtree_models.get(type_)
        given = {setting.attribute.name for setting in ports_of(node)}
        defaults = [p for p in model.ports if p.default is not None and p.name not in given] if model else []
        for port in defaults:
            self.initial[identifier(prefix + port.name)] = port.default or ""
        is_old = self.forest.is_version_3
        for setting in ports_of(node):
            key, bound = setting.attribute.name, old_entry_of(node, setting) if is_old else entry_of(setting)
            if bound is None:
                self.initial[identifier(prefix + key)] = setting.value.value
                remapped[key] = identifier(prefix + key)
            else:
                remapped[key] = frame.entry(bound)
        return TreeFrame(prefix, remapped, is_autoremapped(node, version_3=is_old), frame, frame.trees | {type_})
