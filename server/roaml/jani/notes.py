# SPDX-License-Identifier: Apache-2.0
"""The errors in a JANI file, collected while it is read."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding, Fix, Severity
from roaml.json_syntax import quote
from roaml.suggest import did_you_mean, nearest_name
from roaml.text import Span, TextEdit

SYNTAX = "jani-syntax"
NAME = "jani-name"
TYPE = "jani-type"

_MAX_GUESSES = 20
"""The maximum number of names in one file for which a similar name is searched. Each search compares a name with all
known names."""

_MAX_SUGGESTION_LENGTH = 200
"""The maximum length of a name for which a similar name is searched, in characters."""


class Notes:
    """The findings in a file. They are added while the file is read."""

    def __init__(self) -> None:
        self._findings: list[Finding] = []
        self._guesses: dict[tuple[str, str], str | None] = {}

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All findings, in the order of the text."""
        return tuple(sorted(self._findings, key=lambda finding: finding.span))

    def add(self, finding: Finding) -> None:
        self._findings.append(finding)

    def syntax(self, span: Span, message: str, severity: Severity | None = None) -> None:
        self.add(Finding(SYNTAX, span, message, severity))

    def type(self, span: Span, message: str) -> None:
        self.add(Finding(TYPE, span, message))

    def unknown(
        self,
        kind: str,
        name: str,
        span: Span,
        known: Iterable[str],
        *,
        code: str = NAME,
        severity: Severity | None = None,
        fix: bool = True,
        owner: str = "",
    ) -> None:
        """Report that `name` is not in `known`, and suggest the most similar name.

        Args:
            kind: the kind of the name, for the message.
            span: the position of the finding.
            fix: whether `span` is exactly the text of the name, so that a fix can replace it.
            owner: a phrase for the part in which the name is missing, for the message; empty for the whole model.
        """
        message = f"{owner} has no {kind} `{name[:80]}`" if owner else f"there is no {kind} `{name[:80]}`"
        fixes: tuple[Fix, ...] = ()
        if guess := self._guess(f"{owner} {kind}", name, known):
            message += did_you_mean((guess,))
        if guess and fix:
            fixes = (Fix(f"Change to `{guess}`", (TextEdit(span, quote(guess)[1:-1]),)),)
        self.add(Finding(code, span, message, severity, fixes))

    def _guess(self, kind: str, name: str, known: Iterable[str]) -> str | None:
        key = (kind, name)
        if key not in self._guesses:
            if len(self._guesses) >= _MAX_GUESSES or len(name) > _MAX_SUGGESTION_LENGTH:
                return None
            self._guesses[key] = nearest_name(name, known)
        return self._guesses[key]
