# SPDX-License-Identifier: Apache-2.0
"""nesting-too-deep: see nesting_too_deep.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "nesting-too-deep",
    Severity.ERROR,
    "Elements are nested deeper than the analysis goes.",
    file=passes_on("nesting-too-deep"),
)
