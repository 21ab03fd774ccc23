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
    NODE_AUTOMATON,
    InterfaceEventKind,
    array_of,
    client_of,
    entry_name,
    flagged_by,
    is_acceptance,
    is_blackboard_answer,
    length_name,
    read_interface_event,
    read_tree_event,
    role_of,
    tree_event_name,
    without_client,
    written_entry,
)
from roaml.views.observed import observer_phrase

_SEPARATOR = "__"
_FLAGGED, _LENGTH = f": {FLAG}", ": length"
_ENDINGS = (_FLAGGED, _LENGTH)
_INTERNAL = (InterfaceEventKind.THREAD_START, InterfaceEventKind.THREAD_FREE)


def shared_names(variables: Iterable[str], automata: Mapping[str, str]) -> dict[str, str]:
    """The variable -> its name for users: `/arm/command.data` for a field of the last message of a topic,
    `/arm/command: valid` for whether there is one, `Deliver (bt_1004): /hand_over response.success` for what a client
    of a service has received, `Deliver.status` for what a node of the tree has returned last, `{load}` for the value of
    a blackboard entry that was read last, and `block_placed: violated` for what an observer remembers. Other variables
    have the name that they have in JANI, and so have those whose names would be equal.

    Args:
        automata: the names of all automata, with their names for users (`roaml.views.actors.names_of`).
    """
    nodes = {match[1]: name for own, name in automata.items() if (match := NODE_AUTOMATON.fullmatch(own))}
    names = {variable: _name(variable, automata, nodes) or variable for variable in variables}
    count = Counter(names.values())
    return {variable: name if count[name] == 1 else variable for variable, name in names.items()}


def operand_names(variables: Iterable[str], automata: Mapping[str, str]) -> dict[str, str]:
    """The variable -> its name for users as a part of an expression, in which nothing follows a colon, such as
    `/arm/command.valid`; otherwise as `shared_names`."""
    return {v: ".".join(name.rsplit(": ", 1)) if name.endswith(_ENDINGS) else name
            for v, name in shared_names(variables, automata).items()}  # fmt: skip


def read_names(variables: Iterable[str], automata: Mapping[str, str]) -> list[str]:
    """The names for users of variables that a property reads, without those of flags beside a field of the same event.

    Args:
        automata: as for `shared_names`.
    """
    names = [name.removesuffix(_FLAGGED) for name in shared_names(variables, automata).values()]
    return [name for name in dict.fromkeys(names) if not any(other.startswith(f"{name}.") for other in names)]


def _name(variable: str, automata: Mapping[str, str], nodes: Mapping[str, str]) -> str:
    """The name of a variable for users; "" if it has none.

    Args:
        nodes: the number of each node of the tree, with its name for users.
    """
    if array := array_of(variable):
        name = _name(array, automata, nodes) if variable == length_name(array, 1) else ""
        return f"{name}{_LENGTH}" if name else ""
    event, field, ending = flagged_by(variable), "", _FLAGGED
    if not event:
        event, separator, field = variable.partition(f"{_SEPARATOR}{FIELD_PREFIX}")
        if not separator:
            event, _, field = variable.rpartition(_SEPARATOR)
        ending = ""
    if node := _of_node(event, field, nodes) or _of_blackboard(event, field):
        return f"{node}{ending}"
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
    if interface.kind is InterfaceEventKind.GOAL_ANSWER:
        part = f" goal {'acceptance' if is_acceptance(event, client_of(event, automata)) else 'rejection'}"
    return f"/{interface.name.replace(_SEPARATOR, '/')}{part}{path}"


def _of_node(event: str, field: str, nodes: Mapping[str, str]) -> str:
    """The name of an event between a node of the tree and its parent, or of the status in it; "" for other events, and
    for those between a node and the automaton that evaluates its conditions."""
    tree = read_tree_event(event)
    if tree is None or event != tree_event_name(tree.number, tree.kind) or str(tree.number) not in nodes:
        return ""
    node = nodes[str(tree.number)]
    return f"{node}.{field}" if field else f"{node} {tree.kind.value.replace('_', ' ')}"


def _of_blackboard(event: str, field: str) -> str:
    """The name of the value of a blackboard entry that was read or written last; "" for other events."""
    if is_blackboard_answer(event) and field:
        return entry_name(field, ("{", "}"))
    entry = written_entry(event)
    return f"{entry_name(entry, ('{', '}'))} written" if entry else ""
