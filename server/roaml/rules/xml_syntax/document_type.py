# SPDX-License-Identifier: Apache-2.0
"""The rule `document-type`, which document_type.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.record import replace
from roaml.rules.parser_rules import parser_findings
from roaml.rules.rule import FileContext, Rule


def check(context: FileContext) -> Iterator[Finding]:
    """Report document type declarations. A declaration without content, such as `<!DOCTYPE ascxml>`, has no effect, so
    the severity is information."""
    for finding in parser_findings("document-type", context):
        declares = "[" in context.source.text[finding.span.start : finding.span.end]
        yield finding if declares else replace(finding, severity=Severity.INFORMATION)


RULE = Rule(
    "document-type",
    Severity.ERROR,
    "The file has a document type declaration; entities in it are not expanded.",
    file=check,
)
