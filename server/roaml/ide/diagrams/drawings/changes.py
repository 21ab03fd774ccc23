# SPDX-License-Identifier: Apache-2.0
"""How drawings show what happened to parts between two versions of a model: by colors, and by signs and dashes for
readers who do not distinguish the colors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.figures.drawing import Tone
from roaml.ide.diagrams.diagram import Change
from roaml.ide.diagrams.drawings.cards import TextLine
from roaml.record import replace

_TONES: Mapping[Change, Tone] = {
    Change.SAME: Tone.PLAIN,
    Change.ADDED: Tone.ADDED,
    Change.REMOVED: Tone.REMOVED,
    Change.CHANGED: Tone.CHANGED,
}
_SIGNS: Mapping[Change, str] = {Change.ADDED: "+ ", Change.REMOVED: "− "}


def tone_of(change: Change | None, tone: Tone) -> Tone:
    """The tone of a part; `tone` if no versions are compared. What did not change is plain."""
    return tone if change is None else _TONES[change]


def kind_of(change: Change | None, kind: str) -> str:
    """The kind of a part for the style sheet, with what happened to it."""
    return kind if change in (None, Change.SAME) else f"{kind} {change.value}".strip()


def signed(lines: Sequence[TextLine], change: Change | None) -> tuple[TextLine, ...]:
    """The lines of a row; the first one begins with a sign if the row was added or removed."""
    sign = _SIGNS.get(change) if change is not None else None
    if sign is None or not lines:
        return tuple(lines)
    return (replace(lines[0], text=f"{sign}{lines[0].text}"), *lines[1:])


def is_marked(change: Change | None) -> bool:
    """Whether a row was added or removed."""
    return change in _SIGNS
