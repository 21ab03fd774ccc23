# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-subscription`, which repeated_subscription.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext
from roaml.rules.support.interfaces import declared, named_by_ports, port_span
from roaml.text import Span


def check(context: MachineContext | TreeContext) -> Iterator[Finding]:
    """Report subscribers of one machine that get the same topic, by their names or by the ports of a node."""
    seen: dict[object, tuple[Span, str]] = {}
    reported: set[Span] = set()
    for key, span, handle, topic in _subscribers(context):
        first, other = seen.setdefault(key, (span, handle))
        if other != handle and span not in reported:
            reported.add(span)
            message = (
                f"`{other}` and `{handle}` subscribe to the same topic `{topic}`, so each message arrives at both; "
                "change one of the names, or remove one of the subscribers"
            )
            yield RULE.at(span, message, related=[Related(first, f"the topic of `{other}`")])


def _subscribers(context: MachineContext | TreeContext) -> Iterator[tuple[object, Span, str, str]]:
    """A key for each automaton and topic, with the place where the topic is named, the handle, and the topic."""
    if isinstance(context, MachineContext):
        for declaration, automaton, channel in declared(context, SymbolKind.SUBSCRIBER):
            if isinstance(declaration.interface, Name) and declaration.handle is not None:
                key = (id(automaton), channel.name)
                yield key, declaration.interface.span, declaration.handle.value, declaration.interface.value
        return
    for node, automaton, use in named_by_ports(context):
        topic = context.system.channel(automaton, use) if context.system is not None else None
        if use.kind is SymbolKind.SUBSCRIBER and topic is not None:
            yield (id(automaton), topic.name), port_span(node, use.port), use.handle, topic.name


RULE = Rule(
    "repeated-subscription",
    Severity.WARNING,
    "A machine subscribes to the same topic twice.",
    machine=check,
    tree=check,
    whole=True,
)
