# SPDX-License-Identifier: Apache-2.0
"""Names for users of the variables of an automaton: members of structs, and variables that the translation has
added."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from roaml.jani.model import Automaton
from roaml.jani.node import Origin
from roaml.scxml.names import CONDITIONS_PREFIX, ENTRY_PREFIX, entry_name, is_length
from roaml.views.event_words import goal_phrases
from roaml.views.library_nodes import is_library_node

_SEPARATOR = "__"
"""Separates the members of a struct in the name of a variable (docs/spec/jani.md#array-storage)."""


def variable_phrases(automaton: Automaton, is_event: Callable[[str], bool]) -> Mapping[str, str]:
    """Phrases for those variables of an automaton whose names are not those of the user, by their names: `pose.x` for a
    member of a struct, `executes goal 0 of /drive`, and `{load}` for the value of a blackboard entry that a node of a
    library has read.

    Args:
        is_event: whether a name denotes an event of the system.
    """
    names = [variable.name for variable in automaton.variables]
    if is_library_node(automaton) or automaton.name.startswith(CONDITIONS_PREFIX):
        return {name: entry_phrase(name) for name in names if name.startswith(ENTRY_PREFIX)}
    return {**dict(_members(automaton)), **goal_phrases(names, is_event)}


def entry_phrase(name: str) -> str:
    """A phrase for the variable with the value of a blackboard entry, such as `{load}`."""
    return entry_name(name.removeprefix(ENTRY_PREFIX), ("{", "}"))


def _members(automaton: Automaton) -> Iterator[tuple[str, str]]:
    """The members of structs. The variables of a struct have the place of its declaration in common."""
    declared: dict[Origin, list[str]] = {}
    for variable in automaton.variables:
        if variable.origin is not None and not is_length(variable.name):
            declared.setdefault(variable.origin, []).append(variable.name)
    for names in declared.values():
        owners = {name.partition(_SEPARATOR)[0] for name in names}
        if len(names) > 1 and len(owners) == 1:
            yield from ((name, name.replace(_SEPARATOR, ".")) for name in names)
