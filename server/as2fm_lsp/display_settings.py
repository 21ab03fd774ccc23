# SPDX-License-Identifier: Apache-2.0
"""Which hints and lenses are shown: `as2fm.inlayHints` and `as2fm.codeLens` of the client's settings.

    {"inlayHints": {"types": false}, "codeLens": {"references": false}}

Instead of an object, each section may also be `true` or `false`. Missing and invalid values have the defaults below.
"""

from __future__ import annotations

from collections.abc import Mapping

from roaml.ide.inlay_hints import HintKind
from roaml.record import Record

OFF_BY_DEFAULT = frozenset([HintKind.PORTS])


class DisplaySettings(Record, frozen=True):
    """`hints`: the kinds of hints that are shown; `references`: whether lenses show numbers of uses; `results`: whether
    hints show results of properties."""

    hints: frozenset[HintKind]
    references: bool
    results: bool


def display_settings(settings: object) -> DisplaySettings:
    """The valid display settings among the client's settings, with the defaults for all others.

    Args:
        settings: the client's settings, as received.
    """
    hints = frozenset(k for k in HintKind if _is_on(settings, "inlayHints", k.value, k not in OFF_BY_DEFAULT))
    references = _is_on(settings, "codeLens", "references", True)
    return DisplaySettings(hints, references, _is_on(settings, "inlayHints", "results", True))


def _is_on(settings: object, section: str, key: str, otherwise: bool) -> bool:
    values = settings.get(section) if isinstance(settings, Mapping) else None
    value = values.get(key) if isinstance(values, Mapping) else values
    return value if isinstance(value, bool) else otherwise
