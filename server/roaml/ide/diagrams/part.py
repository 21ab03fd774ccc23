# SPDX-License-Identifier: Apache-2.0
"""Parts of a ROS graph: what matches a text, or the neighbourhood of a node."""

from __future__ import annotations

from collections.abc import Collection

from roaml.ide.diagrams.diagram import DiagramNode, Picture
from roaml.ide.diagrams.namespaces import INTERFACES, content, with_parents
from roaml.record import replace


def matching(picture: Picture, text: str) -> Picture:
    """The nodes that contain all words of a text, and what is connected to them. Words are compared without case with
    the kind of a node, its name (which contains its namespace) and its type. Of a namespace, everything in it is
    shown."""
    words = text.lower().split()
    if not words:
        return picture
    found = {node.id for node in picture.nodes if _contains(node, words)}
    found |= content(picture, found)
    return _restricted(picture, found | _next_to(picture, found))


def around(picture: Picture, node: str) -> Picture:
    """A node and what is connected to it; for a node or plugin of ROS, also those with which it communicates; for a
    namespace, all of this for everything in it. The whole diagram if it does not contain the node.

    Args:
        node: the id of the node.
    """
    center = next((known for known in picture.nodes if known.id == node), None)
    if center is None:
        return picture
    inside = content(picture, {node})
    near = inside | _next_to(picture, inside | {node})
    if center.kind not in INTERFACES:
        interfaces = {known.id for known in picture.nodes if known.id in near and known.kind in INTERFACES}
        near |= _next_to(picture, interfaces)
    return _restricted(picture, near | {node})


def _contains(node: DiagramNode, words: Collection[str]) -> bool:
    text = " ".join((node.kind.value, node.label, *(detail.text for detail in node.details))).lower()
    return all(word in text for word in words)


def _next_to(picture: Picture, ids: Collection[str]) -> set[str]:
    from_them = {edge.target for edge in picture.edges if edge.source in ids}
    return from_them | {edge.source for edge in picture.edges if edge.target in ids}


def _restricted(picture: Picture, kept: Collection[str]) -> Picture:
    shown = with_parents(picture, kept)
    nodes = tuple(node for node in picture.nodes if node.id in shown)
    edges = tuple(edge for edge in picture.edges if edge.source in kept and edge.target in kept)
    return replace(picture, nodes=nodes, edges=edges)
