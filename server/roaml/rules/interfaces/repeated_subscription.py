# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-subscription`, which repeated_subscription.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.outline import InterfaceUse
from roaml.model.syntax import Name
from roaml.model.system import Channel, System, SystemAutomaton
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext
from roaml.rules.support.interfaces import declared, find_use, is_subscribed, named_by_ports, port_span
from roaml.scxml.names import topic_message
from roaml.text import Span


def check(context: MachineContext | TreeContext) -> Iterator[Finding]:
    """Report subscribers of one machine that get the same topic, by their names or by the ports of a node."""
    seen: dict[tuple[int, str], tuple[Span, str]] = {}
    reported: set[Span] = set()
    for automaton, span, use, topic in _subscribers(context):
        handle = use.handle
        first, other = seen.setdefault((id(automaton), topic.name), (span, handle))
        if other != handle and span not in reported:
            reported.add(span)
            is_likely = context.system is not None and _is_another_missed(context.system, use, topic)
            name = use.name or topic.name
            message = (
                f"`{other}` and `{handle}` subscribe to the same topic `{name}`, so each message arrives at both; "
                "unless this is intended, change one of the names, or remove one of the subscribers"
            )
            severity = Severity.WARNING if is_likely else Severity.INFORMATION
            yield RULE.at(span, message, related=[Related(first, f"the topic of `{other}`")], severity=severity)


def _is_another_missed(system: System, use: InterfaceUse, topic: Channel) -> bool:
    """Whether machines publish messages of the same type on another topic, to which nothing subscribes, or whose name
    the handle is. Ports are written to connect a node with the machines, so a property that observes the topic is not
    enough for them."""
    is_own = use.handle == _last(use.name or topic.name)
    for other in system.topics.values():
        sources = [source for source in other.sources if source.use.type == use.type]
        if other is topic or not sources:
            continue
        if not use.port and not is_own and any(use.handle == _last(source.use.name) for source in sources):
            return True
        if not is_subscribed(system, other) and (use.port or not system.is_observed(topic_message(other.name))):
            return True
    return False


def _last(name: str) -> str:
    return name.rpartition("/")[2]


def _subscribers(
    context: MachineContext | TreeContext,
) -> Iterator[tuple[SystemAutomaton, Span, InterfaceUse, Channel]]:
    """The subscribers of each automaton, with the place where the topic is named, and the topic."""
    if isinstance(context, MachineContext):
        for declaration, automaton, channel in declared(context, SymbolKind.SUBSCRIBER):
            use = find_use(automaton, declaration)
            if isinstance(declaration.interface, Name) and use is not None:
                yield automaton, declaration.interface.span, use, channel
        return
    for node, automaton, use in named_by_ports(context):
        topic = context.system.channel(automaton, use) if context.system is not None else None
        if use.kind is SymbolKind.SUBSCRIBER and topic is not None:
            yield automaton, port_span(node, use.port), use, topic


RULE = Rule(
    "repeated-subscription",
    Severity.INFORMATION,
    "A machine subscribes to the same topic twice.",
    machine=check,
    tree=check,
    whole=True,
)
