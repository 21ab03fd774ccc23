# SPDX-License-Identifier: Apache-2.0
"""The links that are reversed so that the graph has no cycles."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

MIN_FAN = 16
"""The minimum number of nodes around another one that are on both sides of it."""


def closing_links(count: int, links: Sequence[tuple[int, int]]) -> frozenset[int]:
    """The indexes of the back edges of a depth-first search from the first node: the links that lead to a node on the
    current path.

    Links are followed in their order, so that a model is drawn in the order in which it is written.

    Args:
        count: the number of nodes.
        links: source and target of each link.
    """
    outgoing: list[list[int]] = [[] for _ in range(count)]
    for index, (source, _) in enumerate(links):
        outgoing[source].append(index)
    closing: set[int] = set()
    finished: set[int] = set()
    for start in range(count):
        if start in finished:
            continue
        active = {start}
        path = [(start, iter(outgoing[start]))]
        while path:
            node, rest = path[-1]
            following = next(rest, None)
            if following is None:
                path.pop()
                active.discard(node)
                finished.add(node)
                continue
            target = links[following][1]
            if target in active:
                closing.add(following)
            elif target not in finished:
                active.add(target)
                path.append((target, iter(outgoing[target])))
    return frozenset(closing)


def fanned_links(count: int, links: Sequence[tuple[int, int]]) -> frozenset[int]:
    """The indexes of the links that are reversed so that a node with many others around it has half of them on each
    side: if most nodes of the graph have their only link from it, the links to the second half of these.

    Args:
        count: the number of nodes.
        links: source and target of each link.
    """
    uses = Counter(end for link in links for end in link)
    fans: dict[int, list[int]] = {}
    for index, (source, target) in enumerate(links):
        if uses[target] == 1:
            fans.setdefault(source, []).append(index)
    largest = max(fans.values(), key=len, default=[])
    if len(largest) < max(MIN_FAN, count / 2):
        return frozenset()
    return frozenset(largest[(len(largest) + 1) // 2 :])
