# SPDX-License-Identifier: Apache-2.0
"""toml-syntax: see toml_syntax.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "toml-syntax",
    Severity.ERROR,
    "A configuration file is not TOML.",
    file=passes_on("toml-syntax"),
)
