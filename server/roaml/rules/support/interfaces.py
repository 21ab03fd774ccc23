# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about topics, services and actions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Fix, Related
from roaml.expr.types import leaves
from roaml.expr.zero import zero_text
from roaml.model.gaps import OTHER_SIDE, InterfaceAct
from roaml.model.machine import Declaration, Handler, Machine, RosSend
from roaml.model.outline import InterfaceUse
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Name
from roaml.model.system import CLOCK_TOPIC, Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.model.tree import TreeNode
from roaml.model.value_types import find_handle
from roaml.record import Record
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, TreeContext
from roaml.rules.support.instances import instances
from roaml.scxml.names import topic_message
from roaml.suggest import are_similar, close_names
from roaml.text import Span, TextEdit


class Naming(Record, frozen=True):
    """A place where an automaton names a topic, service or action.

    Attributes:
        span: the place of the name, or its replacement; see `name_span` and `port_span`.
        literal: whether the name itself is written there.
        use: the declaration that gets the name.
        channel: the topic, service or action.
        related: for the port of a node, the declaration in its plugin.
    """

    span: Span
    literal: bool
    use: InterfaceUse
    channel: Channel
    related: tuple[Related, ...] = ()


def named_here(context: MachineContext | TreeContext, kind: SymbolKind) -> Iterator[Naming]:
    """The places where a file names topics, services or actions for declarations of the kind `kind`: the declarations
    of a machine, or the ports of the nodes of a tree file."""
    if context.system is None:
        return
    if isinstance(context, MachineContext):
        for declaration, automaton, channel in declared(context, kind):
            use = find_use(automaton, declaration)
            if use is not None and isinstance(declaration.interface, Name):
                yield Naming(declaration.interface.span, True, use, channel)
        return
    for node, automaton, use in named_by_ports(context):
        channel_meant = context.system.channel(automaton, use)
        if use.kind is kind and channel_meant is not None:
            setting = next((setting for setting in node.ports if setting.key.value == use.port), None)
            literal = setting is not None and setting.variable is None
            related = (Related(automaton.symbol(use), "used here"),)
            yield Naming(port_span(node, use.port), literal, use, channel_meant, related)


def other_kind(kind: SymbolKind) -> SymbolKind:
    """The kind of the declarations on the other side, for example subscribers for publishers."""
    return OTHER_SIDE[kind]


def declared(context: MachineContext, kind: SymbolKind) -> Iterator[tuple[Declaration, SystemAutomaton, Channel]]:
    """The declarations of a kind in each automaton of the machine, with their topic, service or action."""
    of_kind = [d for d in context.machine.declarations if d.kind is kind and d.handle is not None]
    for automaton in context.automata:
        for declaration in of_kind:
            channel = _channel(context, automaton, declaration)
            if channel is not None:
                yield declaration, automaton, channel


def channels_of(context: MachineContext, declaration: Declaration) -> Iterator[tuple[SystemAutomaton, Channel]]:
    """The topic, service or action of a declaration, in each automaton of the machine."""
    for automaton in context.automata:
        channel = _channel(context, automaton, declaration)
        if channel is not None:
            yield automaton, channel


def _channel(context: MachineContext, automaton: SystemAutomaton, declaration: Declaration) -> Channel | None:
    use = find_use(automaton, declaration)
    return context.system.channel(automaton, use) if context.system and use else None


def named_by_ports(context: TreeContext) -> Iterator[tuple[TreeNode, SystemAutomaton, InterfaceUse]]:
    """The nodes of a file whose ports name topics, services or actions, with their automata in the executed tree."""
    for node, automaton in instances(context):
        for use in automaton.outline.interfaces:
            if use.port:
                yield node, automaton, use


def port_span(node: TreeNode, key: str) -> Span:
    """The value of the port of a node; the name of the node if the value is written elsewhere, for example as a
    default."""
    setting = next((setting for setting in node.ports if setting.key.value == key), None)
    if setting is not None:
        return setting.value.span
    return node.plugin.span if node.plugin else node.element.name_span


def find_use(automaton: SystemAutomaton, declaration: Declaration) -> InterfaceUse | None:
    """The outline of a declaration in an automaton; `None` if there is none, for example because the declaration has no
    handle."""
    return automaton.outline.use(declaration.kind, declaration.handle.value if declaration.handle else "")


def name_span(declaration: Declaration) -> Span:
    """The place where the topic, service or action is named. If the name comes from a port, this is the handle or,
    without a handle, the name of the element."""
    if isinstance(declaration.interface, Name):
        return declaration.interface.span
    return declaration.handle.span if declaration.handle else declaration.element.name_span


def close_channels(name: str, names: Iterable[str]) -> tuple[str, ...]:
    """The names of topics, services or actions that are similar to `name`, the most similar first.

    If two names have equally many parts between `/`, all parts must be similar: `/TimeComponent/Stop` is not a
    misspelled `/DoorComponent/Open`.
    """
    parts = _parts(name)
    return tuple(
        close
        for close in close_names(name, names)
        if len(_parts(close)) != len(parts) or all(map(are_similar, parts, _parts(close)))
    )


_CHANNELS = {
    SymbolKind.PUBLISHER: "topics",
    SymbolKind.SUBSCRIBER: "topics",
    SymbolKind.SERVICE_CLIENT: "services",
    SymbolKind.ACTION_CLIENT: "actions",
}


def intended(system: System, use: InterfaceUse, current: Channel) -> Channel | None:
    """The topic, service or action that a declaration probably means instead of `current`: it has the name of the
    handle and the same type, and no other automaton is on the side of the declaration. A subscriber is not doubted if
    its topic contains the handle, as `/scan_filtered` contains `scan`, or if other machines publish on its topic than
    on the other one."""
    if not use.name or use.kind not in _CHANNELS or use.handle == _parts(use.name)[-1]:
        return None
    if use.kind is SymbolKind.SUBSCRIBER and use.handle in use.name:
        return None
    if use.kind is not SymbolKind.PUBLISHER and not current.sources:
        return None  # reported by the rules about missing publishers and servers
    itself = _machines(end for end in current.users if end.use is use)  # its own messages are hardly intended
    channels: Mapping[str, Channel] = getattr(system, _CHANNELS[use.kind])
    for channel in channels.values():
        own, other = channel.users, channel.sources
        if use.kind is SymbolKind.PUBLISHER:
            own, other = other, own
        if own or system.may(InterfaceAct(use.kind), channel.name):
            continue
        if use.kind is SymbolKind.SUBSCRIBER and system.is_observed(topic_message(channel.name)):
            continue  # a property is on this side
        if use.kind is SymbolKind.SUBSCRIBER and not _machines(current.sources) <= itself | _machines(other):
            continue
        if any(_parts(end.use.name)[-1] == use.handle and end.use.type == use.type for end in other):
            return channel
    return None


def is_subscribed(system: System, topic: Channel) -> bool:
    """Whether a machine subscribes to a topic, or may do so."""
    return bool(topic.users) or system.may(InterfaceAct(SymbolKind.SUBSCRIBER), topic.name)


def _machines(ends: Iterable[ChannelEndpoint]) -> set[str]:
    return {end.automaton.path for end in ends}


def intended_channels(system: System, kind: SymbolKind) -> frozenset[str]:
    """The names of the topics, services or actions that have no declaration of the kind `kind`, and that such a
    declaration probably means."""
    names = set()
    for automaton in system.automata:
        for use in automaton.outline.interfaces:
            current = system.channel(automaton, use) if use.kind is kind else None
            channel = intended(system, use, current) if current is not None else None
            if channel is not None:
                names.add(channel.name)
    return frozenset(names)


def _parts(name: str) -> list[str]:
    return name.strip("/").split("/")


def renamings(context: MachineContext | TreeContext, span: Span, names: Iterable[str]) -> Iterator[Fix]:
    """A fix for each of `names`, the first one preferred, that makes it the name of the topic, service or action at
    `span`, also where the name is used as the handle."""
    spans = [span]
    if isinstance(context, MachineContext):
        written = [d for d in context.machine.declarations if d.interface and d.interface.span == span]
        spans += [s for d in written if d.handle is d.interface for s in _handle_spans(context.machine, d)]
    for number, name in enumerate(names):
        yield Fix(f"Change to `{name}`", tuple(TextEdit(s, name) for s in spans), preferred=number == 0)


def _handle_spans(machine: Machine, declaration: Declaration) -> Iterator[Span]:
    """The places where the rest of the machine refers to a declaration."""
    for chart in machine.charts:
        users: list[Handler | RosSend] = [h for state in chart.states for h in state.handlers]
        users += [s for s in chart.statements if isinstance(s, RosSend)]
        for user in users:
            if user.handle is not None and find_handle(machine, user) is declaration:
                yield user.handle.span


def has_publisher(system: System, topic: Channel) -> bool:
    if topic.name == CLOCK_TOPIC and system.has_timer:
        return True
    return any(ProtocolPart.MESSAGE in endpoint.use.sends for endpoint in topic.sources)


def response(declaration: Declaration, interface: InterfaceType) -> tuple[str, ...]:
    """The lines that send a response with the zero value of its type in each field."""
    assert declaration.handle is not None
    types = {".".join(path): type_ for path, type_ in leaves(interface.part("response"))}
    fields = [f'    <field name="{name}" expr="{zero_text(types[name])}" />' for name in interface.required("response")]
    tag = f'<ros_service_send_response name="{declaration.handle.value}"'
    return (f"{tag}>", *fields, "</ros_service_send_response>") if fields else (f"{tag} />",)
