# SPDX-License-Identifier: Apache-2.0
"""Which nodes of two versions of a behavior tree are the same (docs/comparison.md#trees).

The numbers of nodes change with every insertion, so nodes are matched by their content, in the manner of GumTree
(Falleri et al. 2014): first from the root downwards, child by child in their order; then equal subtrees anywhere, the
largest first, which are moved or wrapped parts; then single nodes of which each version has one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from roaml.ide.diagrams.diagram import DiagramNode, DiagramNodeKind, EdgeKind, Picture


class TreeSide:
    """A version of a tree.

    Attributes:
        nodes: id -> node; entries of the blackboard are left out.
        children: id -> the ids of the children, in their order.
        parents: id -> the id of the parent.
    """

    def __init__(self, picture: Picture) -> None:
        self.nodes = {node.id: node for node in picture.nodes if node.kind is not DiagramNodeKind.VARIABLE}
        self.children: dict[str, list[str]] = {}
        self.parents: dict[str, str] = {}
        for edge in picture.edges:
            if edge.kind is EdgeKind.CHILD:
                self.children.setdefault(edge.source, []).append(edge.target)
                self.parents[edge.target] = edge.source
        self.order = [name for root in self.nodes if root not in self.parents for name in self._below(root)]
        self._texts: dict[str, tuple[object, ...]] = {}
        for name in reversed(self.order):
            node = self.nodes[name]
            own = (key_of(node), *((detail.key, detail.text) for detail in node.details))
            self._texts[name] = (hash((own, *(self._texts[c] for c in self.children.get(name, ())))), *own)
        self.sizes: dict[str, int] = {}
        for name in reversed(self.order):
            self.sizes[name] = 1 + sum(self.sizes[child] for child in self.children.get(name, ()))

    def _below(self, root: str) -> Iterator[str]:
        pending = [root]
        while pending:
            name = pending.pop()
            yield name
            pending += reversed(self.children.get(name, ()))

    def subtree(self, name: str) -> tuple[object, ...]:
        """A value that is equal for equal subtrees."""
        return self._texts[name]


def key_of(node: DiagramNode) -> tuple[str, ...]:
    """What identifies a node beside its position: its kind, its plugin or tree, and its name."""
    title = node.title
    return (node.kind.value, node.label) if title is None else (node.kind.value, title.plugin, title.name)


def matched_nodes(old: TreeSide, new: TreeSide) -> dict[str, str]:
    """The id of a node in the old tree -> that of the same node in the new one."""
    pairs: dict[str, str] = {}
    roots = [[name for name in side.order if name not in side.parents] for side in (old, new)]
    _align(old, new, roots[0], roots[1], pairs)
    _match_elsewhere(old, new, pairs, old.subtree, new.subtree)
    _match_elsewhere(old, new, pairs, lambda n: key_of(old.nodes[n]), lambda n: key_of(new.nodes[n]), only_single=True)
    return pairs


def _align(old: TreeSide, new: TreeSide, before: Sequence[str], after: Sequence[str], pairs: dict[str, str]) -> None:
    """Match two lists of siblings, and the nodes below them: equal subtrees first, between these nodes with the same
    name, and between these nodes of the same type."""
    pending = [(list(before), list(after))]
    while pending:
        left, right = pending.pop()
        for a, b in _siblings(old, new, left, right):
            pairs[a] = b
            pending.append(([c for c in old.children.get(a, ()) if c not in pairs], [*new.children.get(b, ())]))


def _siblings(old: TreeSide, new: TreeSide, left: list[str], right: list[str]) -> Iterator[tuple[str, str]]:
    levels: tuple[tuple[Callable[[str], object], Callable[[str], object]], ...] = (
        (old.subtree, new.subtree),
        (lambda n: key_of(old.nodes[n]), lambda n: key_of(new.nodes[n])),
        (lambda n: key_of(old.nodes[n])[:2], lambda n: key_of(new.nodes[n])[:2]),
    )
    gaps = [(left, right)]
    for of_old, of_new in levels:
        rest: list[tuple[list[str], list[str]]] = []
        for a, b in gaps:
            i = j = 0
            for k, m in (*_common([*map(of_old, a)], [*map(of_new, b)]), (len(a), len(b))):
                if i < k and j < m:
                    rest.append((a[i:k], b[j:m]))
                if k < len(a):
                    yield a[k], b[m]
                i, j = k + 1, m + 1
        gaps = rest


def _common(a: Sequence[object], b: Sequence[object]) -> list[tuple[int, int]]:
    """The pairs of indices of a longest common subsequence."""
    lengths = [[0] * (len(b) + 1) for _ in range(len(a) + 1)]
    for i in reversed(range(len(a))):
        for j in reversed(range(len(b))):
            equal = lengths[i + 1][j + 1] + 1 if a[i] == b[j] else 0
            lengths[i][j] = max(equal, lengths[i + 1][j], lengths[i][j + 1])
    pairs, i, j = [], 0, 0
    while i < len(a) and j < len(b):
        if a[i] == b[j]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif lengths[i + 1][j] >= lengths[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs


def _match_elsewhere(
    old: TreeSide,
    new: TreeSide,
    pairs: dict[str, str],
    of_old: Callable[[str], object],
    of_new: Callable[[str], object],
    *,
    only_single: bool = False,
) -> None:
    """Match nodes that are not matched yet, wherever they are, the largest subtrees first."""
    taken = set(pairs.values())
    waiting: dict[object, list[str]] = {}
    for name in old.order:
        if name not in pairs:
            waiting.setdefault(of_old(name), []).append(name)
    free = [name for name in new.order if name not in taken]
    counts: dict[object, int] = {}
    for name in free:
        counts[of_new(name)] = counts.get(of_new(name), 0) + 1
    for name in sorted(free, key=lambda n: -new.sizes[n]):
        key = of_new(name)
        candidates = [a for a in waiting.get(key, ()) if a not in pairs]
        if name in taken or not candidates or (only_single and (len(candidates) > 1 or counts[key] > 1)):
            continue
        _align_free(old, new, candidates[0], name, pairs, taken)


def _align_free(old: TreeSide, new: TreeSide, a: str, b: str, pairs: dict[str, str], taken: set[str]) -> None:
    """Match two nodes, and the nodes below them that are not matched yet."""
    pending = [([a], [b])]
    while pending:
        left, right = pending.pop()
        for x, y in [(a, b)] if left == [a] else list(_siblings(old, new, left, right)):
            pairs[x] = y
            taken.add(y)
            below = [c for c in old.children.get(x, ()) if c not in pairs]
            above = [c for c in new.children.get(y, ()) if c not in taken]
            if below and above:
                pending.append((below, above))


def moved_nodes(old: TreeSide, new: TreeSide, pairs: dict[str, str]) -> dict[str, str]:
    """The ids, in the new tree, of nodes that were moved -> the id of their parent in the old tree. A node is not moved
    if nodes were only inserted above it, or removed there."""
    back = {b: a for a, b in pairs.items()}
    moved: dict[str, str] = {}
    places: dict[str, list[tuple[int, str]]] = {}
    for a, b in pairs.items():
        above, below = old.parents.get(a), new.parents.get(b)
        while above is not None and above not in pairs:
            above = old.parents.get(above)
        while below is not None and below not in back:
            below = new.parents.get(below)
        if (None if above is None else pairs[above]) != below:
            moved[b] = old.parents.get(a, "")
        elif below is not None:
            places.setdefault(below, []).append((old.order.index(a), b))
    rank = {name: number for number, name in enumerate(new.order)}
    for children in places.values():
        in_old = [b for _, b in sorted(children)]
        in_new = sorted(in_old, key=lambda b: rank[b])
        kept = {in_new[i] for _, i in _common(in_old, in_new)}
        moved |= {b: old.parents.get(back[b], "") for b in in_new if b not in kept}
    return moved
