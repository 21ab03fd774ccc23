# SPDX-License-Identifier: Apache-2.0
"""interface-syntax: see interface_syntax.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule

RULE = Rule(
    "interface-syntax",
    Severity.ERROR,
    "A ROS interface definition does not follow the rules of ROS 2.",
    file=passes_on("interface-syntax"),
)
