# SPDX-License-Identifier: Apache-2.0
"""Diffs in the format of `patch` and `git apply`, in which lines end only at LF."""

from __future__ import annotations

import difflib
import io
from collections.abc import Iterator


def unified(before: str, after: str, old_name: str, new_name: str) -> Iterator[str]:
    """The lines of a unified diff of two texts; none if they are equal."""
    old, new = (list(io.StringIO(text, newline="\n")) for text in (before, after))
    for line in difflib.unified_diff(old, new, old_name, new_name):
        yield line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
