# SPDX-License-Identifier: Apache-2.0
"""Which names look alike, and what is meant where a name is misspelled."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Container, Iterable

from roaml.model.syntax import Name, name_of
from roaml.xml_syntax import Element


def close_names(name: str, candidates: Iterable[str], most: int = 3) -> tuple[str, ...]:
    """Those of `candidates` that look like `name`, the nearest first."""
    return _close_names(name[:80], tuple(candidates), most)


@functools.lru_cache(maxsize=256)
def _close_names(name: str, candidates: tuple[str, ...], most: int) -> tuple[str, ...]:
    """Remembered, as one mistake is often made many times."""
    by_lower = {candidate.lower(): candidate for candidate in candidates}
    matches = difflib.get_close_matches(name.lower(), list(by_lower), most, 0.6)
    return tuple(by_lower[match] for match in matches)


def meant(element: Element, name: str, known: Container[str]) -> Name | None:
    """The value of the attribute `name`, also if the attribute is misspelled as one that the element does not have."""
    if element.get(name) is not None:
        return name_of(element.get(name))
    strange = [a for a in element.attributes if a.name not in known and close_names(a.name, [name])]
    return name_of(strange[0]) if strange else None
