# SPDX-License-Identifier: Apache-2.0
"""Names the variables that make the states of a model many, for users whose search has ended at a limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from roaml.explicit.spreads import Spread, growing, variables_of
from roaml.record import Record
from roaml.scxml.names import CLOCK
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.registers import INT
from roaml.views.ends import is_event, is_translation
from roaml.views.variables import variable_phrases

if TYPE_CHECKING:
    from roaml.smc.record import Recorder

MAX_VARIABLES = 3
"""The maximum number of variables that are named."""
MIN_STEPS = 1_000
"""The minimum number of steps of a trace that shows that a variable grows."""
_PARTS = 4
"""The number of parts of such a trace; a variable that grows has a greater value at the end of each."""


class GrowingVariable(Record, frozen=True):
    """A variable with more and more values in the states that a search has reached.

    Attributes:
        name: the name of the variable for users.
        automaton: the automaton that declares it; "" for a variable of the model.
        values: the number of different values, at least; an array is one value.
        least, greatest: the range of the values; of the elements of an array.
        is_time: whether it contains the time of the clock.
        has_maximum: whether its type has a maximum.
    """

    name: str
    automaton: str
    values: int
    least: float
    greatest: float
    is_time: bool = False
    has_maximum: bool = False

    @property
    def text(self) -> str:
        """A phrase for users."""
        if self.is_time:
            return "the time of the clock"
        owner = f" of `{self.automaton}`" if self.automaton else ""
        return f"`{self.name}`{owner} ({_number(self.least)} to {_number(self.greatest)})"


def growing_variables(checker: ModelChecker, search: Any) -> tuple[GrowingVariable, ...]:
    """The variables that grow with a search: those with most values, and the time of the clock as the last one.

    The variables of the model that the translation of a system adds contain the last message of an event. They are only
    returned if no variable of an automaton grows, because their values come from one.
    """
    spreads = growing(checker, search)
    named = [_named(checker, spread) for spread in spreads]
    own = [variable for variable in named if not variable.is_time]
    if is_translation(checker.model):
        own = [variable for variable in own if variable.automaton] or [
            variable for variable in own if not any(other.is_time for other in named)
        ]
    return (*own[:MAX_VARIABLES], *(variable for variable in named if variable.is_time))


def growth_in_trace(checker: ModelChecker, recorder_of: Callable[[int], Recorder], steps: int, trace: int) -> str:
    """What grows through a trace that was cut, and what to do, as a phrase for users; "" if nothing does, or if time
    passes in it. While a variable grows, no state repeats, so the repetition of states cannot decide the trace.

    Args:
        recorder_of: a maximum number of steps -> a recorder with this limit.
        steps: the number of steps after which the trace was cut.
    """
    is_system = is_translation(checker.model)
    storages = [
        (instance, storage)
        for instance, storage in variables_of(checker)
        if storage.kind == INT and not storage.shape and not (is_system and instance is None)
    ]
    if steps < MIN_STEPS or not storages:
        return ""
    rows = zip(*_values(recorder_of, steps, trace, [storage for _, storage in storages]), strict=True)
    grown = [
        _named(checker, Spread(instance, s.name, steps, row[0], row[-1], s.bounds[1] is not None))
        for (instance, s), row in zip(storages, rows, strict=True)
        if all(earlier < later for earlier, later in pairwise(row))
    ]
    if not grown or any(variable.is_time for variable in grown):
        return ""
    named = sorted(grown, key=lambda variable: variable.least - variable.greatest)[:MAX_VARIABLES]
    verb = "grows" if len(named) == 1 else "grow"
    text = ", ".join(variable.text for variable in named)
    return f"{text} {verb}, so no state repeats, and more steps seldom help; {advice(named)}"


def _values(
    recorder_of: Callable[[int], Recorder], steps: int, trace: int, storages: Sequence[Storage]
) -> Iterator[list[int]]:
    """The values of integers at the start of a trace and at the end of each of its parts."""
    from roaml.smc.record import Recording  # noqa: PLC0415 - few traces are cut

    recorder = recorder_of(steps)
    recorder.initial((), trace)
    yield [recorder.integer(storage) for storage in storages]
    for part in range(1, _PARTS + 1):
        recorder = recorder_of(steps * part // _PARTS)
        recorder.rush(Recording(trace))
        yield [recorder.integer(storage) for storage in storages]


def advice(variables: Sequence[GrowingVariable]) -> str:
    """What to do about such variables, as a phrase for users."""
    remedies = []
    own = [variable for variable in variables if not variable.is_time]
    if unlimited := [variable for variable in own if not variable.has_maximum]:
        which = "variables" if len(unlimited) == len(own) else ", ".join(f"`{variable.name}`" for variable in unlimited)
        remedies.append(f"give {which} a maximum in the model")
    elif own:
        remedies.append("give variables smaller ranges in the model")
    if any(variable.is_time for variable in variables):
        remedies.append("shorten the time (max_time)")
    return " or ".join(remedies)


def _named(checker: ModelChecker, spread: Spread) -> GrowingVariable:
    values, least, greatest, limited = spread.values, spread.least, spread.greatest, spread.has_maximum
    if spread.instance is None:
        shared = spread.name
        if is_translation(checker.model):
            from roaml.views.actors import names_of  # noqa: PLC0415 - messages seldom grow alone
            from roaml.views.shared_names import shared_names  # noqa: PLC0415 - as above

            shared = shared_names([shared], names_of(checker.model.automata))[shared]
        return GrowingVariable(shared, "", values, least, greatest, has_maximum=limited)
    automaton = checker.legend.layout.instances[spread.instance].automaton
    events = {automaton.name for automaton in checker.model.automata if is_event(automaton)}
    name = variable_phrases(automaton, events.__contains__).get(spread.name, spread.name)
    return GrowingVariable(name, automaton.name, values, least, greatest, automaton.name == CLOCK, limited)


def _number(value: float) -> str:
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}"
