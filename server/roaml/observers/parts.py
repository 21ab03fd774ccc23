# SPDX-License-Identifier: Apache-2.0
"""The parts of observers: a list of assignments, counters of clock steps, and delays."""

from __future__ import annotations

from roaml.observers.program import (
    FALSE,
    Assign,
    Expression,
    Literal,
    Register,
    Tick,
    at_least,
    at_most,
    choice,
    conjunction,
    disjunction,
    equal,
    minus,
    negation,
    plus,
)
from roaml.observers.properties import Window

TICK = Tick()
ONE = Literal(1)

_BITS = 30
"""The maximum number of bits in one integer: tools with 32-bit integers must be able to double it."""


class Builder:
    """Collects registers and assignments. Registers are named after their content; a repeated name gets a number."""

    def __init__(self) -> None:
        self.registers: list[Register] = []
        self.assignments: list[Assign] = []
        self._temporary: list[Register] = []
        self._names: dict[str, int] = {}

    def flag(self, name: str, initial: bool = False) -> Register:
        return self._add(Register(self._unique(name), initial))

    def counter(self, name: str, limit: int, initial: int = 0) -> Register:
        return self._add(Register(self._unique(name), initial, limit))

    def temporary(self, name: str, value: Expression) -> Expression:
        """A register for a value that only later assignments at the same letter read; `finish` resets it."""
        if isinstance(value, (Literal, Register, Tick)):
            return value
        register = self.flag(name)
        self._temporary.append(register)
        self.set(register, value)
        return register

    def set(self, register: Register, value: Expression) -> None:
        if value != register:
            self.assignments.append(Assign(register, value))

    def raise_if(self, register: Register, condition: Expression) -> None:
        """Set a flag if the condition is true; the flag is never reset."""
        self.set(register, disjunction(register, condition))

    def finish(self) -> None:
        """Add assignments that reset the temporary registers, because no later letter reads them."""
        for register in self._temporary:
            self.set(register, FALSE)

    def _add(self, register: Register) -> Register:
        self.registers.append(register)
        return register

    def _unique(self, name: str) -> str:
        number = self._names[name] = self._names.get(name, 0) + 1
        return name if number == 1 else f"{name}_{number}"


class Age:
    """The number of clock steps since the last occurrence of an event, at most `limit`. Before the first occurrence it
    is `initial` if that is given, otherwise `limit`."""

    def __init__(self, builder: Builder, name: str, limit: int, initial: int | None = None) -> None:
        self.builder = builder
        self.limit = limit
        self.register = builder.counter(name, limit, limit if initial is None else initial)

    def advance(self) -> None:
        due = conjunction(TICK, at_most(self.register, self.limit - 1))
        self.builder.set(self.register, choice(due, plus(self.register, ONE), self.register))

    def reset(self, condition: Expression, value: int = 0) -> None:
        self.builder.set(self.register, choice(condition, Literal(value), self.register))

    def forget(self, condition: Expression) -> None:
        """Set the number to `limit`, as if the event had never occurred, if `condition` is true."""
        self.reset(condition, self.limit)


class Delay:
    """Whether an event occurred, for each of the last `length` clock steps including this one.

    It is stored as one flag for this step and one bit for each earlier step, in several integers.
    """

    def __init__(self, builder: Builder, name: str, length: int) -> None:
        self.builder = builder
        self.now = builder.flag(f"{name}_now")
        self.rows: list[tuple[Register, int]] = []
        for first in range(0, length - 1, _BITS):
            width = min(_BITS, length - 1 - first)
            self.rows.append((builder.counter(name, 2**width - 1), width))

    def advance(self, name: str) -> Expression:
        """Advance by one clock step if this letter is a clock step.

        Returns:
            Whether the event occurred `length` steps ago, in a register with the name `name`.
        """
        leaving = self.builder.temporary(name, conjunction(TICK, self._top(len(self.rows))))
        for i in range(len(self.rows) - 1, -1, -1):
            row, width = self.rows[i]
            high = 2 ** (width - 1)
            rest = choice(at_least(row, high), minus(row, Literal(high)), row)
            moved = plus(plus(rest, rest), choice(self._top(i), ONE, Literal(0)))
            self.builder.set(row, choice(TICK, moved, row))
        self.builder.set(self.now, conjunction(self.now, negation(TICK)))
        return leaving

    def _top(self, i: int) -> Expression:
        """Whether the first `i` integers carry a bit over into the next integer."""
        if i == 0:
            return self.now
        row, width = self.rows[i - 1]
        return at_least(row, 2 ** (width - 1))

    def add(self, condition: Expression) -> None:
        """Record an event at this letter, if `condition` is true."""
        self.builder.raise_if(self.now, condition)

    def clear(self, condition: Expression) -> None:
        """Forget all events, if `condition` is true."""
        self.builder.set(self.now, conjunction(self.now, negation(condition)))
        for row, _ in self.rows:
            self.builder.set(row, choice(condition, Literal(0), row))

    @property
    def is_empty(self) -> Expression:
        return conjunction(negation(self.now), *(equal(row, 0) for row, _ in self.rows))


class Recent:
    """Whether an event occurred at a distance in a window. Of the occurrences whose distance has reached the lower
    bound, only the last one is stored."""

    def __init__(self, builder: Builder, name: str, window: Window) -> None:
        self.builder = builder
        self.window = window
        self.delay = Delay(builder, f"{name}_times", window.lower) if window.lower else None
        self.flag = builder.flag(name) if window.upper is None else None
        self.age = None if window.upper is None else Age(builder, name, window.upper + 1)

    def advance(self) -> None:
        """Advance by one clock step, if this letter is a clock step."""
        if self.age is not None:
            self.age.advance()
        if self.delay is not None:
            self._matured(self.delay.advance("matured"), self.window.lower)

    def _matured(self, condition: Expression, age: int) -> None:
        if self.age is not None:
            self.age.reset(condition, age)
        if self.flag is not None:
            self.builder.raise_if(self.flag, condition)

    def add(self, condition: Expression) -> None:
        """Record an event at this letter, if `condition` is true."""
        if self.delay is not None:
            self.delay.add(condition)
        else:
            self._matured(condition, 0)

    def clear(self, condition: Expression) -> None:
        """Forget all events, if `condition` is true."""
        if self.delay is not None:
            self.delay.clear(condition)
        if self.age is not None:
            self.age.forget(condition)
        if self.flag is not None:
            self.builder.set(self.flag, conjunction(self.flag, negation(condition)))

    @property
    def is_in_window(self) -> Expression:
        if self.flag is not None:
            return self.flag
        assert self.age is not None
        assert self.window.upper is not None
        return at_most(self.age.register, self.window.upper)
