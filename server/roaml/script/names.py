# SPDX-License-Identifier: Apache-2.0
"""The names in a script."""

from __future__ import annotations

import functools
import re

from roaml.regex import regex
from roaml.script.parse import parse
from roaml.script.tree import Assignment, Name, walk
from roaml.text import Decoded


@functools.lru_cache(maxsize=2048)
def names_in(text: str) -> tuple[tuple[str, str], ...]:
    """The names in a script, each with `read` or with the operator that assigns to it. The result includes the entries
    that statements with syntax errors create."""
    script, problems = parse(Decoded(text, 0))
    names: list[tuple[str, str]] = []
    targets: set[int] = set()
    for expr in walk(script):
        if isinstance(expr, Assignment):
            targets.add(id(expr.target))
            names.append((expr.target.name, expr.operator))
        elif isinstance(expr, Name) and id(expr) not in targets:
            names.append((expr.name, "read"))
    if problems:
        names += [(name, ":=") for name in _CREATED.findall(text)]
    return tuple(names)


_CREATED = regex(r"(@?[A-Za-z_]\w*)\s*:=", re.ASCII)
