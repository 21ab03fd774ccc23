# SPDX-License-Identifier: Apache-2.0
"""The words for what an automaton does in a turn of a trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.durations import moment
from roaml.jani.model import Clause
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.scxml.names import CLOCK, ENTRY_PREFIX, MOCK_FAILURES, MOCK_SUCCESSES, TREE_ROOT_PREFIX
from roaml.smc.record import AutomatonStep
from roaml.views.arrays import DeclaredChange, DeclaredValue
from roaml.views.turns import Message, Turn
from roaml.views.values import shown_parameters, shown_value
from roaml.views.variables import entry_phrase

MAX_CHARACTERS = 60
"""The maximum number of characters of the states or the parameters of an event in a line."""
_COUNTERS = frozenset({MOCK_SUCCESSES, MOCK_FAILURES})


def draws(turn: Turn) -> Iterator[AutomatonStep]:
    """The parts of a turn whose outcome was decided by chance."""
    return (part for part in turn.parts if len(part.edge.destinations) > 1)


def what(turn: Turn) -> str:
    """What the automaton does, without its effects."""
    if turn.observed:
        return turn.observation
    if turn.automaton == CLOCK and turn.heard is None:
        return "advances the time"
    if turn.automaton.startswith(TREE_ROOT_PREFIX) and turn.result:
        return f"ends with {turn.result}"
    source, destination = turn.source, turn.destination
    if turn.starts:
        return "starts" if turn.is_library_node else f"starts in {_short(destination)}"
    move = _short(source if source == destination else f"{source} → {destination}")
    place = "" if turn.is_library_node else f" in {move}"
    answer = f": {turn.status}" if turn.status else ""
    if turn.is_answered and turn.status:
        return f"returns {turn.status}"
    if turn.is_ticked:
        return f"is ticked{place}{answer}"
    if turn.is_halted:
        return f"is halted{place}"
    if turn.heard is not None:
        return f"receives {message_text(turn.heard)}{place}{answer}"
    if turn.is_library_node:
        return f"goes on{answer}"
    return f"{turn.action}: {move}" if turn.action else move


def details(turn: Turn) -> Iterator[str]:
    """The effects of a turn: the outcomes of chance, the variables that change, and the events that are sent."""
    if turn.observed:
        yield from turn.effects
        return
    if turn.automaton == CLOCK:
        return
    yield from chances(turn)
    yield from (
        _change(change, turn)
        for change in turn.changes
        if not (turn.is_library_node and change.variable.name in _COUNTERS)
    )
    yield from (f"sends {message_text(message)}" for message in turn.sent)


def chances(turn: Turn) -> list[str]:
    """A phrase for each outcome of chance in a turn, with its probability unless this depends on the state."""
    return [_chance(part.destination.probability, turn.constants) for part in draws(turn)]


def scheduling(turn: Turn) -> list[str]:
    """Phrases for what the scheduler has decided in a turn: to begin it late, or to choose it among several steps."""
    if turn.observed or turn.automaton == CLOCK:
        return []
    phrases = []
    if turn.ready is not None:
        phrases.append(f"delayed by the scheduler since {moment(turn.ready)}")
    if turn.until is not None:
        phrases.append(f"delayed by the scheduler until {moment(turn.until)}, before its effects are complete")
    if turn.options:
        phrases.append(f"chosen by the scheduler among {turn.options:,} steps")
    return phrases


def _chance(probability: Clause | None, constants: Mapping[str, Value]) -> str:
    known = probability.exp if probability is not None else None
    if known is None:
        return "by chance"
    try:
        value = evaluate(known, constants, {})
    except EvaluationError:
        return "by chance"
    return f"by chance, {value:g}" if isinstance(value, (int, float)) else "by chance"


def message_text(message: Message) -> str:
    """An event with its parameters."""
    values = shown_parameters(message.values)
    return f"{message.name} ({_short(values)})" if values else message.name


def _change(change: DeclaredChange, turn: Turn) -> str:
    name = change.variable.name
    phrase = turn.phrases.get(name, name) if change.variable.instance == turn.instance else name
    if phrase == name and name.startswith(ENTRY_PREFIX):  # an entry that the node writes, but never reads
        phrase = entry_phrase(name)
    return f"{phrase}: {_shown(change.before, change.after)}"


def _shown(before: DeclaredValue, after: DeclaredValue) -> str:
    return f"{_short(shown_value(before))} → {_short(shown_value(after))}"


def _short(text: str) -> str:
    return text if len(text) <= MAX_CHARACTERS else f"{text[: MAX_CHARACTERS - 1]}…"
