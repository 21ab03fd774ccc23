# SPDX-License-Identifier: Apache-2.0
"""Completion items, as plain data."""

from __future__ import annotations

import enum
import re
from collections.abc import Iterable

from roaml.diagnostics import Symbol
from roaml.record import Record
from roaml.regex import regex
from roaml.text import Span


class ItemKind(enum.Enum):
    """The kind of an item; editors show it as an icon."""

    ELEMENT = "element"
    ATTRIBUTE = "attribute"
    VALUE = "value"
    VARIABLE = "variable"
    FUNCTION = "function"
    MEMBER = "member"
    EVENT = "event"
    STATE = "state"
    HANDLE = "handle"
    INTERFACE = "topic, service or action"
    TYPE = "type"
    PLUGIN = "plugin"
    PORT = "port"
    FILE = "file"
    OPERATOR = "operator"
    SKELETON = "skeleton"


class Rank(enum.IntEnum):
    """The rank of an item in the list, the best one first. Items of equal rank keep their order."""

    BEST = 0
    LIKELY = 1
    USUAL = 2
    LATE = 3
    LAST = 4


class CompletionItem(Record, frozen=True):
    """One completion item.

    Attributes:
        insert: the text that replaces `Completions.span`, in the snippet syntax of LSP; "" if it is the label.
        detail: a few words beside the label, such as a type.
        about: the subject of the documentation (`roaml.ide.completion.document`).
        filter: the text that is matched with the typed text; "" if it is the label.
    """

    label: str
    kind: ItemKind
    insert: str = ""
    detail: str = ""
    about: Symbol | None = None
    rank: Rank = Rank.USUAL
    filter: str = ""
    deprecated: bool = False

    @property
    def snippet(self) -> str:
        """The inserted text, in snippet syntax."""
        return self.insert or escaped(self.label)


class Completions(Record, frozen=True):
    """The completions at a caret. The items replace the text in `span`. `incomplete` means that some items are left
    out, so that the editor requests the list again after more typing."""

    span: Span
    items: tuple[CompletionItem, ...]
    incomplete: bool = False


def escaped(text: str) -> str:
    """A text with the special characters of snippets escaped."""
    return re.sub(r"[\\$}]", r"\\\g<0>", text)


_STOP = regex(r"\\([\\$}])|\$\d+|\$\{\d+\|((?:[^,|\\]|\\.)*)(?:,(?:[^|\\]|\\.)*)?\|\}|\$\{\d+:((?:[^}\\]|\\.)*)\}")


def plain(snippet: str) -> str:
    """The text of a snippet for editors without snippets. Each placeholder is replaced by its first choice, by its
    default, or by nothing."""
    return _STOP.sub(lambda stop: stop[1] or _unescaped(stop[2] or stop[3] or ""), snippet)


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", r"\1", text)


class Snippet:
    """A snippet: text with placeholders, which is built from left to right."""

    def __init__(self) -> None:
        self._parts: list[str] = []
        self._stops = 0

    def text(self, text: str) -> Snippet:
        self._parts.append(escaped(text))
        return self

    def stop(self, likely: Iterable[str] = ()) -> Snippet:
        """Add a placeholder. `likely` are the values that it suggests."""
        self._stops += 1
        choices = [text for text in dict.fromkeys(likely) if text]
        if not choices:
            self._parts.append(f"${self._stops}")
        elif len(choices) == 1:
            self._parts.append(f"${{{self._stops}:{escaped(choices[0])}}}")
        else:
            listed = ",".join(re.sub(r"[\\$},|]", r"\\\g<0>", text) for text in choices)
            self._parts.append(f"${{{self._stops}|{listed}|}}")
        return self

    def end(self) -> Snippet:
        """Mark the final position of the caret."""
        self._parts.append("$0")
        return self

    def __str__(self) -> str:
        return "".join(self._parts)
