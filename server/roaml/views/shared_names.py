# SPDX-License-Identifier: Apache-2.0
"""Names for users of the variables that the automata of a translated system share: fields of messages, and what the
observers of properties remember."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from roaml.scxml.events import EventRole
from roaml.scxml.names import (
    FIELD_PREFIX,
    FLAG,
    InterfaceEventKind,
    client_of,
    flagged_by,
    is_blackboard_answer,
    read_interface_event,
    read_tree_event,
    role_of,
    without_client,
)
from roaml.views.observed import observer_phrase

_SEPARATOR = "__"
_INTERNAL = (InterfaceEventKind.THREAD_START, InterfaceEventKind.THREAD_FREE)


def shared_names(variables: Iterable[str], automata: Mapping[str, str]) -> dict[str, str]:
    """The variable -> its name for users: `/arm/command.data` for a field of the last message of a topic,
    `/arm/command: valid` for whether there is one, `Deliver (bt_1004): /hand_over response.success` for what a client
    of a service has received, and `block_placed: violated` for what an observer remembers. Other variables have the
    name that they have in JANI, and so have those whose names would be equal.

    Args:
        automata: the names of all automata, with their names for users (`roaml.views.actors.names_of`).
    """
    names = {variable: _name(variable, automata) or variable for variable in variables}
    count = Counter(names.values())
    return {variable: name if count[name] == 1 else variable for variable, name in names.items()}


def _name(variable: str, automata: Mapping[str, str]) -> str:
    event, field, ending = flagged_by(variable), "", f": {FLAG}"
    if not event:
        event, separator, field = variable.partition(f"{_SEPARATOR}{FIELD_PREFIX}")
        if not separator:
            event, _, field = variable.rpartition(_SEPARATOR)
        ending = ""
    name = field_name(event, field, automata)
    client = automata.get(client_of(event, automata))
    return f"{f'{client}: ' if client else ''}{name}{ending}" if name else observer_phrase(variable, automata)


def field_name(event: str, field: str, automata: Mapping[str, str]) -> str:
    """The name of a field of an event, without the client of a service or action, such as `/arm/command.data`,
    `/hand_over response.success` and, for a plain event, `event.parameter`; "" if the event is not in the user's model.

    Args:
        field: the name of the field in JANI; "" for the event itself.
        automata: the names of all automata.
    """
    path = f".{field.replace(_SEPARATOR, '.')}" if field else ""
    interface = read_interface_event(event, automata)
    if interface is None:
        is_plain = role_of(event) is EventRole.PLAIN and not is_blackboard_answer(event)
        is_plain = is_plain and read_tree_event(event) is None
        return f"{without_client(event, client_of(event, automata))}{path}" if is_plain and event in automata else ""
    if interface.kind in _INTERNAL:
        return ""
    part = "" if interface.kind is InterfaceEventKind.MESSAGE else f" {interface.kind.value}"
    return f"/{interface.name.replace(_SEPARATOR, '/')}{part}{path}"
