# SPDX-License-Identifier: Apache-2.0
"""undefined-entity: see undefined_entity.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "undefined-entity",
    Severity.ERROR,
    "An entity is used that is not one of the five predefined ones.",
    file=passes_on("undefined-entity"),
)
