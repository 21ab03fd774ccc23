# SPDX-License-Identifier: Apache-2.0
"""invalid-setting: see invalid_setting.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "invalid-setting",
    Severity.ERROR,
    "A configuration file has a setting that does not exist, or a value that does not fit.",
    file=passes_on("invalid-setting"),
)
