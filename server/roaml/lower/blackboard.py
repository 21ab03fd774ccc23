# SPDX-License-Identifier: Apache-2.0
"""The automaton that stores the blackboard (docs/spec/plain-scxml.md#blackboard)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roaml.expr.types import BASE_TYPES
from roaml.expr.zero import zero
from roaml.lower.build import event_data, integer, name
from roaml.lower.program import TranslatableSystem
from roaml.model.expand import ROOT_NUMBER
from roaml.scxml.events import EventRole, Role, ScxmlEvent
from roaml.scxml.model import Assign, Automaton, Data, Param, Send, State, Target, Transition
from roaml.scxml.names import BLACKBOARD, BLACKBOARD_ANSWER, BLACKBOARD_REQUEST, BLACKBOARD_WRITE_PREFIX
from roaml.text import Location

if TYPE_CHECKING:
    from roaml.lower.programs.board import Board
    from roaml.lower.programs.entries import BoardEntry

REQUEST = ScxmlEvent(BLACKBOARD_REQUEST, EventRole.BLACKBOARD_READ)
ANSWER = ScxmlEvent(BLACKBOARD_ANSWER)


def blackboard_write(variable: str) -> ScxmlEvent:
    return ScxmlEvent(f"{BLACKBOARD_WRITE_PREFIX}{variable}", EventRole.BLACKBOARD_WRITE)


def blackboard(program: TranslatableSystem) -> Automaton | None:
    """The automaton that stores the blackboard of a system; `None` if the tree uses no variables."""
    system = program.system
    if program.library is not None:
        return board_automaton(
            program.library.board, program.node(ROOT_NUMBER), is_read=program.system.reads_blackboard
        )
    variables = {variable: BASE_TYPES[system.variable_type(variable)] for variable in system.blackboard}
    if not variables:
        return None
    places = {variable: _place(program, variable) for variable in variables}
    data = tuple(Data(v, type_, zero(type_), places[v]) for v, type_ in variables.items())
    origin = next(iter(places.values()))
    writes = tuple(
        Transition(
            blackboard_write(v),
            None,
            (Target("idle", 1.0, (Assign(name(v), event_data("value"), places[v]),), places[v]),),
            places[v],
        )
        for v in variables
    )
    answer = Send(ANSWER, tuple(Param(v, name(v), places[v]) for v in variables), origin)
    asked = Transition(REQUEST, None, (Target("idle", 1.0, (answer,), origin),), origin)
    idle = State("idle", (), (), (*writes, asked) if system.reads_blackboard else writes, origin)
    return Automaton(BLACKBOARD, Role.BLACKBOARD, "idle", data, (idle,), origin)


def board_automaton(board: Board, origin: Location, *, is_read: bool) -> Automaton | None:
    """The automaton that stores the entries of a tree that is executed as BehaviorTree.CPP executes it; `None` if there
    are none.

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


def _place(program: TranslatableSystem, variable: str) -> Location:
    """The place of the first node that uses a variable."""
    instance = program.system.blackboard[variable][0].automaton.instance
    return program.node(instance.number if instance else 0)
