# SPDX-License-Identifier: Apache-2.0
"""duplicate-attribute: see duplicate_attribute.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "duplicate-attribute",
    Severity.ERROR,
    "An element has the same attribute twice.",
    file=passes_on("duplicate-attribute"),
)
