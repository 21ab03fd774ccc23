# SPDX-License-Identifier: Apache-2.0
"""Where two traces of a model part: the first turn of an automaton that differs.

The turns of each automaton are compared in their order (`roaml.views.turns`), without their times and without the order
between different automata, which may be a choice of the scheduler and have no effect. What the translation has added
is not compared.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from roaml.durations import moment
from roaml.jani.node import Origin
from roaml.record import Record, replace
from roaml.smc.record import SELECTED
from roaml.smc.story import Story, outcome
from roaml.views.trace_names import trace_name
from roaml.views.turn_words import chances, details, scheduling, what
from roaml.views.turns import Turn, turns

MAX_NAMED_EFFECTS = 3
"""The maximum number of effects in the clause about a turn."""
_SENDS, _CHANGE = "sends ", " → "
"""How `roaml.views.turn_words.details` begins an event, and what it writes between two values."""

PlaceOf = Callable[[Origin], str]


class Parting(Record, frozen=True):
    """The first difference between two traces.

    Attributes:
        common: the number of turns before it in the first trace, which the second one contains as well.
        here, there: the first turn that differs, of the same automaton; `None` if the automaton takes no further turn
            in the second trace.
    """

    common: int
    here: Turn
    there: Turn | None


class ReadTrace(Record, frozen=True):
    """A trace whose turns have been read.

    Attributes:
        turns: all turns of machines and nodes, in the order in which they begin.
        lanes: the indexes of the turns of each automaton, by the number of its instance.
        keys: what is compared of each turn.
    """

    story: Story
    turns: tuple[Turn, ...]
    lanes: Mapping[int, Sequence[int]]
    keys: tuple[object, ...]


def read_trace(story: Story) -> ReadTrace:
    """All turns of a trace, not only those that are relevant for its property."""
    every = tuple(range(len(story.steps)))
    all_turns = tuple(turns(replace(story, relevant=every, is_whole=True)))
    lanes: dict[int, list[int]] = {}
    for index, turn in enumerate(all_turns):
        lanes.setdefault(turn.instance, []).append(index)
    return ReadTrace(story, all_turns, lanes, tuple((what(turn), *details(turn)) for turn in all_turns))


def parting(first: Story, second: Story) -> Parting | None:
    """The first difference of two traces of a model; `None` if each automaton does the same in both."""
    return first_difference(read_trace(first), read_trace(second))


def first_difference(first: ReadTrace, second: ReadTrace) -> Parting | None:
    """The first difference of two traces whose turns have been read, as `parting` returns it."""
    places = (_difference(first, second, instance) for instance in first.lanes)
    found = [place for place in places if place is not None]
    # An automaton that takes no further turn in a trace may only have had no time for it.
    index, other = min(found, key=lambda place: (place[1] is None, place[0]), default=(None, None))
    if index is None:
        return None
    return Parting(index, first.turns[index], None if other is None else second.turns[other])


class Alignment(Record, frozen=True):
    """Which states of two traces that part belong to each other.

    Attributes:
        pairs: numbers of steps after which the first and the second trace have finished a common turn, ascending.
        here, there: the numbers of steps before the turns that differ.
        here_time, there_time: the times of these turns, in s; `None` if the model has no clock.
    """

    pairs: tuple[tuple[int, int], ...]
    here: int
    there: int
    here_time: float | None
    there_time: float | None


def alignment(first: Story, second: Story, difference: Parting) -> Alignment:
    """The states of two traces that belong to each other up to their first difference.

    The order between different automata can differ, so a state of the second trace is the first one in which it has
    finished all turns that the first trace has finished, and the turn that differs has not begun.
    """
    read, other = read_trace(first), read_trace(second)
    here = difference.here.number - 1
    limit = len(second.steps) if difference.there is None else difference.there.number - 1
    finished = sorted(
        (read.turns[one].last, other.turns[another].last)
        for instance, lane in read.lanes.items()
        for one, another in zip(lane, other.lanes.get(instance, ()), strict=False)
        if one < difference.common and read.turns[one].last <= here
    )
    pairs: list[tuple[int, int]] = []
    step = 0
    for one, another in finished:
        step = max(step, min(another, limit))
        if pairs and pairs[-1][0] == one:
            pairs.pop()
        pairs.append((one, step))
    there = step if difference.there is None else limit
    other_time = difference.here.time if difference.there is None else difference.there.time
    return Alignment(tuple(pairs), here, there, difference.here.time, other_time)


def _difference(first: ReadTrace, second: ReadTrace, instance: int) -> tuple[int, int | None] | None:
    """The indexes of the first turns of an automaton that differ."""
    here, there = first.lanes[instance], second.lanes.get(instance, ())
    for number, index in enumerate(here):
        if number == len(there):
            return index, None
        if first.keys[index] != second.keys[there[number]]:
            return index, there[number]
    return None


def parting_text(difference: Parting, other: Story, place_of: PlaceOf) -> str:
    """The first difference between a trace and another one, as indented lines of text.

    Args:
        other: the second trace.
        place_of: file and line of an origin.
    """
    there = "takes no further turn" if difference.there is None else _turn(difference.there, place_of)
    return (
        f"  {parting_heading(difference, other)}\n    here   {_turn(difference.here, place_of)}\n    there  {there}\n"
    )


def parting_heading(difference: Parting, other: Story) -> str:
    """The verdict of the second trace, what both traces have in common, and the automaton that then differs."""
    turn, count = difference.here, difference.common
    at = "" if turn.time is None else f" at {moment(turn.time)}"
    same = f"the first {f'{count:,} turns are' if count > 1 else 'turn is'} the same, then " if count else ""
    return f"{trace_name(other)} {outcome(other)}: {same}{turn.who}{at}"


def other_course(difference: Parting, other: Story, place_of: PlaceOf) -> str:
    """What the automaton does in the first trace where the second one takes another course, as a clause.

    Args:
        other: the second trace.
        place_of: file and line of an origin.
    """
    here, there = difference.here, difference.there
    odds = chances(here)
    done = what(here)
    if there is not None and done == what(there):
        done = _own_effects(here, there) or _other_effects(here, there) or done
    by = ""
    if odds:
        number = odds[-1].removeprefix("by chance").removeprefix(", ")
        by = f"by chance ({number}), " if number else "by chance, "
    elif here.options:
        by = "by choice of the scheduler, "
    elif here.ready is not None or here.until is not None:
        by = f"{scheduling(here)[0]}, "
    at = "" if here.time is None else f" at {moment(here.time)}"
    place = "" if here.origin is None else place_of(here.origin)
    name = trace_name(other)
    which = " that" if other.recording.trace == SELECTED else ", which"
    where = f" ({place})" if place else ""
    return f"{by}{here.who} {done}{at}{where}, unlike in {name}{which} {outcome(other)}"


def _own_effects(here: Turn, there: Turn) -> str:
    """The events that only the first of two turns sends or, if there are none, the changes of only this turn."""
    known = set(details(there))
    own = [effect for effect in details(here) if effect not in known]
    sent = [effect.removeprefix(_SENDS) for effect in own if effect.startswith(_SENDS)]
    if sent:
        return f"sends {_listed(sent)}"
    changes = [effect for effect in own if _CHANGE in effect]
    return f"changes {_listed(changes)}" if changes else ""


def _other_effects(here: Turn, there: Turn) -> str:
    """The same for a turn that has no effect of its own: what only the second turn sends or changes."""
    known = set(details(here))
    other = [effect for effect in details(there) if effect not in known]
    sent = [effect.removeprefix(_SENDS) for effect in other if effect.startswith(_SENDS)]
    if sent:
        return f"does not send {_listed(sent)}"
    changed = [effect.partition(": ")[0] for effect in other if _CHANGE in effect]
    return f"does not change {_listed(changed)}" if changed else ""


def _listed(effects: Sequence[str]) -> str:
    more = len(effects) - MAX_NAMED_EFFECTS
    shown = [*effects[:MAX_NAMED_EFFECTS], *([f"{more:,} more"] if more > 0 else [])]
    return " and ".join(filter(None, (", ".join(shown[:-1]), *shown[-1:])))


def _turn(turn: Turn, place_of: PlaceOf) -> str:
    effects = ", ".join((*scheduling(turn), *details(turn)))
    place = "" if turn.origin is None else place_of(turn.origin)
    return f"{what(turn)}{f' and {effects}' if effects else ''}{f' ({place})' if place else ''}"
