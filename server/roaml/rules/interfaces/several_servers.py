# SPDX-License-Identifier: Apache-2.0
"""several-servers: see several_servers.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.machine import Declaration
from roaml.model.system import Channel, ChannelEndpoint, SystemAutomaton
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared, name_span


def check(context: MachineContext) -> Iterator[Finding]:
    for kind, what in ((SymbolKind.SERVICE_SERVER, "service"), (SymbolKind.ACTION_SERVER, "action")):
        for declaration, automaton, channel in declared(context, kind):
            own = declaration.handle.value if declaration.handle else ""
            others = [e for e in channel.sources if e.automaton is not automaton or e.use.handle != own]
            if others:
                yield _finding(declaration, automaton, channel, others, what)


def _finding(
    declaration: Declaration, automaton: SystemAutomaton, channel: Channel, others: list[ChannelEndpoint], what: str
) -> Finding:
    span, count = name_span(declaration), len(channel.sources)
    elsewhere = [e for e in others if e.automaton.path != automaton.path or e.automaton is automaton]
    if elsewhere:
        message = f"the {what} `{channel.name}` has {count} servers; it must have exactly one"
        return RULE.at(span, message, related=[Related(other.symbol, "another server") for other in elsewhere])
    where = "is used in the tree" if automaton.instance is not None else "is listed in the system"
    message = (
        f"the {what} `{channel.name}` has {count} servers, because `{automaton.outline.name}` {where} {count} times"
    )
    return RULE.at(span, f"{message}; it must have exactly one")


RULE = Rule("several-servers", Severity.ERROR, "A service or action has more than one server.", machine=check)
