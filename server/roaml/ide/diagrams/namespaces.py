# SPDX-License-Identifier: Apache-2.0
"""The namespaces of a ROS graph, as nodes that contain other nodes.

The namespaces of nodes are shown, and those that several of them have in common. A topic, service or action is in the
innermost shown namespace that its name contains. A graph without namespaces is unchanged.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import combinations, takewhile

from roaml.ide.diagrams.diagram import DiagramNode, DiagramNodeKind, Picture
from roaml.record import replace

INTERFACES = (DiagramNodeKind.TOPIC, DiagramNodeKind.SERVICE, DiagramNodeKind.ACTION_INTERFACE)


def with_namespaces(picture: Picture, namespaces: Mapping[str, str]) -> Picture:
    """The graph with a node for each namespace, before the others, and with the parents of all nodes.

    Args:
        namespaces: id of a node or plugin -> its namespace, without `/` at its ends.
    """
    shown = _shown([tuple(name.split("/")) for name in namespaces.values()])
    if not shown:
        return picture
    nodes = [
        DiagramNode(_id(path), DiagramNodeKind.NAMESPACE, f"/{'/'.join(path)}", parent=_around(path[:-1], shown))
        for path in shown
    ]
    for node in picture.nodes:
        name = node.label.rpartition("/")[0] if node.kind in INTERFACES else namespaces.get(node.id, "")
        nodes.append(replace(node, parent=_around(tuple(name.strip("/").split("/")), shown)))
    return replace(picture, nodes=tuple(nodes))


def _shown(paths: Collection[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """The namespaces of nodes, and those that two of them have in common; each after those that contain it."""
    common = {
        tuple(a for a, _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))
        for one, other in combinations(dict.fromkeys(paths), 2)
    }
    return sorted({*paths, *common} - {()})


def _id(path: tuple[str, ...]) -> str:
    return f"namespace /{'/'.join(path)}"


def _around(path: tuple[str, ...], shown: Collection[tuple[str, ...]]) -> str:
    """The id of the innermost shown namespace that is this one or contains it; "" if there is none."""
    candidates = (path[:length] for length in range(len(path), 0, -1))
    return next((_id(candidate) for candidate in candidates if candidate in shown), "")


def content(picture: Picture, ids: Collection[str]) -> set[str]:
    """The ids of the nodes in nodes, at any depth."""
    inside: set[str] = set()
    for node in picture.nodes:  # parents are before their children
        if node.parent in ids or node.parent in inside:
            inside.add(node.id)
    return inside


def with_parents(picture: Picture, ids: Collection[str]) -> set[str]:
    """The ids of nodes and of those that contain them."""
    parents = {node.id: node.parent for node in picture.nodes}
    found: set[str] = set()
    pending = list(ids)
    while pending:
        name = pending.pop()
        if name and name not in found:
            found.add(name)
            pending.append(parents[name])
    return found
