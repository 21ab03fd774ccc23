# SPDX-License-Identifier: Apache-2.0
"""The sentence that states why a property holds or fails in a trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from roaml.durations import moment
from roaml.jani.node import Origin
from roaml.regex import regex
from roaml.scxml.names import FAILS, SUCCEEDS, TREE_ROOT_PREFIX
from roaml.smc.end import End
from roaml.smc.program import FALSE, TRUE
from roaml.smc.story import Story
from roaml.views.actors import tree_phrase
from roaml.views.observed import REQUIRED_OCCURRED
from roaml.views.parting import Parting, other_course
from roaml.views.turn_words import chances, details, draws, what
from roaml.views.turns import Turn, turns

_ENDS = ("SUCCESS", "FAILURE")
_NUMBER = regex(r" \(bt_\d+\)$")
_OTHER_ENDS: Mapping[End, str] = MappingProxyType(
    {
        End.STUCK: "because machines wait for each other",
        End.QUIET: "because no machine can take a step any more",
        End.DEADLOCK: "because no step is possible any more",
        End.IDLE: "because nothing changes any more",
        End.ROUND: "because the same states are repeated for ever",
    }
)


def cause(story: Story, place_of: Callable[[Origin], str], near: tuple[Parting, Story] | None = None) -> str:
    """Why the property holds or fails, in one sentence; "" if the trace does not decide it, or if the story is not
    about a property. If a trace with the opposite verdict is known, the sentence begins with the turn in which that
    trace takes another course, unless chance decides something later.

    Args:
        place_of: file and line of an origin.
        near: where the trace parts from one with the opposite verdict, and that trace.
    """
    all_turns = turns(story)
    if near is None or not _is_last(near[0], all_turns, can_end=story.recording.end in _OTHER_ENDS):
        return _why(story, all_turns, place_of, 0)
    why = _why(story, all_turns, place_of, near[0].here.number)
    return f"{other_course(*near, place_of)}; {why}" if why else ""


def _is_last(difference: Parting, all_turns: Sequence[Turn], *, can_end: bool) -> bool:
    """Whether the turn in which traces part comes before the end, and chance decides nothing after it.

    Args:
        can_end: whether it may also be one of the last turns, because the sentence about the end does not name these.
    """
    number = difference.here.number
    last = number if can_end else number + 1
    if difference.there is None or any(turn.ends and turn.number < last for turn in all_turns):
        return False
    root = _ended_root(all_turns)
    node = None if root is None else _responsible(all_turns[: all_turns.index(root)])
    if node is not None and node.number == number:
        return False
    return not any(turn.number > number and any(draws(turn)) for turn in all_turns)


def _why(story: Story, all_turns: Sequence[Turn], place_of: Callable[[Origin], str], named: int) -> str:
    """Why the property holds or fails, from the end of the trace.

    Args:
        named: the number of a turn that the sentence names already; 0 if there is none.
    """
    verb = {TRUE: "holds", FALSE: "fails"}.get(story.recording.verdict, "")
    if story.is_whole or not verb or not story.steps:
        return ""
    subject = f"{story.property} {verb}"
    if story.is_reward:
        subject = f"{story.property}: its condition {'is' if verb == 'holds' else 'has not been'} reached"
    occurred = _occurrence(story.property, all_turns) if verb == "holds" else None
    if occurred is not None:
        why = f"because the event that it requires occurred{_at(occurred.time)}"
        return f"{subject}{_at(story.clock[-1])}, {why}, and nothing has violated it when the trace ends"
    if story.recording.end is End.TIME:
        subject += _at(story.clock[-1])
        if verb == "fails":
            return f"{subject}, because the time ends before what the property requires has happened"
        return f"{subject}, because nothing has violated it when the time ends"
    if story.recording.end in _OTHER_ENDS:
        why = _OTHER_ENDS[story.recording.end]
        return f"{subject}{_at(story.clock[-1])}, {why}{_chance_before(all_turns, len(story.steps) + 1, named)}"
    root = _ended_root(all_turns)
    if root is not None:
        why = _why_tree_ends(all_turns[: all_turns.index(root)], root.result, place_of)
        end = f"{tree_phrase(root.automaton, (a.name for a in story.automata))} ends with {root.result}"
        is_about_tree = story.property in (SUCCEEDS, FAILS)
        return f"{end}{_at(root.time)}{why}" if is_about_tree else f"{subject}{_at(root.time)}: {end}{why}"
    last = next((turn for turn in reversed(all_turns) if turn.ends), None)
    if last is None:
        return ""
    return f"{subject}{_at(last.time)}: {_sentence(last, place_of)}{_chance_before(all_turns, last.number, named)}"


def _occurrence(property_: str, all_turns: Sequence[Turn]) -> Turn | None:
    """The turn in which the observer of a property observed the event that it required last; `None` if it required
    none, or another one after it."""
    observed = [turn for turn in all_turns if turn.observed == property_ and turn.effects]
    return observed[-1] if observed and REQUIRED_OCCURRED in observed[-1].effects else None


def _ended_root(all_turns: Sequence[Turn]) -> Turn | None:
    """The turn in which a tree ended, and with it the trace; `None` if the trace ended otherwise."""
    return next((turn for turn in reversed(all_turns) if turn.ends and _is_root(turn)), None)


def _at(time: float | None) -> str:
    return "" if time is None else f" at {moment(time)}"


def _is_root(turn: Turn) -> bool:
    return turn.automaton.startswith(TREE_ROOT_PREFIX) and bool(turn.result)


def _responsible(before: Sequence[Turn]) -> Turn | None:
    """The node because of which the tree ended: the leaf that returned last or, if none returned at that time, the
    lowest inner node that returned, such as a `Timeout`."""
    lowest: Turn | None = None
    for turn in reversed(before):
        if turn.status not in _ENDS:
            continue
        if lowest is not None and turn.time != lowest.time:
            break
        lowest = turn
        if not turn.is_answered:
            break
    return lowest


def _why_tree_ends(before: Sequence[Turn], result: str, place_of: Callable[[Origin], str]) -> str:
    """The node because of which the tree ended, and the node above it that decided otherwise, if there is one."""
    node = _responsible(before)
    if node is None:
        return ""
    cause_ = f"{_node(node, place_of)} {_returned(node, before)}"
    if node.status == result:
        return f", because {cause_}"
    above = (turn for turn in before[before.index(node) :] if turn.status == result and turn.time == node.time)
    decided = next(above, None)
    if decided is None:
        return f", because {cause_}"
    return f", because {_node(decided, place_of)} returns {result} after {cause_}"


def _node(turn: Turn, place_of: Callable[[Origin], str]) -> str:
    """A node of the tree, with its place, which is clearer than its number."""
    place = _place(turn, place_of)
    return f"{_NUMBER.sub('', turn.who)}{place}" if place else turn.who


def _returned(turn: Turn, before: Sequence[Turn]) -> str:
    """What a node returned, and the outcome of chance in this tick, which comes before what its conditions do."""
    odds: list[str] = []
    for own in reversed(before[: before.index(turn) + 1]):
        if own.automaton != turn.automaton:
            continue
        odds = chances(own)
        if odds or own.is_ticked:
            break
    return f"returns {turn.status}{f' ({odds[-1]})' if odds else ''}"


def _place(turn: Turn, place_of: Callable[[Origin], str]) -> str:
    place = "" if turn.origin is None else place_of(turn.origin)
    return f" ({place})" if place else ""


def _sentence(turn: Turn, place_of: Callable[[Origin], str]) -> str:
    """What an automaton does in a turn, with its effects."""
    effects = ", ".join(details(turn))
    return f"{turn.who} {what(turn)}{f' and {effects}' if effects else ''}{_place(turn, place_of)}"


def _chance_before(all_turns: Sequence[Turn], end: int, named: int) -> str:
    """The last relevant outcome of chance before a step; "" if there is none, or if it is that of the turn `named`.

    Args:
        end: the number of the step.
        named: see `_why`.
    """
    drawn = next((t for t in reversed(all_turns) if t.number < end and any(draws(t))), None)
    if drawn is None or drawn.number == named:
        return ""
    odds = chances(drawn)[-1]
    return f"; the last outcome of chance was that of {drawn.who}{_at(drawn.time)} ({odds.removeprefix('by chance, ')})"
