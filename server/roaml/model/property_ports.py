# SPDX-License-Identifier: Apache-2.0
"""Links the ports of a property file to events of the translated system and to their parameters
(docs/spec/xml-properties.md#ports).

The translated system sends each request or answer twice: between the client and the automaton of the interface, and
between that automaton and the server. Ports listen to the event of the client.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from roaml.exhaustive import assert_never
from roaml.expr.types import BASE_TYPES, BOOL, INTEGER_RANGES, UNKNOWN, Struct, Type, is_number
from roaml.interfaces.registry import NotFound
from roaml.interfaces.types import Kind
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.globals import GlobalVariable
from roaml.model.property_file import ObservedPart, Port, PortKind, PortVariable, PortVariableKind, PropertyFile
from roaml.model.property_problems import Problem, ProblemKind
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Name
from roaml.model.system import CLOCK_TOPIC, Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.model.timing import TimerRate, rates
from roaml.model.tree_paths import nodes_called, path_of, short_paths
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.scxml.names import CANCEL_PREFIX, FIELD_PREFIX, flag_of, safe_name, sanitise, topic_message
from roaml.scxml.observed import PortEvent
from roaml.suggest import alternatives, close_names
from roaml.text import Span

FindInterface = Callable[[str, str], "InterfaceType | NotFound"]

INT32 = BASE_TYPES["int32"]
INTERFACE_KINDS: Mapping[PortKind, Kind] = {PortKind.TOPIC: "msg", PortKind.SERVICE: "srv", PortKind.ACTION: "action"}
"""Kind of port -> the kind of its ROS type."""
_WORDS = {
    PortKind.TOPIC: "topic",
    PortKind.SERVICE: "service",
    PortKind.ACTION: "action",
    PortKind.NODE: "node of the behavior tree",
    PortKind.PLAIN: "event",
}
EVENTS = {
    PortKind.TOPIC: (ObservedPart.PUBLISH,),
    PortKind.SERVICE: (ObservedPart.REQUEST, ObservedPart.RESPONSE),
    PortKind.ACTION: (
        ObservedPart.GOAL_REQUEST,
        ObservedPart.GOAL_RESPONSE,
        ObservedPart.FEEDBACK,
        ObservedPart.RESULT,
        ObservedPart.CANCEL_REQUEST,
    ),
    PortKind.NODE: (ObservedPart.TICK, ObservedPart.RESPONSE, ObservedPart.HALT),
}
"""Kind of port -> the values of its attribute `event`."""
_PARTS_OF_CLIENTS = {
    ObservedPart.REQUEST: ProtocolPart.REQUEST,
    ObservedPart.GOAL_REQUEST: ProtocolPart.GOAL,
    ObservedPart.CANCEL_REQUEST: ProtocolPart.CANCEL,
}
"""The events of services and actions that clients send, with what a client sends in them."""
_SENDING = {
    ObservedPart.PUBLISH: "publishes on",
    ObservedPart.REQUEST: "calls",
    ObservedPart.GOAL_REQUEST: "sends goals to",
    ObservedPart.CANCEL_REQUEST: "cancels goals of",
}
_PARTS = {
    ObservedPart.PUBLISH: "message",
    ObservedPart.REQUEST: "request",
    ObservedPart.RESPONSE: "response",
    ObservedPart.GOAL_REQUEST: "goal",
    ObservedPart.FEEDBACK: "feedback",
    ObservedPart.RESULT: "result",
}
_WITHOUT_FIELDS = {
    ObservedPart.GOAL_RESPONSE: "an answer to a goal",
    ObservedPart.CANCEL_REQUEST: "a request to cancel a goal",
}
"""The events of an action that have no fields, in words."""
_GIVEN_BY = {
    PortVariableKind.GOAL_ID: EVENTS[PortKind.ACTION],
    PortVariableKind.RESULT_CODE: (ObservedPart.RESULT,),
    PortVariableKind.ACCEPTED: (ObservedPart.GOAL_RESPONSE,),
}
"""Kind of variable -> the parts of an action that carry its value."""


class LinkedVariable(Record, frozen=True):
    """A variable of a port that is linked to a parameter of the events of the port.

    Attributes:
        type: the type of the value; `UNKNOWN` if not known.
        parameter: the parameter of the events that provides the value; "" if there is none.
    """

    id: str
    kind: PortVariableKind
    type: Type
    parameter: str
    written: PortVariable


class LinkedPort(Record, frozen=True):
    """A port that is linked to its events. `is_known` is false if the events cannot be determined."""

    written: Port
    events: tuple[PortEvent, ...]
    variables: tuple[LinkedVariable, ...]
    is_known: bool = True


class PortLinker:
    """Links the ports of one file and collects the problems in `problems`."""

    def __init__(self, system: System, find: FindInterface, variables: Mapping[str, GlobalVariable]) -> None:
        self.system = system
        self.find = find
        self.variables = variables
        self.problems: list[Problem] = []

    def report(
        self, kind: ProblemKind, span: Span, message: str, close: Iterable[str] = (), *, harmless: bool = False
    ) -> None:
        self.problems.append(Problem(kind, span, message, tuple(close), harmless=harmless))

    def link(self, port: Port) -> LinkedPort:
        if port.name is not None and port.kind is PortKind.PLAIN:
            return self._plain(port, port.name)
        if port.name is None or port.part is None or port.part not in EVENTS[port.kind]:
            return LinkedPort(port, (), tuple(self._unlinked(port)), is_known=False)  # reported by the schema
        if port.kind is PortKind.NODE:
            return self._node(port, port.name, port.part)
        return self._interface(port, port.name, port.part)

    def _unlinked(self, port: Port) -> Iterator[LinkedVariable]:
        for variable in port.variables:
            if variable.id is not None:
                type_ = (
                    BOOL
                    if variable.kind in (PortVariableKind.EVENT, PortVariableKind.ACCEPTED)
                    else INT32
                    if variable.kind is not PortVariableKind.STATE
                    else UNKNOWN
                )
                yield LinkedVariable(variable.id.value, variable.kind, type_, "", variable)

    def _is_complete(self) -> bool:
        return self.system.complete

    # ------------------------------------------------------------ interfaces

    def _interface(self, port: Port, name: Name, event: ObservedPart) -> LinkedPort:
        channel = self._channel(port, name)
        if channel is None:
            return LinkedPort(port, (), tuple(self._unlinked(port)), is_known=False)
        type_ = self._type(port, channel)
        part = type_.part(_PARTS[event]) if type_ is not None and event in _PARTS else None
        if part is None and event in _WITHOUT_FIELDS:
            part = Struct("", (), _WITHOUT_FIELDS[event])
        problems = len(self.problems)
        events = tuple(self._channel_events(port, channel, event))
        if not events and self._is_complete() and len(self.problems) == problems:
            who = _SENDING.get(event, "sends feedback of" if event is ObservedPart.FEEDBACK else "answers")
            self.report(ProblemKind.UNSENT, name.span, f"no machine {who} `{name.value}`, so this event is never sent")
        if events and port.kind is not PortKind.TOPIC and port.target is None and port.origin is None:
            self._warn_of_clients(port, channel, event)
        variables = tuple(self._variables(port, part, FIELD_PREFIX, event))
        return LinkedPort(port, events, variables, is_known=type_ is not None)

    def slowest_timer(self, port: Port) -> TimerRate | None:
        """The timer without which no message of a topic is sent, if one machine sends them and only ticks of its timers
        are the reason; of several timers the fastest. `None` otherwise."""
        channel = (
            self._channels(port.kind).get(sanitise(port.name.value))
            if port.kind is PortKind.TOPIC and port.name
            else None
        )
        senders = [e for e in channel.sources if ProtocolPart.MESSAGE in e.use.sends] if channel is not None else []
        if len(senders) != 1:
            return None
        sender = senders[0]
        sent = ProtocolEvent(ProtocolPart.MESSAGE, sender.use.handle)
        charts = sender.automaton.outline.charts
        causes = {first for chart in charts for first, second in chart.reactions if second == sent}
        if not causes or any(cause.part is not ProtocolPart.TICK for cause in causes):
            return None
        names = {cause.name for cause in causes}
        timers = [t for t in rates(self.system) if t.automaton is sender.automaton and t.name in names]
        return max(timers, key=lambda timer: timer.hertz, default=None)

    def namesakes(self, port: Port) -> Mapping[str, str]:
        """The other interfaces of the kind and type of a port whose name ends with the id of a variable of the port ->
        this id. Ids that the name of the port contains are not doubted: `/scan_filtered` takes the place of `/scan`."""
        if port.name is None or port.kind not in INTERFACE_KINDS:
            return {}
        own = port.name.value
        channels = self._channels(port.kind)
        channel = channels.get(sanitise(own) if port.kind is PortKind.TOPIC else own)
        types = {endpoint.use.type for endpoint in channel.endpoints} if channel is not None else set()
        ids = {v.id.value for v in port.variables if v.id is not None and v.id.value not in own}
        return {
            name: _last(name)
            for other in channels.values()
            if other is not channel and other.sources and {endpoint.use.type for endpoint in other.endpoints} & types
            for name in sorted(_written_names(other, port.kind))[:1]
            if _last(name) in ids
        }

    def _channels(self, kind: PortKind) -> Mapping[str, Channel]:
        return {
            PortKind.TOPIC: self.system.topics,
            PortKind.SERVICE: self.system.services,
            PortKind.ACTION: self.system.actions,
        }[kind]

    def _channel(self, port: Port, name: Name) -> Channel | None:
        key = sanitise(name.value) if port.kind is PortKind.TOPIC else name.value
        channel = self._channels(port.kind).get(key)
        if channel is not None:
            return channel
        if port.kind is PortKind.TOPIC and key == CLOCK_TOPIC and self.system.has_timer:
            return Channel(CLOCK_TOPIC)
        for kind in (PortKind.TOPIC, PortKind.SERVICE, PortKind.ACTION):
            other = sanitise(name.value) if kind is PortKind.TOPIC else name.value
            if kind != port.kind and other in self._channels(kind):
                message = (
                    f"`{name.value}` is {_article(_WORDS[kind])}, not {_article(_WORDS[port.kind])}; use `<{kind}>`"
                )
                self.report(ProblemKind.UNKNOWN_PORT, name.span, message)
                return None
        if self._is_complete():
            known = {
                written: None
                for channel in self._channels(port.kind).values()
                for written in _written_names(channel, port.kind)
            }
            close = close_names(name.value, known)
            hint = f"; did you mean `{close[0]}`?" if close else ""
            message = f"the system has no {_WORDS[port.kind]} `{name.value}`{hint}"
            self.report(ProblemKind.UNKNOWN_PORT, name.span, message, close)
        return None

    def _type(self, port: Port, channel: Channel) -> InterfaceType | None:
        if port.type is None:
            return None
        kind = INTERFACE_KINDS[port.kind]
        given = self.find(kind, port.type.value)
        declared = {endpoint.use.type: self.find(kind, endpoint.use.type) for endpoint in channel.endpoints}
        types = [type_ for type_ in declared.values() if isinstance(type_, InterfaceType)]
        if isinstance(given, InterfaceType):
            if types and all(given.name != type_.name for type_ in types):
                written = next(name for name, type_ in declared.items() if type_ is types[0])
                message = (
                    f"the type of `{port.name.value if port.name else ''}` is `{written}`, not `{port.type.value}`"
                )
                self.report(ProblemKind.PORT_TYPE, port.type.span, message, (written,))
                return types[0]
            return given
        written_types = tuple(name for name, type_ in declared.items() if isinstance(type_, InterfaceType))
        hint = f"; the machines declare `{written_types[0]}`" if written_types else ""
        message = f"there is no {_WORDS[port.kind]} type `{port.type.value}`{hint}"
        self.report(ProblemKind.PORT_TYPE, port.type.span, message, written_types[:1])
        return types[0] if types else None

    def _channel_events(self, port: Port, channel: Channel, event: ObservedPart) -> Iterator[PortEvent]:
        if port.kind is PortKind.TOPIC:
            senders = [e for e in channel.sources if ProtocolPart.MESSAGE in e.use.sends]
            senders = self._chosen(port.origin, senders, "publishes on", channel)
            name = topic_message(channel.name)
            if port.origin is None:
                if senders or (channel.name == CLOCK_TOPIC and self.system.has_timer):
                    yield PortEvent(name)
            else:
                for sender in senders:
                    yield PortEvent(name, sender.automaton.name)
            return
        chooser = port.origin if event in _PARTS_OF_CLIENTS else port.target
        clients = self._chosen(chooser, channel.users, "is a client of", channel)
        stem = f"{'srv' if port.kind is PortKind.SERVICE else 'action'}_{sanitise(channel.name)}"
        for client in clients:
            who, number = safe_name(client.automaton.name), channel.users.index(client)
            goal = (PortVariableKind.GOAL_ID.value, number)
            match event:
                case ObservedPart.REQUEST if ProtocolPart.REQUEST in client.use.sends:
                    yield PortEvent(f"{stem}_req_client_{who}")
                case ObservedPart.RESPONSE if channel.sources:
                    yield PortEvent(f"{stem}_response_client_{who}")
                case ObservedPart.GOAL_REQUEST if ProtocolPart.GOAL in client.use.sends:
                    yield PortEvent(f"{stem}_goal_req_client_{who}", constants=(goal,))
                case ObservedPart.CANCEL_REQUEST if ProtocolPart.CANCEL in client.use.sends:
                    name = f"{CANCEL_PREFIX}{sanitise(channel.name)}"
                    yield PortEvent(name, client.automaton.name, constants=(goal,))
                case ObservedPart.GOAL_RESPONSE if channel.sources:
                    yield PortEvent(
                        f"{stem}_goal_accept_client_{who}", constants=(goal, (PortVariableKind.ACCEPTED.value, True))
                    )
                    yield PortEvent(
                        f"{stem}_goal_reject_client_{who}", constants=(goal, (PortVariableKind.ACCEPTED.value, False))
                    )
                case ObservedPart.FEEDBACK if any(ProtocolPart.FEEDBACK in s.use.sends for s in channel.sources):
                    yield PortEvent(f"{stem}_feedback_handle_client_{who}", constants=(goal,))
                case ObservedPart.RESULT if channel.sources:
                    yield PortEvent(f"{stem}_result_handle_client_{who}", constants=(goal,))

    def _chosen(
        self, name: Name | None, endpoints: list[ChannelEndpoint], does: str, channel: Channel
    ) -> list[ChannelEndpoint]:
        if name is None:
            return endpoints
        chosen = [endpoint for endpoint in endpoints if name.value in names_of(endpoint.automaton)]
        if not chosen and self._is_complete():
            known = [name_ for endpoint in endpoints for name_ in names_of(endpoint.automaton)]
            close = close_names(name.value, known) or tuple(known[:1])
            hint = f"; did you mean `{close[0]}`?" if close else ""
            message = f"no machine `{name.value}` {does} `{channel.name}`{hint}"
            self.report(ProblemKind.UNKNOWN_PORT, name.span, message, close)
        return chosen

    def _warn_of_clients(self, port: Port, channel: Channel, event: ObservedPart) -> None:
        """Warn if there are several clients to choose from."""
        assert port.name is not None
        part = _PARTS_OF_CLIENTS.get(event)
        clients = [client for client in channel.users if part is None or part in client.use.sends]
        if len(clients) < 2:
            return
        names = ", ".join(f"`{client.automaton.name}`" for client in clients)
        attribute = "origin" if event in _PARTS_OF_CLIENTS else "target"
        number = len(clients)
        message = f"the port listens to {number} clients: {names}; AS2FM uses only one; set `{attribute}` to select one"
        self.report(ProblemKind.SEVERAL_CLIENTS, port.name.span, message)

    # ------------------------------------------------------------- the tree

    def _node(self, port: Port, name: Name, event: ObservedPart) -> LinkedPort:
        matches = nodes_called(self.system, name.value)
        if len(matches) != 1:
            if matches:
                paths = dict.fromkeys(path_of(self.system, node) for node in matches)
                message = f"{len(matches)} nodes of the tree have the name `{name.value}`; "
                shorter = short_paths(self.system)
                close = tuple(dict.fromkeys(shorter[node.number] for node in matches))
                if len(paths) > 1:
                    message += f"use the path of one: {', '.join(f'`{path}`' for path in paths)}"
                else:  # siblings
                    message, close = f"{message}give each of them a different `name` in the tree", ()
                self.report(ProblemKind.UNKNOWN_PORT, name.span, message, close)
            elif self._is_complete():
                names = (text for node in self.system.instances for text in (node.name, node.plugin))
                known = dict.fromkeys((*names, *short_paths(self.system).values()))
                close = close_names(name.value, known)
                hint = f"; did you mean `{close[0]}`?" if close else ""
                message = f"the tree has no node `{name.value}`{hint}"
                self.report(ProblemKind.UNKNOWN_PORT, name.span, message, close)
            return LinkedPort(port, (), tuple(self._unlinked(port)), is_known=False)
        status = Struct("", (("status", INT32),) if event is ObservedPart.RESPONSE else (), f"a {event} of a node")
        variables = tuple(self._variables(port, status, "", event))
        return LinkedPort(port, (PortEvent(f"bt_{matches[0].number}_{event}"),), variables)

    # -------------------------------------------------------- plain events

    def _plain(self, port: Port, name: Name) -> LinkedPort:
        """Link a port that names an event of the translation."""
        params = self._parameters(name.value)
        if params is None and self._is_complete():
            events = [variable.event for variable in self.variables.values()]
            close = close_names(name.value, dict.fromkeys(events))
            hint = f"; did you mean `{close[0]}`?" if close else ""
            self.report(ProblemKind.UNKNOWN_PORT, name.span, f"the system sends no event `{name.value}`{hint}", close)
        data = None if params is None else Struct("", tuple(params.items()), f"the event `{name.value}`")
        sender = port.origin.value if port.origin is not None else ""
        variables = tuple(self._variables(port, data, "", None))
        return LinkedPort(port, (PortEvent(name.value, sender),), variables, is_known=params is not None)

    def _parameters(self, event: str) -> dict[str, Type] | None:
        """The parameters of an event of the translation; `None` if there is no event with this name."""
        if flag_of(event) not in self.variables:
            return None
        names = (v for v in self.variables.values() if v.event == event and v.name.startswith(f"{event}__"))
        return {v.name.removeprefix(f"{event}__"): v.leaf for v in names if "." not in v.name[len(event) :]}

    # ------------------------------------------------------------ variables

    def _variables(
        self, port: Port, data: Struct | None, prefix: str, event: ObservedPart | None
    ) -> Iterator[LinkedVariable]:
        """Link the variables of a port. `data` is the data of the event, `None` if not known."""
        for variable in port.variables:
            if variable.id is None:
                continue
            match variable.kind:
                case PortVariableKind.EVENT:
                    yield LinkedVariable(variable.id.value, PortVariableKind.EVENT, BOOL, "", variable)
                case PortVariableKind.STATE:
                    type_, parameter = self._field(variable, data, prefix, port.kind)
                    yield LinkedVariable(variable.id.value, PortVariableKind.STATE, type_, parameter, variable)
                case PortVariableKind.GOAL_ID | PortVariableKind.RESULT_CODE | PortVariableKind.ACCEPTED:
                    if port.kind is PortKind.ACTION and event not in _GIVEN_BY[variable.kind]:
                        carriers = _either(map(str, _GIVEN_BY[variable.kind]))
                        message = f"`{event}` carries no `<{variable.kind}>`; only {carriers} carries it"
                        self.report(ProblemKind.PORT_VARIABLE, variable.element.name_span, message)
                    type_ = BOOL if variable.kind is PortVariableKind.ACCEPTED else INT32
                    parameter = "code" if variable.kind is PortVariableKind.RESULT_CODE else ""
                    yield LinkedVariable(variable.id.value, variable.kind, type_, parameter, variable)
                case _:
                    assert_never(variable.kind)

    def _field(self, variable: PortVariable, data: Struct | None, prefix: str, kind: PortKind) -> tuple[Type, str]:
        if variable.field is None:
            attribute, noun = ("param", "parameter") if kind is PortKind.PLAIN else ("field", "field")
            message = f"`{attribute}` is missing; add the name of the {noun} whose value the variable gets"
            self.report(ProblemKind.PORT_VARIABLE, variable.element.name_span, message)
            return UNKNOWN, ""
        parts = variable.field.value.split(".")
        parameter = prefix + "__".join(parts)
        if data is None:
            return _declared(variable), parameter
        type_: Type | None = data
        for part in parts:
            type_ = type_.member(part) if isinstance(type_, Struct) else None
            if type_ is None:
                known = list(_leaf_paths(data))
                close = close_names(variable.field.value, known) or (tuple(known) if len(known) == 1 else ())
                noun = "parameter" if kind is PortKind.PLAIN else "field"
                whole = f"`{data.name}`" if data.name else data.what
                hint = alternatives(close, known, noun)
                message = f"{whole} has no {noun} `{variable.field.value}`{hint}"
                self.report(ProblemKind.PORT_VARIABLE, variable.field.span, message, close)
                return _declared(variable), parameter
        if isinstance(type_, Struct):
            message = (
                f"`{variable.field.value}` is a message; write the path of one of its fields, such as `position.x`"
            )
            self.report(ProblemKind.PORT_VARIABLE, variable.field.span, message)
            return UNKNOWN, parameter
        assert type_ is not None
        if not prefix and (type_ == UNKNOWN or _same_kind(_declared(variable), type_)):
            # A parameter of a plain event has the type of the sent value, which need not be the declared type.
            return _declared(variable), parameter
        if variable.type is not None and type_ != UNKNOWN and variable.type.text != str(type_):
            message = f"the type of `{variable.field.value}` is `{type_}`, not `{variable.type.text}`"
            harmless = _contains(_declared(variable), type_)
            if harmless:
                message += f"; the variable has the values of `{type_}`"
            self.report(ProblemKind.PORT_VARIABLE, variable.type.span, message, (str(type_),), harmless=harmless)
        return type_, parameter


def observed_names(file: PropertyFile) -> Iterator[str]:
    """The names of the flags (`EVENT.valid`) of the topics and plain events that the ports of a file listen to. They
    can be determined without a system."""
    for port in file.ports:
        if port.name is not None and port.kind in (PortKind.TOPIC, PortKind.PLAIN):
            name = topic_message(port.name.value) if port.kind is PortKind.TOPIC else port.name.value
            yield flag_of(name)


def part_of(port: Port, find: Callable[[str, str], InterfaceType | None]) -> Struct | None:
    """The struct of the message, or of the part of a service or action, that a port of a ROS interface listens to;
    `None` if its type or part is not known, or if the part has no fields."""
    part = _PARTS.get(port.part) if port.part is not None and port.kind in INTERFACE_KINDS else None
    type_ = find(INTERFACE_KINDS[port.kind], port.type.value) if part is not None and port.type is not None else None
    return None if type_ is None or part is None else type_.part(part)


def _declared(variable: PortVariable) -> Type:
    """The type in the attribute `type` if it is a base type; otherwise `UNKNOWN`."""
    name = variable.type.name if variable.type else None
    return BASE_TYPES.get(name.base, UNKNOWN) if name and not name.dimensions else UNKNOWN


def _contains(declared: Type, of_field: Type) -> bool:
    """Whether a variable that is declared with another type than its field behaves as declared: numbers of the field
    are numbers of the declared type, or the variable is declared as an integer and the field is a real number, whose
    fraction the variable keeps."""
    if not (is_number(declared) and is_number(of_field)):
        return False
    outer, inner = INTEGER_RANGES.get(str(declared)), INTEGER_RANGES.get(str(of_field))
    if outer is not None and inner is not None:
        return bool(outer[0] <= inner[0] and inner[1] <= outer[1])
    return outer is not None or inner is not None or str(declared) == "float64"


def _same_kind(left: Type, right: Type) -> bool:
    return getattr(left, "kind", None) == getattr(right, "kind", "")


def _leaf_paths(data: Struct) -> Iterator[str]:
    for name, type_ in data.members:
        if isinstance(type_, Struct):
            yield from (f"{name}.{path}" for path in _leaf_paths(type_))
        else:
            yield name


def names_of(automaton: SystemAutomaton) -> tuple[str, ...]:
    """The names by which a port may select an automaton: the names of its node and its machine, and its own name."""
    names = [automaton.name]
    if automaton.instance is not None:
        names = [automaton.instance.name, automaton.outline.name, *names]
    return tuple(dict.fromkeys(name for name in names if name))


def _written_names(channel: Channel, kind: PortKind) -> Iterator[str]:
    for endpoint in channel.endpoints:
        name = endpoint.automaton.interface_name(endpoint.use)
        if name is not None:
            yield name
    if kind is PortKind.TOPIC and channel.name == CLOCK_TOPIC:
        yield CLOCK_TOPIC


def _article(word: str) -> str:
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"


def _either(names: Iterable[str]) -> str:
    return " or ".join(f"`{name}`" for name in names)


def _last(name: str) -> str:
    """The last part of the name of an interface."""
    return name.rpartition("/")[2]
