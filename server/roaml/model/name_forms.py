# SPDX-License-Identifier: Apache-2.0
"""The syntax of names: which names variables and events may have."""

from __future__ import annotations

import re

from roaml.expr.words import CONTEXTUAL, RESERVED
from roaml.regex import regex
from roaml.scxml.names import STATUSES

VARIABLE = regex(r"[A-Za-z_]\w*\Z", re.ASCII)
EVENT = regex(r"[A-Za-z_][A-Za-z0-9._-]*\Z")


def is_reserved(name: str) -> bool:
    """Whether `name` is a reserved word of ECMAScript, which cannot be the name of a variable or member."""
    return name in RESERVED or name in CONTEXTUAL


def variable_problem(name: str) -> str:
    """A message that says why `name` is not a valid variable name; "" if it is valid."""
    if name in STATUSES:
        return f"`{name}` is the status of a tree node and cannot be the name of a variable"
    if name in ("length", "Math", "true", "false"):
        return f"`{name}` has a special meaning and cannot be the name of a variable"
    if is_reserved(name):
        return f"`{name}` is a reserved word of ECMAScript and cannot be the name of a variable"
    if not VARIABLE.match(name):
        return (
            f"`{name}` is not a valid variable name: it must begin with a letter or `_` and contain only letters, "
            "digits and `_`"
        )
    if name.endswith("_"):
        return f"`{name}` ends in `_`, which is not allowed in the name of a variable"
    return ""
