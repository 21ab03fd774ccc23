# SPDX-License-Identifier: Apache-2.0
"""Which nodes of a tree must be ticked for its success, and which are for unusual cases.

A branch behind a condition, such as charging when the battery is low, may be right although no run of a model needs it.
It is wrong if the condition is not checked when it would matter: then the branch is ticked as soon as the control nodes
around it check their children again at every tick.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping

from roaml.libraries.programs.statuses import FAILURE, SUCCESS
from roaml.model.expand import Instance, node_at
from roaml.model.node_effects import statuses, succeeds_only_with
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.text import SourceFile, TextEdit, apply_edits

ByNumber = Mapping[int, Instance]
"""The nodes of the executed trees by their numbers."""

_IN_TURN = {
    "Sequence": "ReactiveSequence",
    "AsyncSequence": "ReactiveSequence",
    "SequenceWithMemory": "ReactiveSequence",
    "Fallback": "ReactiveFallback",
    "AsyncFallback": "ReactiveFallback",
}
"""Control nodes that continue with a running child -> those that tick the children before it again."""


def is_required(system: System, instance: Instance, nodes: ByNumber) -> bool:
    """Whether a tree succeeds only if a node does."""
    way = (instance, *_around(instance, nodes))
    return all(succeeds_only_with(system, outer, child.number) for child, outer in itertools.pairwise(way))


def ends_only_in_failure(
    system: System, nodes: ByNumber, returned: Mapping[int, frozenset[int]], instance: Instance
) -> bool:
    """Whether the tree of a node ends, but never with success, although its decorators pass success on.

    Args:
        returned: number of a node -> the numbers of the statuses that it returns in some run.
    """
    *_, root = (instance, *_around(instance, nodes))
    top = root
    while len(top.children) == 1:
        if SUCCESS not in statuses(system, top) or not succeeds_only_with(system, top, top.children[0]):
            return False
        top = nodes[top.children[0]]
    known = returned.get(root.number, frozenset())
    return FAILURE in known and SUCCESS not in known


def reactive(analysis: Analysis, path: str, instance: Instance, nodes: ByNumber) -> Analysis | None:
    """An analysis of a system in which the control nodes around a node are reactive; `None` if they are so already."""
    changed = {outer.source: outer.plugin for outer in _around(instance, nodes) if outer.plugin in _IN_TURN}
    edits: dict[str, list[TextEdit]] = {}
    for source, plugin in changed.items():
        tree = analysis.tree(source.path)
        node = None if tree is None else node_at(tree, source)
        if node is not None and node.element.name == plugin:
            spans = (node.element.name_span, node.element.close_name_span)
            new = (TextEdit(span, _IN_TURN[plugin]) for span in spans if span is not None)
            edits.setdefault(source.path, []).extend(new)
    return edited(analysis, path, edits) if edits else None


def edited(analysis: Analysis, path: str, edits: Mapping[str, Iterable[TextEdit]]) -> Analysis:
    """An analysis of a system with changes in some of its files."""
    sources = {file: analysis.source(file) for file in edits}
    texts = {
        file: SourceFile(file, apply_edits(source.text, tuple(sorted(edits[file]))))
        for file, source in sources.items()
        if source is not None
    }
    files, memo = analysis.files.with_texts(texts), analysis.memo.copy()
    return Analysis(files, analysis.registry, memo, (path,), analysis.overrides, analysis.tree_settings, expands=False)


def _around(instance: Instance, nodes: ByNumber) -> Iterator[Instance]:
    """The nodes around a node, the nearest one first."""
    while instance.parent is not None:
        instance = nodes[instance.parent]
        yield instance
