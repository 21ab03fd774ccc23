# SPDX-License-Identifier: Apache-2.0
"""The rule `topic-without-subscriber`, which topic_without_subscriber.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.gaps import InterfaceAct
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext, did_you_mean, replacements
from roaml.rules.support.interfaces import Naming, close_channels, declared, name_span, named_here, renamings
from roaml.scxml.names import topic_message
from roaml.text import Span


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


def _tree(context: TreeContext) -> Iterator[Finding]:
    """Report nodes whose topic nothing receives, although other nodes of the same plugin publish on another topic."""
    system = context.system
    namings = [n for n in named_here(context, SymbolKind.PUBLISHER) if n.literal]
    heard: dict[tuple[str, str, str], str] = {}
    for naming in namings:
        if naming.channel.users:
            heard.setdefault(_declaration(naming), context.source.text[naming.span.start : naming.span.end])
    reported: set[Span] = set()
    for naming in namings:
        topic, other = naming.channel, heard.get(_declaration(naming))
        is_observed = system is None or system.is_observed(topic_message(topic.name))
        if topic.users or other is None or is_observed or naming.span in reported:
            continue
        if system is not None and not system.may(InterfaceAct(SymbolKind.SUBSCRIBER), topic.name):
            reported.add(naming.span)
            message = (
                f"no machine subscribes to the topic `{topic.name}`, while other such nodes publish on `{other}`; did "
                f"you mean `{other}`?"
            )
            fixes = replacements(naming.span, (other,))
            yield RULE.at(naming.span, message, *fixes, severity=Severity.WARNING, related=naming.related)


def _declaration(naming: Naming) -> tuple[str, str, str]:
    return naming.use.handle, naming.use.port, naming.use.type


RULE = Rule(
    "topic-without-subscriber",
    Severity.HINT,
    "No machine subscribes to a topic that is published.",
    machine=check,
    tree=_tree,
    whole=True,
)
