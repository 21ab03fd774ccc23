# SPDX-License-Identifier: Apache-2.0
"""The rule `not-checked`, which not_checked.md describes."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.types import BASE_TYPES
from roaml.interfaces.registry import NotFound
from roaml.language import HL_SCXML
from roaml.model.expand import node_at
from roaml.model.gaps import Act, GapAct, InterfaceAct, answers
from roaml.model.globals import global_variables
from roaml.model.kinds import FileKind
from roaml.model.machine import Machine
from roaml.model.ros import InterfaceType
from roaml.model.system import Fact, System, may_give_variable
from roaml.model.system_file import SystemSection
from roaml.model.vocabulary import DECLARING_ELEMENTS, FOREIGN_TYPES
from roaml.record import Record
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule, SystemContext, TreeContext
from roaml.rules.support.interfaces import has_publisher, named_by_ports, port_span
from roaml.scxml.names import topic_message
from roaml.suggest import close_names
from roaml.text import Span
from roaml.xml_syntax import Element

_ANY_PLUGIN: set[Fact] = {(GapAct.PLUGIN, None)}
"""The facts that an unreadable file may contain if a system lists it as a plugin: a plugin with any name."""
_ANY_FACT: set[Fact] = {(GapAct.ANYTHING, None)}
_MAX_NAMED_QUESTIONS = 3
"""The maximum number of facts, such as whether a plugin exists, that a message names."""


def check(context: MachineContext | TreeContext | SystemContext) -> Iterator[Finding]:
    texts_at: dict[Span, list[str]] = {}
    if isinstance(context, MachineContext) and context.system is not None and not context.all_structs:
        yield from _unknown_types(context)
    causes = list(_causes(context, context.system)) if context.system is not None else []
    questions = list(_questions(context.system, context.interface)) if context.system is not None and causes else []
    for span, facts in causes:
        texts = texts_at.setdefault(span, [])
        texts += [question.text for question in questions if question.text not in texts and question.may_be(facts)]
    if isinstance(context, MachineContext):
        for element, span in _misspelled(context.machine):
            texts_at.setdefault(span, []).extend(_of_machine(context, element))
    reported: set[tuple[str, ...]] = set()
    for span, texts in texts_at.items():
        if tuple(texts) in reported:
            continue  # the same node, or the same mistake, elsewhere in this file
        reported.add(tuple(texts))
        if texts and _is_unresolved(context, span):
            reason, advice = "because a listed plugin cannot be read", "fix the errors of that plugin first"
            yield RULE.at(span, f"not checked, {reason}: {_listing(texts)}; {advice}")
        elif texts:
            yield RULE.at(span, f"not checked because of this error: {_listing(texts)}; fix the error first")


def _misspelled(machine: Machine) -> Iterator[tuple[Element, Span]]:
    """The elements of a machine that are unknown and similar to known ones, and those with an attribute of this kind,
    each with the place of the wrong name."""
    for element in machine.element.walk():
        if element.is_foreign:
            continue
        type_ = HL_SCXML.elements.get(element.name)
        if type_ is None:
            if close_names(element.name, HL_SCXML.elements, 1):
                yield element, element.name_span
            continue
        for attribute in element.attributes:
            is_foreign = ":" in attribute.name  # the attribute of another tool, which has no meaning here
            if is_foreign or attribute.name in type_.attributes:
                continue
            if close_names(attribute.name, type_.attributes, 1):
                yield element, attribute.name_span


def _of_machine(context: MachineContext, element: Element) -> Iterator[str]:
    """The questions about a machine that a misspelled element, or its misspelled attribute, leaves open, as clauses."""
    charts = context.machine.charts
    handlers = [handler for chart in charts for state in chart.states for handler in state.handlers]
    is_declaration = not any(state.element.span.contains(element.span.start) for c in charts for state in c.states)
    if any(chart.data for chart in charts):
        yield "which values the variables have"
    asked = dict.fromkeys(_ASKED[handler.trigger] for handler in handlers if handler.trigger in _ASKED)
    if asked:
        yield f"whether each {_or(tuple(asked))} is answered"
    if context.system is not None and is_declaration:
        yield "which values machines send"
        if DECLARING_ELEMENTS[SymbolKind.TIMER] in (element.name, *close_names(element.name, HL_SCXML.elements)):
            yield "how the rates of the timers fit together"


_ASKED = {
    ProtocolPart.BT_TICK: "tick",
    ProtocolPart.BT_HALT: "halt",
    ProtocolPart.REQUEST: "request",
    ProtocolPart.GOAL: "goal",
    ProtocolPart.THREAD_START: "goal",
}
"""The kinds of events that require an answer -> what users call them."""


def _or(words: tuple[str, ...]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"


def _is_unresolved(context: MachineContext | TreeContext | SystemContext, span: Span) -> bool:
    """Whether `span` is the name of a plugin that may be in a file that cannot be read. No rule reports an error there,
    because the plugin may exist."""
    if not isinstance(context, TreeContext) or context.system is None or context.system.plugins_known:
        return False
    nodes = (node_at(context.file, instance.source) for instance in context.system.instances)
    node = next((node for node in nodes if node is not None and node.plugin and node.plugin.span == span), None)
    if node is None or node.plugin is None or node.type is not None:
        return False
    return node.plugin.value not in [outline.name for _, outline in context.system.nodes]


def _unknown_types(context: MachineContext) -> Iterator[Finding]:
    """Report types of variables that may be structs whose declaration cannot be read, each at its first use."""
    known = {*BASE_TYPES, *context.struct_names, *FOREIGN_TYPES}
    for chart in context.machine.charts:
        for data in chart.data:
            if data.type is None or data.type.name is None:
                continue
            name = data.type.name.base
            if name not in known:
                known.add(name)
                message = (
                    f"not checked: whether the type `{name}` exists, because a declaration of structs in this system "
                    "cannot be read; fix the errors of the declarations first"
                )
                yield RULE.at(data.type.span, message)


class _Question(Record, frozen=True):
    """A question about a system that its readable parts do not answer.

    Attributes:
        act: what an automaton would have to do; `None` if the question is whether a variable of the translation exists.
        name: the name of the plugin, topic, service, action, event or variable in question.
        text: the question as a clause, such as "whether the plugin `Wait` exists".
    """

    act: Act | None
    name: str
    text: str

    def may_be(self, facts: set[Fact]) -> bool:
        missing = self.act
        if missing is None:
            return any(may_give_variable(act, about, self.name) for act, about in facts)
        return any(answers(act, missing) and about in (None, self.name) for act, about in facts)


def _causes(context: MachineContext | TreeContext | SystemContext, system: System) -> Iterator[tuple[Span, set[Fact]]]:
    """The places in a file that cannot be read, each with the facts that the place may contain."""
    if isinstance(context, MachineContext):
        for placed in context.gaps:
            for automaton in context.automata:
                yield placed.span, system.facts(placed.gap, automaton)
        if context.machine.name is None and SystemSection.BEHAVIOR_TREE in context.listed_as:
            yield context.machine.element.name_span, _ANY_PLUGIN
        return
    for placed in context.gaps:
        yield placed.span, system.facts(placed.gap)
    if isinstance(context, SystemContext):
        plugins = [
            f
            for f in context.files
            if f.input.section is SystemSection.BEHAVIOR_TREE and f.required_kind is not FileKind.TREE
        ]
        yield from ((listed.span, _ANY_PLUGIN) for listed in plugins if not listed.usable)
        misplaced = system.ticked_nodes | system.idle_plugins
        yield from ((listed.span, _ANY_FACT) for listed in context.files if listed.path in misplaced)
        return
    for instance in system.instances:
        if instance.source.path == context.source.path and system.plugin(instance.plugin, instance.tree)[1] is None:
            node = node_at(context.file, instance.source)
            if node is not None and node.plugin is not None:
                yield node.plugin.span, system.facts_of_unknown(instance)
    for node, automaton, use in named_by_ports(context):
        if automaton.interface_name(use) is None:
            yield port_span(node, use.port), system.facts_of_name(automaton, use)


def _questions(system: System, interface: Callable[[str, str], InterfaceType | NotFound]) -> Iterator[_Question]:
    unknown = {i.plugin for i in system.instances if system.plugin(i.plugin, i.tree)[1] is None}
    for name in () if system.plugins_known else sorted(unknown):  # otherwise `unknown-node` answers it
        yield _Question(GapAct.PLUGIN, name, f"whether the plugin `{name}` exists")
    for topic in system.topics.values():
        if not topic.users and not system.is_observed(topic_message(topic.name)):
            question = f"which machine subscribes to the topic `{topic.name}`"
            yield _Question(InterfaceAct(SymbolKind.SUBSCRIBER), topic.name, question)
        if not has_publisher(system, topic) and any(user.use.receives for user in topic.users):
            yield _Question(
                InterfaceAct(SymbolKind.PUBLISHER, ProtocolPart.MESSAGE),
                topic.name,
                f"which machine publishes on the topic `{topic.name}`",
            )
    for kind_name, server, client, channels in (
        ("service", SymbolKind.SERVICE_SERVER, SymbolKind.SERVICE_CLIENT, system.services),
        ("action", SymbolKind.ACTION_SERVER, SymbolKind.ACTION_CLIENT, system.actions),
    ):
        for channel in channels.values():
            if not channel.sources:
                yield _Question(
                    InterfaceAct(server), channel.name, f"which machine serves the {kind_name} `{channel.name}`"
                )
            elif not channel.users:
                yield _Question(
                    InterfaceAct(client), channel.name, f"which machine uses the {kind_name} `{channel.name}`"
                )
    for event in system.events.values():
        if not event.senders:
            yield _Question(GapAct.SENDS, event.name, f"which machine sends the event `{event.name}`")
        elif not event.receivers and not system.is_observed(event.name):
            yield _Question(GapAct.RECEIVES, event.name, f"which machine has a transition for the event `{event.name}`")
    for variable, ports in system.blackboard.items():
        is_read = any(bound.port.read for bound in ports)
        if not any(bound.port.written for bound in ports):
            does = "writes" if is_read else "writes and which node reads"
            yield _Question(GapAct.VARIABLE, variable, f"which node {does} the blackboard variable `{variable}`")
        elif not is_read:
            yield _Question(GapAct.VARIABLE, variable, f"which node reads the blackboard variable `{variable}`")
    if not system.observed:
        return
    known = global_variables(system, lambda kind, name: _type_or_none(interface(kind, name)))
    for name in sorted(system.observed - known.keys()):
        yield _Question(None, name, f"whether the variable `{name}`, which a property names, exists")


def _type_or_none(interface: InterfaceType | NotFound) -> InterfaceType | None:
    return None if isinstance(interface, NotFound) else interface


def _listing(questions: list[str]) -> str:
    more = len(questions) - _MAX_NAMED_QUESTIONS
    parts = [*questions[:_MAX_NAMED_QUESTIONS], *([f"{more} more facts"] if more > 0 else [])]
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"


RULE = Rule(
    "not-checked",
    Severity.INFORMATION,
    "A part of the system cannot be checked because of an error.",
    machine=check,
    tree=check,
    system=check,
    whole=True,
)
