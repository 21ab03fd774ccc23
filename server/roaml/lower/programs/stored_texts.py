# SPDX-License-Identifier: Apache-2.0
"""The entries that the library stores as texts although their values are numbers, because constants of `SetBlackboard`
set them (docs/spec/mocks.md#stored-texts)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from roaml.forest.cpp_types import ANY, STRING
from roaml.forest.forest import port_type
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree
from roaml.record import Record
from roaml.roles import Direction
from roaml.script.tree import Assignment, Name, Script, walk


class StoredTexts(Record, frozen=True, eq=False):
    """The entries of texts that constants of `SetBlackboard` set.

    Attributes:
        entries: the names of these entries, and of those to which scripts copy them.
        untyped: the entries to which no port is bound that has a type of its own or is not known.
    """

    entries: frozenset[str]
    untyped: frozenset[str]


def set_entry(node: ExecutedNode, *, in_system: bool) -> str | None:
    """The entry that a `SetBlackboard` writes or an `UnsetBlackboard` removes; `None` if its name is known only when
    the tree runs. In a system, `{v}` refers to the entry `v` itself (docs/spec/nodes.md#library)."""
    for port, entry, text, _ in node.ports():
        if port in ("output_key", "key"):
            return node.frame.entry(text.strip()) if entry is None else entry if in_system else None
    return None


def stored_texts(
    tree: ExecutedTree, scripts: Iterable[tuple[ExecutedNode, Script]], given: Mapping[str, str]
) -> StoredTexts:
    """The entries of texts that constants of `SetBlackboard` set in a tree without a system.

    Args:
        scripts: the scripts of the tree, each with its node.
        given: entry -> the text to which the program that runs the tree sets it.
    """
    constants: set[str] = set()
    named: set[str] = set()
    typed = {*given, *tree.initial}
    strings: set[str] = set()
    for node in tree.nodes:
        if node.type == "SetBlackboard":
            target = set_entry(node, in_system=False)
            values = [entry for port, entry, _, _ in node.ports() if port == "value"]
            named.update(entry for entry in (target, *values) if entry is not None)
            if target is not None and values == [None]:
                constants.add(target)
            continue
        for port, entry, _, _ in node.ports():
            if entry is None or node.is_subtree:
                continue
            declared = node.known.port(port) if node.known else None
            type_ = None if declared is None else port_type(declared)
            if type_ == STRING:
                strings.add(entry)
            elif declared is None or type_ != ANY or declared.direction is not Direction.IN:
                typed.add(entry)
    texts = constants - typed
    copies = [
        (node.frame.entry(part.target.name), node.frame.entry(part.value.name))
        for node, script in scripts
        for part in walk(script)
        if isinstance(part, Assignment) and part.operator in (":=", "=") and isinstance(part.value, Name)
    ]
    copied = {target for target, source in copies if source in texts} - typed
    while not copied <= texts:
        texts |= copied
        copied = {target for target, source in copies if source in texts} - typed
    return StoredTexts(frozenset(texts), frozenset(named - typed - strings))
