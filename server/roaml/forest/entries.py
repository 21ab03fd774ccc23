# SPDX-License-Identifier: Apache-2.0
"""The blackboard of trees: which names refer to the same entry, and which places read and write it
(docs/spec/lone-trees.md#entries).

- Names of different trees refer to one entry if a `SubTree` remaps one to the other. All uses of a tree are combined,
  so an entry is treated as written if one of the uses writes it.
- A node with unknown ports may read and write the entries that its attributes name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TypeAlias

from roaml.forest.cpp_types import ANY
from roaml.forest.forest import Forest, port_type
from roaml.forest.ports import ports_of
from roaml.forest.scripts import scripts_of
from roaml.forest.written_for import OLD_ATTRIBUTES
from roaml.libraries import Node, Port
from roaml.libraries.programs.assembly import programs
from roaml.libraries.scripts import SCRIPT
from roaml.model.tree import PortSetting, Tree, TreeNode, blackboard_variable
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import Direction
from roaml.script.names import names_in
from roaml.text import Span

ROOT = ""
"""The name that represents the blackboard of the executed tree, to which `@name` refers."""

Key: TypeAlias = tuple[str, str]
"""The name of a tree, and the name of an entry in it."""

_TRUE = ("1", "true", "True", "TRUE")
_NAME = regex(r"@?[A-Za-z_][\w.:-]*\Z", re.ASCII)


class Use(Record, frozen=True):
    """A place that refers to an entry.

    Attributes:
        path: the file.
        tree: the name of the tree.
        name: the name of the entry as written, including a leading `@`.
        reads, writes: whether the place reads or writes the entry; `None` if not known.
        creates: whether this use creates the entry.
        type: the type of the port, `any` if not known.
        from_library: whether the type comes from a library, not from a model in a file.
        script: whether the use is in a script.
        remaps: whether the use only makes an entry available in a subtree under another name.
        span: the span of the attribute's value, which for a script is the whole script.
    """

    path: str
    tree: str
    name: str
    reads: bool | None
    writes: bool | None
    creates: bool
    type: str
    from_library: bool
    script: bool
    node: TreeNode
    span: Span
    remaps: bool = False


class Entries(Record, frozen=True, eq=False, dict=True):
    """The entries of the blackboards of a forest.

    Attributes:
        uses: all uses, in the order of the files and of the text.
        remapped: the entries of subtrees that refer to entries of the trees that use them.
        intended: the entries that invalid values of output ports, and misspelled attributes of subtrees, are probably
            intended to name. An empty name represents all entries of the tree.
    """

    uses: tuple[Use, ...]
    _roots: Mapping[Key, Key]
    remapped: frozenset[Key] = frozenset()
    intended: frozenset[Key] = frozenset()

    def entry(self, tree: str, name: str) -> Key:
        """The key that represents the entry to which a name in a tree refers; equal keys are equal entries."""
        key = (ROOT, name[1:]) if name.startswith("@") else (tree, name)
        while key in self._roots:
            key = self._roots[key]
        return key

    def is_intended(self, tree: str, name: str) -> bool:
        """Whether an invalid value of an output port, or a misspelled attribute of a subtree, is probably intended to
        name this entry."""
        return (tree, name) in self.intended or (tree, "") in self.intended

    @cached_property
    def by_entry(self) -> Mapping[Key, list[Use]]:
        uses: dict[Key, list[Use]] = {}
        for use in self.uses:
            uses.setdefault(self.entry(use.tree, use.name), []).append(use)
        return uses


def entry_of(setting: PortSetting) -> str | None:
    """The name of the entry that a port is bound to; `None` if its value is a constant. `{=}` and `=` refer to the
    entry with the name of the port."""
    value = setting.value.value.strip()
    if value == "=":
        return setting.attribute.name
    name = blackboard_variable(value)
    return setting.attribute.name if name == "=" else name or None


def find_entries(forest: Forest) -> Entries:
    uses = tuple(_uses(forest))
    return Entries(uses, _joined(forest, uses), frozenset(_remapped(forest)), frozenset(_intended(forest, uses)))


def _remapped(forest: Forest) -> Iterator[Key]:
    for _, inner, node in _calls(forest):
        yield from ((inner, setting.attribute.name) for setting in ports_of(node) if entry_of(setting) is not None)


def _intended(forest: Forest, uses: tuple[Use, ...]) -> Iterator[Key]:
    names = {(use.tree, use.name) for use in uses if not use.node.is_subtree or use.remaps}
    for _, inner, node in _calls(forest):
        model = forest.subtree_models.get(inner)
        for setting in ports_of(node):
            name = setting.attribute.name
            if (inner, name) not in names and (model is None or model.port(name) is None):
                yield inner, ""
    for _, tree, node in forest.all_nodes:
        known = forest.declaration(node)
        for setting in ports_of(node) if known else ():
            port = known.port(setting.attribute.name) if known else None
            if port is not None and port.direction is Direction.OUT and entry_of(setting) is None:
                text = setting.value.value.strip().strip("{}")
                yield _name(tree), text if _NAME.match(text) else ""
                yield _name(tree), port.name


def _uses(forest: Forest) -> Iterator[Use]:
    for path, tree, node in forest.all_nodes:
        own = tree.id.value if tree.id else ""
        for use in scripts_of(forest, node):
            span = use.attribute.value_span
            for name, operator in names_in(use.attribute.value):
                reads, writes = operator not in (":=", "="), operator != "read"
                yield Use(path, own, name, reads, writes, operator == ":=", ANY, False, True, node, span)
        if forest.calls_tree(node):
            yield from _of_subtree(forest, path, own, node)
        else:
            yield from _of_ports(forest, path, own, node)


def _of_ports(forest: Forest, path: str, own: str, node: TreeNode) -> Iterator[Use]:
    known = forest.known_node(node)
    for setting in ports_of(node):
        port = known.port(setting.attribute.name) if known else None
        span, text = setting.value.span, setting.value.value.strip()
        name = entry_of(setting)
        if port is not None and port.names_entry:
            name = name or (text if _NAME.match(text) else None)
            if name is not None:
                reads, writes = (False, True) if port.direction.writes else (None, None)
                yield Use(path, own, name, reads, writes, True, ANY, False, False, node, span)
        elif name is not None and port is not None:
            if port.type == SCRIPT:
                continue
            direction = port.direction
            reads = direction.reads if direction is not Direction.INOUT else None
            assert known is not None
            type_ = ANY if forest.is_partly_described(known) else port_type(port)
            library = bool(known.library)
            writes = direction.writes
            if library and direction is Direction.INOUT and not _is_written(known, port):
                reads, writes = True, False
            yield Use(path, own, name, reads, writes, True, type_, library, False, node, span)
        elif name is not None:
            yield Use(path, own, name, None, None, True, ANY, False, False, node, span)


def _is_written(node: Node, port: Port) -> bool:
    """Whether a node of a library writes the entry in a port. A loop only takes elements from its queue."""
    return node.name not in programs() or port.name in programs()[node.name].written_ports


def _of_subtree(forest: Forest, path: str, own: str, node: TreeNode) -> Iterator[Use]:
    """The uses in the ports of a subtree. A literal value is written to the entry of the subtree."""
    inner = node.plugin.value if node.plugin else ""
    known = inner in forest.trees
    for setting in ports_of(node):
        name = bound_entry(forest, node, setting)
        if name is None:
            key = setting.attribute.name
            yield Use(path, inner, key, False, True, True, ANY, False, False, node, setting.value.span)
        elif not known:
            yield Use(path, own, name, None, None, True, ANY, False, False, node, setting.value.span)
        else:
            yield Use(path, own, name, False, False, False, ANY, False, False, node, setting.value.span, remaps=True)


def _joined(forest: Forest, uses: tuple[Use, ...]) -> Mapping[Key, Key]:
    """A union-find forest of keys, in which all names of one entry have the same root: key -> parent."""
    roots: dict[Key, Key] = {}

    def find(key: Key) -> Key:
        top = key
        while top in roots:
            top = roots[top]
        while key in roots:
            roots[key], key = top, roots[key]
        return top

    def join(left: Key, right: Key) -> None:
        first, second = find(left), find(right)
        if first != second:
            roots[first] = second

    def key_of(tree: str, name: str) -> Key:
        return (ROOT, name[1:]) if name.startswith("@") else (tree, name)

    names: dict[str, set[str]] = {}
    for use in uses:
        if not use.name.startswith("@"):
            names.setdefault(use.tree, set()).add(use.name)
    calls = list(_calls(forest))
    for outer, inner, node in calls:
        for setting in ports_of(node):
            name = bound_entry(forest, node, setting)
            if name is not None:
                names.setdefault(outer, set()).add(name)
                join((inner, setting.attribute.name), key_of(outer, name))
    for inner, outer, name in _taken_over(forest, calls, names):
        join((inner, name), (outer, name))
    used = {inner for _, inner, _ in calls}
    for tree in forest.trees:
        if tree not in used:
            for name in sorted(names.get(tree, ())):
                join((tree, name), (ROOT, name))
    return roots


def _taken_over(
    forest: Forest, calls: list[tuple[str, str, TreeNode]], names: dict[str, set[str]]
) -> Iterator[tuple[str, str, str]]:
    """The names that automatic remapping unifies, as inner tree, outer tree and name. Adds them to `names`."""
    users: dict[str, list[tuple[str, frozenset[str]]]] = {}
    for outer, inner, node in calls:
        if is_autoremapped(node, version_3=forest.is_of_version_3(node)):
            given = frozenset(setting.attribute.name for setting in ports_of(node))
            users.setdefault(inner, []).append((outer, given))
    pending = [(tree, name) for tree in users for name in sorted(names.get(tree, ()))]
    while pending:
        inner, name = pending.pop()
        for outer, given in users.get(inner, ()):
            if name not in given and not name.startswith("_"):
                yield inner, outer, name
                if name not in names.setdefault(outer, set()):
                    names[outer].add(name)
                    pending.append((outer, name))


def _calls(forest: Forest) -> Iterator[tuple[str, str, TreeNode]]:
    """The uses of known trees, as outer tree, inner tree and node."""
    for _, tree, node in forest.all_nodes:
        is_call = forest.calls_tree(node)
        if is_call and node.plugin is not None and node.plugin.value in forest.trees:
            yield _name(tree), node.plugin.value, node


def _name(tree: Tree) -> str:
    return tree.id.value if tree.id else ""


def is_autoremapped(node: TreeNode, *, version_3: bool = False) -> bool:
    """Whether a `<SubTree>` binds all entries that are not set. `version_3`: whether its file is of version 3."""
    names = ("_autoremap", *OLD_ATTRIBUTES) if version_3 else ("_autoremap",)
    given = (node.element.get(name) for name in names)
    return any(attribute is not None and attribute.value.strip() in _TRUE for attribute in given)


def bound_entry(forest: Forest, node: TreeNode, setting: PortSetting) -> str | None:
    """The name of the entry that an attribute of a subtree is bound to; `None` if it is a constant. In a file of
    version 3, the values of a `SubTree` are names of entries without braces."""
    name = setting.value.value.strip()
    is_name = forest.is_of_version_3(node) and node.element.name == "SubTree" and _NAME.match(name)
    return name if is_name else entry_of(setting)
