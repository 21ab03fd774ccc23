# SPDX-License-Identifier: Apache-2.0
"""Hover texts for nodes of trees, and their ports, that libraries and models declare."""

from __future__ import annotations

from roaml.ide.describe import forest as describe_forest
from roaml.ide.hover.place import Place
from roaml.model.kinds import FileKind
from roaml.text import Span


def of_library(place: Place) -> tuple[Span, str] | None:
    """The description of the node or port whose name is at a place; `None` if there is none."""
    is_tree, offset = place.kind is FileKind.TREE, place.offset
    forest = place.analysis.forest(place.path, place.systems[0]) if is_tree else None
    if forest is None:
        return None
    for _, node in forest.own_nodes:
        element = node.element
        tag = next((s for s in (element.name_span, element.close_name_span) if s and s.contains(offset)), None)
        if tag is None and not element.span.contains(offset):
            continue
        known = forest.declaration(node)
        if known is None or forest.is_machine(known):
            continue
        id_ = None if node.compact or node.plugin is None else node.plugin.span
        for span in (tag if node.compact else None, id_):
            if span is not None and span.contains(offset):
                return span, describe_forest.node(known)
        for setting in node.ports:
            port = known.port(setting.attribute.name)
            if port is not None and setting.attribute.name_span.contains(offset):
                return setting.attribute.name_span, describe_forest.port(known, port)
    return None
