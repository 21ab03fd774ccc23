# SPDX-License-Identifier: Apache-2.0
"""xml-syntax: see xml_syntax.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule("xml-syntax", Severity.ERROR, "The file is not well-formed XML.", file=passes_on("xml-syntax"))
