# SPDX-License-Identifier: Apache-2.0
"""duplicate-json-key: see duplicate_json_key.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "duplicate-json-key",
    Severity.WARNING,
    "An object has the same key twice; only the last one counts.",
    file=passes_on("duplicate-json-key"),
)
