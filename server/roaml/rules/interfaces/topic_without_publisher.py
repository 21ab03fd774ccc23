# SPDX-License-Identifier: Apache-2.0
"""The rule `topic-without-publisher`, which topic_without_publisher.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.gaps import InterfaceAct
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext, did_you_mean
from roaml.rules.support.interfaces import close_channels, has_publisher, intended_channels, named_here, renamings

_PUBLISHES = InterfaceAct(SymbolKind.PUBLISHER, ProtocolPart.MESSAGE)


def check(context: MachineContext | TreeContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    unpublished = [n for n in named_here(context, SymbolKind.SUBSCRIBER) if not has_publisher(system, n.channel)]
    intended = intended_channels(system, SymbolKind.PUBLISHER) if unpublished else frozenset()
    published = [t.name for t in system.topics.values() if t.sources] if unpublished else []
    for naming in unpublished:
        topic = naming.channel
        if not naming.use.receives or system.may(_PUBLISHES, topic.name):
            continue
        if topic.name in intended:
            continue  # misleading-handle reports the publisher
        # A topic that is declared on both sides is unlikely to be misspelled.
        close = close_channels(topic.name, () if topic.sources else published)
        silent = " (a publisher is declared but never publishes)" if topic.sources else ""
        message = (
            f"no machine publishes on the topic `{topic.name}`{silent}, so no message arrives{did_you_mean(close)}"
        )
        fixes = renamings(context, naming.span, close if naming.literal else ())
        # A machine that never waits for this topic alone may have inputs that are not used in this system.
        needed = bool(close or topic.sources or naming.use.awaited)
        severity = Severity.ERROR if needed else Severity.WARNING
        yield RULE.at(naming.span, message, *fixes, severity=severity, related=naming.related)


RULE = Rule(
    "topic-without-publisher",
    Severity.ERROR,
    "No machine publishes on a topic that is subscribed to.",
    machine=check,
    tree=check,
    whole=True,
)
