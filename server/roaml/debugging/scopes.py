# SPDX-License-Identifier: Apache-2.0
"""The variables that a frame shows, and the names that its expressions can use."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import cast

from roaml.debugging.breakpoints import WatchedVariable
from roaml.debugging.evaluate import Scope
from roaml.debugging.frames import Frame
from roaml.debugging.sources import Sources
from roaml.debugging.values import SEPARATOR, Value, nested, type_of, typed_value, untyped_values
from roaml.exhaustive import Vocabulary
from roaml.record import Record, replace
from roaml.scxml.names import (
    FIELD_PREFIX,
    FLAG,
    STATUS_NAMES,
    InterfaceEventKind,
    is_blackboard,
    is_length,
    is_timer,
    read_interface_event,
    read_tree_event,
    received_by,
)
from roaml.simulation.session import Session
from roaml.simulation.state import MachineState, SystemState
from roaml.smc.record import Plain, TraceStep, TraceVerdict
from roaml.views.arrays import declared
from roaml.views.observed import observer_phrase


class ScopeEntry(Record, frozen=True):
    """A named value of a scope.

    Attributes:
        type: the declared type, or another description of the value, for users.
        expression: an expression with this value; "" if there is none.
        variable: the variable that a data breakpoint on the entry watches; `None` if it cannot have one.
    """

    name: str
    value: Value
    type: str = ""
    expression: str = ""
    variable: WatchedVariable | None = None


class ScopeHint(Vocabulary):
    """The kind of a scope, as named in DAP."""

    LOCALS = "locals"
    ARGUMENTS = "arguments"


class ScopeEntries(Record, frozen=True):
    """A scope of a frame. `hint` is its kind in DAP; `None` for a scope that all frames have."""

    name: str
    entries: tuple[ScopeEntry, ...]
    hint: ScopeHint | None = None


class Values:
    """The values at the position of a session: variables, messages, ports, statuses of nodes, and verdicts; as scopes
    of frames, and by name for expressions."""

    def __init__(
        self,
        session: Session,
        sources: Sources,
        state: SystemState,
        upcoming: TraceStep | None,
        verdicts: Mapping[str, TraceVerdict],
    ) -> None:
        self._session = session
        self._sources = sources
        self._state = state
        self._verdicts = verdicts
        self._received = "" if upcoming is None else received_by(upcoming.action or "")
        self._receivers = [] if upcoming is None else [part.instance for part in session.actors(upcoming)]
        self._stored: dict[int, dict[str, Plain]] = {}
        for (instance, name), value in session.values():
            self._stored.setdefault(instance, {})[name] = value
        self._clients = session.automata
        self._instances = {automaton.name: number for number, automaton in enumerate(session.automata_of_model)}

    # ------------------------------------------------------------ scopes

    def scopes(self, frame: Frame) -> list[ScopeEntries]:
        """The scopes of a frame that are not empty."""
        own_scopes = []
        if frame.instance >= 0:
            own_scopes.append(ScopeEntries("Variables", tuple(self._own(frame.instance)), ScopeHint.LOCALS))
            message = self.message(frame.instance)
            if message:
                entries = (ScopeEntry(name, value, type_of(value), name) for name, value in message.items())
                own_scopes.append(ScopeEntries("Message", tuple(entries), ScopeHint.ARGUMENTS))
        if frame.node:
            own_scopes.append(ScopeEntries("Ports", tuple(self._ports(frame.node)), ScopeHint.ARGUMENTS))
        own = {entry.name for scope in own_scopes if scope.hint is not None for entry in scope.entries}
        shared = (_without_expressions(scope, own) for scope in self.shared_scopes())
        return [scope for scope in (*own_scopes, *shared) if scope.entries]

    def shared_scopes(self) -> Iterator[ScopeEntries]:
        """The scopes that all frames have."""
        yield ScopeEntries("Blackboard", tuple(self._blackboard()))
        yield ScopeEntries("Tree", tuple(self._nodes()))
        yield ScopeEntries("Messages", tuple(self._messages()))
        yield ScopeEntries("Global variables", tuple(self._shared()))
        yield ScopeEntries("Time", tuple(self._time()))
        yield ScopeEntries("Properties", tuple(self._properties()))

    def machines(self) -> Iterator[tuple[MachineState, tuple[ScopeEntry, ...]]]:
        """The machines and plugins, with their variables."""
        for machine in self._state.machines:
            yield machine, tuple(self._own(self._instances[machine.automaton]))

    def _own(self, instance: int) -> Iterator[ScopeEntry]:
        stored = self._stored.get(instance, {})
        automaton = self._session.automata_of_model[instance]
        types, phrases = self._sources.variable_types(automaton), self._session.phrases(automaton.name)
        shown: set[str] = set()
        for name, type_ in types.items():
            value = typed_value(name, type_, stored)
            if value is not None and _is_stored(name, stored):
                shown |= {
                    part for part in stored if part == name or part.startswith((f"{name}{SEPARATOR}", f"{name}."))
                }
                yield ScopeEntry(name, value, str(type_), name, WatchedVariable(instance, name))
        for name, value in untyped_values({n: v for n, v in stored.items() if n not in shown}).items():
            yield ScopeEntry(phrases.get(name, name), value, type_of(value), name, WatchedVariable(instance, name))

    def _ports(self, node: int) -> Iterator[ScopeEntry]:
        for port in self._sources.nodes[node].ports:
            if not port.entry:
                yield ScopeEntry(port.name, port.text, "constant")
            else:
                value = self._blackboard_values().get(port.entry)
                yield ScopeEntry(port.name, port.text if value is None else value, f"blackboard entry {port.entry}")

    def _blackboard_values(self) -> dict[str, Value]:
        return {name: value for board in self._boards() for name, value in self._board_values(board).items()}

    def _boards(self) -> list[int]:
        """The numbers of the automata that store blackboards."""
        return [instance for name, instance in self._instances.items() if is_blackboard(name)]

    def _board_values(self, instance: int) -> dict[str, Value]:
        return untyped_values(self._stored.get(instance, {}))

    def _blackboard(self) -> Iterator[ScopeEntry]:
        for instance in self._boards():
            types = self._sources.variable_types(self._session.automata_of_model[instance])
            for name, value in self._board_values(instance).items():
                type_ = str(types.get(name, type_of(value)))
                yield ScopeEntry(name, value, type_, name, WatchedVariable(instance, name))

    def _nodes(self) -> Iterator[ScopeEntry]:
        for node in self._state.nodes:
            yield ScopeEntry(node.name, node.status.value, "status", f"bt_{node.number}")

    def _messages(self) -> Iterator[ScopeEntry]:
        for event in self._state.events:
            parameters: Value = self._parameters(event.event)
            waiting = ", not received yet" if event.is_waiting else ""
            yield ScopeEntry(event.text, parameters, f"sent by {event.sender} in step {event.step}{waiting}")

    def read_by(self, variables: Collection[str]) -> Iterator[ScopeEntry]:
        """What a property has read, given the variables of the model that it reads: the last messages whose fields or
        presence are among them, and the other variables that the user knows. For an observer of events, which decides a
        property when it sees an event, the last event that was sent."""
        read = {name.partition(f"{SEPARATOR}{FIELD_PREFIX}")[0].removesuffix(f".{FLAG}") for name in variables}
        sent = [event for event in self._state.events if event.event in read]
        if not sent and any(observer_phrase(name, self._clients) for name in variables):
            sent = sorted(self._state.events, key=lambda event: event.step)[-1:]
        for event in sent:
            yield ScopeEntry(event.text, self._parameters(event.event), f"sent by {event.sender} in step {event.step}")
        yield from (entry for entry in self._shared() if entry.name in variables)

    def _shared(self) -> Iterator[ScopeEntry]:
        stored = self._stored.get(-1, {})
        own = {name: v for name, v in stored.items() if name in self._state.shared or is_length(name)}
        for name, value in untyped_values(own).items():
            if name in self._state.shared and not observer_phrase(name, self._clients):
                yield ScopeEntry(name, value, type_of(value), name, WatchedVariable(-1, name))

    def _time(self) -> Iterator[ScopeEntry]:
        yield ScopeEntry("step", self._session.position, "number of steps", "step")
        if self._state.time is not None:
            yield ScopeEntry("time", self._state.time, "s", "time")

    def _properties(self) -> Iterator[ScopeEntry]:
        for name, verdict in self._verdicts.items():
            yield ScopeEntry(name, verdict.value, "verdict")
        for name, value in self._state.shared.items():
            if (phrase := observer_phrase(name, self._clients)) and not isinstance(value, list):
                yield ScopeEntry(phrase, value, "observer", name, WatchedVariable(-1, name))

    # ------------------------------------------------------------ messages

    def message(self, instance: int) -> dict[str, Value]:
        """The event variables of the handler that an instance executes, or is about to execute
        (docs/spec/machines.md#event-variables)."""
        name = self._session.automata_of_model[instance].name
        machine = next((machine for machine in self._state.machines if machine.automaton == name), None)
        event = self._received if instance in self._receivers else ""
        if machine is not None and machine.event:
            event = machine.event
        if not event or is_timer(event):
            return {}
        return _event_variables(event, self._parameters(event), self._clients)

    def _parameters(self, event: str) -> dict[str, Value]:
        """The parameters with which an event was last sent, as structs."""
        stored = self._stored.get(-1, {})
        types = self._sources.event_parameters.get(event, {})
        values: dict[str, Value] = {}
        prefix = f"{event}{SEPARATOR}"
        for name, type_ in types.items():
            value = typed_value(prefix + name, type_, stored)
            if value is not None:
                values[name.removeprefix(FIELD_PREFIX)] = value
        if not types:
            own = {name.removeprefix(prefix): stored[name] for name in self._session.event_variables(event)}
            values = {name.removeprefix(FIELD_PREFIX): value for name, value in untyped_values(own).items()}
        return nested(values)

    # ------------------------------------------------------------ expressions

    def entry(self, path: str, frame: Frame | None) -> ScopeEntry | None:
        """The variable or blackboard entry that an expression such as `way`, `pose.x` or `Arm.pose.x` denotes; `None`
        if there is none. Variables of the frame take precedence over those of the system."""
        own = () if frame is None or frame.instance < 0 else self._own(frame.instance)
        owned = (
            replace(entry, expression=f"{machine.identifier}.{entry.expression}")
            for machine, entries in self.machines()
            for entry in entries
        )
        entries = (*own, *self._blackboard(), *self._shared(), *owned)
        return next((found for entry in entries if (found := _member(entry, path)) is not None), None)

    def names(self, frame: Frame | None) -> Scope:
        """The values of the names that an expression can use. Names of the frame take precedence over those of the
        system."""
        known: dict[str, Value] = {status: status for status in STATUS_NAMES.values()}
        known |= {name: verdict.value for name, verdict in self._verdicts.items()}
        for entry in self._time():
            known[entry.name] = entry.value
        for machine in self._state.machines:
            instance = self._instances[machine.automaton]
            known[machine.identifier] = {**{e.expression: e.value for e in self._own(instance)}, "state": machine.state}
        known |= {entry.name: entry.value for entry in self._shared()}
        known |= {f"bt_{node.number}": node.status.value for node in self._state.nodes}
        known |= self._blackboard_values()
        if frame is not None and frame.instance >= 0:
            known |= self.message(frame.instance)
            known |= {entry.expression: entry.value for entry in self._own(frame.instance)}
        shared = self._stored.get(-1, {})
        own = known.get

        def value(name: str) -> Value | None:
            own_value = own(name)
            if own_value is not None or name not in shared:
                return own_value
            return cast("Value", declared(name, shared[name], shared))

        return value


def _without_expressions(scope: ScopeEntries, names: Collection[str]) -> ScopeEntries:
    """A scope whose entries with one of the names have no expression, because the name denotes another variable."""
    entries = (replace(entry, expression="") if entry.expression in names else entry for entry in scope.entries)
    return replace(scope, entries=tuple(entries))


def _member(entry: ScopeEntry, path: str) -> ScopeEntry | None:
    """The entry itself or the member of its struct that has a path."""
    if path == entry.expression:
        return entry
    if not path.startswith(f"{entry.expression}.") or entry.variable is None:
        return None
    value, variable = entry.value, entry.variable
    for member in path.removeprefix(f"{entry.expression}.").split("."):
        if not isinstance(value, dict) or member not in value:
            return None
        value, variable = value[member], WatchedVariable(variable.instance, f"{variable.name}{SEPARATOR}{member}")
    return ScopeEntry(path, value, "", path, variable)


def _is_stored(name: str, stored: Mapping[str, Plain]) -> bool:
    return name in stored or any(part.startswith(f"{name}{SEPARATOR}") for part in stored)


def _event_variables(event: str, parameters: dict[str, Value], clients: Collection[str]) -> dict[str, Value]:
    handle = {name: parameters.pop(name) for name in ("goal_id",) if name in parameters}
    if read_tree_event(event):
        status = parameters.get("status")
        return {"_bt": {"status": STATUS_NAMES.get(status, "")}} if isinstance(status, int) else {}
    read = read_interface_event(event, clients)
    match None if read is None else read.kind:
        case None:
            return {"_event": {"data": {**handle, **parameters}}} if parameters or handle else {}
        case InterfaceEventKind.MESSAGE:
            return {"_msg": parameters}
        case InterfaceEventKind.REQUEST:
            return {"_req": parameters}
        case InterfaceEventKind.RESPONSE:
            return {"_res": parameters}
        case InterfaceEventKind.CANCEL:
            return {"_action": dict(handle)}
        case kind:
            return _action_variables(kind, handle, parameters)


def _action_variables(
    kind: InterfaceEventKind, handle: dict[str, Value], parameters: dict[str, Value]
) -> dict[str, Value]:
    action: dict[str, Value] = {"_action": dict(handle)} if handle else {}
    if kind is InterfaceEventKind.RESULT:
        code = {"code": parameters.pop("code")} if "code" in parameters else {}
        return {**action, "_wrapped_result": {**code, "result": parameters}}
    if kind is InterfaceEventKind.FEEDBACK:
        return {**action, "_feedback": parameters}
    return {**action, "_goal": parameters} if parameters else action
