# SPDX-License-Identifier: Apache-2.0
"""The rule `port-range`, which port_range.md describes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from fractions import Fraction

from roaml.diagnostics import Finding, Severity
from roaml.forest.cpp_types import mismatch
from roaml.forest.forest import CPP
from roaml.libraries import Node, Port, PortLimits, node_in_libraries
from roaml.model.port_checks import PortChoice
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext, listing
from roaml.rules.support.forest import forest_of
from roaml.rules.support.instances import instances
from roaml.rules.support.message_constants import port_constant
from roaml.rules.support.settings import constant_settings, integer_of, place_of


def check(context: TreeContext) -> Iterator[Finding]:
    """Report numbers outside of the limits of ports in the libraries (docs/spec/lone-trees.md#limits)."""
    settings: dict[TreeNode, dict[str, str]] = {}
    for node, port, text in constant_settings(context):
        settings.setdefault(node, {})[port] = text
    for node, texts in settings.items():
        known = _library_node(context, node)
        if known is not None and any(port.limits for port in known.ports):
            yield from _check(context, node, known, texts)
    yield from _of_plugins(context)


def _of_plugins(context: TreeContext) -> Iterator[Finding]:
    """Report constants that a plugin refuses, and the only one that it does not distinguish, if it also distinguishes a
    number that no node has."""
    used: dict[tuple[PortChoice, str], dict[Fraction, TreeNode]] = {}
    reported: set[tuple[TreeNode, str]] = set()
    for node, automaton in instances(context):
        plugin, name = automaton.outline.plugin, automaton.outline.name
        for refusal in plugin.port_refusals:
            number = port_constant(automaton, refusal.port)
            if number is not None and refusal.holds(number) and (node, refusal.port) not in reported:
                reported.add((node, refusal.port))
                message = (
                    f"`{name}` does not accept this value of `{refusal.port}`: it enters the state `{refusal.state}`, "
                    "in which it handles no ticks"
                )
                yield RULE.at(place_of(node, refusal.port), message)
        for choice in plugin.port_choices:
            number = port_constant(automaton, choice.port)
            if number is not None:
                used.setdefault((choice, name), {}).setdefault(number, node)
    for (choice, name), nodes in used.items():
        others, unused = nodes.keys() - choice.numbers, choice.numbers - nodes.keys()
        if len(others) == 1 and unused:
            (number,) = others
            known = listing([f"{n}" for n in sorted(choice.numbers)])
            message = f"`{name}` compares `{choice.port}` only with {known}, and no node has the value {min(unused)}"
            yield RULE.at(place_of(nodes[number], choice.port), message)


def _library_node(context: TreeContext, node: TreeNode) -> Node | None:
    """The declaration of the node in a library; `None` if no library declares it."""
    name = node.plugin.value if node.plugin is not None and not node.is_subtree else ""
    if context.system is not None:
        is_plugin = context.system.plugin(name)[0] != ""
        return None if is_plugin else CPP.nodes.get(name) or node_in_libraries(name)
    forest = forest_of(context)
    declaration = forest.known_node(node) if forest is not None else None
    if declaration is None or not declaration.behaviour:
        return None
    return declaration if declaration.library else node_in_libraries(name)


def _check(context: TreeContext, node: TreeNode, known: Node, texts: Mapping[str, str]) -> Iterator[Finding]:
    is_as2fm = context.system is not None and context.system.is_as2fm
    for port in known.ports:
        number = _number(port, texts[port.name]) if port.name in texts else None
        if port.limits is None or number is None:
            continue
        if number < -1 and is_as2fm and port.limits.special:
            continue  # the node never returns a status, which `node-configuration` reports
        reason = _reason(port.limits, number, len(node.children))
        effect = f"; {port.limits.effect}" if port.limits.effect and not _upper(port.limits) else ""
        # The translation computes the period of a rate, so it refuses rates that are not positive.
        severity = Severity.ERROR if reason and port.limits.is_exclusive else None
        if not reason and port.limits.magnitude is not None and abs(number) > port.limits.magnitude:
            lowest = -port.limits.magnitude if port.limits.minimum is None else port.limits.minimum
            reason = f"from {lowest:g} to {port.limits.magnitude:g}"
        if not reason:
            reason, effect = _order(known, port.limits, number, texts), f"; {port.limits.effect}"
        if reason:
            message = f"`{port.name}` of `{known.name}` must be {reason}, not {texts[port.name].strip()}{effect}"
            yield RULE.at(place_of(node, port.name), message, severity=severity)
    yield from _too_slow(node, known, texts)


def _too_slow(node: TreeNode, known: Node, texts: Mapping[str, str]) -> Iterator[Finding]:
    """Report a time that is shorter than the node needs for its distance with its speed."""
    for port in known.ports:
        limits = port.limits
        if limits is None or not limits.distance:
            continue
        names = (port.name, limits.distance, limits.speed)
        time, distance, speed = (_constant_of(known, name, texts) for name in names)
        if known.name in _SIGNED and distance is not None and speed is not None and distance * speed < 0:
            written = limits.speed if limits.speed in texts else limits.distance
            message = f"`{limits.distance}` and `{limits.speed}` of `{known.name}` must have the same sign"
            yield RULE.at(place_of(node, written), f"{message}; the behavior would fail at once")
            continue
        if time is None or distance is None or speed is None or time <= 0:  # 0 is no limit
            continue
        if abs(distance) <= time * abs(speed) * (1 + 1e-9):
            continue
        needs = "no time is enough" if speed == 0 else f"this needs {abs(distance / speed):.4g} s"
        place = limits.speed if speed == 0 else next((name for name in names if name in texts), None)
        if place is not None and place in texts:
            message = f"`{known.name}` has {time:g} s for {abs(distance):g} m with {abs(speed):g} m/s, but {needs}"
            yield RULE.at(place_of(node, place), f"{message}; {limits.effect}")


_SIGNED = frozenset(("DriveOnHeading",))
"""The nodes that drive backwards if the distance and the speed are negative. Others ignore the signs."""


def _constant_of(known: Node, name: str, texts: Mapping[str, str]) -> float | None:
    """The number of a port that is set to a constant or has a default."""
    port = known.port(name)
    text = texts.get(name, port.default) if port is not None else None
    return None if port is None or text is None else _number(port, text)


def _reason(limits: PortLimits, number: float, children: int) -> str:
    """A phrase for the numbers that are useful, such as "at least 1", if `number` is not one of them; otherwise ""."""
    if limits.counts_children:
        # `node-configuration` reports numbers that are too large.
        is_useful = number >= 1 or -max(children, 1) <= number <= -1
        lowest = f"from -{children} to " if children > 1 else ""
        return "" if is_useful else f"at least 1, or {lowest}-1 (all children)"
    if limits.minimum is None or number in limits.special:
        return ""
    if number < limits.minimum or (limits.is_exclusive and number == limits.minimum):
        special = "".join(f", or {other:g} for no limit" for other in sorted(limits.special))
        return f"{'greater than' if limits.is_exclusive else 'at least'} {limits.minimum:g}{special}"
    return ""


def _upper(limits: PortLimits) -> str:
    """The name of the port whose number is the upper bound; "" if there is none."""
    return limits.at_most or limits.less_than


def _order(known: Node, limits: PortLimits, number: float, texts: Mapping[str, str]) -> str:
    """A phrase for the useful numbers if `number` is too large for the number of the port that limits it, otherwise
    ""."""
    other = known.port(_upper(limits))
    text = texts.get(other.name, other.default) if other is not None else None
    bound = _number(other, text) if other is not None and text is not None else None
    if other is None or bound is None or number < bound or (limits.at_most and number == bound):
        return ""
    return f"{'at most' if limits.at_most else 'less than'} `{other.name}`, which is {bound:g}"


def _number(port: Port, text: str) -> float | None:
    """The number in a text; `None` if the text is not a number, which other rules report."""
    text = text.strip()
    if port.limits is not None and (integer := integer_of(text)) is not None:
        return integer
    if not text or mismatch(port.type, text) is not None:
        return None
    try:
        number = float(text)
    except ValueError:  # a blackboard entry, or an expression
        return None
    return None if math.isnan(number) else number


RULE = Rule("port-range", Severity.WARNING, "A port is set to a number that has no useful effect.", tree=check)
