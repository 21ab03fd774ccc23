# SPDX-License-Identifier: Apache-2.0
"""Typing in a generated machine, key by key.

A name, a tag or an expression loses its last character and gets it back; then a new statement is written character by
character. Before or after every key, the text contains an error, so that the server publishes diagnostics.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

WORDS = (
    '<data id="counter',
    '<ros_topic_publisher name="out" topic="/ring/topic_0" type="std_msgs/Int32',
    '<ros_topic_publisher name="out" topic="/ring/topic_0',
    'service_name="/ring/add_0',
    '<state id="state_3',
    "<ros_topic_publish",
    'cond="counter &lt;',
    'target="state_4',
    'expr="Math.min(speed + 0.1 * goal',
    '<field name="linear.x',
    'expr="_msg.data',
    'location="here.x',
    'event="ring_0_event_1',
    'expr="!ready',
    "</ros_topic_callback",
    'expr="_res.sum',
)
"""The words that lose their last character. Other files depend on some of them, such as the names of topics and events.
"""

STATEMENT = '<assign location="counter" expr="Math.max(counter - 2, 0)" />'


class Key(NamedTuple):
    """One key: `start` and `end` are offsets in the text before, which becomes `text`."""

    start: int
    end: int
    inserted: str
    before: str
    text: str

    def change(self) -> dict[str, Any]:
        """The content change of this key in the protocol."""
        start, end = position(self.before, self.start), position(self.before, self.end)
        return {"range": {"start": start, "end": end}, "text": self.inserted}


def position(text: str, offset: int) -> dict[str, int]:
    """The position of an offset in an ASCII text, whose columns are the same in all encodings."""
    return {"line": text.count("\n", 0, offset), "character": offset - text.rfind("\n", 0, offset) - 1}


def keys(text: str, rounds: int = 3) -> Iterator[Key]:
    """The keys for all words, `rounds` times at different places, and then for the statement. The final text is the
    original one with the statement."""
    yield from word_keys(text, rounds)
    at = _place(text, "<assign ", rounds)
    for character in STATEMENT:
        changed = text[:at] + character + text[at:]
        yield Key(at, at, character, text, changed)
        text, at = changed, at + 1


def word_keys(text: str, rounds: int = 3, words: Sequence[str] = WORDS) -> Iterator[Key]:
    """The keys that remove and restore the last character of each word, `rounds` times at different places. The final
    text is the original one."""
    for end in places(text, rounds, words):
        yield from _retyped(text, end)


def places(text: str, rounds: int = 3, words: Sequence[str] = WORDS) -> list[int]:
    """The ends of the words from which `word_keys` removes the last character."""
    return [_place(text, word, number) + len(word) for number in range(rounds) for word in words]


def _place(text: str, word: str, number: int) -> int:
    places = [at for at in range(len(text)) if text.startswith(word, at)]
    return places[number * 2 % len(places)]


def _retyped(text: str, end: int) -> Iterator[Key]:
    shorter = text[: end - 1] + text[end:]
    yield Key(end - 1, end, "", text, shorter)
    yield Key(end - 1, end - 1, text[end - 1], shorter, text)
