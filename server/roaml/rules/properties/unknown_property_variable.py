# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-property-variable`, which unknown_property_variable.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Severity
from roaml.expr.types import Unknown, unwrap
from roaml.jani.properties import identifiers
from roaml.model.globals import GlobalVariable
from roaml.model.system import System
from roaml.roles import ProtocolPart
from roaml.rules.rule import PropertiesContext, Rule, close_names, did_you_mean, replacements
from roaml.scxml.names import topic_message


def check(context: PropertiesContext) -> Iterator[Finding]:
    system = context.system
    if system is None or context.variables is None:
        return
    unsent = _unsent(system)
    for property_ in context.properties:
        for name, span in identifiers(property_.expression):
            if name in context.variables or system.may_have_variable(name):
                continue
            silent = next((channel for event, channel in unsent.items() if _is_of(name, event)), None)
            if silent is not None:
                yield RULE.at(span, f"the system has no variable `{name}`, because no machine sends {silent}")
            elif not _is_part_of_unknown(name, context.variables):
                close = close_names(name, context.variables) or _same_event(name, context.variables)
                hint = did_you_mean(close) or _explanation(name, context.variables)
                yield RULE.at(span, f"the system has no variable `{name}`{hint}", *replacements(span, close))


def _unsent(system: System) -> dict[str, str]:
    """The events that machines handle or declare, but none sends -> what they are, for messages. The name of a variable
    of these is right: the message is missing."""
    unsent = {event.name: f"the event `{event.name}`" for event in system.events.values() if not event.senders}
    for topic in system.topics.values():
        if not any(ProtocolPart.MESSAGE in endpoint.use.sends for endpoint in topic.sources):
            unsent[topic_message(topic.name)] = f"a message on the topic `{topic.name}`"
    return unsent


def _is_of(name: str, event: str) -> bool:
    """Whether a variable belongs to an event."""
    return name.startswith((f"{event}__", f"{event}."))


def _is_part_of_unknown(name: str, variables: Mapping[str, GlobalVariable]) -> bool:
    """Whether a variable may be part of a parameter of unknown type, which another rule reports."""
    unknown = (v.name for v in variables.values() if isinstance(unwrap(v.type)[0], Unknown))
    return any(_is_of(name, prefix) for prefix in unknown)


def _same_event(name: str, variables: Mapping[str, GlobalVariable]) -> tuple[str, ...]:
    """At most three variables of the event whose name is the beginning of `name`."""
    event = name.partition("__")[0].partition(".")[0]
    return tuple(v.name for v in variables.values() if v.event == event)[:3]


def _explanation(name: str, variables: Mapping[str, GlobalVariable]) -> str:
    return (
        "; a property can use flags and parameters of events, `EVENT.valid` and `EVENT__PARAMETER`" if variables else ""
    )


RULE = Rule(
    "unknown-property-variable",
    Severity.ERROR,
    "A property uses a variable that the translated system does not have.",
    properties=check,
)
