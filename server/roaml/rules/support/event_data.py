# SPDX-License-Identifier: Apache-2.0
"""Event variables that are available at a place."""

from __future__ import annotations

from roaml.model.value_types import ValuePlace, bound_in


def known_here(place: ValuePlace) -> list[str]:
    """The names of the event variables that are available at a place."""
    if place.handler is None:
        return []
    return [binding.name for binding in bound_in(place.handler, place.part)]
