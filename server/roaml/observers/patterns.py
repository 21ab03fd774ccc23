# SPDX-License-Identifier: Apache-2.0
"""Translates a pattern in a scope to its observer.

A *stretch* is a part of the trace that a scope selects. The scope opens and closes stretches; the pattern is evaluated
on the open one. At most one is open at a time.
"""

from __future__ import annotations

from typing import Protocol

from roaml.observers.parts import TICK, Age, Builder, Delay, Recent
from roaml.observers.program import (
    FALSE,
    TRUE,
    Expression,
    Input,
    Observer,
    Outputs,
    at_least,
    at_most,
    conjunction,
    disjunction,
    equal,
    negation,
)
from roaml.observers.properties import CLOSE, LEFT, OPEN, RIGHT, Pattern, PatternProperty, ScopeKind, Window


def observe_pattern(property_: PatternProperty) -> Observer:
    builder = Builder()
    violated = builder.flag("violated")
    satisfied = None if property_.scope.has_until else builder.flag("satisfied")
    exercised = builder.flag("exercised") if _can_be_vacuous(property_) else None
    opened = builder.flag("opened") if _can_be_closed(property_) else None
    scope = _Scope(builder, property_.scope)
    pattern = _pattern_state(builder, property_, scope.is_open_at_first)
    is_deferred = property_.scope.is_judged_at_close
    bad = builder.flag("bad") if is_deferred else violated
    triggered = builder.flag("asked_inside") if is_deferred and exercised is not None else None

    # Evaluate a stretch that ends before this letter.
    closes = builder.temporary("closes", scope.closes)
    if closes != FALSE:
        builder.raise_if(violated, conjunction(closes, disjunction(bad if is_deferred else FALSE, pattern.owes)))
        if satisfied is not None:
            builder.raise_if(satisfied, conjunction(closes, negation(violated)))
        if triggered is not None and exercised is not None:
            builder.raise_if(exercised, conjunction(closes, triggered))
        if opened is not None and is_deferred:
            builder.raise_if(opened, closes)
    pattern.advance()
    if closes != FALSE:
        pattern.clear(closes)
        for flag in dict.fromkeys((bad, triggered)) if is_deferred else ():
            if flag is not None:
                builder.set(flag, conjunction(flag, negation(closes)))

    # Evaluate the stretch that contains this letter.
    opens = builder.temporary("opens", scope.opens)
    scope.update(opens, closes)
    if opens != FALSE:
        pattern.open(opens)
    builder.raise_if(bad, conjunction(scope.inside, pattern.read(scope.inside)))
    if satisfied is not None:
        safe = conjunction(scope.inside, pattern.is_safe, negation(bad), negation(violated))
        builder.raise_if(satisfied, safe)
    if exercised is not None:
        builder.raise_if(exercised if triggered is None else triggered, conjunction(scope.inside, pattern.triggers))
    if opened is not None and not is_deferred:
        builder.raise_if(opened, scope.inside)
    builder.finish()
    pending, due = FALSE if is_deferred else pattern.owes, FALSE if is_deferred else pattern.is_due
    outputs = Outputs(
        violated, satisfied, conjunction(scope.inside, pending), conjunction(scope.inside, due), exercised, opened
    )
    return Observer(property_.inputs, tuple(builder.registers), tuple(builder.assignments), outputs)


def _can_be_vacuous(property_: PatternProperty) -> bool:
    return property_.pattern.is_binary or property_.scope not in (ScopeKind.GLOBALLY, ScopeKind.UNTIL)


def _can_be_closed(property_: PatternProperty) -> bool:
    """Whether a pattern has two conditions, and a scope that has no judged stretch in some traces."""
    return property_.pattern.is_binary and property_.scope not in (ScopeKind.GLOBALLY, ScopeKind.UNTIL)


# ----------------------------------------------------------------------- scopes


class _Scope:
    """A scope: determines which letters are in a stretch (docs/spec/xml-properties.md#scopes)."""

    def __init__(self, builder: Builder, kind: ScopeKind) -> None:
        self.builder = builder
        self.kind = kind
        self.is_open_at_first = kind in (ScopeKind.GLOBALLY, ScopeKind.BEFORE, ScopeKind.UNTIL)
        self.flag = None if kind is ScopeKind.GLOBALLY else builder.flag("inside", self.is_open_at_first)

    @property
    def inside(self) -> Expression:
        return TRUE if self.flag is None else self.flag

    @property
    def closes(self) -> Expression:
        """Whether the open stretch ends before this letter."""
        match self.kind:
            case ScopeKind.GLOBALLY | ScopeKind.AFTER:
                return FALSE
            case ScopeKind.BEFORE | ScopeKind.UNTIL:
                return conjunction(self.inside, Input(OPEN))
            case ScopeKind.BETWEEN | ScopeKind.AFTER_UNTIL:
                return conjunction(self.inside, Input(CLOSE))

    @property
    def opens(self) -> Expression:
        """Whether a condition opens a stretch at this letter. The start of the trace opens one without a condition."""
        match self.kind:
            case ScopeKind.GLOBALLY | ScopeKind.BEFORE | ScopeKind.UNTIL:
                return FALSE
            case ScopeKind.AFTER:
                return conjunction(negation(self.inside), Input(OPEN))
            case ScopeKind.BETWEEN | ScopeKind.AFTER_UNTIL:
                return conjunction(negation(self.inside), Input(OPEN), negation(Input(CLOSE)))

    def update(self, opens: Expression, closes: Expression) -> None:
        if self.flag is not None:
            self.builder.set(self.flag, disjunction(opens, conjunction(self.flag, negation(closes))))


# --------------------------------------------------------------------- patterns


class _PatternState(Protocol):
    """The state of a pattern in the open stretch (docs/spec/xml-properties.md#patterns). Its registers have fixed
    values while no stretch is open.

    Attributes:
        owes: whether an obligation is open: the stretch violates the pattern if it ends here.
        is_due: whether an obligation is open whose deadline is now, or that has no deadline.
        is_safe: whether the stretch satisfies the pattern, however it continues.
        triggers: whether the pattern creates an obligation at this letter.
    """

    @property
    def owes(self) -> Expression: ...
    @property
    def is_due(self) -> Expression: ...
    @property
    def is_safe(self) -> Expression: ...
    @property
    def triggers(self) -> Expression: ...

    def advance(self) -> None:
        """Advance by one clock step, if this letter is a clock step."""

    def clear(self, closes: Expression) -> None:
        """Reset all registers, if `closes`."""

    def open(self, opens: Expression) -> None:
        """Begin a stretch at this letter, if `opens`."""

    def read(self, inside: Expression) -> Expression:
        """Evaluate this letter, if it is `inside` the stretch.

        Returns:
            Whether the stretch violates the pattern, if it is open.
        """


def _pattern_state(builder: Builder, property_: PatternProperty, is_open: bool) -> _PatternState:
    match property_.pattern:
        case Pattern.UNIVERSALITY:
            return _Always(builder, property_.window, is_open, Input(LEFT))
        case Pattern.ABSENCE:
            return _Always(builder, property_.window, is_open, negation(Input(LEFT)))
        case Pattern.EXISTENCE:
            return _Existence(builder, property_.window, is_open)
        case Pattern.RESPONSE:
            return _Response(builder, property_.window)
        case Pattern.PRECEDENCE:
            return _Precedence(builder, property_.window)
        case Pattern.RECURRENCE:
            assert property_.window.upper is not None
            return _Recurrence(builder, property_.window.upper, is_open)


class _Stretch:
    """The number of clock steps since the stretch opened, counted up to the bounds of the window."""

    def __init__(self, builder: Builder, window: Window, is_open: bool) -> None:
        self.window = window
        self.limit = window.lower if window.upper is None else window.upper + 1
        self.age = None if window.is_unbounded else Age(builder, "elapsed", self.limit, 0 if is_open else None)

    def advance(self) -> None:
        if self.age is not None:
            self.age.advance()

    def clear(self, closes: Expression) -> None:
        if self.age is not None:
            self.age.forget(closes)

    def open(self, opens: Expression) -> None:
        if self.age is not None:
            self.age.reset(opens)

    @property
    def is_in_window(self) -> Expression:
        if self.age is None:
            return TRUE
        begun = at_least(self.age.register, self.window.lower) if self.window.lower else TRUE
        passed = FALSE if self.window.upper is None else at_least(self.age.register, self.window.upper + 1)
        return conjunction(begun, negation(passed))

    @property
    def is_over(self) -> Expression:
        """Whether the window has passed."""
        return FALSE if self.age is None or self.window.upper is None else equal(self.age.register, self.limit)

    @property
    def is_last(self) -> Expression:
        """Whether the window has no upper bound, or this letter is at its upper bound."""
        if self.age is None or self.window.upper is None:
            return TRUE
        return at_least(self.age.register, self.window.upper)


class _Always:
    """The pattern that requires `holds` at every letter in the window."""

    owes: Expression = FALSE
    is_due: Expression = FALSE

    def __init__(self, builder: Builder, window: Window, is_open: bool, holds: Expression) -> None:
        self.stretch = _Stretch(builder, window, is_open)
        self.holds = holds

    @property
    def is_safe(self) -> Expression:
        return self.stretch.is_over

    @property
    def triggers(self) -> Expression:
        return self.stretch.is_in_window

    def advance(self) -> None:
        self.stretch.advance()

    def clear(self, closes: Expression) -> None:
        self.stretch.clear(closes)

    def open(self, opens: Expression) -> None:
        self.stretch.open(opens)

    def read(self, inside: Expression) -> Expression:
        return conjunction(self.stretch.is_in_window, negation(self.holds))


class _Existence:
    """The pattern that requires the condition at some letter in the window."""

    triggers: Expression = TRUE

    def __init__(self, builder: Builder, window: Window, is_open: bool) -> None:
        self.builder = builder
        self.stretch = _Stretch(builder, window, is_open)
        self.seen = builder.flag("seen")

    @property
    def owes(self) -> Expression:
        return negation(self.seen)

    @property
    def is_due(self) -> Expression:
        return conjunction(negation(self.seen), self.stretch.is_last)

    @property
    def is_safe(self) -> Expression:
        return self.seen

    def advance(self) -> None:
        self.stretch.advance()

    def clear(self, closes: Expression) -> None:
        self.stretch.clear(closes)
        self.builder.set(self.seen, conjunction(self.seen, negation(closes)))

    def open(self, opens: Expression) -> None:
        self.stretch.open(opens)

    def read(self, inside: Expression) -> Expression:
        self.builder.raise_if(self.seen, conjunction(inside, self.stretch.is_in_window, Input(LEFT)))
        return conjunction(self.stretch.is_over, negation(self.seen))


class _Response:
    """The pattern that requires an answer to each request. The time from the request to the answer is in the window.

    Only the oldest open request matters: its answer also answers all others whose window has begun, and its
    deadline is the first one.
    """

    is_safe: Expression = FALSE

    def __init__(self, builder: Builder, window: Window) -> None:
        self.builder = builder
        self.window = window
        self.delay = Delay(builder, "requests", window.lower) if window.lower else None
        self.flag = builder.flag("waiting") if window.upper is None else None
        self.age = None if window.upper is None else Age(builder, "waiting", window.upper + 1)
        self.is_late: Expression = FALSE

    @property
    def _waits(self) -> Expression:
        if self.flag is not None:
            return self.flag
        assert self.age is not None
        assert self.window.upper is not None
        return at_most(self.age.register, self.window.upper)

    @property
    def owes(self) -> Expression:
        return self._waits if self.delay is None else disjunction(self._waits, negation(self.delay.is_empty))

    @property
    def is_due(self) -> Expression:
        if self.age is None:
            return self.owes
        assert self.window.upper is not None
        return equal(self.age.register, self.window.upper)

    @property
    def triggers(self) -> Expression:
        return Input(LEFT)

    def advance(self) -> None:
        if self.age is not None:
            self.is_late = self.builder.temporary("late", conjunction(TICK, self.is_due))
            self.age.advance()
        if self.delay is not None:
            self._begin(self.delay.advance("matured"), self.window.lower)

    def _begin(self, condition: Expression, age: int) -> None:
        """Record that the window of a request begins."""
        if self.flag is not None:
            self.builder.raise_if(self.flag, condition)
        if self.age is not None:
            self.age.reset(conjunction(condition, negation(self._waits)), age)

    def clear(self, closes: Expression) -> None:
        if self.delay is not None:
            self.delay.clear(closes)
        self._end(closes)

    def _end(self, condition: Expression) -> None:
        """Remove all requests whose window has begun: they are answered, or the stretch has closed."""
        if self.flag is not None:
            self.builder.set(self.flag, conjunction(self.flag, negation(condition)))
        if self.age is not None:
            self.age.forget(condition)

    def open(self, opens: Expression) -> None:
        pass

    def read(self, inside: Expression) -> Expression:
        request, answer = conjunction(inside, Input(LEFT)), conjunction(inside, Input(RIGHT))
        if self.delay is not None:
            self.delay.add(request)
        else:
            self._begin(conjunction(request, negation(Input(RIGHT))), 0)
        self._end(answer)
        return self.is_late


class _Precedence:
    """The precedence pattern: at each letter at which the second condition holds, the first condition must have held at
    a distance in the window."""

    owes: Expression = FALSE
    is_due: Expression = FALSE

    def __init__(self, builder: Builder, window: Window) -> None:
        self.recent = Recent(builder, "preceded", window)

    @property
    def is_safe(self) -> Expression:
        return FALSE if self.recent.flag is None else self.recent.flag

    @property
    def triggers(self) -> Expression:
        return Input(RIGHT)

    def advance(self) -> None:
        self.recent.advance()

    def clear(self, closes: Expression) -> None:
        self.recent.clear(closes)

    def open(self, opens: Expression) -> None:
        pass

    def read(self, inside: Expression) -> Expression:
        self.recent.add(conjunction(inside, Input(LEFT)))
        return conjunction(Input(RIGHT), negation(self.recent.is_in_window))


class _Recurrence:
    """The pattern that requires the condition repeatedly: within the bound after the stretch opened, and within the
    bound after each time at which it held."""

    owes: Expression = FALSE
    is_due: Expression = FALSE
    is_safe: Expression = FALSE
    triggers: Expression = TRUE

    def __init__(self, builder: Builder, limit: int, is_open: bool) -> None:
        self.age = Age(builder, "elapsed", limit + 1, 0 if is_open else None)

    def advance(self) -> None:
        self.age.advance()

    def clear(self, closes: Expression) -> None:
        self.age.forget(closes)

    def open(self, opens: Expression) -> None:
        self.age.reset(opens)

    def read(self, inside: Expression) -> Expression:
        self.age.reset(conjunction(inside, Input(LEFT)))
        return equal(self.age.register, self.age.limit)
