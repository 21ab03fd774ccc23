# SPDX-License-Identifier: Apache-2.0
"""The files that the setting `exclude` excludes. Its patterns have the syntax of `.gitignore` files
(https://git-scm.com/docs/gitignore)."""

from __future__ import annotations

import functools
import re
import warnings
from typing import TYPE_CHECKING

from roaml.project.paths import is_below, relative
from roaml.record import Record

if TYPE_CHECKING:
    from pathspec import GitIgnoreSpec, PathSpec, Pattern

MAX_WILDCARDS = 3
"""The maximum number of `*` in one part of a pattern, and of `**` in a pattern. It is limited because a pattern may
come from an untrusted source, and the time to compare a path grows with its length to the power of this number."""
MAX_DEPTH = 30
"""The maximum number of parts of a path that are compared. A file that is deeper is excluded if one of its first 30
folders is excluded."""


class Exclude(Record, frozen=True):
    """The patterns of excluded files. If several patterns match, the last one decides.

    Attributes:
        folder: the folder to which the patterns are relative. For files in a root outside of this folder, the patterns
            are relative to that root.
    """

    patterns: tuple[str, ...] = ()
    folder: str = ""

    def covers(self, path: str, root: str) -> bool:
        """Whether the file `path`, which is below the folder `root`, is excluded."""
        return self._covers(path, root, "")

    def covers_folder(self, path: str, root: str) -> bool:
        """Whether all files in the folder `path`, which is `root` itself or below `root`, are excluded."""
        return self._covers(path, root, "/")

    def _covers(self, path: str, root: str, end: str) -> bool:
        if not self.patterns:
            return False
        base = self.folder if self.folder and is_below(path, self.folder) else root
        if path == base:
            return False
        *folders, name = relative(path, base).split("/")
        parts = [*(f"{folder}/" for folder in folders), name + end][:MAX_DEPTH]
        return any(_matches(self.patterns, "".join(parts[:count])) for count in range(1, len(parts) + 1))


NOTHING = Exclude()


def problem(pattern: str) -> str:
    """A message that says why `pattern` is not a valid pattern; "" if it is valid."""
    parts = pattern.split("/")
    if parts.count("**") > MAX_WILDCARDS:
        return f"`{pattern}` contains more than {MAX_WILDCARDS} `**`; write a pattern with fewer"
    if any(part.count("*") > MAX_WILDCARDS for part in parts):
        return (
            f"`{pattern}` contains more than {MAX_WILDCARDS} `*` without a `/` between them; write a pattern with fewer"
        )
    try:
        _compiled((pattern,))
    except (ValueError, re.error):
        return f"`{pattern}` is not a valid pattern; use the syntax of `.gitignore` files"
    return ""


@functools.lru_cache(maxsize=10_000)
def _matches(patterns: tuple[str, ...], path: str) -> bool:
    """Whether the patterns exclude `path`, regardless of its enclosing folders. The path of a folder ends with `/`."""
    folders, files = _compiled(patterns)
    return folders.match_file(path) if path.endswith("/") else files.match_file(path)


@functools.lru_cache(maxsize=16)
def _compiled(patterns: tuple[str, ...]) -> tuple[PathSpec[Pattern], GitIgnoreSpec]:
    """The matchers for folders and for files. For a folder, the last pattern that matches decides. For a file, as in
    Git, `!folder/` does not cancel a pattern that matches the file itself."""
    from pathspec import GitIgnoreSpec, PathSpec  # noqa: PLC0415 - most projects exclude nothing

    # In pathspec, `a/**` also matches the folder `a/` itself; in Git it does not.
    contents = [pattern[:-1] if pattern.endswith("/**") else pattern for pattern in patterns]
    with warnings.catch_warnings():  # `re` warns about `[[`
        warnings.simplefilter("ignore")
        return PathSpec.from_lines("gitignore", contents), GitIgnoreSpec.from_lines(patterns)
