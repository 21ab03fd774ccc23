# SPDX-License-Identifier: Apache-2.0
"""The rule `short-time`, which short_time.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from roaml.diagnostics import Finding, Severity
from roaml.durations import NANOSECONDS
from roaml.exact_number import exact_number
from roaml.model.node_effects import tree_effects
from roaml.model.property_links import MAX_COARSENESS, LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.instances import instances
from roaml.rules.support.property_problems import problems
from roaml.rules.support.settings import place_of
from roaml.rules.support.timing import duration, durations, port_durations, running_first, tick_period


def _tree(context: TreeContext) -> Iterator[Finding]:
    yield from _mocked(context)
    tick = tick_period(context)
    if tick is None:
        return
    times = {(node, port): ns for node, port, ns in durations(context)}
    for (node, port), ns in times.items():
        if ns < (tick if _type_name(node) == "Timeout" else tick / MAX_COARSENESS):
            message = (
                f"{duration(ns)} is shorter than the time between two ticks of the tree, {duration(tick)} "
                "(`bt_tick_rate`), and has the same effect as one tick"
            )
            yield RULE.at(place_of(node, port), message)
    yield from _timeouts(context, {node: (port, ns) for (node, port), ns in times.items() if ns >= tick})


def _mocked(context: TreeContext) -> Iterator[Finding]:
    """Report timeouts and rates of a tree that are too short for its mocks, or for the durations in its ports."""
    forest = context.forest
    for _, node in forest.own_nodes if forest is not None else ():
        known = forest.known_node(node) if forest is not None else None
        port = _TIMES.get(known.name) if known is not None and known.behaviour else None
        setting = next((s for s in node.ports if s.attribute.name == port), None)
        number = exact_number(setting.value.value) if setting is not None else None
        if port is None or setting is None or number is None or number <= 0 or len(node.children) != 1:
            continue
        least = _least(context, node.children[0])
        reason = " with the mocks of this tree" if context.mocked else ""
        if port == "msec" and number * NANOSECONDS["ms"] <= least:
            message = (
                f"this timeout of {duration(number * NANOSECONDS['ms'])} ends its child before the child can succeed, "
                f"which takes {duration(least)} at least{reason}"
            )
            yield RULE.at(setting.value.span, message)
        if port == "hz" and least * number > NANOSECONDS["s"]:
            message = (
                f"the child takes {duration(least)} at least{reason}, so it is ticked anew at most "
                f"{float(NANOSECONDS['s'] / least):.3g} times in a second, not {float(number):g} times"
            )
            yield RULE.at(setting.value.span, message)


_TIMES = {"Timeout": "msec", "RateController": "hz"}
"""The nodes whose time must be enough for their child, with the port of this time."""
_IN_TURN = frozenset(("Sequence", "AsyncSequence", "SequenceWithMemory", "ReactiveSequence"))
_PASSING = frozenset(("Timeout", "RetryUntilSuccessful", "Repeat", "RateController"))


def _type_name(node: TreeNode) -> str:
    return node.plugin.value if node.plugin is not None else ""


def _least(context: TreeContext, node: TreeNode) -> Fraction:
    """The least time that a node takes until it succeeds, in ns."""
    name = _type_name(node)
    inside = [_least(context, child) for child in node.children if not child.scripts]
    if not node.children:
        return context.mocked.get(node, _own_time(context, node))
    if name == "Delay":
        return _number(node, "delay_msec") * NANOSECONDS["ms"] + sum(inside, Fraction(0))
    if name in _IN_TURN:
        return sum(inside, Fraction(0))
    if name == "Fallback":
        return min(inside) if len(inside) == len(node.children) else Fraction(0)
    return inside[0] if name in _PASSING and len(inside) == 1 else Fraction(0)


def _own_time(context: TreeContext, node: TreeNode) -> Fraction:
    """The least time, in ns, that a leaf of a library takes to succeed according to the constants of its ports."""
    known = context.forest.known_node(node) if context.forest is not None else None
    match known.name if known is not None and known.behaviour else "":
        case "Sleep":
            return _number(node, "msec") * NANOSECONDS["ms"]
        case "Wait":
            return _number(node, "wait_duration") * NANOSECONDS["s"]
        case "DriveOnHeading":
            distance, speed = _number(node, "dist_to_travel"), _number(node, "speed")
        case "BackUp":
            distance, speed = _number(node, "backup_dist"), _number(node, "backup_speed")
        case _:
            return Fraction(0)
    return distance / speed * NANOSECONDS["s"] if distance and speed else Fraction(0)


def _number(node: TreeNode, port: str) -> Fraction:
    """The absolute value of a constant; 0 if the port has none."""
    text = next((setting.value.value for setting in node.ports if setting.attribute.name == port), "")
    return abs(exact_number(text) or Fraction(0))


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
    with_ticks = running_first(context.system) | waits
    reported: set[TreeNode] = set()
    for node, automaton in timed:
        port, ns = times[node]
        assert automaton.instance is not None
        if automaton.instance.number in waits or node in reported:
            continue
        least = effects.time_to_success(context.system, automaton, waits)
        if least < ns:
            least = effects.time_to_success(context.system, automaton, with_ticks)
            least = least if least > ns else 0  # at the same time, either may be first
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
