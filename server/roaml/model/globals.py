# SPDX-License-Identifier: Apache-2.0
"""The global variables of the translated system, which properties may use (docs/spec/jani.md#global-variables).

Every event that is sent has a flag `EVENT.valid` and one variable for each leaf of a parameter. Arrays and strings also
have variables with their lengths. The translation reads only the flags of the tree; a test compares the whole table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.types import (
    BASE_TYPES,
    BOOL,
    INT,
    EmptyArray,
    ScalarKind,
    Struct,
    Type,
    is_kind,
    leaves,
    type_of_empty,
    unwrap,
    wrap,
)
from roaml.interruption import checkpoint
from roaml.model.expand import is_on_board
from roaml.model.outline import InterfaceUse, SentField
from roaml.model.ros import InterfaceType
from roaml.model.system import CLOCK_TOPIC, Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.model.value_types import INTERFACE_KINDS, section_of
from roaml.record import Record
from roaml.roles import ProtocolPart, SymbolKind
from roaml.scxml.names import (
    BLACKBOARD_WRITE_PREFIX,
    FIELD_PREFIX,
    FLAG,
    TreeEventKind,
    action_stem,
    blackboard_answer,
    blackboard_request,
    cancel_request,
    flag_of,
    safe_name,
    service_stem,
    topic_message,
    tree_event_name,
)

FindInterface = Callable[[str, str], InterfaceType | None]
"""Finds a ROS type by its kind (msg, srv or action) and its name as written; `None` if there is none."""


class GlobalVariable(Record, frozen=True):
    """A variable of the translated system.

    Attributes:
        type: its type, in which a string is an array of bytes.
        leaf: the type of the leaf of the parameter that it contains; that of a length is `type`.
        event: the event whose data it contains.
        parameter: the parameter of the event; `FLAG` for the flag.
        source: the part of the models that sends the event; `None` if it has no symbol.
    """

    name: str
    type: Type
    leaf: Type
    event: str
    parameter: str
    source: Symbol | None


def global_variables(system: System, interface: FindInterface) -> dict[str, GlobalVariable]:
    """All global variables by name."""
    table: dict[str, GlobalVariable] = {}
    for event, source, params in _events(system, interface):
        checkpoint()
        table.setdefault(flag_of(event), GlobalVariable(flag_of(event), BOOL, BOOL, event, FLAG, source))
        for name, type_ in params:
            for variable, stored, leaf in _flatten(f"{event}__{name}", type_):
                table.setdefault(variable, GlobalVariable(variable, stored, leaf, event, name, source))
    return table


def tree_flags(system: System) -> tuple[str, ...]:
    """The flags of the events of a tree that is executed as the libraries execute it. They exist even if the tree never
    sends the event, so that properties may use them whatever the other nodes of the tree are."""
    return tuple(flag_of(event) for event, _, _ in _tree(system)) if system.is_library_tree else ()


def event_names(system: System, interface: FindInterface) -> frozenset[str]:
    """The names of the events of the translated system."""
    return frozenset(event for event, _, _ in _events(system, interface))


def event_parameters(system: System, interface: FindInterface) -> dict[str, dict[str, Type]]:
    """The parameters of each event of the translated system, with the types of the models."""
    parameters: dict[str, dict[str, Type]] = {}
    for event, _, params in _events(system, interface):
        for name, type_ in params:
            parameters.setdefault(event, {}).setdefault(name, type_)
    return parameters


def _flatten(name: str, type_: Type) -> Iterator[tuple[str, Type, Type]]:
    """The names of the variables of a parameter, the types in which they are stored, and those of the models: its
    leaves, and the lengths of its arrays and strings (docs/spec/types.md#leaves, docs/spec/jani.md#array-storage)."""
    for path, leaf in leaves(type_):
        full = "__".join((name, *path))
        inner, bounds = unwrap(leaf)
        if isinstance(inner, EmptyArray):
            inner, bounds = INT, (*bounds, None)
        if is_kind(inner, ScalarKind.STRING):
            inner, bounds = INT, (*bounds, None)
        yield full, wrap(inner, bounds), leaf
        for dimension in range(len(bounds)):
            lengths = wrap(INT, bounds[:dimension])
            yield f"{full}.d{dimension + 1}_len", lengths, lengths


_Params = Iterable[tuple[str, Type]]
_Event = tuple[str, Symbol | None, _Params]


def _events(system: System, interface: FindInterface) -> Iterator[_Event]:
    for event in system.events.values():
        for automaton, sent in event.senders:
            symbol = Symbol(automaton.path, SymbolKind.EVENT, event.name)
            yield event.name, symbol, [(p.name.replace(".", "__"), p.type) for p in sent.params]
    for topic in system.topics.values():
        for endpoint in topic.sources:
            if ProtocolPart.MESSAGE in endpoint.use.sends:
                is_read = any(subscriber.use.reads for subscriber in topic.users)
                fields = _sent(endpoint.use, ProtocolPart.MESSAGE, interface if is_read else None)
                yield topic_message(topic.name), endpoint.symbol, fields
    if system.has_timer:
        clock = ((f"{FIELD_PREFIX}sec", INT), (f"{FIELD_PREFIX}nanosec", INT))
        yield topic_message(CLOCK_TOPIC), None, clock
    for service in system.services.values():
        yield from _service(service, interface)
    for action in system.actions.values():
        yield from _action(action, interface)
    yield from _tree(system)
    yield from _blackboard(system)


def _sent(use: InterfaceUse, part: ProtocolPart, interface: FindInterface | None) -> list[tuple[str, Type]]:
    """The fields of a part of an interface as parameters of its event, with the types of the values that are sent. If
    `interface` is given, because the data are read, the type of `[]` follows from the ROS definition."""
    fields = dict(use.fields).get(part, ())
    found = interface and interface(INTERFACE_KINDS[use.kind], use.type)
    declared = {} if not found else {".".join(path): type_ for path, type_ in leaves(found.part(section_of(part)))}
    return [(_field_name(field), _type(field, declared)) for field in fields]


def _field_name(field: SentField) -> str:
    return FIELD_PREFIX + field.name.replace(".", "__")


def _type(field: SentField, declared: Mapping[str, Type]) -> Type:
    if isinstance(field.type, EmptyArray) and field.name in declared:
        return type_of_empty(declared[field.name])
    return field.type


def _forwarded(
    channel: Channel, use: InterfaceUse, part: ProtocolPart, interface: FindInterface
) -> list[tuple[str, Type]]:
    """The fields of a part of a service or action as parameters of the events that its automaton sends, with the types
    of the ROS definition: the required fields, and those that some automaton sends."""
    interface_type = interface(INTERFACE_KINDS[use.kind], use.type)
    if interface_type is None:
        return []
    section = section_of(part)
    known = {FIELD_PREFIX + path.replace(".", "__") for path in interface_type.required(section)}
    for endpoint in channel.endpoints:
        for field in dict(endpoint.use.fields).get(part, ()):
            name = _field_name(field)
            known.update("__".join((name, *path)) for path, _ in leaves(field.type))
    struct: Struct = interface_type.part(section)
    fields = ((FIELD_PREFIX + "__".join(path), type_) for path, type_ in leaves(struct))
    return [(name, type_) for name, type_ in fields if name in known]


def _service(service: Channel, interface: FindInterface) -> Iterator[_Event]:
    name = service_stem(service.name)
    for client in service.users:
        who = safe_name(client.automaton.name)
        parts = (ProtocolPart.REQUEST, ProtocolPart.RESPONSE)
        request, response = (_forwarded(service, client.use, part, interface) for part in parts)
        if ProtocolPart.REQUEST in client.use.sends:
            yield f"{name}_req_client_{who}", client.symbol, _sent(client.use, ProtocolPart.REQUEST, interface)
        yield f"{name}_request", client.symbol, request
        yield f"{name}_response_client_{who}", client.symbol, response
    for server in service.sources:
        if ProtocolPart.RESPONSE in server.use.sends:
            yield f"{name}_response", server.symbol, _sent(server.use, ProtocolPart.RESPONSE, interface)


_GOAL_ID = ("goal_id", BASE_TYPES["int32"])
_CODE = ("code", BASE_TYPES["int32"])
_THREAD_ID = ("thread_id", BASE_TYPES["int32"])


def _action(action: Channel, interface: FindInterface) -> Iterator[_Event]:
    name = action_stem(action.name)
    for client in action.users:
        if ProtocolPart.CANCEL in client.use.sends:
            yield cancel_request(action.name), client.symbol, [_GOAL_ID]
        yield from _action_client(action, client, interface)
    for server in action.sources:
        sent: dict[ProtocolPart, list[tuple[str, Type]]] = {
            ProtocolPart.GOAL_ACCEPTED: [_GOAL_ID],
            ProtocolPart.GOAL_REJECTED: [_GOAL_ID],
            ProtocolPart.FEEDBACK: [*_sent(server.use, ProtocolPart.FEEDBACK, interface), _GOAL_ID],
            ProtocolPart.RESULT: [*_sent(server.use, ProtocolPart.RESULT, interface), _GOAL_ID, _CODE],
            ProtocolPart.THREAD_START: [*_sent(server.use, ProtocolPart.THREAD_START, interface), _GOAL_ID, _THREAD_ID],
            ProtocolPart.THREAD_FREE: [_THREAD_ID],
        }
        for part in server.use.sends:
            if part in sent:
                yield f"{name}_{part.value.replace('-', '_')}", server.symbol, sent[part]


def _action_client(action: Channel, client: ChannelEndpoint, interface: FindInterface) -> Iterator[_Event]:
    name, who, symbol = action_stem(action.name), safe_name(client.automaton.name), client.symbol
    parts = (ProtocolPart.GOAL, ProtocolPart.FEEDBACK, ProtocolPart.RESULT)
    goal, feedback, result = (_forwarded(action, client.use, part, interface) for part in parts)
    if ProtocolPart.GOAL in client.use.sends:
        yield f"{name}_goal_req_client_{who}", symbol, _sent(client.use, ProtocolPart.GOAL, interface)
    yield f"{name}_goal_handle", symbol, [_GOAL_ID, *goal]
    yield f"{name}_goal_accept_client_{who}", symbol, []
    yield f"{name}_goal_reject_client_{who}", symbol, []
    yield f"{name}_feedback_handle_client_{who}", symbol, feedback
    yield f"{name}_result_handle_client_{who}", symbol, [_CODE, *result]


def _tree(system: System) -> Iterator[_Event]:
    for automaton in system.automata:
        instance = automaton.instance
        if instance is None:
            continue
        symbol = Symbol(automaton.path, SymbolKind.MACHINE, automaton.outline.name) if automaton.path else None
        parent = None if instance.parent is None else system.by_instance.get(instance.parent)
        plugin = automaton.outline.plugin
        if parent is None or _calls(parent, instance.number):
            yield tree_event_name(instance.number, TreeEventKind.TICK), symbol, []
        if _is_halted(system, parent, instance.number):
            yield tree_event_name(instance.number, TreeEventKind.HALT), symbol, []
        if plugin.answers_tick:
            yield tree_event_name(instance.number, TreeEventKind.RESPONSE), symbol, [("status", INT)]
        if plugin.answers_halt:
            yield tree_event_name(instance.number, TreeEventKind.HALT_RESPONSE), symbol, []


def _is_halted(system: System, parent: SystemAutomaton | None, number: int) -> bool:
    """Whether the node with the instance number `number` is halted: by its parent; the topmost node, by the root of a
    tree that is ticked again after it has ended."""
    if parent is None:
        return system.is_library_tree and system.parameters.tick_if_not_running
    return parent.outline.plugin.halts_children and _calls(parent, number)


def _calls(parent: SystemAutomaton, number: int) -> bool:
    """Whether a parent can tick or halt its child with the instance number `number`."""
    assert parent.instance is not None
    plugin = parent.outline.plugin
    return plugin.any_child or parent.instance.children.index(number) < plugin.children


def _blackboard(system: System) -> Iterator[_Event]:
    variables: Mapping[str, Type] = {name: BASE_TYPES[type_] for name, type_ in system.variables.items()}
    for name in variables:
        if system.writes_variable(name):
            yield f"{BLACKBOARD_WRITE_PREFIX}{name}", None, [("value", variables[name])]
    for root in system.roots:
        if system.reads_blackboard(root.tree):
            own = [item for item in variables.items() if is_on_board(item[0], root.tree)]
            yield blackboard_request(root.tree), None, []
            yield blackboard_answer(root.tree), None, own
