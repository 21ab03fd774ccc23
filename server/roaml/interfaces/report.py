# SPDX-License-Identifier: Apache-2.0
"""Collects the findings of the readers of definition files."""

from __future__ import annotations

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.text import Span, TextEdit

CODE = "interface-syntax"
"""The code of every finding in a definition file."""

MAX_FINDINGS = 100
"""The maximum number of errors in a file; a file with more is unlikely to be an interface definition and is not read
further."""


class FileFindings:
    """The findings of one file so far."""

    def __init__(self) -> None:
        self._findings: list[Finding] = []

    def __len__(self) -> int:
        return len(self._findings)

    @property
    def is_full(self) -> bool:
        return len(self._findings) >= MAX_FINDINGS

    def add(
        self,
        span: Span,
        message: str,
        *,
        instead: str | None = None,
        at_end: int | None = None,
        before: int | None = None,
        severity: Severity | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        """Add a finding with `message` at `span`; `instead` is the correct text for `span`, or the text that is missing
        at the offset `at_end`, or perhaps at the beginning of the line at `before`."""
        fixes: tuple[Fix, ...] = ()
        where = span if at_end is None else Span(at_end, at_end)
        if instead is not None:
            title = f"Write `{shorten(' '.join(instead.split()))}`"
            fixes = (Fix(title, (TextEdit(where, instead),)),)
            if before is not None:
                earlier = TextEdit(Span(before, before), instead.lstrip())
                fixes = (
                    Fix(f"{title} before the field", (earlier,), preferred=False),
                    Fix(f"{title} after the field", fixes[0].edits, preferred=False),
                )
        self._findings.append(Finding(CODE, span, message, severity, fixes, related))

    def findings(self) -> tuple[Finding, ...]:
        """All findings in the order of the text."""
        return tuple(sorted(self._findings, key=lambda finding: finding.span))


def shorten(written: str) -> str:
    """Text of a file for a message, shortened to 40 characters."""
    return written if len(written) <= 40 else f"{written[:40]}…"
