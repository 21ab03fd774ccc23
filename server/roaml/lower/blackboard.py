# SPDX-License-Identifier: Apache-2.0
"""The automaton that stores the blackboard (docs/spec/plain-scxml.md#blackboard)."""

from __future__ import annotations

from roaml.expr.types import BASE_TYPES
from roaml.expr.zero import zero
from roaml.lower.blackboard_events import ANSWER, REQUEST, blackboard_write
from roaml.lower.build import event_data, name
from roaml.lower.program import TranslatableSystem
from roaml.lower.programs.blackboard import board_automaton
from roaml.model.expand import ROOT_NUMBER
from roaml.scxml.events import Role
from roaml.scxml.model import Assign, Automaton, Data, Param, Send, State, Target, Transition
from roaml.scxml.names import BLACKBOARD
from roaml.text import Location


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


def _place(program: TranslatableSystem, variable: str) -> Location:
    """The place of the first node that uses a variable."""
    instance = program.system.blackboard[variable][0].automaton.instance
    return program.node(instance.number if instance else 0)
