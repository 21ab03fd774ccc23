# SPDX-License-Identifier: Apache-2.0
"""The executed tree with all its instances: subtrees put in place, nodes numbered, ports bound (spec/02 §3.3, §7.1).

- Works on outlines, which hold no places: an instance knows its file, its tree and its position in that tree.
- What cannot be expanded (an unknown or recursive subtree) is left out; rules on the files themselves report it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import TypeAlias

from roaml.model.tree import TreeFile, TreeNode, blackboard_variable, nodes, port_key

ROOT_NUMBER = 1000


@dataclass(frozen=True, slots=True)
class NodeOutline:
    """A node without places. `position` counts the nodes of its tree in pre-order from 0; `condition` tells that it is
    written as `<Condition>`."""

    position: int
    plugin: str
    name: str
    is_subtree: bool
    attributes: tuple[tuple[str, str], ...]
    children: tuple[NodeOutline, ...]
    condition: bool = False


@dataclass(frozen=True, slots=True)
class TreeOutline:
    path: str
    id: str
    root: NodeOutline | None


@dataclass(frozen=True, slots=True)
class TreeFileOutline:
    """A file of trees without places. `defaults` are (plugin, port, value) of `<TreeNodesModel>`, `conditions` the
    plugins that are conditions there."""

    path: str
    main: str
    trees: tuple[TreeOutline, ...]
    defaults: tuple[tuple[str, str, str], ...]
    conditions: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Constant:
    """A port holds this text."""

    text: str


@dataclass(frozen=True, slots=True)
class Reference:
    """A port is bound to the blackboard variable of this full name."""

    variable: str


PortValue: TypeAlias = Constant | Reference


@dataclass(frozen=True, slots=True)
class Source:
    """The node of a file that something was made of."""

    path: str
    tree: str
    position: int


@dataclass(frozen=True, slots=True)
class Instance:
    """One node of the executed tree.

    Attributes:
        number: 1000 for the root, then counted in pre-order; part of event names.
        automaton: `BT_plugin_<number>_<name>`.
        ports: what the tree sets, defaults of `<TreeNodesModel>` included.
        children: the numbers of its children.
        condition: the tree says that it is a condition: it is written or modelled as `<Condition>`.
    """

    number: int
    plugin: str
    name: str
    ports: tuple[tuple[str, PortValue], ...]
    parent: int | None
    children: tuple[int, ...]
    source: Source
    condition: bool = False

    @property
    def automaton(self) -> str:
        return f"BT_plugin_{self.number}_{self.name}"

    def port(self, key: str) -> PortValue | None:
        return next((value for name, value in self.ports if name == key), None)


def tree_file_outline(path: str, file: TreeFile) -> TreeFileOutline:
    return TreeFileOutline(
        path,
        file.main.value if file.main else "",
        tuple(
            TreeOutline(path, tree.id.value if tree.id else "", _outlines(tree.roots[0]) if tree.roots else None)
            for tree in file.trees
        ),
        tuple(
            (model.id.value, port.name.value, port.default)
            for model in file.models
            for port in model.ports
            if model.id and port.name and port.default is not None
        ),
        frozenset(model.id.value for model in file.models if model.id and model.kind == "Condition"),
    )


def _outlines(root: TreeNode) -> NodeOutline:
    count = 0

    def convert(node: TreeNode) -> NodeOutline:
        nonlocal count
        position, count = count, count + 1
        plugin = node.plugin.value if node.plugin else ""
        return NodeOutline(
            position,
            plugin,
            node.name.value if node.name else "",
            node.is_subtree,
            tuple((port_key(plugin, attribute.name), attribute.value) for attribute in node.element.attributes),
            tuple(convert(child) for child in node.children),
            node.element.name == "Condition",
        )

    return convert(root)


def node_at(file: TreeFile, source: Source) -> TreeNode | None:
    """The node of a file that `source` names."""
    for tree in file.trees:
        if (tree.id.value if tree.id else "") == source.tree:
            for position, node in enumerate(nodes(tree)):
                if position == source.position:
                    return node
    return None


def main_tree(files: tuple[TreeFileOutline, ...]) -> TreeOutline | tuple[str, ...]:
    """The tree that is executed, or the names of the candidates if that cannot be told.

    The first file decides by `main_tree_to_execute`; without it, it is the only tree that no other refers to.
    """
    trees = [tree for file in files for tree in file.trees]
    wanted = files[0].main if files else ""
    if wanted:
        for tree in trees:
            if tree.id == wanted:
                return tree
        # A file of one tree needs no names: its only tree is meant whatever it is called (spec/02 §3.1).
        return trees[0] if len(trees) == 1 else tuple(tree.id for tree in trees)
    if len(trees) == 1:
        return trees[0]
    used = {node.plugin for tree in trees for node in _walk(tree.root) if node.is_subtree}
    roots = [tree for tree in trees if tree.id not in used]
    return roots[0] if len(roots) == 1 else tuple(tree.id for tree in roots or trees)


def _walk(node: NodeOutline | None) -> Iterator[NodeOutline]:
    if node is not None:
        yield node
        for child in node.children:
            yield from _walk(child)


def is_whole(files: tuple[TreeFileOutline, ...]) -> bool:
    """Whether `expand` leaves nothing out: it is clear which tree is executed, and what each subtree stands for."""
    trees = {tree.id: tree for file in files for tree in file.trees}
    main = main_tree(files)
    if isinstance(main, tuple) or len(trees) < sum(len(file.trees) for file in files):
        return False
    uses: dict[str, set[str]] = {}
    pending = [main.id]
    while pending:
        name = pending.pop()
        if name not in trees:
            return False
        if name not in uses:
            uses[name] = {node.plugin for node in _walk(trees[name].root) if node.is_subtree}
            pending += uses[name]
    try:
        TopologicalSorter(uses).prepare()
    except CycleError:
        return False
    return True


def expand(files: tuple[TreeFileOutline, ...]) -> tuple[Instance, ...]:
    """All instances of the executed tree in pre-order; none if it cannot be told which tree that is."""
    main = main_tree(files)
    if isinstance(main, tuple) or main.root is None:
        return ()
    return _Expansion(files).run(main)


@dataclass(frozen=True, slots=True)
class _Frame:
    """One subtree instance: how its names translate to names of the whole blackboard."""

    prefix: str
    remapped: Mapping[str, PortValue]
    autoremap: bool
    outer: _Frame | None
    names: frozenset[str]

    def resolve(self, name: str) -> PortValue:
        if name.startswith("@"):
            return Reference(name[1:])
        if name in self.remapped:
            return self.remapped[name]
        if self.autoremap and self.outer and not name.startswith("_") and self.outer.knows(name):
            return self.outer.resolve(name)
        return Reference(f"{self.prefix}{name}")

    def knows(self, name: str) -> bool:
        if name in self.names or name in self.remapped:
            return True
        return self.autoremap and self.outer is not None and self.outer.knows(name)

    def value(self, text: str) -> PortValue:
        variable = blackboard_variable(text)
        return Constant(text) if variable is None else self.resolve(variable)


_MAX_INSTANCES = 10_000


class _Expansion:
    def __init__(self, files: tuple[TreeFileOutline, ...]) -> None:
        self.trees = {tree.id: tree for file in reversed(files) for tree in reversed(file.trees)}
        self.defaults: dict[str, dict[str, str]] = {}
        for file in files:
            for plugin, port, value in file.defaults:
                self.defaults.setdefault(plugin, {}).setdefault(port, value)
        self.conditions = frozenset(name for file in files for name in file.conditions)
        self.instances: list[Instance] = []
        self.prefixes: set[str] = set()

    def run(self, main: TreeOutline) -> tuple[Instance, ...]:
        frame = _Frame("", {}, False, None, _names(main))
        assert main.root is not None
        self.place(main.root, main, frame, None, (main.id,))
        return tuple(instance for instance in self.instances if instance is not None)

    def place(
        self, node: NodeOutline, tree: TreeOutline, frame: _Frame, parent: int | None, inside: tuple[str, ...]
    ) -> int | None:
        """Add the instances of `node` and all below it; the number of the topmost, None if there is none."""
        if node.is_subtree:
            inner = self.trees.get(node.plugin)
            if inner is None or inner.root is None or inner.id in inside:
                return None
            return self.place(inner.root, inner, self.enter(node, inner, frame), parent, (*inside, inner.id))
        if len(self.instances) >= _MAX_INSTANCES:
            return None
        number = ROOT_NUMBER + len(self.instances)
        settings = {**self.defaults.get(node.plugin, {}), **dict(node.attributes)}
        ports = tuple((key, frame.value(text)) for key, text in settings.items())
        source = Source(tree.path, tree.id, node.position)
        condition = node.condition or node.plugin in self.conditions
        instance = Instance(number, node.plugin, node.name or node.plugin, ports, parent, (), source, condition)
        self.instances.append(instance)
        placed = [self.place(child, tree, frame, number, inside) for child in node.children]
        children = tuple(child for child in placed if child is not None)
        self.instances[number - ROOT_NUMBER] = Instance(
            number, instance.plugin, instance.name, ports, parent, children, source, condition
        )
        return number

    def enter(self, node: NodeOutline, inner: TreeOutline, frame: _Frame) -> _Frame:
        """The frame of a subtree instance: its prefix is unique, its attributes rename variables."""
        attributes = dict(node.attributes)
        word = re.sub(r"\W", "_", node.name or node.plugin, flags=re.ASCII)
        word = word if word[:1].isalpha() or word[:1] == "_" else f"_{word}"
        prefix, count = f"{frame.prefix}{word}__", 1
        while prefix in self.prefixes:
            count += 1
            prefix = f"{frame.prefix}{word}_{count}__"
        self.prefixes.add(prefix)
        remapped: dict[str, PortValue] = {}
        for name, text in {**self.defaults.get(node.plugin, {}), **attributes}.items():
            if name not in _OWN_ATTRIBUTES and not name.startswith("_"):
                remapped[name] = frame.value("{" + name + "}") if text.strip() == "{=}" else frame.value(text)
        autoremap = any(attributes.get(name) in ("true", "1") for name in _AUTOREMAP)
        return _Frame(prefix, remapped, autoremap, frame, _names(inner))


_OWN_ATTRIBUTES = frozenset(("ID", "name"))
_AUTOREMAP = ("_autoremap", "__autoremap", "__shared_blackboard")


def _names(tree: TreeOutline) -> frozenset[str]:
    """The variables that the nodes of a tree refer to."""
    return frozenset(
        variable
        for node in _walk(tree.root)
        for _, text in node.attributes
        if (variable := blackboard_variable(text)) is not None
    )
