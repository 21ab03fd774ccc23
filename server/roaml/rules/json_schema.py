# SPDX-License-Identifier: Apache-2.0
"""json-schema: see json_schema.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "json-schema",
    Severity.ERROR,
    "A JSON Schema says something for which there is no struct.",
    file=passes_on("json-schema"),
)
