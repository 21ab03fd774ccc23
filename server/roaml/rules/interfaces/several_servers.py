# SPDX-License-Identifier: Apache-2.0
"""The rule `several-servers`, which several_servers.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.machine import Declaration
from roaml.model.system import Channel, ChannelEndpoint, SystemAutomaton
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared, name_span
from roaml.scxml.names import sanitise


def check(context: MachineContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for kind, noun, channels in (
        (SymbolKind.SERVICE_SERVER, "service", context.system.services),
        (SymbolKind.ACTION_SERVER, "action", context.system.actions),
    ):
        served: dict[str, list[Channel]] = {}
        for channel in channels.values():
            if channel.sources:
                served.setdefault(sanitise(channel.name), []).append(channel)
        for declaration, automaton, channel in declared(context, kind):
            own = declaration.handle.value if declaration.handle else ""
            others = [e for e in channel.sources if e.automaton is not automaton or e.use.handle != own]
            if others:
                yield _finding(declaration, automaton, channel, others, noun)
            alike = [other for other in served[sanitise(channel.name)] if other is not channel]
            if alike:
                yield _same_events(declaration, channel, alike[0], noun)


def _same_events(declaration: Declaration, channel: Channel, other: Channel, noun: str) -> Finding:
    """Report two names that have the same form in the names of events (docs/spec/plain-scxml.md#interface-names)."""
    message = (
        f"the {noun}s `{channel.name}` and `{other.name}` are both called `{sanitise(channel.name)}` in the "
        f"translation, which cannot distinguish them; rename one of them"
    )
    return RULE.at(
        name_span(declaration), message, related=[Related(other.sources[0].symbol, f"the server of `{other.name}`")]
    )


def _finding(
    declaration: Declaration,
    automaton: SystemAutomaton,
    channel: Channel,
    others: list[ChannelEndpoint],
    noun: str,
) -> Finding:
    span, count = name_span(declaration), len(channel.sources)
    elsewhere = [e for e in others if e.automaton.path != automaton.path or e.automaton is automaton]
    if elsewhere:
        message = f"the {noun} `{channel.name}` has {count} servers; it must have exactly one"
        return RULE.at(span, message, related=[Related(other.symbol, "another server") for other in elsewhere])
    where = "is used in the tree" if automaton.instance is not None else "is listed in the system"
    message = (
        f"the {noun} `{channel.name}` has {count} servers, because `{automaton.outline.name}` {where} {count} times"
    )
    return RULE.at(span, f"{message}; it must have exactly one")


RULE = Rule(
    "several-servers", Severity.ERROR, "A service or action has more than one server.", machine=check, whole=True
)
