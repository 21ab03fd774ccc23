# SPDX-License-Identifier: Apache-2.0
"""The rule `short-time`, which short_time.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.property_problems import problems
from roaml.rules.support.settings import place_of
from roaml.rules.support.timing import duration, durations, tick_period


def _tree(context: TreeContext) -> Iterator[Finding]:
    tick = tick_period(context)
    if tick is None:
        return
    times = {node: ns for node, _, ns in durations(context)}
    for node, port, ns in durations(context):
        text = place_of(node, port)
        if ns < tick:
            message = (
                f"{duration(ns)} is shorter than the time between two ticks of the tree, {duration(tick)} "
                "(`bt_tick_rate`), and has the same effect as one tick"
            )
            yield RULE.at(text, message)
        elif node.plugin is not None and node.plugin.value == "Timeout" and node.children:
            least = _least(node.children[0], times)
            if least >= ns:
                message = (
                    f"this timeout of {duration(ns)} ends its child before the child can succeed: its delays take "
                    f"{duration(least)}"
                )
                yield RULE.at(text, message)


_ONE_OF = ("Fallback", "ReactiveFallback", "AsyncFallback", "FallbackWithMemory", "Switch2", "IfThenElse", "Parallel")


def _least(node: TreeNode, times: dict[TreeNode, int]) -> int:
    """The least time in ns that passes until a node returns SUCCESS, by the delays in it."""
    name = node.plugin.value if node.plugin is not None else ""
    inside = [_least(child, times) for child in node.children]
    if name == "Delay":
        return times.get(node, 0) + sum(inside)
    if name == "Sleep":
        return times.get(node, 0)
    if name in ("Sequence", "SequenceWithMemory", "AsyncSequence", "SequenceStar"):
        return sum(inside)
    if name in ("ReactiveSequence", "ParallelAll"):
        return max(inside, default=0)
    if name in ("Timeout", "Repeat", "RetryUntilSuccessful", "RetryUntilSuccesful", "RunOnce"):
        return inside[0] if inside else 0
    return min(inside, default=0) if name in _ONE_OF else 0


def _properties(file: LinkedFile) -> Iterator[Finding]:
    return problems(RULE, ProblemKind.SHORT, file)


RULE = Rule(
    "short-time",
    Severity.WARNING,
    "A time is shorter than a step of the clock, a tick, or what it waits for.",
    tree=_tree,
    xml_properties=_properties,
)
