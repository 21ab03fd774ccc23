# SPDX-License-Identifier: Apache-2.0
"""A state that does not change any more: the locations of all automata, and what each could do with the others."""

from __future__ import annotations

from dataclasses import dataclass

from roaml.jani.model import Automaton, Edge, System


@dataclass(frozen=True, slots=True)
class Standstill:
    """
    Attributes:
        automata: that of each element of the system.
        locations: where each of them is.
        enabled: the edges there whose guards hold, of each of them.
    """

    automata: tuple[Automaton, ...]
    locations: tuple[str, ...]
    enabled: tuple[tuple[Edge, ...], ...]
    system: System
