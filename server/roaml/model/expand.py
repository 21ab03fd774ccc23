# SPDX-License-Identifier: Apache-2.0
"""The executed tree with all its instances: subtrees expanded, nodes numbered, ports bound
(docs/spec/trees.md#instances, docs/spec/trees.md#subtrees).

- The input consists of outlines, which contain no positions. An instance refers to its node by the file, the tree, and
  the position in that tree.
- A subtree that cannot be expanded, because it is unknown or recursive, is left out. Rules that check the files report
  it.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import TypeAlias

from roaml.libraries.scripts import AFTERWARDS, CONDITIONS, script_ports
from roaml.model.tree import Tree, TreeFile, TreeNode, blackboard_variable, port_key
from roaml.record import PartlyCompared, Record, field, replace
from roaml.regex import regex
from roaml.script.names import names_in
from roaml.scxml.names import NODE_PREFIX
from roaml.suggest import close_names

ROOT_NUMBER = 1000


class NodeOutline(Record, frozen=True):
    """A node of a tree, without positions in the text.

    Attributes:
        position: its index among the nodes of its tree in pre-order, from 0.
        plugin: the name of its plugin; the ID of the tree if it is a subtree.
        condition: whether it is written as `<Condition>`.
    """

    position: int
    plugin: str
    name: str
    is_subtree: bool
    attributes: tuple[tuple[str, str], ...]
    children: tuple[NodeOutline, ...]
    condition: bool = False


class TreeOutline(Record, frozen=True):
    path: str
    id: str
    root: NodeOutline | None


class TreeFileOutline(Record, frozen=True):
    """A file of trees without positions.

    Attributes:
        main: the value of `main_tree_to_execute`; "" if it is not given.
        defaults: the default values in `<TreeNodesModel>`, as (plugin, port, value).
        declared: all ports in `<TreeNodesModel>`, as (plugin, port).
        from_project: whether the file is included only because a Groot2 project in the same directory as the executed
            file lists it. Such a file provides only subtrees.
        conditions: the plugins that are conditions in `<TreeNodesModel>`.
    """

    path: str
    main: str
    trees: tuple[TreeOutline, ...]
    defaults: tuple[tuple[str, str, str], ...]
    declared: tuple[tuple[str, str], ...] = ()
    from_project: bool = False
    conditions: frozenset[str] = frozenset()


class PortConstant(Record, frozen=True):
    """A port with a constant text.

    Attributes:
        variable: the full name of the variable whose value it is, if a `<SubTree>` gives it; "" otherwise.
    """

    text: str
    variable: str = ""


class Reference(Record, frozen=True):
    """A port that is bound to the blackboard variable with this full name."""

    variable: str


PortValue: TypeAlias = PortConstant | Reference


class NodeSource(Record, frozen=True):
    """A reference to a node in a file: the file, the tree, and the position of the node in the tree."""

    path: str
    tree: str
    position: int


class TreeUse(PartlyCompared, frozen=True):
    """One use of a tree: the executed tree itself, or a `<SubTree>` node.

    Attributes:
        name: the name of the `<SubTree>`; the ID of the tree if it has none.
        tree: the ID of the tree.
        outer: the index of the enclosing use; `None` for the executed tree.
        frame: the mapping of the names in this use to blackboard variables.
        scripts: the conditions and scripts of the `<SubTree>`, by attribute.
    """

    UNCOMPARED = frozenset({"frame"})

    name: str
    tree: str
    outer: int | None
    frame: Frame
    scripts: tuple[tuple[str, str], ...] = ()


class Instance(Record, frozen=True):
    """One node of the executed tree.

    Attributes:
        number: 1000 for the root, then increasing in pre-order; that of the root of each further tree is the next
            multiple of 1000. The number is a part of event names.
        automaton: the name of its automaton, `BT_plugin_<number>_<name>`; `BT_plugin_<number>_<tree>.<name>` in a tree
            with a name.
        ports: the values that the tree sets, including defaults of `<TreeNodesModel>`.
        children: the numbers of its children.
        condition: whether it is written as `<Condition>`, or declared so in `<TreeNodesModel>`.
        use: the index of the `TreeUse` that the node is in.
        scripts: its conditions and scripts (docs/spec/trees.md#scripts), by attribute.
        tree: the name of the executed tree, if the system gives it one (docs/spec/trees.md#several-trees).
    """

    number: int
    plugin: str
    name: str
    ports: tuple[tuple[str, PortValue], ...]
    parent: int | None
    children: tuple[int, ...]
    source: NodeSource
    condition: bool = False
    use: int = 0
    scripts: tuple[tuple[str, str], ...] = ()
    tree: str = ""

    @property
    def automaton(self) -> str:
        name = f"{self.tree}.{self.name}" if self.tree else self.name
        return f"{NODE_PREFIX}{self.number}_{name}"

    def port(self, key: str) -> PortValue | None:
        return next((value for name, value in self.ports if name == key), None)


Written: TypeAlias = tuple[bool, tuple[tuple[str, str], ...]]
"""Whether a node stands for a tree, and its attributes with the main names of its ports."""


def _as_written(node: TreeNode) -> Written:
    plugin = node.plugin.value if node.plugin else ""
    return node.is_subtree, tuple((port_key(plugin, each.name), each.value) for each in node.element.attributes)


def tree_file_outline(path: str, file: TreeFile, read: Callable[[TreeNode], Written] = _as_written) -> TreeFileOutline:
    return TreeFileOutline(
        path,
        file.main.value if file.main else "",
        tuple(
            TreeOutline(path, tree.id.value if tree.id else "", _outlines(tree.roots[0], read) if tree.roots else None)
            for tree in file.trees
        ),
        tuple(
            (model.id.value, port.name.value, port.default)
            for model in file.models
            for port in model.ports
            if model.id and port.name and port.default is not None
        ),
        tuple(
            (model.id.value, port.name.value) for model in file.models for port in model.ports if model.id and port.name
        ),
        conditions=frozenset(model.id.value for model in file.models if model.id and model.is_condition),
    )


def _outlines(root: TreeNode, read: Callable[[TreeNode], Written]) -> NodeOutline:
    count = 0

    def convert(node: TreeNode) -> NodeOutline:
        nonlocal count
        position, count = count, count + 1
        return NodeOutline(
            position,
            node.plugin.value if node.plugin else "",
            node.name.value if node.name else "",
            *read(node),
            tuple(convert(child) for child in node.children),
            node.element.name == "Condition",
        )

    return convert(root)


def nodes_of(file: TreeFile, tree_id: str) -> tuple[TreeNode, ...]:
    """The nodes of the first tree named `tree_id`, in pre-order; empty if there is no such tree."""
    return file.nodes_by_tree.get(tree_id, ())


def tree_called(file: TreeFile, tree_id: str) -> Tree | None:
    """The first tree named `tree_id`; `None` if there is none."""
    return next((tree for tree in file.trees if (tree.id.value if tree.id else "") == tree_id), None)


def node_at(file: TreeFile, source: NodeSource) -> TreeNode | None:
    """The node of a file that `source` refers to; `None` if it does not exist."""
    tree_nodes = nodes_of(file, source.tree)
    return tree_nodes[source.position] if source.position < len(tree_nodes) else None


class ListedTree(Record, frozen=True):
    """A tree that a system executes.

    Attributes:
        name: the name that the system gives it; "" if it has none.
        files: the file that the system lists, and the files that it includes.
    """

    name: str
    files: tuple[TreeFileOutline, ...]


def main_tree(files: tuple[TreeFileOutline, ...]) -> TreeOutline | tuple[str, ...]:
    """The tree that is executed; if it is ambiguous, the names of the possible trees.

    It is the tree that `main_tree_to_execute` of the first file names, or the only tree of all files. Without this
    attribute, it is the only tree that no other tree uses; files that only a Groot2 project lists are then left out.
    """
    trees = [tree for file in files for tree in file.trees]
    main = files[0].main if files else ""
    if main:
        for tree in trees:
            if tree.id == main:
                return tree
        # The only tree of a file is executed whatever its name is (docs/spec/trees.md#main-tree).
        return trees[0] if len(trees) == 1 else tuple(tree.id for tree in trees)
    trees = [tree for file in files for tree in file.trees if not file.from_project]
    if len(trees) == 1:
        return trees[0]
    used = {node.plugin for tree in trees for node in _walk(tree.root) if node.is_subtree}
    roots = [tree for tree in trees if tree.id not in used]
    return roots[0] if len(roots) == 1 else tuple(tree.id for tree in roots or trees)


def _walk(root: NodeOutline | None) -> Iterator[NodeOutline]:
    """All nodes, parents before children."""
    pending = [] if root is None else [root]
    while pending:
        node = pending.pop()
        yield node
        pending += reversed(node.children)


def is_whole(files: tuple[TreeFileOutline, ...]) -> bool:
    """Whether the result of `expand` is complete: the executed tree and all its subtrees are known, and the tree is not
    too large."""
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
    return extent(files).is_expanded


MAX_NODES = 10_000
"""The maximum number of nodes of an executed tree; a larger one is not expanded."""

MAX_SUBTREES = 1_000
"""The maximum number of nested subtrees. The length of the names of blackboard variables grows with this number."""


class TreeExtent(Record, frozen=True):
    """The size of a tree with all subtrees expanded, computed without expanding them.

    Attributes:
        nodes: the number of nodes, with all subtrees expanded.
        depth: the maximum nesting depth of subtrees.
        largest: the `<SubTree>` that contributes most to the size. It is searched from the executed tree downwards,
            through the largest subtree at each level, and the search ends at the first subtree that alone is within the
            limits. `None` if there are no subtrees.
    """

    nodes: int
    depth: int
    largest: NodeSource | None

    @property
    def is_expanded(self) -> bool:
        return self.nodes <= MAX_NODES and self.depth <= MAX_SUBTREES


def extent(files: tuple[TreeFileOutline, ...], executed: TreeOutline | None = None) -> TreeExtent:
    """The size of the executed tree. Subtrees that are unknown or contain themselves have the size 0.

    Args:
        executed: the executed tree, if it is known.
    """
    main = main_tree(files) if executed is None else executed
    if isinstance(main, tuple) or main.root is None:
        return TreeExtent(0, 0, None)
    trees = _by_id(files)
    sizes: dict[str, tuple[int, int]] = {}
    for name in _innermost_first(main, trees):
        tree = main if name == main.id else trees[name]
        used = [sizes[node.plugin] for node in _walk(tree.root) if node.is_subtree and node.plugin in sizes]
        own = sum(not node.is_subtree for node in _walk(tree.root))
        sizes[name] = own + sum(nodes for nodes, _ in used), 1 + max((depth for _, depth in used), default=-1)
    return TreeExtent(*sizes[main.id], _largest(main, trees, sizes))


def _innermost_first(main: TreeOutline, trees: Mapping[str, TreeOutline]) -> Iterator[str]:
    """The names of `main` and of all trees that it uses, directly or indirectly. Each name follows the names of the
    trees that it uses; the trees of a cycle are in any order."""
    entered, done = {main.id}, set[str]()
    stack = [(main.id, _used(main, trees))]
    while stack:
        name, left = stack[-1]
        inner = next((name for name in left if name not in entered), None)
        if inner is None:
            stack.pop()
            if name not in done:
                done.add(name)
                yield name
        else:
            entered.add(inner)
            stack.append((inner, _used(trees[inner], trees)))


def _used(tree: TreeOutline, trees: Mapping[str, TreeOutline]) -> Iterator[str]:
    names = (node.plugin for node in _walk(tree.root) if node.is_subtree and node.plugin in trees)
    return iter(dict.fromkeys(names))


def _largest(
    main: TreeOutline, trees: Mapping[str, TreeOutline], sizes: Mapping[str, tuple[int, int]]
) -> NodeSource | None:
    tree, largest, seen = main, None, {main.id}
    while True:
        uses = [n for n in _walk(tree.root) if n.is_subtree and n.plugin in sizes and n.plugin not in seen]
        if not uses:
            return largest
        node = max(uses, key=lambda use: sizes[use.plugin])
        largest = NodeSource(tree.path, tree.id, node.position)
        nodes, depth = sizes[node.plugin]
        if nodes <= MAX_NODES and depth <= MAX_SUBTREES:
            return largest
        seen.add(node.plugin)
        tree = trees[node.plugin]


def _by_id(files: tuple[TreeFileOutline, ...]) -> dict[str, TreeOutline]:
    """The trees by name; if names are equal, the first tree is used."""
    return {tree.id: tree for file in reversed(files) for tree in reversed(file.trees)}


class Frame(Record, frozen=True, eq=False):
    """One use of a tree, with the mapping of the names in it to the full names of blackboard variables.

    Attributes:
        use: the `<SubTree>` node; `None` for the executed tree.
        name: the name of the `<SubTree>`; the ID of the tree if it has none.
        word, suffix: the last part of `prefix` is `<word><suffix>__`. The word is the name of the `<SubTree>` as an
            identifier; the suffix makes the prefix unique.
        prefix: the beginning of the full names of the variables of this use.
        remapped: the names that the attributes of the `<SubTree>` bind, with their values in the enclosing use.
        autoremap: whether all other names are bound to the variables of the same name in the enclosing use.
        outer: the enclosing use.
        names: the variables that the nodes of the tree refer to; `None` if a program may set other entries, too, so
            that every name counts.
        inside: the IDs of the tree and of all enclosing trees.
        board: the beginning of the full names of the variables of the executed tree.
        scripts: the conditions and scripts of the `<SubTree>`.
        looked_up: a cache of resolved names.
    """

    tree: TreeOutline
    use: NodeSource | None
    name: str
    word: str
    suffix: str
    prefix: str
    remapped: Mapping[str, PortValue]
    autoremap: bool
    outer: Frame | None
    names: frozenset[str] | None
    inside: frozenset[str]
    board: str = ""
    scripts: tuple[tuple[str, str], ...] = ()
    looked_up: dict[str, PortValue | None] = field(default_factory=dict)

    def resolve(self, name: str) -> PortValue:
        """The blackboard variable or constant that `name` refers to in this use, after all remappings.

        Automatic remapping leads to the outermost enclosing tree that uses the name.
        """
        if name.startswith("@"):
            return Reference(f"{self.board}{name[1:]}")
        return self._outer_value(name) or Reference(f"{self.prefix}{name}")

    def _outer_value(self, name: str) -> PortValue | None:
        """The value of a name in the outermost use of a tree that remaps or uses it; `None` if neither this use nor the
        uses from which it takes its names do so."""
        visited: list[Frame] = []
        frame: Frame | None = self
        while frame is not None and name not in frame.remapped and name not in frame.looked_up:
            visited.append(frame)
            frame = frame.outer if frame.autoremap and not name.startswith("_") else None
        value = None if frame is None else frame.remapped.get(name) or frame.looked_up.get(name)
        for frame in reversed(visited):
            if value is None and (frame.names is None or name in frame.names):
                value = Reference(f"{frame.prefix}{name}")
            frame.looked_up[name] = value
        return value

    def value(self, key: str, text: str) -> PortValue:
        """The value of the attribute `key` with the text `text`; `{=}` refers to the variable named `key`."""
        variable = blackboard_variable(text)
        return PortConstant(text) if variable is None else self.resolve(key if variable == "=" else variable)


class Expansion(Record, frozen=True):
    """The executed tree.

    Attributes:
        instances: its nodes in pre-order.
        frames: all uses of trees, each after the enclosing one; the executed tree is first.
        frame_of: number of an instance -> the use of a tree that contains it.
        left_out: the `<SubTree>` nodes that cannot be expanded, in pre-order.
    """

    instances: tuple[Instance, ...] = ()
    frames: tuple[Frame, ...] = ()
    frame_of: Mapping[int, Frame] = field(default_factory=dict)
    left_out: tuple[NodeSource, ...] = ()

    @property
    def uses(self) -> tuple[TreeUse, ...]:
        """The uses of trees, in the order of `frames`."""
        indices = {id(frame): index for index, frame in enumerate(self.frames)}
        return tuple(
            TreeUse(
                frame.name,
                frame.tree.id,
                None if frame.outer is None else indices[id(frame.outer)],
                frame,
                frame.scripts,
            )
            for frame in self.frames
        )


def expand(
    files: tuple[TreeFileOutline, ...], main: TreeOutline | None = None, *, takes_all: bool = False
) -> Expansion:
    """The executed tree; it is empty if the tree is ambiguous, has no node, or is too large
    (`TreeExtent.is_expanded`).

    Args:
        main: the executed tree, if it is known.
        takes_all: whether automatic remapping leads to the outermost enclosing tree even for names that only the inner
            tree uses, because a program may set their entries.
    """
    chosen = main_tree(files) if main is None else main
    if isinstance(chosen, tuple) or chosen.root is None or not extent(files, chosen).is_expanded:
        return Expansion()
    return _Expander(files, takes_all=takes_all).run(chosen)


def expand_listed(trees: Iterable[ListedTree]) -> Expansion:
    """All trees that a system executes, in their order (docs/spec/trees.md#several-trees)."""
    instances: list[Instance] = []
    frames: list[Frame] = []
    frame_of: dict[int, Frame] = {}
    left_out: list[NodeSource] = []
    for tree in trees:
        chosen = main_tree(tree.files)
        if isinstance(chosen, tuple) or chosen.root is None or not extent(tree.files, chosen).is_expanded:
            continue
        first = ROOT_NUMBER if not instances else next_root(instances[-1].number)
        expansion = _Expander(tree.files, takes_all=False, first=first, name=tree.name).run(chosen)
        instances += (replace(node, use=node.use + len(frames)) for node in expansion.instances)
        frames += expansion.frames
        frame_of |= expansion.frame_of
        left_out += expansion.left_out
    return Expansion(tuple(instances), tuple(frames), frame_of, tuple(left_out))


def next_root(number: int) -> int:
    """The number of the root of the tree after one whose last node has the number `number`."""
    return (number // ROOT_NUMBER + 1) * ROOT_NUMBER


def board_prefix(tree: str) -> str:
    """The beginning of the full names of the blackboard variables of the tree with the name `tree`."""
    return f"{tree}__" if tree else ""


def is_on_board(variable: str, tree: str) -> bool:
    """Whether a variable, by its full name, is on the blackboard of the tree with the name `tree`."""
    return variable.startswith(board_prefix(tree))


def entered_uses(uses: tuple[TreeUse, ...], inner: int, around: int | None = None) -> tuple[int, ...]:
    """The uses of trees between two nodes: the use `inner` and its enclosing ones up to `around`, without `around`, the
    outermost first. The executed tree itself is left out."""
    entered: list[int] = []
    index: int | None = inner
    while index != around and index is not None:
        if uses[index].outer is not None:
            entered.append(index)
        index = uses[index].outer
    return tuple(reversed(entered))


class _Placed(Record):
    """An instance while it is built: its children may not exist yet."""

    plugin: str
    name: str
    ports: tuple[tuple[str, PortValue], ...]
    parent: int | None
    source: NodeSource
    condition: bool
    children: list[int]
    scripts: tuple[tuple[str, str], ...]


class _Expander:
    """Expands a tree with an explicit stack, because subtrees may be nested more deeply than Python's call stack
    allows."""

    def __init__(
        self, files: tuple[TreeFileOutline, ...], *, takes_all: bool, first: int = ROOT_NUMBER, name: str = ""
    ) -> None:
        self.trees = _by_id(files)
        self.first = first
        self.name = name
        self.takes_all = takes_all
        self.left_out: list[NodeSource] = []
        self.defaults: dict[str, dict[str, str]] = {}
        for file in files:
            for plugin, port, value in file.defaults:
                self.defaults.setdefault(plugin, {}).setdefault(port, value)
        self.conditions = frozenset(name for file in files for name in file.conditions)
        self.placed: list[_Placed] = []
        self.frames: list[Frame] = []
        self.frame_of: dict[int, Frame] = {}
        self.prefixes: set[str] = set()
        self.counts: dict[str, int] = {}
        self.names: dict[str, frozenset[str]] = {}

    def run(self, main: TreeOutline) -> Expansion:
        assert main.root is not None
        name, prefix, inside = self.name or main.id, board_prefix(self.name), frozenset((main.id,))
        frame = Frame(main, None, name, self.name, "", prefix, {}, False, None, self.names_in(main), inside, prefix)
        self.frames.append(frame)
        pending: list[tuple[NodeOutline, Frame, int | None]] = [(main.root, frame, None)]
        while pending:
            node, frame, parent = pending.pop()
            if node.is_subtree:
                inner = self.trees.get(node.plugin) if node.plugin else None
                if inner is not None and inner.root is not None and inner.id not in frame.inside:
                    pending.append((inner.root, self.enter(node, inner, frame), parent))
                else:
                    self.left_out.append(NodeSource(frame.tree.path, frame.tree.id, node.position))
                continue
            number = self.place(node, frame, parent)
            pending += ((child, frame, number) for child in reversed(node.children))
        indices = {id(frame): index for index, frame in enumerate(self.frames)}
        instances = (
            Instance(
                number,
                placed.plugin,
                placed.name,
                placed.ports,
                placed.parent,
                tuple(placed.children),
                placed.source,
                placed.condition,
                indices[id(self.frame_of[number])],
                placed.scripts,
                self.name,
            )
            for number, placed in enumerate(self.placed, self.first)
        )
        return Expansion(tuple(instances), tuple(self.frames), self.frame_of, tuple(self.left_out))

    def place(self, node: NodeOutline, frame: Frame, parent: int | None) -> int:
        """Create an instance of `node` and return its number."""
        number = self.first + len(self.placed)
        settings = {**self.defaults.get(node.plugin, {}), **dict(node.attributes)}
        ports = tuple((key, frame.value(key, text)) for key, text in settings.items())
        source = NodeSource(frame.tree.path, frame.tree.id, node.position)
        condition = node.condition or node.plugin in self.conditions
        name = node.name or node.plugin
        self.placed.append(_Placed(node.plugin, name, ports, parent, source, condition, [], _scripts(node)))
        self.frame_of[number] = frame
        if parent is not None:
            self.placed[parent - self.first].children.append(number)
        return number

    def enter(self, node: NodeOutline, inner: TreeOutline, frame: Frame) -> Frame:
        """The frame for the `<SubTree>` `node` that uses the tree `inner`. Its prefix is unique."""
        word, suffix = re.sub(r"\W", "_", node.name or node.plugin, flags=re.ASCII), ""
        word = word if word[:1].isalpha() or word[:1] == "_" else f"_{word}"
        first = prefix = f"{frame.prefix}{word}__"
        while prefix in self.prefixes:
            count = self.counts[first] = self.counts.get(first, 1) + 1
            suffix = f"_{count}"
            prefix = f"{frame.prefix}{word}{suffix}__"
        self.prefixes.add(prefix)
        remapped: dict[str, PortValue] = {}
        for name, text in {**self.defaults.get(node.plugin, {}), **dict(node.attributes)}.items():
            if name not in _OWN_ATTRIBUTES and not name.startswith("_"):
                value = frame.value(name, text)
                is_given_here = isinstance(value, PortConstant) and not value.variable
                remapped[name] = PortConstant(text, f"{prefix}{name}") if is_given_here else value
        autoremap = _is_autoremapped(node)
        use, inside = NodeSource(frame.tree.path, frame.tree.id, node.position), frame.inside | {inner.id}
        entered = Frame(
            inner,
            use,
            node.name or node.plugin,
            word,
            suffix,
            prefix,
            remapped,
            autoremap,
            frame,
            self.names_in(inner),
            inside,
            frame.board,
            _scripts(node),
        )
        self.frames.append(entered)
        return entered

    def names_in(self, tree: TreeOutline) -> frozenset[str] | None:
        if self.takes_all:
            return None
        if tree.id not in self.names:
            self.names[tree.id] = _names(tree)
        return self.names[tree.id]


_OWN_ATTRIBUTES = frozenset(("ID", "name"))
AUTOREMAP = "_autoremap"
_AUTOREMAP = (AUTOREMAP, "__autoremap", "__shared_blackboard")


def _scripts(node: NodeOutline) -> tuple[tuple[str, str], ...]:
    ports = () if node.is_subtree else script_ports().get(node.plugin, ())
    return tuple((key, text) for key, text in node.attributes if key in (*CONDITIONS, *AFTERWARDS, *ports))


def _names(tree: TreeOutline) -> frozenset[str]:
    """The variables that the nodes of a tree use."""
    names: set[str] = set()
    for node in _walk(tree.root):
        for key, text in node.attributes:
            if (variable := blackboard_variable(text)) is not None:
                names.add(key if variable == "=" else variable)
        for _, text in _scripts(node):
            names |= {name for name, _ in names_in(text)}
    return frozenset(names)


# ------------------------------------------------------------------- remappings


class StrayRemap(Record, frozen=True):
    """An attribute of a `<SubTree>` whose name is not a variable of the subtree.

    Attributes:
        source: the node of the `<SubTree>`.
        key: the name of the attribute.
        outer: the value of the attribute.
        meant: the variables of the subtree with similar names that no attribute sets, the most similar first.
        names: the variables of the subtree.
    """

    source: NodeSource
    key: str
    outer: str
    meant: tuple[str, ...]
    names: tuple[str, ...]


def stray_remaps(files: tuple[TreeFileOutline, ...], path: str | None = None) -> Iterator[StrayRemap]:
    """All attributes of `<SubTree>` nodes whose names are not variables of their subtree.

    Args:
        path: the file whose trees are searched; `None` for the trees of all files.
    """
    trees = _by_id(files)
    declared = {pair for file in files for pair in file.declared}
    words, variables = _Words(trees, _words), _Words(trees, _variables)
    for file in files:
        for tree in file.trees if path in (None, file.path) else ():
            for node in _walk(tree.root):
                if node.is_subtree and node.plugin in trees:
                    yield from _strays(tree, node, words, variables, declared)


def _strays(
    tree: TreeOutline, node: NodeOutline, words: _Words, variables: _Words, declared: set[tuple[str, str]]
) -> Iterator[StrayRemap]:
    given = {key: text for key, text in node.attributes if key not in _NO_REMAPS and not key.startswith("_")}
    for key, text in given.items():
        if not words.has(node.plugin, key) and (node.plugin, key) not in declared and ":" not in key:
            free = tuple(name for name in variables.of(node.plugin) if name not in given)
            source = NodeSource(tree.path, tree.id, node.position)
            yield StrayRemap(source, key, text, close_names(key, free), free)


class _Words:
    """The names that each tree uses, including the names of its subtrees with automatic remapping.

    Each name has a number, and a set of names is an integer with one bit for each name. This saves memory if subtrees
    are nested deeply, because each tree contains the names of all subtrees inside.
    """

    def __init__(self, trees: Mapping[str, TreeOutline], words: Callable[[TreeOutline], frozenset[str]]) -> None:
        own = {id_: words(tree) for id_, tree in trees.items()}
        self._names = sorted({name for names in own.values() for name in names})
        self._bits = {name: 1 << number for number, name in enumerate(self._names)}
        self._sets = {id_: sum(self._bits[name] for name in names) for id_, names in own.items()}
        self._decoded: dict[int, tuple[str, ...]] = {}
        self._take_all({id_: _taking_all(tree, trees) for id_, tree in trees.items()})

    def has(self, tree_id: str, name: str) -> bool:
        return bool(self._sets[tree_id] & self._bits.get(name, 0))

    def of(self, tree_id: str) -> tuple[str, ...]:
        """All names of a tree, sorted."""
        bits = self._sets[tree_id]
        if bits not in self._decoded:
            flags = reversed(f"{bits:b}")
            self._decoded = {bits: tuple(itertools.compress(self._names, map(int, flags)))}
        return self._decoded[bits]

    def _take_all(self, inner: Mapping[str, frozenset[str]]) -> None:
        """Add the names of the subtrees in `inner` to those of each tree, until nothing changes. Without a cycle, one
        round is sufficient."""
        try:
            order = tuple(TopologicalSorter(inner).static_order())
        except CycleError:
            order = tuple(inner)
        before: dict[str, int] = {}
        while before != self._sets:
            before = dict(self._sets)
            for id_ in order:
                for subtree in inner[id_]:
                    self._sets[id_] |= self._sets[subtree]


def _taking_all(tree: TreeOutline, trees: Mapping[str, TreeOutline]) -> frozenset[str]:
    """The IDs of the subtrees in `tree` that are used with automatic remapping."""
    subtrees = (node for node in _walk(tree.root) if node.is_subtree and node.plugin in trees)
    return frozenset(node.plugin for node in subtrees if _is_autoremapped(node))


def _is_autoremapped(node: NodeOutline) -> bool:
    attributes = dict(node.attributes)
    return any(attributes.get(name) in ("true", "1") for name in _AUTOREMAP)


def _words(tree: TreeOutline) -> frozenset[str]:
    """Every name in the values of the attributes of a tree: names of variables, and names in scripts. The value `{=}`
    contains the name of its attribute."""
    words: set[str] = set()
    for node in _walk(tree.root):
        for key, text in node.attributes:
            if key not in _OWN_ATTRIBUTES and key not in _AUTOREMAP:
                words |= {key} if text.strip() == "{=}" else set(_WORD.findall(text))
    return frozenset(words)


def _variables(tree: TreeOutline) -> frozenset[str]:
    """The names of the variables in the values of the attributes of a tree, without the words in constants."""
    names: set[str] = set()
    for node in _walk(tree.root):
        scripts = dict(_scripts(node))
        for key, text in node.attributes:
            if key in scripts:
                names.update(_WORD.findall(_STRING.sub("", text)))
            elif text.strip() == "{=}":
                names.add(key)
            elif key not in _OWN_ATTRIBUTES:
                names.update(word for part in _REFERENCE.findall(text) for word in _WORD.findall(part))
    return frozenset(names - _SCRIPT_WORDS)


_NO_REMAPS = _OWN_ATTRIBUTES | {"xmlns"}
_WORD = regex(r"(?<!\w)[A-Za-z_]\w*", re.ASCII)
_REFERENCE = regex(r"\{([^{}]*)\}")
_STRING = regex(r"'[^']*'")
_SCRIPT_WORDS = {"true", "false"}
