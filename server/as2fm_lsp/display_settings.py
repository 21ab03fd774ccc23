# SPDX-License-Identifier: Apache-2.0
"""Which hints and lenses the user wants to see: `as2fm.inlayHints` and `as2fm.codeLens` of the client's settings.

    {"inlayHints": {"types": false}, "codeLens": {"references": false}}

Each may also be a plain true or false. What is not said is as below; what makes no sense counts as not said.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from roaml.ide.inlay_hints import HintKind

_ON = {
    HintKind.TYPES: True,
    HintKind.PORTS: False,
    HintKind.TOPICS: True,
    HintKind.EVENTS: True,
    HintKind.NODES: True,
}


@dataclass(frozen=True, slots=True)
class DisplaySettings:
    """`references`: whether lenses count uses; `results`: whether hints tell what is known of properties."""

    hints: frozenset[HintKind]
    references: bool
    results: bool


def display_settings(settings: object) -> DisplaySettings:
    """
    Args:
        settings: the client's settings, as they came.
    """
    hints = frozenset(kind for kind, on in _ON.items() if _is_on(settings, "inlayHints", kind.value, on))
    references = _is_on(settings, "codeLens", "references", True)
    return DisplaySettings(hints, references, _is_on(settings, "inlayHints", "results", True))


def _is_on(settings: object, section: str, key: str, otherwise: bool) -> bool:
    values = settings.get(section) if isinstance(settings, Mapping) else None
    value = values.get(key) if isinstance(values, Mapping) else values
    return value if isinstance(value, bool) else otherwise
