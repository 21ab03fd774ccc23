# SPDX-License-Identifier: Apache-2.0
"""json-syntax: see json_syntax.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule("json-syntax", Severity.ERROR, "The file is not well-formed JSON.", file=passes_on("json-syntax"))
