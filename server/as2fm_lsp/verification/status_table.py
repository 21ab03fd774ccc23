# SPDX-License-Identifier: Apache-2.0
"""A table of the statuses that the nodes of a tree return in a trace."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

from roaml.lower.programs.executed import ExecutedNode
from roaml.scxml.names import STATUS_NAMES, TreeEventKind, read_tree_event, sent_by
from roaml.smc.story import Story
from roaml.text import Location

COLUMNS = ("SUCCESS", "FAILURE", "RUNNING", "SKIPPED")
MAX_LISTED_NODES = 40
"""The maximum number of nodes in a table."""


def status_table(
    story: Story, nodes: Sequence[ExecutedNode], place_of: Callable[[Location], str], *, is_whole: bool = False
) -> list[str]:
    """The lines of the table. Nodes that are never ticked are in one line, because they cannot be responsible.

    Args:
        nodes: the nodes of the tree, in its order.
        is_whole: whether the table may have more than `MAX_LISTED_NODES` nodes.
    """
    returned = _returned(story)
    rows: list[tuple[str, ...]] = [("node", "ticks", *COLUMNS)]
    idle = []
    for node in nodes:
        counts = returned.get(node.number, Counter())
        if not counts:
            idle.append(f"{node.name} ({place_of(node.origin)})")
            continue
        numbers = (str(sum(counts.values())), *(str(counts[name]) for name in COLUMNS))
        rows.append((f"{node.name} ({place_of(node.origin)})", *numbers))
    left_out = 0 if is_whole else max(0, len(rows) - 1 - MAX_LISTED_NODES)
    lines = list(_aligned(rows[: len(rows) - left_out]))
    if left_out:
        lines.append(f"  … {left_out} more nodes (--verbose) …")
    if idle:
        lines.append(f"  never ticked: {', '.join(dict.fromkeys(idle))}")
    return lines


def _aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        numbers = "  ".join(text.rjust(width) for text, width in zip(row[1:], widths[1:], strict=True))
        yield f"  {row[0].ljust(widths[0])}  {numbers}"


def _returned(story: Story) -> dict[int, Counter[str]]:
    """Number of a node -> status -> how often the node has returned it."""
    status: dict[int, int] = {}
    counts: dict[int, Counter[str]] = {}
    for step in story.steps:
        for change in step.changes:
            event, _, parameter = change.variable.name.partition("__")
            answer = read_tree_event(event)
            if answer is not None and answer.kind is TreeEventKind.RESPONSE and parameter == "status":
                status[answer.number] = int(str(change.after))
        sent = read_tree_event(sent_by(step.action or ""))
        if sent is not None and sent.kind is TreeEventKind.RESPONSE and sent.number in status:
            name = STATUS_NAMES[status[sent.number]]
            counts.setdefault(sent.number, Counter())[name] += 1
    return counts
