# SPDX-License-Identifier: Apache-2.0
"""Names of parameters and instances (docs/spec/parameters.md), as the expansion records them."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.names.occurrence import Access, Occurrence
from roaml.project.analysis import Analysis


def in_parameters(analysis: Analysis, path: str, system: str | None) -> Iterator[Occurrence]:
    """The names of parameters and instances in the file `path`, as a part of `system`."""
    expanded = analysis.expanded(system) if system else analysis.expanded_file(path)
    if expanded is not None:
        for place in expanded.expansion.names.get(path, ()):
            access = Access.TEXT if place.defines else Access.READ
            yield Occurrence(place.span, place.symbol, place.defines, access)
