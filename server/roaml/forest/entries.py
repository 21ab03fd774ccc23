# SPDX-License-Identifier: Apache-2.0
"""The blackboard of trees: which names refer to the same entry, and which places read and write it
(docs/spec/lone-trees.md#entries).

- The trees are expanded: a place in a tree that is used several times refers to an entry in each use.
- A node with unknown ports may read and write the entries that its attributes name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

from roaml.forest.cpp_types import ANY
from roaml.forest.expanded import ExpandedTree, expanded_trees
from roaml.forest.forest import Forest, port_type
from roaml.forest.names import NAME, bound_entry, entry_named, entry_of
from roaml.forest.ports import ports_of
from roaml.forest.scripts import scripts_of
from roaml.libraries import Node, Port
from roaml.libraries.programs.assembly import programs
from roaml.libraries.scripts import SCRIPT
from roaml.model.expand import Frame, nodes_of
from roaml.model.outline import MachineOutline
from roaml.model.tree import TreeNode
from roaml.record import Record, replace
from roaml.roles import Direction
from roaml.script.names import names_in
from roaml.text import Span


class Use(Record, frozen=True, eq=False):
    """A place that refers to an entry.

    Attributes:
        path: the file.
        tree: the name of the tree.
        name: the name of the entry as written, including a leading `@`.
        port: the port that is bound to the entry; "" in a script.
        reads, writes: whether the place reads or writes the entry; `None` if not known.
        creates: whether this use creates the entry.
        type: the type of the port, `any` if not known.
        from_library: whether the type comes from a library, not from a model in a file or a machine.
        script: whether the use is in a script.
        remaps: whether the use only makes an entry available in a subtree under another name.
        into: whether a `<SubTree>` gives the entry of its subtree, whose name is `tree`, a constant.
        is_default: whether the place is the name of the node, because the value is a default of `<TreeNodesModel>`.
        span: the span of the attribute's value, which for a script is the whole script.
    """

    path: str
    tree: str
    name: str
    port: str
    node: TreeNode
    span: Span
    reads: bool | None = None
    writes: bool | None = None
    creates: bool = True
    type: str = ANY
    from_library: bool = False
    script: bool = False
    remaps: bool = False
    into: bool = False
    is_default: bool = False


class BoundUse(Record, frozen=True, eq=False):
    """A place in one use of its tree.

    Attributes:
        variable: the full name of the entry.
        executed: whether the tree is executed (`ExpandedTree`).
    """

    use: Use
    frame: Frame
    variable: str
    executed: bool


class Entries(Record, frozen=True, eq=False, dict=True):
    """The entries of the blackboards of a forest.

    Attributes:
        uses: all uses, in the order of the files and of the text.
        by_entry: entry -> the places that refer to it, in the order of execution.
        trees: the expanded trees.
        intended: the entries that invalid values of output ports, and misspelled attributes of subtrees, are probably
            intended to name, as names of a tree and of an entry. An empty name represents all entries of the tree.
    """

    uses: tuple[Use, ...]
    by_entry: Mapping[str, tuple[BoundUse, ...]]
    trees: tuple[_Boards, ...]
    intended: frozenset[tuple[str, str]] = frozenset()

    def entries(self, tree: str, name: str) -> frozenset[str]:
        """The keys in `by_entry` of the entries to which a name in a tree refers, in all uses of the tree that are
        executed, or in all uses if none is. It is empty for a tree that is not expanded, because it is too large."""
        return frozenset(boards.key(frame, name) for boards, frame in self._frames.get(tree, ()))

    @cached_property
    def _frames(self) -> Mapping[str, list[tuple[_Boards, Frame]]]:
        frames: dict[str, list[tuple[_Boards, Frame]]] = {}
        for is_executed in (True, False):
            later: dict[str, list[tuple[_Boards, Frame]]] = {}
            for boards in self.trees:
                if boards.tree.executed is is_executed:
                    for frame in boards.tree.frames:
                        later.setdefault(frame.tree.id, []).append((boards, frame))
            frames = {**later, **frames}
        return frames

    def is_intended(self, tree: str, name: str) -> bool:
        """Whether an invalid value of an output port, or a misspelled attribute of a subtree, is probably intended to
        name this entry."""
        return (tree, name) in self.intended or (tree, "") in self.intended


class _Boards(Record, frozen=True, eq=False, dict=True):
    """The blackboards of an expanded tree. Trees that no tree uses have one blackboard, because one program may execute
    them.

    Attributes:
        number: a number of the tree, which distinguishes the blackboards of its subtrees.
    """

    number: int
    tree: ExpandedTree

    def key(self, frame: Frame, name: str) -> str:
        variable = full_name(frame, name)
        is_outermost = self.number == 0 or not variable.startswith(self._prefixes)
        return variable if is_outermost else f"{self.number}:{variable}"

    @cached_property
    def _prefixes(self) -> tuple[str, ...]:
        top = self.tree.frames[0]
        return tuple(frame.prefix for frame in self.tree.frames if frame.outer is top)


def full_name(frame: Frame, name: str) -> str:
    """The full name of the entry to which a name in a use of a tree refers."""
    return frame.resolve(name).variable


def find_entries(forest: Forest) -> Entries:
    uses_of: dict[TreeNode, tuple[Use, ...]] = {
        node: tuple(_uses(forest, path, tree.id.value if tree.id else "", node))
        for path, tree, node in forest.all_nodes
    }
    uses = tuple(use for of_node in uses_of.values() for use in of_node)
    trees = tuple(_Boards(number, tree) for number, tree in enumerate(expanded_trees(forest)))
    by_entry: dict[str, list[BoundUse]] = {}
    for boards in trees:
        for use, frame in _in_order(forest, boards.tree, uses_of):
            bound = BoundUse(use, frame, full_name(frame, use.name), boards.tree.executed)
            by_entry.setdefault(boards.key(frame, use.name), []).append(bound)
    bound_uses = {key: tuple(bound) for key, bound in by_entry.items()}
    return Entries(uses, bound_uses, trees, frozenset(_intended(forest, uses)))


def _in_order(
    forest: Forest, expanded: ExpandedTree, uses_of: Mapping[TreeNode, tuple[Use, ...]]
) -> Iterator[tuple[Use, Frame]]:
    """The uses in the nodes of an expanded tree, in pre-order, each with the use of a tree in which its name has a
    meaning."""
    files = dict(forest.files)
    inner = {(id(frame.outer), frame.use.position): frame for frame in expanded.frames if frame.use is not None}

    def nodes_in(frame: Frame) -> Iterator[tuple[Frame, Frame | None, TreeNode]]:
        for position, node in enumerate(nodes_of(files[frame.tree.path], frame.tree.id)):
            yield frame, inner.get((id(frame), position)), node

    pending = [nodes_in(expanded.frames[0])]
    while pending:
        frame, entered, node = next(pending[-1], (None, None, None))
        if frame is None or node is None:
            pending.pop()
            continue
        for use in uses_of[node]:
            of_use = entered if use.into else frame
            if of_use is not None:
                yield use, of_use
        if entered is not None:
            pending.append(nodes_in(entered))


def _intended(forest: Forest, uses: tuple[Use, ...]) -> Iterator[tuple[str, str]]:
    names = {(use.tree, use.name) for use in uses if not use.node.is_subtree or use.remaps}
    for _, tree, node in forest.all_nodes:
        if forest.calls_tree(node):
            inner = node.plugin.value if node.plugin is not None else ""
            model = forest.subtree_models.get(inner)
            for setting in ports_of(node) if inner in forest.trees else ():
                name = setting.attribute.name
                if (inner, name) not in names and (model is None or model.port(name) is None):
                    yield inner, ""
        known = forest.declaration(node)
        for setting in ports_of(node) if known else ():
            port = known.port(setting.attribute.name) if known else None
            if port is not None and port.direction is Direction.OUT and entry_of(setting) is None:
                own = tree.id.value if tree.id else ""
                text = setting.value.value.strip().strip("{}")
                yield own, text if NAME.match(text) else ""
                yield own, port.name


def _uses(forest: Forest, path: str, own: str, node: TreeNode) -> Iterator[Use]:
    for script in scripts_of(forest, node):
        span = script.attribute.value_span
        for name, operator in names_in(script.attribute.value):
            reads, writes = operator not in (":=", "="), operator != "read"
            yield Use(path, own, name, "", node, span, reads, writes, operator == ":=", script=True)
    is_call = forest.calls_tree(node)
    yield from _of_subtree(forest, path, own, node) if is_call else _of_ports(forest, path, own, node)
    plugin = node.plugin
    given = {setting.key.value for setting in node.ports}
    for port, text in forest.defaults.get(plugin.value, {}).items() if plugin is not None else ():
        entry = entry_named(port, text)
        if port in given or plugin is None:
            continue
        if entry is None:
            if is_call:
                yield Use(path, plugin.value, port, port, node, plugin.span, False, True, into=True, is_default=True)
        elif is_call:
            yield Use(path, own, entry, port, node, plugin.span, False, False, False, remaps=True, is_default=True)
        elif forest.system is not None:
            yield _of_port(forest, Use(path, own, entry, port, node, plugin.span, is_default=True))


def _of_ports(forest: Forest, path: str, own: str, node: TreeNode) -> Iterator[Use]:
    known = forest.known_node(node)
    for setting in forest.port_settings(node):
        key = setting.attribute.name if forest.system is None else setting.key.value
        port = known.port(key) if known else None
        span, text = setting.value.span, setting.value.value.strip()
        name = entry_of(setting)
        if port is not None and port.names_entry:
            name = name or (text if NAME.match(text) else None)
        if name is not None and (port is None or port.type != SCRIPT):
            yield _of_port(forest, Use(path, own, name, key, node, span))


def _of_port(forest: Forest, use: Use) -> Use:
    """The use of an entry in a port, with what is known about the port."""
    known = forest.known_node(use.node)
    if forest.system is not None and use.node.plugin is not None:
        return _of_outline(forest.system.plugin(use.node.plugin.value)[1], use)
    port = known.port(use.port) if known else None
    if known is None or port is None:
        return use
    if port.names_entry:
        reads, writes = (False, True) if port.direction.writes else (None, None)
        return replace(use, reads=reads, writes=writes)
    direction, is_library = port.direction, bool(known.library)
    reads, writes = direction.reads if direction is not Direction.INOUT else None, direction.writes
    if is_library and direction is Direction.INOUT and not _is_written(known, port):
        reads, writes = True, False
    type_ = ANY if forest.is_partly_described(known) else port_type(port)
    return replace(use, reads=reads, writes=writes, type=type_, from_library=is_library)


def _of_outline(outline: MachineOutline | None, use: Use) -> Use:
    """The use of an entry in a port of a system. A port for values to the node is read, even if its machine ignores
    it."""
    port = outline.port(use.port) if outline is not None else None
    if port is None:
        return use
    return replace(use, reads=port.direction is not Direction.OUT, writes=port.written, type=port.type)


def _is_written(node: Node, port: Port) -> bool:
    """Whether a node of a library writes the entry in a port. A loop only takes elements from its queue."""
    return node.name not in programs() or port.name in programs()[node.name].written_ports


def _of_subtree(forest: Forest, path: str, own: str, node: TreeNode) -> Iterator[Use]:
    """The uses in the ports of a subtree. A literal value is written to the entry of the subtree."""
    inner = node.plugin.value if node.plugin else ""
    known = inner in forest.trees
    for setting in ports_of(node):
        name, key, span = bound_entry(forest, node, setting), setting.attribute.name, setting.value.span
        if name is None:
            yield Use(path, inner, key, key, node, span, False, True, into=True)
        elif not known:
            yield Use(path, own, name, key, node, span)
        else:
            yield Use(path, own, name, key, node, span, False, False, False, remaps=True)
