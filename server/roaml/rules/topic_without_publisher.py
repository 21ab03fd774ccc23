# SPDX-License-Identifier: Apache-2.0
"""topic-without-publisher: see topic_without_publisher.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.system import CLOCK_TOPIC, Automaton, Channel, System
from roaml.rules.interfaces import declared, name_span
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None or not system.complete:
        return
    for declaration, automaton, topic in declared(context, "subscriber"):
        if has_publisher(system, topic) or not receives(automaton, declaration.handle):
            continue
        # A topic that is declared on both sides is hardly misspelled.
        others = [] if topic.sources else [t.name for t in system.topics.values() if t.sources]
        close = close_names(topic.name, others)
        silent = " (declared, but nothing is ever published)" if topic.sources else ""
        message = f"nobody publishes on the topic `{topic.name}`{silent}{did_you_mean(close)}"
        span = name_span(declaration)
        yield RULE.at(span, message, *(replacements(span, close) if declaration.interface is not None else ()))


def has_publisher(system: System, topic: Channel) -> bool:
    if topic.name == CLOCK_TOPIC and system.has_timer:
        return True
    return any("message" in endpoint.use.sends for endpoint in topic.sources)


def receives(automaton: Automaton, handle: object) -> bool:
    """Whether a subscriber that is declared also has a callback."""
    name = getattr(handle, "value", "")
    return any(use.kind == "subscriber" and use.handle == name and use.receives for use in automaton.outline.interfaces)


RULE = Rule("topic-without-publisher", Severity.ERROR, "A topic is subscribed to that nobody publishes.", machine=check)
