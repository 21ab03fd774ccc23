# SPDX-License-Identifier: Apache-2.0
"""The names of the nodes of the executed tree for users: paths through nodes and subtrees
(docs/spec/xml-properties.md#ports)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from roaml.model.expand import Instance
from roaml.model.system import System
from roaml.record import Record


class Part(Record, frozen=True):
    """A part of a path: a node, or the use of a tree. The first of its names is the preferred one."""

    names: tuple[str, ...]
    is_tree: bool


def parts_above(system: System, instance: Instance) -> tuple[Part, ...]:
    """The nodes and the uses of trees that contain a node, the outermost first."""
    parts: list[Part] = []
    node, use = instance, instance.use
    while True:
        parent = system.by_instance.get(node.parent) if node.parent is not None else None
        around = parent.instance if parent is not None else None
        outermost = None if around is None else around.use
        index: int | None = use
        while index is not None and index != outermost:
            tree = system.tree_uses[index]
            names = tuple(dict.fromkeys(filter(None, (tree.name, tree.tree))))
            parts += [Part(names, is_tree=True)] if names else []
            index = tree.outer
        if around is None:
            return tuple(reversed(parts))
        parts.append(Part((around.name,), is_tree=False))
        node, use = around, around.use


def path_of(system: System, instance: Instance) -> str:
    """The whole path of a node. Only siblings with equal names have the same path."""
    return "/".join((*(part.names[0] for part in parts_above(system, instance)), instance.name))


def instance_of(system: System, number: int) -> Instance:
    """The node with the number `number`, a key of `short_paths`."""
    instance = system.by_instance[number].instance
    assert instance is not None
    return instance


def label_of(system: System, instance: Instance) -> str:
    """A short label of a node: its tree, its plugin, and its name in quotes if it has one."""
    tree = system.tree_uses[instance.use].name if system.tree_uses else ""
    named = "" if instance.name == instance.plugin else f' "{instance.name}"'
    return f"{tree}/{instance.plugin}{named}" if tree else f"{instance.plugin}{named}"


MAX_COMPARISONS = 10_000_000
"""The maximum number of parts of paths that are compared to find the shortest paths of the nodes with one name."""


def short_paths(system: System) -> Mapping[int, str]:
    """Number of a node -> the shortest text that identifies it in a `<bt_node>`: its name, or its name after as few
    parts of its path as necessary. Uses of trees are preferred to nodes.

    If even the whole path is ambiguous, or if too many nodes in deep trees have the same name (`MAX_COMPARISONS`), the
    text is the whole path.
    """
    by_name: dict[str, list[Instance]] = {}
    for instance in _instances(system):
        by_name.setdefault(instance.name, []).append(instance)
    paths: dict[int, str] = {}
    for name, instances in by_name.items():
        above = {instance.number: parts_above(system, instance) for instance in instances} if instances[1:] else {}
        is_large = (len(above) * max(map(len, above.values()), default=0)) ** 2 > MAX_COMPARISONS
        for instance in instances:
            own = above.get(instance.number, ())
            path = tuple(part.names[0] for part in own) if is_large else _short_path(own, above.values())
            paths[instance.number] = "/".join((*path, name))
    return paths


def _short_path(own: tuple[Part, ...], all_: Iterable[tuple[Part, ...]]) -> tuple[str, ...]:
    trees = tuple(part.names[0] for part in own if part.is_tree)
    names = tuple(part.names[0] for part in own)
    paths = (*(part[start:] for part in (trees, names) for start in reversed(range(len(part)))),)
    return next((path for path in paths if _matching(path, all_) == [own]), names)


def nodes_called(system: System, text: str) -> tuple[Instance, ...]:
    """The nodes that `text` refers to; empty if there are none.

    The text is the name of a node, or an ID that is not the name of a node. The names of enclosing nodes and trees may
    precede it, separated by `/`. If the text is the whole path of a node, it refers only to this node.
    """
    *path, last = text.split("/")
    instances = _instances(system)
    called = [instance for instance in instances if instance.name == last]
    called = called or [instance for instance in instances if instance.plugin == last]
    if not path:
        return tuple(called)
    above = [parts_above(system, instance) for instance in called]
    matching = set(_matching(tuple(path), above))
    return tuple(instance for instance, parts in zip(called, above, strict=True) if parts in matching)


def _instances(system: System) -> list[Instance]:
    return [automaton.instance for automaton in system.automata if automaton.instance is not None]


def _matching(path: tuple[str, ...], above: Iterable[tuple[Part, ...]]) -> list[tuple[Part, ...]]:
    matching = [parts for parts in above if _is_inside(path, parts)]
    return [parts for parts in matching if len(parts) == len(path)] or matching


def _is_inside(path: tuple[str, ...], above: tuple[Part, ...]) -> bool:
    """Whether the names in `path` occur in `above` in this order."""
    parts = iter(above)
    return all(any(name in part.names for part in parts) for name in path)
