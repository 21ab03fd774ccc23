# SPDX-License-Identifier: Apache-2.0
"""Which names look alike."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def close_names(name: str, candidates: Iterable[str], most: int = 3) -> tuple[str, ...]:
    """Those of `candidates` that look like `name`, the nearest first."""
    by_lower = {candidate.lower(): candidate for candidate in candidates}
    matches = difflib.get_close_matches(name.lower()[:80], list(by_lower), most, 0.6)
    return tuple(by_lower[match] for match in matches)
