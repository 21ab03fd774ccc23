# SPDX-License-Identifier: Apache-2.0
"""missing-folder: see missing_folder.md."""

from __future__ import annotations

from roaml.diagnostics import Finding, Severity
from roaml.rules.parser_rules import passes_on
from roaml.rules.rule import Rule
from roaml.text import Span

RULE = Rule(
    "missing-folder",
    Severity.WARNING,
    "A configuration file names a folder that does not exist.",
    file=passes_on("missing-folder"),
)


def finding(span: Span, written: str) -> Finding:
    """For a folder as it is written in the configuration."""
    message = f"there is no folder `{written}`; relative paths begin at the folder of this file"
    return RULE.at(span, message)
