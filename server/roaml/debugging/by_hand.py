# SPDX-License-Identifier: Apache-2.0
"""Changes of a run by the user: a message is published, a service is called, or a variable or a blackboard entry is
set."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any

from roaml.debugging.breakpoints import WatchedVariable
from roaml.debugging.evaluate import WatchError
from roaml.debugging.sources import Sources
from roaml.debugging.values import SEPARATOR, Value, bytes_of, nested, shown, type_of
from roaml.expr.types import INTEGER_RANGES, Array, Scalar, ScalarKind, Struct, Type, leaves
from roaml.record import Record
from roaml.scxml.names import (
    FIELD_PREFIX,
    flag_of,
    is_blackboard_event,
    is_timer,
    read_tree_event,
    sent_by,
)
from roaml.simulation.intervention import Intervention
from roaml.simulation.session import Session
from roaml.smc.record import Plain, RecordedVariable
from roaml.suggest import alternatives, close_names
from roaml.views.event_words import event_phrase, interface_name


class Sendable(Record, frozen=True):
    """An event that the user can send.

    Attributes:
        event: the name of the event in plain SCXML.
        name: the topic, service or action; for a plain event, its name.
        text: a description such as "a message on the topic `/level`".
        template: the fields with the values that they have if they are omitted.
        types: the types of the fields.
        is_free: whether the previous event of this name has been received, so that another one can be sent.
    """

    event: str
    name: str
    text: str
    template: Mapping[str, Value]
    types: Mapping[str, str]
    is_free: bool


def sendable(session: Session, sources: Sources) -> Iterator[Sendable]:
    """The events that the user can send, ordered by name: messages, requests, goals, and plain events. Events of the
    tree, of timers, of the clock and of the blackboard cannot be sent."""
    automata = session.automata
    events = {sent_by(action or "") for action in session.actions} - {""}
    forms = []
    for event in events:
        if _is_internal(event) or any(variable.startswith(f"{event}{SEPARATOR}") for variable in session.clock):
            continue
        types = dict(_parameters(sources, event))
        template = {name: _default(type_) for name, type_ in types.items()}
        name = interface_name(event, automata) or event
        text = event_phrase(event, automata)
        client = event.partition("_client_")[2]
        text += f" for {client}" if client in automata else ""
        names = {name: str(type_) for name, type_ in types.items()}
        forms.append(Sendable(event, name, text, nested(template), names, session.is_free(event)))
    yield from sorted(forms, key=lambda form: (form.name, form.event))


def _is_internal(event: str) -> bool:
    return is_blackboard_event(event) or is_timer(event) or read_tree_event(event) is not None


def sending(session: Session, sources: Sources, name: str, fields: Value) -> Intervention:
    """The change of the state of the model by which an event is sent.

    Args:
        name: the event; or the topic, service or action, if only one of its events can be sent.
        fields: an object; a field that is omitted is 0, false or empty.

    Raises:
        WatchError: there is no such event, or there are several; the previous event has not been received; a field does
            not exist or does not have its type.
    """
    if not isinstance(fields, dict):
        raise WatchError(f"the fields must be an object such as {{data: 1}}, not {shown(fields)}")
    forms = list(sendable(session, sources))
    matches = [form for form in forms if form.event == name]
    matches = matches or [form for form in forms if form.name in (name, f"/{name}")]
    if len(matches) > 1 and any("_req" in form.event for form in matches):
        matches = [form for form in matches if "_req_client_" in form.event]
    if not matches:
        names = list(dict.fromkeys(form.name for form in forms))
        hint = alternatives(close_names(name, names), names, "name")
        raise WatchError(f"no message can be sent to `{name}`: there is no such topic, service, action or event{hint}")
    if len(matches) > 1:
        raise WatchError(f"`{name}` has several events; use one of {', '.join(f'`{form.event}`' for form in matches)}")
    (form,) = matches
    if not form.is_free:
        raise WatchError(f"{form.text} has been sent but not received yet; continue until it is received")
    return Intervention(form.event, tuple(_written(session, sources, form, fields)))


def setting(session: Session, sources: Sources, variable: WatchedVariable, value: Value) -> Intervention:
    """The change of the state that sets a variable or a blackboard entry.

    Raises:
        WatchError: the value does not have the type of the variable, or is too large for it.
    """
    current = _stored(session, variable.instance)
    automaton = None if variable.instance < 0 else session.automata_of_model[variable.instance]
    path = variable.name.split(SEPARATOR)
    type_ = None if automaton is None else sources.variable_types(automaton).get(path[0])
    for member in path[1:]:
        type_ = dict(type_.members).get(member) if isinstance(type_, Struct) else None
    cells = _Cells(current)
    cells.set(variable.name, type_, value, (), variable.name.replace(SEPARATOR, "."))
    return Intervention("", tuple(cells.changes(variable.instance)))


def _written(
    session: Session, sources: Sources, form: Sendable, fields: dict[str, Value]
) -> Iterator[tuple[RecordedVariable, Plain]]:
    cells = _Cells(_stored(session, -1))
    types = _parameters(sources, form.event)
    _check_members(fields, form.template, "")
    for name, type_ in types.items():
        value: Value | None = fields
        for member in name.split(SEPARATOR):
            value = value.get(member) if isinstance(value, dict) else None
        path = name.replace(SEPARATOR, ".")
        for prefix in (FIELD_PREFIX, ""):
            if cells.has(f"{form.event}{SEPARATOR}{prefix}{name}"):
                cells.set(f"{form.event}{SEPARATOR}{prefix}{name}", type_, value, (), path)
                break
    valid = flag_of(form.event)
    if cells.has(valid):
        cells.set(valid, None, True, (), valid)
    yield from cells.changes(-1)


def _check_members(fields: Mapping[str, Value], known: Mapping[str, Value], path: str) -> None:
    for name, value in fields.items():
        if name not in known:
            hint = alternatives(close_names(name, known), known, "field") if known else "; it has no fields"
            raise WatchError(f"there is no field `{path}{name}`{hint}")
        inner = known[name]
        if isinstance(inner, dict) and isinstance(value, dict):
            _check_members(value, inner, f"{path}{name}.")


def _parameters(sources: Sources, event: str) -> Mapping[str, Type]:
    """The types of the parameters of an event, by their names in the interface."""
    types = sources.declared_parameters.get(event, {})
    return {name.removeprefix(FIELD_PREFIX): type_ for name, type_ in types.items()}


def _default(type_: Type) -> Value:
    match type_:
        case Struct():
            return {name: _default(inner) for name, inner in type_.members}
        case Scalar(kind=ScalarKind.BOOL):
            return False
        case Scalar(kind=ScalarKind.STRING):
            return ""
        case Scalar(kind=ScalarKind.REAL):
            return 0.0
        case Scalar():
            return 0
    return []


def _stored(session: Session, instance: int) -> dict[str, Plain]:
    return {variable.name: value for variable, value in session.values() if variable.instance == instance}


class _Cells:
    """The variables of an instance, with the new values of those that are changed."""

    def __init__(self, stored: dict[str, Plain]) -> None:
        self._stored = stored
        self._changed: dict[str, Plain] = {}

    def has(self, name: str) -> bool:
        return name in self._stored or any(stored.startswith(f"{name}{SEPARATOR}") for stored in self._stored)

    def changes(self, instance: int) -> Iterator[tuple[RecordedVariable, Plain]]:
        return ((RecordedVariable(instance, name), value) for name, value in self._changed.items())

    def set(self, name: str, type_: Type | None, value: Value | None, index: tuple[int, ...], path: str) -> None:
        """Set a variable, or an element of it. Without a value, it becomes 0, false or empty.

        Args:
            path: the name of the variable that messages show.

        Raises:
            WatchError: the value does not have the type of the variable, or is too large for it.
        """
        if isinstance(type_, Struct):
            members: dict[str, Value] = {} if value is None else _expect(value, dict, path, "an object")
            _check_members(members, dict.fromkeys((member for member, _ in type_.members), 0), f"{path}.")
            for member, inner in type_.members:
                self.set(f"{name}{SEPARATOR}{member}", inner, members.get(member), index, f"{path}.{member}")
        elif isinstance(type_, Array):
            elements: list[Any] = [] if value is None else _expect(value, list, path, "an array")
            self._set_array(name, type_, elements, index, path)
        else:
            self._set_leaf(name, type_, value, index, path)

    def _set_array(self, name: str, type_: Array, elements: list[Value], index: tuple[int, ...], path: str) -> None:
        element = type_.element
        names = [name + "".join(SEPARATOR + member for member in leaf) for leaf, _ in leaves(element)]
        capacity = self._capacity(names[0] if names else name, index)
        if len(elements) > capacity:
            raise WatchError(f"`{path}` has space for {capacity} elements, not for {len(elements)}")
        for leaf in names:
            self._set_length(leaf, len(elements), index)
        for number in range(capacity):
            value = elements[number] if number < len(elements) else None
            self.set(name, element, value, (*index, number), f"{path}[{number}]")

    def _set_leaf(self, name: str, type_: Type | None, value: Value | None, index: tuple[int, ...], path: str) -> None:
        old = self._at(name, index)
        if isinstance(old, list):
            codes: list[Any]
            if isinstance(value, list):
                codes = value
            else:
                codes = [*bytes_of(_expect("" if value is None else value, str, path, "a string"))]
            if len(codes) > len(old):
                raise WatchError(f"`{path}` has space for {len(old)} elements, not for {len(codes)}")
            self._set_length(name, len(codes), index)
            for number, element in enumerate(itertools.chain(codes, [0] * (len(old) - len(codes)))):
                self._put(name, (*index, number), element)
            return
        if value is None:
            value = False if isinstance(old, bool) else 0
        if isinstance(old, bool):
            _expect(value, bool, path, "a boolean")
        elif isinstance(value, bool) or not isinstance(value, (int, float)):
            raise WatchError(f"`{path}` must be a number, not {shown(value)}")
        elif isinstance(old, float):
            value = float(value)
        else:
            if value != int(value):
                raise WatchError(f"`{path}` must be an integer, not {shown(value)}")
            value = int(value)
            low, high = INTEGER_RANGES.get(str(type_), (-(2**63), 2**63 - 1))
            if not low <= value <= high:
                raise WatchError(f"`{path}` must be from {low} to {high}, not {value}")
        assert isinstance(value, (bool, int, float))
        self._put(name, index, value)

    def _capacity(self, name: str, index: tuple[int, ...]) -> int:
        value = self._at(name, index)
        return len(value) if isinstance(value, list) else 0

    def _set_length(self, name: str, length: int, index: tuple[int, ...]) -> None:
        variable = f"{name}.d{len(index) + 1}_len"
        if variable in self._stored:
            self._put(variable, index, length)

    def _at(self, name: str, index: tuple[int, ...]) -> Plain:
        if name not in self._stored:
            raise WatchError(f"`{name}` is not a variable of the model")
        value = self._stored[name]
        for number in index:
            assert isinstance(value, list)
            value = value[number]
        return value

    def _put(self, name: str, index: tuple[int, ...], value: Plain) -> None:
        self._changed[name] = _replaced(self._changed.get(name, self._stored[name]), index, value)


def _replaced(whole: Plain, index: tuple[int, ...], value: Plain) -> Plain:
    if not index:
        return value
    assert isinstance(whole, list)
    return [
        _replaced(element, index[1:], value) if number == index[0] else element for number, element in enumerate(whole)
    ]


def _expect(value: Value, type_: type, path: str, what: str) -> Any:
    if not isinstance(value, type_):
        raise WatchError(f"`{path}` must be {what}, not {shown(value)} ({type_of(value)})")
    return value
