# SPDX-License-Identifier: Apache-2.0
"""A state that no longer changes: the locations of all automata, and their enabled edges."""

from __future__ import annotations

from roaml.jani.model import Automaton, Edge, System
from roaml.record import Record


class Standstill(Record, frozen=True):
    """The state in which a trace does not change any more.

    Attributes:
        automata: the automaton of each element of the system.
        locations: the current location of each element.
        enabled: for each element, the edges of the current location whose guards hold.
        system: the composition of the elements, with their synchronisations.
    """

    automata: tuple[Automaton, ...]
    locations: tuple[str, ...]
    enabled: tuple[tuple[Edge, ...], ...]
    system: System
