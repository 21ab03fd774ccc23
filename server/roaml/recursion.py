# SPDX-License-Identifier: Apache-2.0
"""Deep recursion: expressions may be nested as deeply as JSON allows (`roaml.json_syntax.brackets.MAX_DEPTH`)."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

RECURSION_LIMIT = 8_000
"""Python's recursion limit for functions that follow the nesting of expressions."""


@contextmanager
def deep_recursion() -> Iterator[None]:
    """Raise Python's recursion limit to `RECURSION_LIMIT`."""
    depth = sys.getrecursionlimit()
    sys.setrecursionlimit(max(depth, RECURSION_LIMIT))
    try:
        yield
    finally:
        sys.setrecursionlimit(depth)
