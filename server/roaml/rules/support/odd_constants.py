# SPDX-License-Identifier: Apache-2.0
"""Integer constants that have another value than in the other machines of a system, which exchange the values."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from roaml.model.machine import Chart
from roaml.model.message_constants import named_constants
from roaml.rules.rule import MachineContext
from roaml.rules.support.words import words_of

MIN_EQUAL = 2
"""In how many other machines a constant of the same name must be before another value is suspicious."""

MIN_SIMILAR = 3
"""The same for constants whose names contain the words of the others, such as `NAV_MOVING` for `NAV_STATUS_MOVING`."""


def odd_constants(context: MachineContext, chart: Chart) -> dict[str, tuple[int, int]]:
    """Constant of `chart` -> its value, and the different value that it has in all other machines that have it."""
    own = {constant.name: constant.number for constant in named_constants(chart)}
    if context.system is None or not own:
        return {}
    others = {
        path: {constant.name: constant.number for constant in outline.named}
        for path, outline in (*context.system.nodes, *context.system.plugins)
        if path != context.source.path and outline.named
    }
    expected = {name: _expected(name, others.values()) for name in own if _is_series(name, own)}
    return {name: (own[name], meant) for name, meant in expected.items() if meant not in (None, own[name])}


def _is_series(name: str, names: Collection[str]) -> bool:
    """Whether other constants begin with the same word, as those that distinguish the values of a status. Others may be
    settings, which differ between machines."""
    first = words_of(name)[:1]
    return any(other != name and other.isupper() and words_of(other)[:1] == first for other in names)


def _expected(name: str, others: Collection[Mapping[str, int]]) -> int | None:
    """The value of a constant in all other machines that have it; `None` if they are few or have several values."""
    equal = [constants[name] for constants in others if name in constants and _is_series(name, constants)]
    if len(equal) >= MIN_EQUAL:
        return equal[0] if len(set(equal)) == 1 else None
    similar = [n for constants in others for known, n in constants.items() if _is_similar(name, known)]
    return similar[0] if len(similar) >= MIN_SIMILAR and len(set(similar)) == 1 else None


def _is_similar(name: str, other: str) -> bool:
    """Whether two names end in the same word, and one contains all words of the other."""
    words, others = words_of(name), words_of(other)
    return words[-1:] == others[-1:] and (set(words) <= set(others) or set(others) <= set(words))
