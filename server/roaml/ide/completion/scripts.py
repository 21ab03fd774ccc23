# SPDX-License-Identifier: Apache-2.0
"""The names that a script of a tree can use."""

from __future__ import annotations

from roaml.ide.completion.expressions import beginning
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.ide.completion.ports import node_name
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS, SCRIPT
from roaml.model.tree import is_variable_name
from roaml.text import Span


def in_script(
    request: Request, subject: CompletionSubject, name: str, span: Span
) -> tuple[Span, list[CompletionItem]] | None:
    """The span that the completions at the caret replace, and the completions; `None` if the attribute `name` does not
    contain a script."""
    forest, element = request.forest, subject.element
    if forest is None or element is None or not any(typed.element.name == "BehaviorTree" for typed in subject.parents):
        return None
    known = forest.node(node_name(element))
    port = known.port(name) if known else None
    if name not in (*CONDITIONS, *AFTERWARDS) and (port is None or port.type != SCRIPT):
        return None
    begun = beginning(request.file.document.text, span.start, request.offset)
    if begun is None:
        return span, []
    return begun.span, [
        *_entries(request),
        *(CompletionItem(word, ItemKind.VALUE, rank=Rank.LATE) for word in ("true", "false")),
    ]


def _entries(request: Request) -> list[CompletionItem]:
    trees = request.trees.files[request.path].trees
    tree = next((tree for tree in trees if tree.element.span.contains(request.offset)), None)
    if tree is None:
        return []
    id_ = tree.id.value if tree.id else ""
    return [
        CompletionItem(
            name, ItemKind.VARIABLE, "", "blackboard", request.trees.variable(request.path, id_, name), Rank.LIKELY
        )
        for name in dict.fromkeys(request.trees.names_in(tree))
        if is_variable_name(name)
    ]
