# SPDX-License-Identifier: Apache-2.0
"""The rule `short-time`, which short_time.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Severity
from roaml.model.node_effects import tree_effects
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.instances import instances
from roaml.rules.support.property_problems import problems
from roaml.rules.support.settings import place_of
from roaml.rules.support.timing import duration, durations, port_durations, tick_period


def _tree(context: TreeContext) -> Iterator[Finding]:
    tick = tick_period(context)
    if tick is None:
        return
    times = {(node, port): ns for node, port, ns in durations(context)}
    for (node, port), ns in times.items():
        if ns < tick:
            message = (
                f"{duration(ns)} is shorter than the time between two ticks of the tree, {duration(tick)} "
                "(`bt_tick_rate`), and has the same effect as one tick"
            )
            yield RULE.at(place_of(node, port), message)
    yield from _timeouts(context, {node: (port, ns) for (node, port), ns in times.items() if ns >= tick})


def _timeouts(context: TreeContext, times: Mapping[TreeNode, tuple[str, int]]) -> Iterator[Finding]:
    """Report times that end a child before it can succeed: those for which the node itself does not wait."""
    timed = [(node, automaton) for node, automaton in instances(context) if node in times and automaton.instance]
    if context.system is None or not timed:
        return
    effects = tree_effects(context.system)
    waits = {
        automaton.instance.number: times[node][1]
        for node, automaton in timed
        if automaton.instance and effects.waits(automaton)
    }
    for _, automaton, _, _, ns in port_durations(context):
        if automaton.instance is not None:
            waits[automaton.instance.number] = ns
    reported: set[TreeNode] = set()
    for node, automaton in timed:
        port, ns = times[node]
        assert automaton.instance is not None
        if automaton.instance.number in waits or node in reported:
            continue
        least = effects.time_to_success(context.system, automaton, waits)
        if least >= ns:
            reported.add(node)
            message = (
                f"this timeout of {duration(ns)} ends its child before the child can succeed, which takes "
                f"{duration(least)} at least"
            )
            yield RULE.at(place_of(node, port), message)


def _properties(file: LinkedFile) -> Iterator[Finding]:
    return problems(RULE, ProblemKind.SHORT, file)


RULE = Rule(
    "short-time",
    Severity.WARNING,
    "A time is shorter than a step of the clock, a tick, or what it waits for.",
    tree=_tree,
    xml_properties=_properties,
)
