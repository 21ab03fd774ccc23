# SPDX-License-Identifier: Apache-2.0
"""The initial states of a model (docs/spec/semantics.md#initial-states).

Variables without an initial value can have every value of their type that the conditions on initial states
(`restrict-initial`) allow. Variables that no condition connects are independent of each other, so the set of initial
states is a product of small tables and is never listed as a whole.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

from roaml.jani.expressions import Binary, Expression, Name
from roaml.jani.model import Function
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.record import Record
from roaml.smc.fault import MESSAGES, FaultCode, FaultError
from roaml.smc.names import Storage, variables_in
from roaml.smc.registers import BOOL, INT, REAL, Number

MAX_ROWS = 1_000_000
"""The maximum number of combinations of initial values of variables that depend on each other."""
MAX_TRIED = 300_000
"""The maximum number of evaluations of conditions on initial states; this many take some seconds."""
MAX_INITIAL_STATES = 1 << 62
"""The maximum number of initial states, which are numbered."""
OVERFLOW = MESSAGES[FaultCode.OVERFLOW]
NO_INITIAL_STATE = "there is no initial state: the initial values do not satisfy this condition"

Cells: TypeAlias = tuple[Number, ...]


class InitialChoice(Record, frozen=True):
    """Variables that depend on each other, and all combinations of their initial values: at least two."""

    storages: tuple[Storage, ...]
    rows: Sequence[Cells]


class InitialCondition(Record, frozen=True):
    """A condition on initial states, and the meanings of the names in it.

    Attributes:
        names: the variables to which it can refer.
    """

    expression: Expression
    names: Mapping[str, Storage]
    functions: Mapping[str, Function]


class OpenVariable(Record, frozen=True):
    """A variable without initial value."""

    storage: Storage
    origin: Origin | None


def initial_choices(
    conditions: Iterable[InitialCondition],
    open_variables: Sequence[OpenVariable],
    constants: Mapping[str, Value],
    initial: dict[int, Value],
) -> tuple[InitialChoice, ...]:
    """The choices between initial values.

    Args:
        initial: the initial value of each other storage, by its `id`. A value is added for each open variable: that of
            the first initial state.

    Raises:
        FaultError: there is no initial state, or there are too many values.
    """
    return _Initial(conditions, open_variables, constants, initial).choices()


class _Conjunct:
    """A part of a condition; all parts must hold. `open` contains the variables without initial value in it."""

    def __init__(self, expression: Expression, condition: InitialCondition, parent: _Initial) -> None:
        self.expression = expression
        self.origin = expression.origin or condition.expression.origin
        self.condition = condition
        self.parent = parent
        self.read = self.storages(expression)
        self.open = [storage for _, storage in self.read if id(storage) in parent.open]

    def storages(self, expression: Expression) -> list[tuple[str, Storage]]:
        names = self.condition.names
        read = sorted(variables_in(expression, self.condition.functions))
        return [(name, names[name]) for name in read if name in names]

    def determined(self) -> Iterator[tuple[Storage, Expression]]:
        """The open variables whose values this part states, and the expressions for the values."""
        node = self.expression
        if not isinstance(node, Binary) or node.operator is not BinaryOperator.EQUAL:
            return
        for side, other in ((node.left, node.right), (node.right, node.left)):
            storage = self.condition.names.get(side.identifier) if isinstance(side, Name) else None
            if storage is None or id(storage) not in self.parent.open:
                continue
            if all(storage is not read for _, read in self.storages(other)):
                yield storage, other

    def value(self, expression: Expression) -> Value:
        """The value of an expression.

        Raises:
            EvaluationError: it has none.
        """
        self.parent.count(self.origin)
        values = {**self.parent.constants}
        for name, storage in self.read:
            if id(storage) in self.parent.initial:  # `expression` may be a part without the other variables
                values[name] = self.parent.initial[id(storage)]
        return evaluate(expression, values, self.condition.functions)

    def holds(self) -> bool:
        """Whether the part holds.

        Raises:
            FaultError: its value is undefined.
        """
        try:
            return bool(self.value(self.expression))
        except EvaluationError as error:
            raise FaultError(error.message, error.origin or self.origin) from None

    def may_hold(self) -> bool:
        """Whether the part holds or has an undefined value, which matters only if all other parts hold."""
        try:
            return bool(self.value(self.expression))
        except EvaluationError:
            return True


class _Initial:
    def __init__(
        self,
        conditions: Iterable[InitialCondition],
        open_variables: Sequence[OpenVariable],
        constants: Mapping[str, Value],
        initial: dict[int, Value],
    ) -> None:
        self.constants = constants
        self.initial = initial
        self.open = {id(variable.storage): variable for variable in open_variables}
        self.tried = 0
        self.conjuncts = [
            _Conjunct(part, condition, self) for condition in conditions for part in _parts(condition.expression)
        ]

    def count(self, origin: Origin | None) -> None:
        self.tried += 1
        if self.tried > MAX_TRIED:
            raise FaultError(
                f"the initial states are not found within {MAX_TRIED:,} evaluations of their condition; give more "
                "variables an `initial-value`",
                origin,
            )

    def choices(self) -> tuple[InitialChoice, ...]:
        for conjunct in self.conjuncts:
            if not conjunct.open and not conjunct.holds():
                raise FaultError(NO_INITIAL_STATE, conjunct.origin)
        choices = []
        for part in self.components():
            conjuncts = [c for c in self.conjuncts if c.open and id(c.open[0]) in {id(storage) for storage in part}]
            rows = self.rows(part, conjuncts)
            for storage, value in zip(part, rows[0], strict=True):
                self.initial[id(storage)] = _converted(storage, value)
            if len(rows) > 1:
                choices.append(InitialChoice(tuple(part), rows))
        return tuple(choices)

    def components(self) -> list[list[Storage]]:
        """The open variables, grouped by the conditions that connect them, each group in the order of the model."""
        group_of: dict[int, list[int]] = {key: [key] for key in self.open}
        for conjunct in self.conjuncts:
            for other in conjunct.open[1:]:
                first, second = group_of[id(conjunct.open[0])], group_of[id(other)]
                if first is not second:
                    first += second
                    group_of.update((key, first) for key in second)
        place = {key: number for number, key in enumerate(self.open)}
        groups = {id(group): sorted(group, key=place.__getitem__) for group in group_of.values()}
        return [[self.open[key].storage for key in group] for group in groups.values()]

    def rows(self, part: list[Storage], conjuncts: list[_Conjunct]) -> Sequence[Cells]:
        """The combinations of values of one group that satisfy its conditions."""
        if not conjuncts:
            domain = self.domain(part[0])
            return [(value,) for value in domain]
        order, sources = self.order(part, conjuncts)
        level_of = {id(storage): level for level, storage in enumerate(order)}
        checks: list[list[_Conjunct]] = [[] for _ in order]
        for conjunct in conjuncts:
            checks[max(level_of[id(storage)] for storage in conjunct.open)].append(conjunct)
        found: list[Cells] = []

        def extend(level: int) -> None:
            if level == len(order):
                if all(conjunct.holds() for conjunct in conjuncts):
                    found.append(tuple(_plain(self.initial[id(storage)]) for storage in part))
                    self.limit(part, len(found))
                return
            storage = order[level]
            for value in self.candidates(storage, sources.get(id(storage))):
                self.initial[id(storage)] = _converted(storage, value)
                if all(conjunct.may_hold() for conjunct in checks[level]):
                    extend(level + 1)

        extend(0)
        if not found:
            raise FaultError(NO_INITIAL_STATE, conjuncts[0].condition.expression.origin)
        return sorted(found)

    def order(
        self, part: list[Storage], conjuncts: list[_Conjunct]
    ) -> tuple[list[Storage], dict[int, tuple[_Conjunct, Expression]]]:
        """The order in which the variables get their values, and the equations that state values. A variable whose
        value follows from those before it comes first, otherwise one with few values."""
        equations = [
            (storage, conjunct, expression) for conjunct in conjuncts for storage, expression in conjunct.determined()
        ]
        order: list[Storage] = []
        placed: set[int] = set()
        sources: dict[int, tuple[_Conjunct, Expression]] = {}
        while len(order) < len(part):
            for storage, conjunct, expression in equations:
                free = {id(read) for _, read in conjunct.storages(expression)} & self.open.keys()
                if id(storage) not in placed and free <= placed:
                    sources[id(storage)] = conjunct, expression
                    break
            else:
                rest = [storage for storage in part if id(storage) not in placed]
                storage = min(rest, key=self.size)
                self.domain(storage)
            order.append(storage)
            placed.add(id(storage))
        return order, sources

    def candidates(self, storage: Storage, source: tuple[_Conjunct, Expression] | None) -> Iterable[Number]:
        """The values that a variable can have, given those of the variables before it."""
        if source is None:
            return self.domain(storage)
        conjunct, expression = source
        try:
            value = conjunct.value(expression)
        except EvaluationError as error:
            raise FaultError(error.message, error.origin or conjunct.origin) from None
        if not isinstance(value, (bool, int, float)):
            return ()
        if isinstance(value, int) and abs(value) >= 1 << 63:
            raise FaultError(OVERFLOW, expression.origin or conjunct.origin)
        if storage.kind == REAL:
            value = float(value)
        elif not math.isfinite(value) or value != int(value):
            return ()
        else:
            value = int(value)
            if abs(value) >= 1 << 63:
                raise FaultError(OVERFLOW, expression.origin or conjunct.origin)
        low, high = storage.bounds
        return () if (low is not None and value < low) or (high is not None and value > high) else (value,)

    def size(self, storage: Storage) -> float:
        """The number of values of the type of a variable; infinite if it is not bounded."""
        if storage.kind == BOOL:
            return 2
        low, high = storage.bounds
        return float("inf") if storage.kind != INT or low is None or high is None else high - low + 1

    def domain(self, storage: Storage) -> Sequence[int]:
        """All values of the type of a variable.

        Raises:
            FaultError: the type is not bounded, or has too many values.
        """
        size = self.size(storage)
        if size == float("inf"):
            raise FaultError(
                f"the variable `{storage.name}` has no initial value, its type has no bounds, and no equation in "
                "`restrict-initial` states its value",
                self.open[id(storage)].origin,
            )
        if size < 1:
            raise FaultError(
                f"the variable `{storage.name}` has no initial value, because its type has no values: the lower bound "
                "is greater than the upper bound",
                self.open[id(storage)].origin,
            )
        self.limit([storage], size)
        low, _ = storage.bounds
        first = 0 if low is None else int(low)
        return range(first, first + int(size))

    def limit(self, part: list[Storage], size: float) -> None:
        if size > MAX_ROWS:
            names = ", ".join(f"`{storage.name}`" for storage in part)
            raise FaultError(
                f"{names} can have more than {MAX_ROWS:,} initial values; restrict them by `restrict-initial`",
                self.open[id(part[0])].origin,
            )


def _parts(expression: Expression) -> Iterator[Expression]:
    """The operands of a conjunction."""
    waiting = [expression]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Binary) and node.operator is BinaryOperator.AND:
            waiting += (node.right, node.left)
        else:
            yield node


def _converted(storage: Storage, value: Number) -> Value:
    return bool(value) if storage.kind == BOOL else value


def _plain(value: Value) -> Number:
    assert isinstance(value, (bool, int, float))
    return value if isinstance(value, float) else int(value)
