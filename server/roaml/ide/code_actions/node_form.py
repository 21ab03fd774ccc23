# SPDX-License-Identifier: Apache-2.0
"""Conversions between the two forms of a node of a tree: `<Action ID="X"/>` (explicit) and `<X/>` (compact)."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.edit.elements import removal
from roaml.ide.code_actions.action import REWRITE, CodeAction, WorkspaceEdit, known
from roaml.model.tree import EXPLICIT, SUBTREES, TreeNode, nodes
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.text import Span, TextEdit, computed


def one_node(analysis: Analysis, path: str, node: TreeNode) -> Iterator[CodeAction]:
    """An action that converts a node to the other form."""
    edits = _other_form(analysis, path, node)
    if edits:
        title = "Write the node in its explicit form" if node.compact else "Write the node in its compact form"
        yield CodeAction(title, REWRITE, known(_change(analysis, path, edits)))


def whole_file(analysis: Analysis, path: str, place: Span) -> Iterator[CodeAction]:
    """Actions that convert all nodes to one form, offered at the start tags of the root and of the trees."""
    file = analysis.tree(path)
    if file is None:
        return
    tags = [file.element, *(tree.element for tree in file.trees)]
    if not any(tag.open_span.start <= place.start and place.end <= tag.open_span.end for tag in tags):
        return
    for compact in (True, False):
        convertible = [n for tree in file.trees for n in nodes(tree) if n.compact is not compact]
        if any(_other_form(analysis, path, node) for node in convertible):
            form = "compact" if compact else "explicit"

            def make(convertible: list[TreeNode] = convertible) -> WorkspaceEdit:
                return _change(
                    analysis, path, [edit for node in convertible for edit in _other_form(analysis, path, node)]
                )

            yield CodeAction(f"Write all nodes in their {form} form", REWRITE, make)


def _change(analysis: Analysis, path: str, edits: list[TextEdit]) -> WorkspaceEdit:
    source = analysis.source(path)
    return WorkspaceEdit({path: tuple(in_layout(source, edits))}) if source else WorkspaceEdit()


def _other_form(analysis: Analysis, path: str, node: TreeNode) -> list[TextEdit]:
    """The edits that convert a node to the other form; empty if the result would have another meaning."""
    source, element = analysis.source(path), node.element
    if source is None or node.plugin is None or node.is_subtree or element.is_foreign or not element.complete:
        return []
    name, id_ = node.plugin.value, element.get("ID")
    if node.compact:
        if id_ is not None:  # a port of this name
            return []
        at = element.name_span.end
        edits = [TextEdit(Span(at, at), f' ID="{name}"')]
        tag = _category(analysis, path, node)
    elif id_ is None or not name.isidentifier() or name in (*EXPLICIT, *SUBTREES):
        return []
    else:
        edits = [*computed([removal(source.text, id_.span)])]
        tag = name
    names = [element.name_span, *([element.close_name_span] if element.close_name_span else [])]
    return sorted([*edits, *(TextEdit(span, tag) for span in names)])


def _category(analysis: Analysis, path: str, node: TreeNode) -> str:
    """The category of the node: the one that `<TreeNodesModel>` declares, otherwise one that fits the number of its
    children."""
    name = node.plugin.value if node.plugin else ""
    for tree_path in analysis.trees_from(path):
        file = analysis.tree(tree_path)
        for model in file.models if file else ():
            if model.id is not None and model.id.value == name and model.kind in EXPLICIT:
                return model.kind
    return {0: "Action", 1: "Decorator"}.get(len(node.children), "Control")
