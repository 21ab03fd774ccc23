# SPDX-License-Identifier: Apache-2.0
"""The executed tree with the places of its parts: where the name of a blackboard variable, or the constant of a port,
is written.

`roaml.model.expand` expands the subtrees without positions; this module adds the positions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

from roaml.diagnostics import Symbol
from roaml.forest.scripts import script_attributes
from roaml.ide.names.occurrence import Form, tree_node
from roaml.model import expand
from roaml.model.expand import tree_called
from roaml.model.syntax import Name
from roaml.model.tree import Tree, TreeFile, TreeNode, blackboard_variable, nodes
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.script.names import names_in as names_in_script

Piece = tuple[str, Symbol | None, Form]
"""A part of a name in the translation: its text, the symbol whose name it contains, if any, and the form of that
name."""

TreeKey = tuple[str, str]
"""The path of a file, and the ID of a tree in it."""


class Setting(Record, frozen=True):
    """A value of a port, written in the file `path`."""

    path: str
    value: Name


class Frame(Record, frozen=True, eq=False):
    """One instance of a tree.

    Attributes:
        expanded: the same instance without places.
        tree: the tree in the file.
        prefix: the parts of the prefix of its variables in the translation.
        settings: the values of its ports, from the attributes of the subtree node and from defaults.
        outer: the instance of the tree that contains the subtree node; `None` for the main tree.
        names: the names of the variables that occur in the tree or in defaults of the ports of its nodes.
    """

    expanded: expand.Frame
    tree: Tree
    prefix: tuple[Piece, ...]
    settings: Mapping[str, Setting]
    outer: Frame | None
    names: frozenset[str]

    @property
    def path(self) -> str:
        return self.expanded.tree.path

    @property
    def key(self) -> TreeKey:
        return self.expanded.tree.path, self.expanded.tree.id

    def knows(self, name: str) -> bool:
        if name in self.names or name in self.settings:
            return True
        return self.takes_all and self.outer is not None and self.outer.knows(name)

    @property
    def takes_all(self) -> bool:
        """Whether the names of variables without an explicit remapping refer to the outer instance (automatic
        remapping)."""
        return self.expanded.autoremap

    def is_shared(self, name: str) -> bool:
        """Whether `name` refers to the same variable as in the outer instance."""
        if name in self.settings:
            return self.settings[name].value.value.strip() == "{=}"
        if self.outer is None or name.startswith("@"):
            return False
        return self.expanded.resolve(name) == self.outer.expanded.resolve(name)


class Trees:
    """The tree files of a system.

    Args:
        listed: the trees of the system; without a system, one tree without a name.
        owner: the system file, or the first tree file if there is no system.
        is_alone: whether there is no system.
    """

    def __init__(
        self, analysis: Analysis, listed: tuple[expand.ListedTree, ...], owner: str, *, is_alone: bool = False
    ) -> None:
        self.is_alone = is_alone
        paths = dict.fromkeys(outline.path for tree in listed for outline in tree.files)
        self.files: dict[str, TreeFile] = {path: file for path in paths if (file := analysis.tree(path)) is not None}
        self.owner = owner
        self.trees: dict[str, tuple[str, Tree]] = {}
        for path, file in self.files.items():
            for tree in file.trees:
                self.trees.setdefault(tree.id.value if tree.id else "", (path, tree))
        self._listed = listed

    def tree_symbol(self, path: str, name: str) -> Symbol:
        """The symbol of the tree to which a name refers in a file. If there is no system, files that do not include
        each other may contain different trees with the same name."""
        home = self.owner
        if self.is_alone:
            defining = [p for p, file in self.files.items() if any(t.id and t.id.value == name for t in file.trees)]
            if len(defining) > 1:
                home = path if path in defining else defining[0]
        return Symbol(home, SymbolKind.TREE, name)

    def names_in(self, tree: Tree) -> Iterator[str]:
        """The names of the variables to which a tree refers."""
        yield from names_in(tree)
        for node in nodes(tree):
            for attribute in script_attributes(node):
                yield from (name for name, _ in names_in_script(attribute.value))

    @cached_property
    def defaults(self) -> Mapping[str, Mapping[str, Setting]]:
        """The default values of the ports of each plugin and subtree."""
        settings: dict[str, dict[str, Setting]] = {}
        for path, file in self.files.items():
            for model in file.models:
                for port in model.ports:
                    default = port.element.get("default")
                    if model.id and port.name and default is not None:
                        setting = Setting(path, Name(default.value, default.value_span))
                        settings.setdefault(model.id.value, {}).setdefault(port.name.value, setting)
        return settings

    @cached_property
    def _expansion(self) -> expand.Expansion:
        return expand.expand_listed(self._listed)

    @property
    def main(self) -> tuple[str, Tree] | None:
        frames = self.frames
        return (frames[0].path, frames[0].tree) if frames else None

    @property
    def frames(self) -> tuple[Frame, ...]:
        return tuple(self._frames.values())

    @cached_property
    def _by_key(self) -> Mapping[TreeKey, Frame]:
        """The first use of each tree."""
        return {frame.key: frame for frame in reversed(self.frames)}

    @cached_property
    def nodes(self) -> Mapping[int, tuple[Frame, TreeNode]]:
        """The executed nodes by number."""
        return {
            instance.number: (
                self._frames[self._expansion.frame_of[instance.number]],
                self._nodes[instance.source.path, instance.source.tree][instance.source.position],
            )
            for instance in self._expansion.instances
        }

    @cached_property
    def _nodes(self) -> Mapping[TreeKey, tuple[TreeNode, ...]]:
        """The nodes of each tree, in the order of their positions."""
        frames = {frame.key: frame.tree for frame in self.frames}
        return {key: tuple(nodes(tree)) for key, tree in frames.items()}

    @cached_property
    def _frames(self) -> Mapping[expand.Frame, Frame]:
        frames: dict[expand.Frame, Frame] = {}
        names: dict[TreeKey, frozenset[str]] = {}
        for expanded in self._expansion.frames:
            tree = tree_called(self.files[expanded.tree.path], expanded.tree.id)
            assert tree is not None
            outer = frames[expanded.outer] if expanded.outer is not None else None
            prefix, settings = self._use(expanded, outer)
            key = expanded.tree.path, expanded.tree.id
            if key not in names:
                names[key] = self._names(tree)
            frames[expanded] = Frame(expanded, tree, prefix, settings, outer, names[key])
        return frames

    def _use(self, expanded: expand.Frame, outer: Frame | None) -> tuple[tuple[Piece, ...], Mapping[str, Setting]]:
        """The prefix of the names in an instance of a tree, and the values that the subtree node gives to its ports."""
        if expanded.use is None or outer is None:
            return self._board(expanded), {}
        node = tuple(nodes(outer.tree))[expanded.use.position]
        assert node.plugin is not None
        if node.name is not None:
            source, written = tree_node(*outer.key, expanded.use.position, node.name.value), node.name.value
        else:
            source, written = self.tree_symbol(outer.path, node.plugin.value), node.plugin.value
        lead = expanded.word[: len(expanded.word) - len(written)]
        prefix: tuple[Piece, ...] = (
            *outer.prefix,
            (lead, None, Form.AS_IS),
            (expanded.word.removeprefix(lead), source, Form.WORD),
            (f"{expanded.suffix}__", None, Form.AS_IS),
        )
        settings = dict(self.defaults.get(node.plugin.value, {}))
        settings |= {port.key.value: Setting(outer.path, port.value) for port in node.ports}
        return prefix, {name: value for name, value in settings.items() if not name.startswith("_")}

    def _board(self, frame: expand.Frame) -> tuple[Piece, ...]:
        """The beginning of the full names of the variables of the executed tree that contains `frame`."""
        name = frame.board.removesuffix("__")
        return ((name, self.instance(name), Form.AS_IS), ("__", None, Form.AS_IS)) if name else ()

    def instance(self, name: str) -> Symbol:
        """The symbol of the name of an executed tree (docs/spec/trees.md#several-trees)."""
        path = next((tree.files[0].path for tree in self._listed if tree.name == name), self.owner)
        return Symbol(path, SymbolKind.MACHINE, name)

    def _names(self, tree: Tree) -> frozenset[str]:
        """The names of the variables to which a tree refers, directly or by defaults of the ports of its nodes."""
        names = set(self.names_in(tree))
        for node in nodes(tree):
            plugin = node.plugin.value if node.plugin else ""
            for key, setting in self.defaults.get(plugin, {}).items():
                variable = blackboard_variable(setting.value.value)
                if variable is not None and node.element.get(key) is None:
                    names.add(key if variable == "=" else variable)
        return frozenset(names)

    # ------------------------------------------------------------- variables

    def variable(self, path: str, tree: str, name: str) -> Symbol:
        """The symbol of the blackboard variable to which `{name}` refers in a tree. Names that refer to one variable
        because of `{=}` or automatic remapping have the same symbol."""
        if name.startswith("@"):
            name = name[1:]
            if (frame := self._by_key.get((path, tree), next(iter(self.frames), None))) is not None:
                while frame.outer is not None:
                    frame = frame.outer
                path, tree = frame.key
        path, tree = self._root((path, tree, name))[:2]
        return Symbol(path, SymbolKind.BLACKBOARD, name, tree)

    def _root(self, key: tuple[str, str, str]) -> tuple[str, str, str]:
        while (above := self._shared.get(key, key)) != key:
            key = above
        return key

    @cached_property
    def _shared(self) -> Mapping[tuple[str, str, str], tuple[str, str, str]]:
        """A union-find structure: variable -> a variable that is the same because of `{=}` or automatic remapping."""
        above: dict[tuple[str, str, str], tuple[str, str, str]] = {}

        def root(key: tuple[str, str, str]) -> tuple[str, str, str]:
            while above.get(key, key) != key:
                key = above[key]
            return key

        for frame in self.frames:
            for name in frame.names:
                inner = frame
                while inner.outer is not None and inner.is_shared(name):
                    first, other = sorted((root((*inner.key, name)), root((*inner.outer.key, name))))
                    above[other] = first
                    inner = inner.outer
        return above

    def is_taken(self, symbol: Symbol, new: str) -> bool:
        """Whether the variable of `symbol` would become the same as another variable if it were renamed to `new`."""
        for path, file in self.files.items():
            for tree in file.trees:
                key = path, tree.id.value if tree.id else ""
                if self.variable(*key, symbol.name) == symbol and new in self.names_in(tree):
                    return True
        for frame in self.frames:
            own = self.variable(*frame.key, symbol.name) == symbol and symbol.name in frame.names
            if own and (new in frame.names or new in frame.settings):
                return True
            if frame.outer is None or not frame.takes_all or new in frame.settings:
                continue
            outside = self.variable(*frame.outer.key, symbol.name) == symbol and frame.outer.knows(symbol.name)
            free = own and symbol.name not in frame.settings
            if (free and frame.outer.knows(new)) or (outside and new in frame.names):
                return True
        return False

    @cached_property
    def full_names(self) -> Mapping[str, tuple[Piece, ...]]:
        """The full name of each variable in the translation -> its parts."""
        by_name: dict[str, tuple[Piece, ...]] = {}
        for frame in self.frames:
            for name in frame.names:
                if not name.startswith("@") and name not in frame.settings and not frame.is_shared(name):
                    pieces = (*frame.prefix, (name, self.variable(*frame.key, name), Form.AS_IS))
                    by_name.setdefault("".join(piece[0] for piece in pieces), pieces)
                elif name.startswith("@"):
                    last = name[1:], self.variable(*frame.key, name), Form.AS_IS
                    board = frame.expanded.board
                    by_name.setdefault(f"{board}{name[1:]}", (*self._board(frame.expanded), last))
        return by_name

    def constant(self, number: int, key: str) -> Setting | None:
        """The place of the constant to which the port `key` of the node `number` is set; `None` if the port is not set
        to a constant."""
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
    """The names of the variables that the attributes of a tree's nodes contain."""
    for node in nodes(tree):
        for attribute in node.element.attributes:
            variable = blackboard_variable(attribute.value)
            if variable is not None:
                yield attribute.name if variable == "=" and node.is_subtree else variable
