# SPDX-License-Identifier: Apache-2.0
"""The automaton that stores the blackboard of a tree that is executed as BehaviorTree.CPP executes it."""

from __future__ import annotations

from roaml.expr.types import BASE_TYPES
from roaml.lower.blackboard_automaton import blackboard_automaton
from roaml.lower.programs.board import Board
from roaml.model.expand import is_on_board
from roaml.scxml.model import Automaton, Data
from roaml.text import Location


def board_automaton(board: Board, origin: Location, *, is_read: bool, tree: str = "") -> Automaton | None:
    """The automaton that stores the entries of the blackboard of a tree, and the flags of the nodes that observe an
    entry; `None` if there are none.

    Args:
        tree: the name of the tree in the system; "" if it has none.
        is_read: whether a node reads an entry.
    """
    all_entries = (*board.entries.values(), *board.flag_of.values())
    entries = [entry for entry in all_entries if is_on_board(entry.variable, tree)]
    if not entries:
        return None
    data = [Data(entry.variable, BASE_TYPES[entry.type_name], entry.start, origin) for entry in entries]
    flags = {entry: [flag.variable for flag in observers] for entry, observers in board.flags.items()}
    return blackboard_automaton(data, flags, origin, is_read=is_read, tree=tree)
