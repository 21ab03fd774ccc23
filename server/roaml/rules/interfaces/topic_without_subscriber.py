# SPDX-License-Identifier: Apache-2.0
"""The rule `topic-without-subscriber`, which topic_without_subscriber.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.gaps import InterfaceAct
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, did_you_mean
from roaml.rules.support.interfaces import close_channels, declared, name_span, renamings
from roaml.scxml.names import topic_message


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    unheard = [
        (declaration, topic)
        for declaration, _, topic in declared(context, SymbolKind.PUBLISHER)
        if not topic.users and not system.is_observed(topic_message(topic.name))
    ]
    unpublished = [t.name for t in system.topics.values() if t.users and not t.sources] if unheard else []
    for declaration, topic in unheard:
        if not system.may(InterfaceAct(SymbolKind.SUBSCRIBER), topic.name):
            close = close_channels(topic.name, unpublished)
            message = f"no machine subscribes to the topic `{topic.name}`, so its messages have no effect"
            message += did_you_mean(close)
            names = close if isinstance(declaration.interface, Name) else ()
            fixes = renamings(context, name_span(declaration), names)
            yield RULE.at(name_span(declaration), message, *fixes)


RULE = Rule(
    "topic-without-subscriber",
    Severity.HINT,
    "No machine subscribes to a topic that is published.",
    machine=check,
    whole=True,
)
