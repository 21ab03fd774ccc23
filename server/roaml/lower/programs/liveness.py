# SPDX-License-Identifier: Apache-2.0
"""Finds the variables of the program of a node whose values can still be read (docs/spec/mocks.md#nodes).

The automaton of a node has separate states for all values of the variables that are known during the translation.
Values that are never read again must not separate states.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator, Mapping

from roaml.libraries.programs import assembly
from roaml.libraries.programs.assembly import CodeLabel, Instruction, NodeProgram
from roaml.lower.programs.steps import Place
from roaml.record import astuple

_END: Place = ("end", 0)
"""The place at which the node waits for its parent."""

_AFTER_SEGMENT: Mapping[str, tuple[Place, ...]] = {
    "before": (("tick", 0),),
    "tick": (),
    "after": (_END,),
    "halt": (("halted", 0), _END),
    "halted": (("after", 0), _END),
}
"""Segment -> the places at which the execution can continue after its last instruction."""


@functools.lru_cache(maxsize=1024)
def live_variables(program: NodeProgram, given: frozenset[str]) -> Mapping[Place, frozenset[str]]:
    """Place in the code of a node that has the conditions and scripts `given` -> the variables that may be read from
    there on before they are assigned. While the node waits for its parent, these are `status` and `program.fixed`."""
    code = assembly.segments(program, given)
    live: dict[Place, frozenset[str]] = {_END: frozenset(("status", *program.fixed))}
    changed = True
    while changed:
        changed = False
        for segment, instructions in code.items():
            for index in range(len(instructions), -1, -1):
                place = (segment, index)
                if index == len(instructions):
                    read, assigned, following = set[str](), None, _AFTER_SEGMENT[segment]
                else:
                    part = instructions[index]
                    read, assigned, following = _read(part), _assigned(part), tuple(_following(part, place))
                after = frozenset[str]().union(*(live.get(other, frozenset()) for other in following))
                now = (after - {assigned}) | read
                changed = changed or now != live.get(place)
                live[place] = now
    return live


def _read(instruction: Instruction) -> set[str]:
    expressions = (value for value in astuple(instruction) if isinstance(value, ast.expr))
    return {part.id for value in expressions for part in ast.walk(value) if isinstance(part, ast.Name)}


def _assigned(instruction: Instruction) -> str | None:
    match instruction:
        case assembly.SetVariable(target, None, _):
            return target
        case assembly.TickChild(_, target):
            return target
    return None


def _following(instruction: Instruction, place: Place) -> Iterator[Place]:
    segment, index = place
    for value in astuple(instruction):
        if isinstance(value, CodeLabel):
            yield (segment, value.index)
    match instruction:
        case assembly.Return():
            yield ("after", 0)
        case assembly.HaltSelf():
            yield ("halt", 0)
        case assembly.Jump() | assembly.Throw():
            pass
        case _:
            yield (segment, index + 1)
