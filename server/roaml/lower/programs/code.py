# SPDX-License-Identifier: Apache-2.0
"""The input for the automaton of a node of a tree: its program, its children, and the values of its ports."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from fractions import Fraction
from typing import TypeAlias

from roaml.expr.tree import Expr
from roaml.expr.types import BASE_TYPES, Type
from roaml.libraries.programs.assembly import NodeProgram
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS, Known
from roaml.lower.programs.entries import BoardEntry, EntryKind
from roaml.lower.programs.scripts import CompiledScript
from roaml.record import Record
from roaml.text import Location

Value: TypeAlias = "Known | Expr"

TYPES: Mapping[EntryKind, Type] = {
    EntryKind.INTEGER: BASE_TYPES["int64"],
    EntryKind.REAL: BASE_TYPES["float64"],
    EntryKind.TEXT: BASE_TYPES["string"],
}


STATUSES = frozenset((SUCCESS, FAILURE, RUNNING))
"""The statuses with which a machine answers a tick, as codes."""


class Child(Record, frozen=True, eq=False):
    """The properties of a child that the automaton of its parent depends on.

    Attributes:
        address: the address of the child in names of events: its number, or another word.
        answers: the codes with which it may answer.
        is_stateless: whether resetting the child has no effect.
        origin: the place of the child, which is that of its ticks and halts.
    """

    address: str
    answers: frozenset[int]
    is_stateless: bool
    origin: Location


class NodeCode(Record, frozen=True, eq=False):
    """Everything that determines the automaton of a node.

    Attributes:
        address: the address of the node in names of events: its number, or another word.
        known: port or parameter with a constant value -> the value.
        bound: port that is bound to an entry of the blackboard -> the entry.
        whole: the ports that need an integer and are bound to an entry of real numbers.
        scripts: attribute or port -> its script.
        updated: the flag that states whether the observed entry was written; `None` if no node or script writes it.
        outputs: the entries that a mock writes when it succeeds, each with its possible values.
        elements: the elements of the queue of a loop.
        flags_at: port that writes an observed entry whose value is never read -> the flags of its observers.
        rate: the rate of the tree, in Hz.
        counts: whether counters for measurements are included.
        tree: the name of the tree in the system; "" if it has none.
        is_halted_always: whether the node is halted even if that has no effect, because its parent may be a machine.
    """

    address: str
    name: str
    program: NodeProgram
    children: tuple[Child, ...]
    known: Mapping[str, Known]
    bound: Mapping[str, BoardEntry]
    scripts: Mapping[str, CompiledScript]
    updated: BoardEntry | None
    outputs: tuple[tuple[BoardEntry, tuple[Known, ...]], ...]
    elements: tuple[Known, ...]
    flags_at: Mapping[str, tuple[BoardEntry, ...]]
    rate: Fraction
    counts: bool
    origin: Location
    is_halted_always: bool = False
    whole: frozenset[str] = frozenset()
    tree: str = ""

    @property
    def shape(self) -> Hashable:
        """A key for everything that determines the states of the automaton. The automata of two nodes with equal shapes
        differ only in names and values.

        Conditions on variables are not part of the shape, because the automaton contains both of their outcomes.
        """
        positions: dict[str, int] = {}

        def entry(used: BoardEntry | None) -> Hashable:
            return used and (positions.setdefault(used.variable, len(positions)), used.kind, used.type)

        def script(name: str, used: CompiledScript) -> Hashable:
            return name, tuple(map(entry, used.reads)), len(used.conditions), tuple(map(entry, used.writes))

        return (
            self.program.name,
            tuple((child.answers, child.is_stateless) for child in self.children),
            tuple((name, type(value), value) for name, value in sorted(self.known.items())),
            tuple((port, entry(bound)) for port, bound in sorted(self.bound.items())),
            self.whole,
            tuple(script(name, used) for name, used in sorted(self.scripts.items())),
            entry(self.updated),
            tuple((entry(output), len(values)) for output, values in self.outputs),
            self.elements,
            self.rate,
            self.is_halted_always,
        )
