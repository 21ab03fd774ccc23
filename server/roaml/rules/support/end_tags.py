# SPDX-License-Identifier: Apache-2.0
"""Removes findings about end tags that differ from their start tags because the name in the start tag is wrong."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.diagnostics import Finding, Severity, Symbol
from roaml.text import Span


def without_misnamed_ends(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """The findings without those about end tags whose start tag has another finding with a fix, which changes both
    tags."""
    wrong: set[Span | Symbol] = {f.span for f in findings if f.fixes and _is_certain(f)}
    return tuple(finding for finding in findings if not _is_at_wrong_start(finding, wrong))


def _is_certain(finding: Finding) -> bool:
    """Whether a finding states that the name of an element is wrong, so that its fixes change both tags."""
    is_error = finding.severity in (None, Severity.ERROR)
    return finding.code == "unknown-element" or (finding.code == "unknown-node" and is_error)


def _is_at_wrong_start(finding: Finding, wrong: set[Span | Symbol]) -> bool:
    return finding.code == "xml-syntax" and any(related.place in wrong for related in finding.related)
