# SPDX-License-Identifier: Apache-2.0
"""jani-syntax: see jani_syntax.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "jani-syntax",
    Severity.ERROR,
    "A property does not have the form that JANI wants.",
    file=passes_on("jani-syntax"),
)
