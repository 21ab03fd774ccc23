# SPDX-License-Identifier: Apache-2.0
"""`as2fm/picture`: a machine, the behavior tree or the ROS graph as a diagram."""

from __future__ import annotations

from typing import Any

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, string
from roaml.ide.diagrams import Picture, machine_picture, ros_picture, tree_picture
from roaml.project.analysis import Analysis
from roaml.text import Location

METHOD = "as2fm/picture"

_PICTURES = {"machine": machine_picture, "tree": tree_picture, "ros": ros_picture}


def register(context: Context) -> None:
    session = context.session

    def place(analysis: Analysis, location: Location | None) -> dict[str, object] | None:
        source = analysis.source(location.path) if location else None
        if source is None or location is None:
            return None
        start, end = (session.convert.position(source, offset) for offset in location.span)
        return {
            "uri": session.convert.uri(location.path),
            "range": {
                "start": {"line": start.line, "character": start.character},
                "end": {"line": end.line, "character": end.character},
            },
        }

    def convert(analysis: Analysis, kind: str, picture: Picture) -> dict[str, object]:
        return {
            "kind": kind,
            "title": picture.title,
            "nodes": [
                {
                    "id": node.id,
                    "kind": node.kind.value,
                    "label": node.label,
                    "details": list(node.details),
                    "parent": node.parent,
                    "initial": node.initial,
                    "place": place(analysis, node.place),
                }
                for node in picture.nodes
            ],
            "edges": [
                {
                    "source": edge.source,
                    "target": edge.target,
                    "kind": edge.kind.value,
                    "labels": list(edge.labels),
                    "probabilistic": edge.probabilistic,
                    "place": place(analysis, edge.place),
                }
                for edge in picture.edges
            ],
        }

    @context.feature(METHOD)
    def picture(params: Any) -> dict[str, object] | None:
        """The diagram; null if the file has no diagram of this kind."""
        kind = string(params, "kind")
        make = _PICTURES.get(kind)
        path = session.convert.path(document_uri(params))
        analysis = session.moment().snapshot(path).analysis
        drawn = make(analysis, path) if make else None
        return None if drawn is None else convert(analysis, kind, drawn)
