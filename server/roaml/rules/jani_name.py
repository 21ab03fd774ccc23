# SPDX-License-Identifier: Apache-2.0
"""jani-name: see jani_name.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.jani.notes import NAME
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(NAME, Severity.ERROR, "Two properties in a file have the same name.", file=passes_on(NAME))
