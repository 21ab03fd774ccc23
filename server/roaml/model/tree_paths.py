# SPDX-License-Identifier: Apache-2.0
"""The names by which people know a node of the executed tree: its path through nodes and subtrees
(docs/spec/xml-properties.md#ports)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from roaml.model.expand import Instance
from roaml.model.system import System

Part: TypeAlias = tuple[str, ...]
"""A part of a path, by each of its names; the first one is preferred."""


def parts_above(system: System, instance: Instance) -> tuple[Part, ...]:
    """The nodes and the uses of trees around a node, outermost first."""
    parts: list[Part] = []
    node, use = instance, instance.use
    while True:
        parent = system.by_instance.get(node.parent) if node.parent is not None else None
        around = parent.instance if parent is not None else None
        outermost = None if around is None else around.use
        index: int | None = use
        while index is not None and index != outermost:
            tree = system.tree_uses[index]
            parts.append(tuple(dict.fromkeys(filter(None, (tree.name, tree.tree)))))
            index = tree.outer
        if around is None:
            return tuple(part for part in reversed(parts) if part)
        parts.append((around.name,))
        node, use = around, around.use


def path_of(system: System, instance: Instance) -> str:
    """The whole path of a node, which is unique except among siblings of one name."""
    return "/".join((*(part[0] for part in parts_above(system, instance)), instance.name))


def label_of(system: System, instance: Instance) -> str:
    """A node in a few words: its tree, its plugin, and its name in quotes if it has one."""
    tree = system.tree_uses[instance.use].name if system.tree_uses else ""
    named = "" if instance.name == instance.plugin else f' "{instance.name}"'
    return f"{tree}/{instance.plugin}{named}" if tree else f"{instance.plugin}{named}"


def short_path(system: System, instance: Instance) -> str:
    """The shortest text that names a node in a `<bt_node>`: its name, or as much of its path as it takes.

    The whole path if even that names several nodes.
    """
    above = [part[0] for part in parts_above(system, instance)]
    texts = [instance.name, *("/".join((*above[start:], instance.name)) for start in reversed(range(len(above))))]
    return next((text for text in texts if len(list(nodes_called(system, text))) == 1), texts[-1])


def nodes_called(system: System, text: str) -> Iterator[Instance]:
    """The nodes that `text` names: a name; an ID that is not the name of a node; one of these after names of nodes and
    trees around it, joined by `/`."""
    *path, last = text.split("/")
    instances = [automaton.instance for automaton in system.automata if automaton.instance is not None]
    matches = [instance for instance in instances if instance.name == last]
    for instance in matches or [instance for instance in instances if instance.plugin == last]:
        if not path or _is_inside(path, parts_above(system, instance)):
            yield instance


def _is_inside(path: list[str], above: tuple[Part, ...]) -> bool:
    """Whether the names in `path` occur in `above` in this order."""
    parts = iter(above)
    return all(any(name in part for part in parts) for name in path)
