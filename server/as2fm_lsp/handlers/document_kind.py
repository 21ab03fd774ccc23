# SPDX-License-Identifier: Apache-2.0
"""`as2fm/about`: the kind of a document and its systems, so that an editor offers the commands that apply to it."""

from __future__ import annotations

from typing import Any, TypedDict

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri
from roaml.model.kinds import FileKind

METHOD = "as2fm/about"

_KINDS = {
    FileKind.MACHINE: "machine",
    FileKind.SYSTEM: "system",
    FileKind.TREE: "tree",
    FileKind.STRUCTS: "structs",
    FileKind.JSON_STRUCTS: "structs",
    FileKind.PROPERTIES: "properties",
    FileKind.XML_PROPERTIES: "properties",
    FileKind.INTERFACE: "interface",
    FileKind.JANI_MODEL: "model",
}


class About(TypedDict):
    """`kind` is "" for unsupported files; `systems` are the URIs of the systems that use the file. `hasTree` is whether
    the file or one of these systems has a behavior tree."""

    kind: str
    systems: list[str]
    hasTree: bool


def register(context: Context) -> None:
    session = context.session

    @context.feature(METHOD)
    def about(params: Any) -> About:
        path = session.convert.path(document_uri(params))
        analysis = session.moment().snapshot(path).analysis
        systems = analysis.memberships.get(path, ())
        kind = analysis.kind(path)
        has_tree = kind is FileKind.TREE or any(analysis.tree_paths(system) for system in systems)
        return {
            "kind": _KINDS.get(kind, ""),
            "systems": [session.convert.uri(system) for system in systems],
            "hasTree": has_tree,
        }
