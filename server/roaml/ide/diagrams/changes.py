# SPDX-License-Identifier: Apache-2.0
"""The diagram of two versions of a model together: each part states whether it was added, removed or changed
(docs/comparison.md#pictures).

A state, an interface or a machine is the same in both versions if its name is the same; nodes of trees are matched by
`tree_matching`. A transition is the same if its ends, its trigger, its condition and its actions are; otherwise, the
old one is removed and the new one is added.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher

from roaml.ide.diagrams.diagram import (
    Change,
    Detail,
    DetailKind,
    DiagramEdge,
    DiagramKind,
    DiagramNode,
    DiagramNodeKind,
    EdgeKind,
    Picture,
)
from roaml.ide.diagrams.tree_matching import TreeSide, matched_nodes, moved_nodes
from roaml.record import Record, replace

_WORDS: Mapping[DiagramNodeKind, str] = {
    DiagramNodeKind.STATE: "state",
    DiagramNodeKind.THREAD: "action thread",
    DiagramNodeKind.GROUP: "group",
    DiagramNodeKind.SUBTREE: "subtree",
    DiagramNodeKind.VARIABLE: "blackboard entry",
    DiagramNodeKind.NAMESPACE: "namespace",
    DiagramNodeKind.ROS_NODE: "node",
    DiagramNodeKind.PLUGIN: "plugin",
    DiagramNodeKind.TOPIC: "topic",
    DiagramNodeKind.SERVICE: "service",
    DiagramNodeKind.ACTION_INTERFACE: "action",
}
_MAX_TEXT = 120
"""The maximum number of characters of the text for a transition."""


class PartChange(Record, frozen=True):
    """A part that was added, removed or changed. `text` names it, with what changed about it."""

    change: Change
    text: str


def compared(kind: DiagramKind, old: Picture | None, new: Picture | None) -> Picture:
    """The diagram with the parts of both versions, in the order of the new one. `None` is a version without the
    diagram."""
    shown = new or old
    assert shown is not None
    empty = replace(shown, nodes=(), edges=())
    before, after = old or empty, new or empty
    moved: dict[str, str] = {}
    if kind is DiagramKind.TREE:
        sides = TreeSide(before), TreeSide(after)
        pairs = matched_nodes(*sides)
        moved = {b: sides[0].nodes[a].label if a else "" for b, a in moved_nodes(*sides, pairs).items()}
        before = _renamed(before, {name: pairs.get(name, f"old {name}") for name in sides[0].nodes})
    else:
        before, after = (_renamed(picture, _stable_ids(kind, picture)) for picture in (before, after))
    nodes = _merged_nodes(before.nodes, after.nodes, moved)
    kept = {node.id for node in after.nodes}
    return Picture(shown.title, nodes, _merged_edges(before.edges, after.edges, kept))


def changes_of(picture: Picture) -> tuple[PartChange, ...]:
    """What happened to the parts of a diagram that `compared` has returned."""
    nodes = {node.id: node for node in picture.nodes}
    origin = {edge.target: edge.source for edge in picture.edges if nodes[edge.target].kind is DiagramNodeKind.CHOICE}
    changes = [
        PartChange(node.change, _node_text(node))
        for node in picture.nodes
        if node.change is not None and node.change is not Change.SAME and node.kind is not DiagramNodeKind.CHOICE
    ]
    for edge in picture.edges:
        if edge.change in (None, Change.SAME) or edge.kind in (EdgeKind.CHILD, EdgeKind.READS, EdgeKind.WRITES):
            continue
        assert edge.change is not None
        source, is_choice = nodes[origin.get(edge.source, edge.source)], edge.source in origin
        if nodes[edge.target].kind is DiagramNodeKind.CHOICE:
            text = f"random choice of `{source.label}`: {' '.join(edge.labels) or 'without event'}"
        else:
            text = _edge_text(edge, source, nodes[edge.target], is_choice=is_choice)
        changes.append(PartChange(edge.change, text))
    return tuple(changes)


def _node_text(node: DiagramNode) -> str:
    details = [f"{'+' if d.change is Change.ADDED else '−'} {d.text}" for d in node.details if _is_marked(d)]
    text = f"{_WORDS.get(node.kind, 'node')} `{node.label}`"
    return f"{text}: {'; '.join(details)}" if details and node.change is Change.CHANGED else text


def _is_marked(detail: Detail) -> bool:
    return detail.change not in (None, Change.SAME)


def _edge_text(edge: DiagramEdge, source: DiagramNode, target: DiagramNode, *, is_choice: bool) -> str:
    if edge.kind in (EdgeKind.PUBLISHES, EdgeKind.SUBSCRIBES, EdgeKind.SERVES, EdgeKind.CALLS, EdgeKind.SENDS):
        names = f": {', '.join(edge.labels)}" if edge.labels else ""
        return f"`{source.label}` → `{target.label}` ({edge.kind.value}{names})"
    parts = [" ".join(edge.labels), *(f"/ {action}" for action in edge.actions)]
    what = " ".join(part for part in parts if part) or "without event"
    if len(what) > _MAX_TEXT:
        what = f"{what[: _MAX_TEXT - 1]}…"
    chance = " by chance" if is_choice else ""
    return f"transition `{source.label}` → `{target.label}`{chance}: {what}"


def _stable_ids(kind: DiagramKind, picture: Picture) -> dict[str, str]:
    """The id of each node -> an id that does not depend on the positions and files of other parts."""
    names: dict[str, str] = {}
    if kind is DiagramKind.ROS:
        names = {node.id: f"{node.kind.value} {node.label}" for node in picture.nodes}
    else:
        entering = {edge.target: edge for edge in picture.edges}
        for node in picture.nodes:
            if node.kind is DiagramNodeKind.CHOICE and node.id in entering:
                edge = entering[node.id]
                names[node.id] = f"choice {edge.source} {' '.join(edge.labels)}"
            else:
                names[node.id] = node.id
    seen: Counter[str] = Counter()
    for name, stable in names.items():
        seen[stable] += 1
        names[name] = stable if seen[stable] == 1 else f"{stable} #{seen[stable]}"
    return names


def _renamed(picture: Picture, names: Mapping[str, str]) -> Picture:
    return replace(
        picture,
        nodes=tuple(
            replace(node, id=names.get(node.id, node.id), parent=names.get(node.parent, node.parent))
            for node in picture.nodes
        ),
        edges=tuple(
            replace(edge, source=names.get(edge.source, edge.source), target=names.get(edge.target, edge.target))
            for edge in picture.edges
        ),
    )


def _merged_nodes(
    old: Sequence[DiagramNode], new: Sequence[DiagramNode], moved: Mapping[str, str]
) -> tuple[DiagramNode, ...]:
    before = {node.id: node for node in old}
    merged = [_compared_node(before.get(node.id), node, moved.get(node.id)) for node in new]
    known = {node.id for node in new}
    for previous, node in zip([None, *old], old, strict=False):
        if node.id not in known:
            place = 0 if previous is None else 1 + next(i for i, n in enumerate(merged) if n.id == previous.id)
            merged.insert(place, replace(node, change=Change.REMOVED, initial=False))
    return tuple(merged)


def _compared_node(old: DiagramNode | None, new: DiagramNode, moved_from: str | None) -> DiagramNode:
    if old is None:
        return replace(new, change=Change.ADDED)
    details = list(_compared_details(old.details, new.details))
    if old.label != new.label:
        details.insert(0, Detail(DetailKind.COUNT, f"name {old.label}", change=Change.REMOVED))
    if old.initial != new.initial and new.kind is DiagramNodeKind.STATE:
        details.insert(0, Detail(DetailKind.COUNT, "initial state", change=_added_if(new.initial)))
    if moved_from is not None:
        where = f"moved from {moved_from}" if moved_from else "moved"
        details.append(Detail(DetailKind.COUNT, where, change=Change.ADDED))
    is_same = old.kind is new.kind and all(detail.change is Change.SAME for detail in details)
    return replace(new, details=tuple(details), change=Change.SAME if is_same else Change.CHANGED)


def _added_if(is_new: bool) -> Change:
    return Change.ADDED if is_new else Change.REMOVED


def _compared_details(old: Sequence[Detail], new: Sequence[Detail]) -> Iterator[Detail]:
    matcher = SequenceMatcher(None, [d.text for d in old], [d.text for d in new], autojunk=False)
    for tag, i, k, j, m in matcher.get_opcodes():
        if tag == "equal":
            yield from (replace(detail, change=Change.SAME) for detail in new[j:m])
        else:
            yield from (replace(detail, change=Change.REMOVED) for detail in old[i:k])
            yield from (replace(detail, change=Change.ADDED) for detail in new[j:m])


def _merged_edges(old: Sequence[DiagramEdge], new: Sequence[DiagramEdge], kept: set[str]) -> tuple[DiagramEdge, ...]:
    """The edges of both versions. A link from a node of a tree to a child that is now below another node is left out,
    so that the merged tree is a tree."""
    counts = Counter(map(_edge_key, old))
    merged: list[DiagramEdge] = []
    for edge in new:
        is_old = counts[_edge_key(edge)] > 0
        counts[_edge_key(edge)] -= is_old
        merged.append(replace(edge, change=Change.SAME if is_old else Change.ADDED))
    left = Counter(map(_edge_key, new))
    previous: dict[str, DiagramEdge] = {}
    for edge in old:
        if left[_edge_key(edge)] > 0:
            left[_edge_key(edge)] -= 1
            previous[edge.source] = edge
            continue
        if edge.kind is EdgeKind.CHILD and edge.target in kept:
            continue
        removed = replace(edge, change=Change.REMOVED)
        merged.insert(_place(merged, edge, previous.get(edge.source)), removed)
        previous[edge.source] = edge
    return tuple(merged)


def _place(merged: Sequence[DiagramEdge], edge: DiagramEdge, previous: DiagramEdge | None) -> int:
    """The index at which a removed edge is inserted: behind the edge before it that leaves the same node."""
    if previous is not None:
        return 1 + max(i for i, known in enumerate(merged) if _edge_key(known) == _edge_key(previous))
    return next((i for i, known in enumerate(merged) if known.source == edge.source), len(merged))


def _edge_key(edge: DiagramEdge) -> tuple[object, ...]:
    return (
        edge.source,
        edge.target,
        edge.kind,
        edge.labels,
        edge.actions,
        edge.probabilistic,
        edge.internal,
    )
