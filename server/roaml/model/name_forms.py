# SPDX-License-Identifier: Apache-2.0
"""The forms of names: which names variables and events may have."""

from __future__ import annotations

import re

from roaml.expr.words import CONTEXTUAL, RESERVED
from roaml.model.value_types import STATUSES

VARIABLE = re.compile(r"[A-Za-z_]\w*\Z", re.ASCII)
EVENT = re.compile(r"[A-Za-z_][A-Za-z0-9._-]*\Z")


def is_reserved(name: str) -> bool:
    """Whether `name` cannot name a variable or member, as it is a reserved word of ECMAScript."""
    return name in RESERVED or name in CONTEXTUAL


def variable_problem(name: str) -> str:
    """Why `name` cannot name a variable, or ""."""
    if name in STATUSES:
        return f"`{name}` is the answer of a tree node and cannot name a variable"
    if name in ("length", "Math", "true", "false"):
        return f"`{name}` has a meaning of its own and cannot name a variable"
    if is_reserved(name):
        return f"`{name}` is a word of ECMAScript and cannot name a variable"
    if not VARIABLE.match(name):
        return f"`{name}` cannot name a variable: it begins with a letter and holds letters, digits and `_`"
    if name.endswith("_"):
        return f"`{name}` ends in `_`, and such a variable cannot be used"
    return ""
