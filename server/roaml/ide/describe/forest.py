# SPDX-License-Identifier: Apache-2.0
"""Descriptions, as Markdown, of nodes and ports in trees that belong to no system, from libraries and models."""

from __future__ import annotations

from roaml.ide.describe.markdown import code, lines, name, paragraphs, prose
from roaml.libraries import Node, Port
from roaml.roles import NodeKind


def node(known: Node) -> str:
    """The description of a node: its ports, its behavior, and the source of its declaration."""
    ports = "".join(f"\n  {_line(port)}" for port in known.ports if not port.alias_of)
    kind = (
        str(known.kind)
        if known.kind in (NodeKind.ACTION, NodeKind.CONDITION, NodeKind.DECORATOR)
        else f"{known.kind} node"
    )
    since = f" since {known.since}" if known.since else ""
    return paragraphs(
        code(f"{kind} {known.name}{ports}"),
        _text(known.text, known.library),
        f"*{known.library}{since}*" if known.library else "*`<TreeNodesModel>`*",
    )


def port(known: Node, described: Port) -> str:
    """The description of a port: type, default and meaning."""
    must = "must be set" if described.required else ""
    value = name(described.default) if described.default else "empty"
    default = "" if described.default is None else f"{value} if not set"
    return paragraphs(code(_line(described)), lines(_text(described.text, known.library), must, default))


def _line(described: Port) -> str:
    default = f" = {described.default}" if described.default else ""
    type_ = f" : {described.type}" if described.type else ""
    return f"{described.direction} {described.name}{type_}{default}"


def _text(text: str, library: str) -> str:
    """A description as Markdown. Descriptions in libraries are Markdown; descriptions in a user's model are not."""
    return text if library else prose(text)
