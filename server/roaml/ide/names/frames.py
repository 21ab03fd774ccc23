# SPDX-License-Identifier: Apache-2.0
"""The executed tree with the places of all that is written in it: which text a blackboard variable or a port's constant
comes from.

Follows `roaml.model.expand`, which works without places, step by step; a test holds the two against each other.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from roaml.diagnostics import Symbol
from roaml.ide.names.occurrence import Form, tree_node
from roaml.model.expand import ROOT_NUMBER, extent, main_tree, tree_file_outline
from roaml.model.syntax import Name
from roaml.model.tree import Tree, TreeFile, TreeNode, blackboard_variable, nodes
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind

AUTOREMAP = ("_autoremap", "__autoremap", "__shared_blackboard")

Piece = tuple[str, Symbol | None, Form]
"""A part of a name that the translation makes: its text and what that comes from, if anything."""

TreeKey = tuple[str, str]
"""File and ID of a tree."""


@dataclass(frozen=True, slots=True)
class Setting:
    """A value of a port, written in the file `path`."""

    path: str
    value: Name


@dataclass(frozen=True, eq=False)
class Frame:
    """One instance of a tree.

    Attributes:
        prefix: of the full names of its variables.
        settings: what the attributes of the subtree node, and defaults, say.
        outer: the instance around it.
        names: the variables that the tree's text mentions.
    """

    path: str
    tree: Tree
    prefix: tuple[Piece, ...]
    settings: Mapping[str, Setting]
    autoremap: bool
    outer: Frame | None
    names: frozenset[str]

    @property
    def key(self) -> TreeKey:
        return self.path, self.tree.id.value if self.tree.id else ""

    def knows(self, name: str) -> bool:
        if name in self.names or name in self.settings:
            return True
        return self.autoremap and self.outer is not None and self.outer.knows(name)

    def is_shared(self, name: str) -> bool:
        """Whether `name` is the same variable as the one with this name outside."""
        if self.outer is None or name.startswith(("@", "_")):
            return name in self.settings and self.settings[name].value.value.strip() == "{=}"
        if name in self.settings:
            return self.settings[name].value.value.strip() == "{=}"
        return self.autoremap and self.outer.knows(name)


class Trees:
    """The tree files of a system, the executed one first.

    Args:
        paths: of the files.
        owner: the system file, or the tree file if it is looked at alone.
    """

    def __init__(self, analysis: Analysis, paths: tuple[str, ...], owner: str) -> None:
        found = ((path, analysis.tree(path)) for path in paths)
        self.files: dict[str, TreeFile] = {path: file for path, file in found if file is not None}
        self.owner = owner
        self.trees: dict[str, tuple[str, Tree]] = {}
        for path, file in self.files.items():
            for tree in file.trees:
                self.trees.setdefault(tree.id.value if tree.id else "", (path, tree))

    @cached_property
    def defaults(self) -> Mapping[str, Mapping[str, Setting]]:
        """Of each plugin and subtree, what its ports hold where a tree does not set them."""
        found: dict[str, dict[str, Setting]] = {}
        for path, file in self.files.items():
            for model in file.models:
                for port in model.ports:
                    default = port.element.get("default")
                    if model.id and port.name and default is not None:
                        setting = Setting(path, Name(default.value, default.value_span))
                        found.setdefault(model.id.value, {}).setdefault(port.name.value, setting)
        return found

    @cached_property
    def main(self) -> tuple[str, Tree] | None:
        outlines = tuple(tree_file_outline(path, file) for path, file in self.files.items())
        main = main_tree(outlines)
        if isinstance(main, tuple) or not extent(outlines).is_expanded:
            return None
        for tree in self.files[main.path].trees:
            if (tree.id.value if tree.id else "") == main.id:
                return main.path, tree
        return None

    @cached_property
    def _walked(self) -> tuple[tuple[tuple[Frame, TreeNode], ...], tuple[Frame, ...]]:
        walk = _Walk(self)
        if self.main is not None:
            walk.run(*self.main)
        return tuple(walk.nodes), tuple(walk.frames)

    @property
    def nodes(self) -> Mapping[int, tuple[Frame, TreeNode]]:
        """The executed nodes by number."""
        return dict(enumerate(self._walked[0], ROOT_NUMBER))

    @property
    def frames(self) -> tuple[Frame, ...]:
        return self._walked[1]

    # ------------------------------------------------------------- variables

    def variable(self, path: str, tree: str, name: str) -> Symbol:
        """The blackboard variable of `{name}` in a tree. Variables that always share their name are one."""
        if name.startswith("@"):
            name = name[1:]
            if self.main is not None:
                path, tree = self.main[0], self.main[1].id.value if self.main[1].id else ""
        path, tree = self._root((path, tree, name))[:2]
        return Symbol(path, SymbolKind.BLACKBOARD, name, tree)

    def _root(self, key: tuple[str, str, str]) -> tuple[str, str, str]:
        while (above := self._shared.get(key, key)) != key:
            key = above
        return key

    @cached_property
    def _shared(self) -> Mapping[tuple[str, str, str], tuple[str, str, str]]:
        """Union-find: a variable -> an equal one, by `{=}` or automatic remapping."""
        above: dict[tuple[str, str, str], tuple[str, str, str]] = {}

        def root(key: tuple[str, str, str]) -> tuple[str, str, str]:
            while above.get(key, key) != key:
                key = above[key]
            return key

        for frame in self.frames:
            for name in frame.names:
                inner = frame
                while inner.outer is not None and inner.is_shared(name):
                    one, other = sorted((root((*inner.key, name)), root((*inner.outer.key, name))))
                    above[other] = one
                    inner = inner.outer
        return above

    def is_taken(self, symbol: Symbol, new: str) -> bool:
        """Whether a variable named `new` would be the same as another one."""
        for path, file in self.files.items():
            for tree in file.trees:
                key = path, tree.id.value if tree.id else ""
                if self.variable(*key, symbol.name) == symbol and new in names_in(tree):
                    return True
        for frame in self.frames:
            own = self.variable(*frame.key, symbol.name) == symbol and symbol.name in frame.names
            if own and (new in frame.names or new in frame.settings):
                return True
            if frame.outer is None or not frame.autoremap or new in frame.settings:
                continue
            outside = self.variable(*frame.outer.key, symbol.name) == symbol and frame.outer.knows(symbol.name)
            free = own and symbol.name not in frame.settings
            if (free and frame.outer.knows(new)) or (outside and new in frame.names):
                return True
        return False

    @cached_property
    def full_names(self) -> Mapping[str, tuple[Piece, ...]]:
        """The full name of each variable in the translation -> its parts."""
        found: dict[str, tuple[Piece, ...]] = {}
        for frame in self.frames:
            for name in frame.names:
                if not name.startswith("@") and name not in frame.settings and not frame.is_shared(name):
                    pieces = (*frame.prefix, (name, self.variable(*frame.key, name), Form.AS_IS))
                    found.setdefault("".join(piece[0] for piece in pieces), pieces)
                elif name.startswith("@"):
                    found.setdefault(name[1:], ((name[1:], self.variable(*frame.key, name), Form.AS_IS),))
        return found

    def constant(self, number: int, key: str) -> Setting | None:
        """The text that gives the port `key` of a node a constant."""
        frame, node = self.nodes.get(number, (None, None))
        if frame is None or node is None:
            return None
        setting = self.setting(frame.path, node, key)
        outer: Frame | None = frame
        while setting is not None and outer is not None:
            variable = blackboard_variable(setting.value.value)
            if variable is None:
                return setting
            name = key if variable == "=" else variable
            while outer is not None and name not in outer.settings:
                outer = outer.outer if outer.is_shared(name) else None
            if outer is None:
                return None
            setting, key, outer = outer.settings[name], name, outer.outer
        return None if setting is None or blackboard_variable(setting.value.value) is not None else setting

    def setting(self, path: str, node: TreeNode, key: str) -> Setting | None:
        for port in node.ports:
            if port.key.value == key:
                return Setting(path, port.value)
        return self.defaults.get(node.plugin.value if node.plugin else "", {}).get(key)


def names_in(tree: Tree) -> Iterator[str]:
    """The variables that the nodes of a tree use."""
    for node in nodes(tree):
        for attribute in node.element.attributes:
            variable = blackboard_variable(attribute.value)
            if variable is not None:
                yield attribute.name if variable == "=" and node.is_subtree else variable


class _Walk:
    def __init__(self, trees: Trees) -> None:
        self.trees = trees
        self.nodes: list[tuple[Frame, TreeNode]] = []
        self.frames: list[Frame] = []
        self.prefixes: set[str] = set()
        self.counts: dict[str, int] = {}
        self.positions: dict[Tree, dict[TreeNode, int]] = {}
        self.known_names: dict[Tree, frozenset[str]] = {}

    def run(self, path: str, main: Tree) -> None:
        """Works with a list of what is still to be placed, as `roaml.model.expand` does."""
        frame = Frame(path, main, (), {}, False, None, self.names(main))
        self.frames.append(frame)
        pending = [(root, frame, frozenset((frame.key[1],))) for root in main.roots[:1]]
        while pending:
            node, frame, inside = pending.pop()
            if not node.is_subtree:
                self.nodes.append((frame, node))
                pending += ((child, frame, inside) for child in reversed(node.children))
                continue
            inner_path, tree = self.trees.trees.get(node.plugin.value if node.plugin else "", ("", None))
            if tree is not None and tree.roots and (tree.id.value if tree.id else "") not in inside:
                inner = self.enter(node, inner_path, tree, frame, self.position(frame.tree, node))
                pending.append((tree.roots[0], inner, inside | {inner.key[1]}))

    def position(self, tree: Tree, node: TreeNode) -> int:
        if tree not in self.positions:
            self.positions[tree] = {each: position for position, each in enumerate(nodes(tree))}
        return self.positions[tree][node]

    def names(self, tree: Tree) -> frozenset[str]:
        """With those that a tree uses through defaults."""
        if tree not in self.known_names:
            self.known_names[tree] = self.names_of(tree)
        return self.known_names[tree]

    def names_of(self, tree: Tree) -> frozenset[str]:
        found = set(names_in(tree))
        for node in nodes(tree):
            plugin = node.plugin.value if node.plugin else ""
            for key, setting in self.trees.defaults.get(plugin, {}).items():
                variable = blackboard_variable(setting.value.value)
                if variable is not None and node.element.get(key) is None:
                    found.add(key if variable == "=" else variable)
        return frozenset(found)

    def enter(self, node: TreeNode, path: str, tree: Tree, frame: Frame, position: int) -> Frame:
        assert node.plugin is not None
        if node.name is not None:
            source, written = tree_node(*frame.key, position, node.name.value), node.name.value
        else:
            source, written = Symbol(self.trees.owner, SymbolKind.TREE, node.plugin.value), node.plugin.value
        word = re.sub(r"\W", "_", written, flags=re.ASCII)
        lead = "" if word[:1].isalpha() or word[:1] == "_" else "_"
        above, suffix = "".join(piece[0] for piece in frame.prefix), ""
        wanted = f"{above}{lead}{word}"
        while f"{wanted}{suffix}__" in self.prefixes:
            count = self.counts[wanted] = self.counts.get(wanted, 1) + 1
            suffix = f"_{count}"
        self.prefixes.add(f"{above}{lead}{word}{suffix}__")
        prefix: tuple[Piece, ...] = (
            *frame.prefix,
            (lead, None, Form.AS_IS),
            (word, source, Form.WORD),
            (f"{suffix}__", None, Form.AS_IS),
        )
        settings = dict(self.trees.defaults.get(node.plugin.value, {}))
        settings |= {port.key.value: Setting(frame.path, port.value) for port in node.ports}
        settings = {name: value for name, value in settings.items() if not name.startswith("_")}
        values = (attribute for name in AUTOREMAP if (attribute := node.element.get(name)))
        autoremap = any(attribute.value in ("true", "1") for attribute in values)
        inner = Frame(path, tree, prefix, settings, autoremap, frame, self.names(tree))
        self.frames.append(inner)
        return inner
