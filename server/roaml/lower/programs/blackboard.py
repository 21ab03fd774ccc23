# SPDX-License-Identifier: Apache-2.0
"""The automaton that stores the blackboard of a tree that is executed as BehaviorTree.CPP executes it."""

from __future__ import annotations

from roaml.expr.types import BASE_TYPES
from roaml.lower.blackboard_events import ANSWER, REQUEST, blackboard_write
from roaml.lower.build import event_data, integer, name
from roaml.lower.programs.board import Board
from roaml.lower.programs.entries import BoardEntry
from roaml.scxml.events import Role
from roaml.scxml.model import Assign, Automaton, Data, Param, Send, State, Target, Transition
from roaml.scxml.names import BLACKBOARD
from roaml.text import Location


def board_automaton(board: Board, origin: Location, *, is_read: bool) -> Automaton | None:
    """The automaton that stores the entries of a blackboard; `None` if there are none.

    Args:
        is_read: whether a node reads an entry.
    """
    entries = [*board.entries.values(), *board.flag_of.values()]
    if not entries:
        return None
    data = tuple(Data(entry.variable, BASE_TYPES[entry.type_name], entry.start, origin) for entry in entries)
    writes = [
        Transition(
            blackboard_write(entry.variable),
            None,
            (Target("idle", 1.0, _stored(board, entry, origin), origin),),
            origin,
        )
        for entry in entries
    ]
    answer = Send(ANSWER, tuple(Param(entry.variable, name(entry.variable), origin) for entry in entries), origin)
    asked = Transition(REQUEST, None, (Target("idle", 1.0, (answer,), origin),), origin)
    idle = State("idle", (), (), (*writes, asked) if is_read else tuple(writes), origin)
    return Automaton(BLACKBOARD, Role.BLACKBOARD, "idle", data, (idle,), origin)


def _stored(board: Board, entry: BoardEntry, origin: Location) -> tuple[Assign, ...]:
    """The assignments of the blackboard when an entry is written: its value, and the flags of the nodes that observe
    it."""
    flags = board.flags.get(entry.variable, ())
    return (
        Assign(name(entry.variable), event_data("value"), origin),
        *(Assign(name(flag.variable), integer(1), origin) for flag in flags),
    )
