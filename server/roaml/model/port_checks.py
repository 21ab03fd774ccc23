# SPDX-License-Identifier: Apache-2.0
"""What a plugin expects of the constants to which the tree sets its ports: the values that it refuses, and those among
which it distinguishes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction

from roaml.expr.infer import constant_fraction
from roaml.expr.operators import MIRRORED, Operator
from roaml.expr.tree import Binary, Expr, Name, walk
from roaml.model.machine import Chart, Machine, State
from roaml.model.syntax import Expression, PortRead
from roaml.model.waits import fixed_variables
from roaml.record import Record


class PortRefusal(Record, frozen=True):
    """A plugin enters the state `state`, in which it handles nothing, if `PORT OPERATOR number` holds at the start."""

    port: str
    operator: Operator
    number: Fraction
    state: str

    def holds(self, value: Fraction) -> bool:
        match self.operator:
            case Operator.LESS:
                return value < self.number
            case Operator.LESS_EQUAL:
                return value <= self.number
            case Operator.GREATER:
                return value > self.number
            case Operator.GREATER_EQUAL:
                return value >= self.number
            case Operator.EQUAL:
                return value == self.number
        return value != self.number


class PortChoice(Record, frozen=True):
    """A plugin compares the value of a port with `numbers`, and uses it for nothing else."""

    port: str
    numbers: frozenset[Fraction]


def port_refusals(machine: Machine) -> Iterator[PortRefusal]:
    chart = machine.chart
    ports = _ports(chart)
    states = {state.id.value: state for state in chart.states if state.id}
    first = states.get(chart.initial.value if chart.initial else "")
    for handler in first.handlers if first is not None and ports else ():
        target = handler.targets[0].state if len(handler.targets) == 1 else None
        if handler.trigger is not None or handler.cond is None or target is None:
            continue
        for part in _alternatives(handler.cond.tree) if _ends(states.get(target.value)) else ():
            yield from _refusal(ports, part, target.value)


def port_choices(machine: Machine, expressions: Iterable[Expression]) -> Iterator[PortChoice]:
    """The choices of a plugin whose expressions, without locations of assignments, are `expressions`."""
    ports = _ports(machine.chart)
    numbers: dict[str, set[Fraction]] = {}
    compared: set[Expr] = set()
    others: set[str] = set()
    for node in (node for expression in expressions if ports for node in walk(expression.tree)):
        if isinstance(node, Binary) and node.operator in (Operator.EQUAL, Operator.NOT_EQUAL):
            for side, other in ((node.left, node.right), (node.right, node.left)):
                number = constant_fraction(other)
                if isinstance(side, Name) and number is not None:
                    numbers.setdefault(side.name, set()).add(number)
                    compared.add(side)
        elif isinstance(node, Name) and node not in compared:
            others.add(node.name)
    for name, known in numbers.items():
        if name in ports and name not in others:
            yield PortChoice(ports[name], frozenset(known))


def _ports(chart: Chart) -> dict[str, str]:
    """The variables that hold the value of a port, with the port."""
    held = fixed_variables(chart).items()
    return {name: value.key.value for name, value in held if isinstance(value, PortRead) and value.key}


def _ends(state: State | None) -> bool:
    return state is not None and not any(handler.effective for handler in state.handlers) and state.entry is None


def _alternatives(tree: Expr) -> Iterator[Expr]:
    if isinstance(tree, Binary) and tree.operator is Operator.OR:
        yield from _alternatives(tree.left)
        yield from _alternatives(tree.right)
    else:
        yield tree


def _refusal(ports: dict[str, str], tree: Expr, state: str) -> Iterator[PortRefusal]:
    if not isinstance(tree, Binary) or tree.operator not in MIRRORED:
        return
    for side, other, operator in (
        (tree.left, tree.right, tree.operator),
        (tree.right, tree.left, MIRRORED[tree.operator]),
    ):
        number = constant_fraction(other)
        if isinstance(side, Name) and side.name in ports and number is not None:
            yield PortRefusal(ports[side.name], operator, number, state)
