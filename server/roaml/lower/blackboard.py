# SPDX-License-Identifier: Apache-2.0
"""The automaton that stores the blackboard (docs/spec/plain-scxml.md#blackboard)."""

from __future__ import annotations

from roaml.expr.types import BASE_TYPES
from roaml.expr.zero import zero
from roaml.lower.blackboard_automaton import blackboard_automaton
from roaml.lower.program import TranslatableSystem
from roaml.lower.programs.blackboard import board_automaton
from roaml.model.expand import Instance, is_on_board
from roaml.scxml.model import Automaton, Data
from roaml.text import Location


def blackboard(program: TranslatableSystem, root: Instance) -> Automaton | None:
    """The automaton that stores the blackboard of a tree; `None` if the tree uses no variables."""
    system, tree = program.system, root.tree
    is_read = system.reads_blackboard(tree)
    if program.library is not None:
        return board_automaton(program.library.board, program.node(root.number), is_read=is_read, tree=tree)
    names = (variable for variable in system.blackboard if is_on_board(variable, tree))
    variables = {variable: BASE_TYPES[system.variable_type(variable)] for variable in names}
    if not variables:
        return None
    data = [Data(v, type_, zero(type_), _place(program, v)) for v, type_ in variables.items()]
    return blackboard_automaton(data, {}, data[0].origin, is_read=is_read, tree=tree)


def _place(program: TranslatableSystem, variable: str) -> Location:
    """The place of the first node that uses a variable."""
    instance = program.system.blackboard[variable][0].automaton.instance
    return program.node(instance.number if instance else 0)
