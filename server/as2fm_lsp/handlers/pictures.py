# SPDX-License-Identifier: Apache-2.0
"""`as2fm/picture`: a machine, the behavior tree or the ROS graph as a diagram; `as2fm/pictureFile`: as a file."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from typing import Any

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, optional_string, string, strings
from as2fm_lsp.session import Session
from roaml.figures.drawing import Drawing
from roaml.figures.layout import LayoutDirection
from roaml.figures.pdf import pdf_file
from roaml.figures.svg import svg_file, svg_scene
from roaml.figures.themes import THEMES
from roaml.ide.diagrams import (
    OUTLINE_WIDTHS,
    DiagramKind,
    Picture,
    around,
    collapsed,
    draw,
    draw_outline,
    matching,
    picture_of,
    with_provided_interfaces,
)
from roaml.ide.picture_edits import PictureParts
from roaml.project.analysis import Analysis
from roaml.text import Location

METHOD = "as2fm/picture"
FILE_METHOD = "as2fm/pictureFile"
OUTLINES = dict(zip(("outline", "wide-outline"), OUTLINE_WIDTHS, strict=True))
"""The widths of the outlines of a tree, in pixels, by the values of the parameter `direction`."""


def register(context: Context) -> None:
    session = context.session

    @context.feature(METHOD)
    def picture(params: Any) -> dict[str, object] | None:
        """The diagram, drawn in each direction; null if the file has no diagram of this kind."""
        shown = asked_picture(session, params)
        return _converted(session, *shown) if shown else None

    @context.feature(FILE_METHOD)
    def picture_file(params: Any) -> dict[str, object] | None:
        """The text of an SVG file with the diagram, in the direction and the theme that the client shows. If the
        parameter `format` is `pdf`, also the PDF file, in base64."""
        shown = asked_picture(session, params)
        if shown is None:
            return None
        _, kind, diagram = shown
        direction, theme = string(params, "direction"), string(params, "theme")
        if direction in OUTLINES and kind is DiagramKind.TREE:
            drawing = draw_outline(diagram, OUTLINES[direction])
        else:
            is_wide = direction == LayoutDirection.RIGHT.value
            drawing = draw(kind, diagram, LayoutDirection.RIGHT if is_wide else LayoutDirection.DOWN)
        svg = svg_file(drawing, diagram.title, theme if theme in THEMES else "light")
        if getattr(params, "format", None) != "pdf":
            return {"svg": svg}
        return {"svg": svg, "pdf": b64encode(pdf_file(svg)).decode("ascii")}


def asked_picture(session: Session, params: Any) -> tuple[Analysis, DiagramKind, Picture] | None:
    """The picture that a request names; `None` if the file has none of this kind."""
    kind = next((kind for kind in DiagramKind if kind.value == string(params, "kind")), None)
    hidden = strings(params, "collapsed")
    path = session.convert.path(document_uri(params))
    analysis = session.moment().snapshot(path).analysis
    picture = picture_of(kind, analysis, path) if kind else None
    if kind is None or picture is None:
        return None
    if kind is not DiagramKind.ROS:
        return analysis, kind, collapsed(picture, hidden)
    text, center = optional_string(params, "matching"), optional_string(params, "around")
    picture = collapsed(around(matching(picture, text), center), hidden)
    if not text and not center:
        picture = with_provided_interfaces(picture)
    return analysis, kind, picture


def _place(session: Session, analysis: Analysis, location: Location | None) -> dict[str, object] | None:
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


def _converted(session: Session, analysis: Analysis, kind: DiagramKind, picture: Picture) -> dict[str, object]:
    parts = PictureParts(analysis)

    def place(location: Location | None) -> dict[str, object] | None:
        return _place(session, analysis, location)

    return {
        "kind": kind.value,
        "title": picture.title,
        "nodes": [
            {
                "id": node.id,
                "kind": node.kind.value,
                "label": node.label,
                "details": [detail.text for detail in node.details],
                "parent": node.parent,
                "hides": list(node.hides),
                "initial": node.initial,
                "place": place(node.place),
                "actions": [action.value for action in parts.actions(node.place)],
                "use": place(node.use),
                "useActions": [action.value for action in parts.actions(node.use)],
            }
            for node in picture.nodes
        ],
        "edges": [
            {
                "source": edge.source,
                "target": edge.target,
                "kind": edge.kind.value,
                "labels": [*edge.labels, *filter(None, [edge.order]), *(f"/ {action}" for action in edge.actions)],
                "probabilistic": edge.probabilistic,
                "interface": edge.interface.value if edge.interface else "",
                "place": place(edge.place),
                "actions": [action.value for action in parts.actions(edge.place)],
            }
            for edge in picture.edges
        ],
        "drawings": [_drawing(drawing) for drawing in _drawings(kind, picture)],
    }


def _drawings(kind: DiagramKind, picture: Picture) -> Iterator[Drawing]:
    """The drawings in each direction, and the outlines of a tree."""
    yield from (draw(kind, picture, direction) for direction in LayoutDirection)
    if kind is DiagramKind.TREE:
        yield from (draw_outline(picture, width) for width in OUTLINES.values())


def _drawing(drawing: Drawing) -> dict[str, object]:
    """The drawing for a view: its size, its SVG, and the boxes of nodes by their indexes."""
    return {
        "width": drawing.size.width,
        "height": drawing.size.height,
        "scene": svg_scene(drawing),
        "nodes": [
            {"index": index, "x": box.x, "y": box.y, "width": box.width, "height": box.height}
            for index, box in drawing.nodes.items()
        ],
    }
