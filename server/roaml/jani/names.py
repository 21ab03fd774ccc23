# SPDX-License-Identifier: Apache-2.0
"""The names that are declared in one part of a JANI file."""

from __future__ import annotations

import itertools

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.jani.notes import NAME, Notes
from roaml.json_syntax import JsonString
from roaml.json_syntax.strings import quote
from roaml.text import Span, TextEdit


class DeclaredNames:
    """The declared names of one kind. Names that are declared twice, or used without a declaration, are reported.

    Args:
        kind: the kind, such as `variable`, for messages.
        outer: the names of the same kind in the model, for names in an automaton.
    """

    def __init__(self, kind: str, notes: Notes, outer: DeclaredNames | None = None) -> None:
        self._kind = kind
        self._notes = notes
        self._outer = outer
        self._first: dict[str, Span] = {}

    def declare(self, name: JsonString) -> None:
        text, span = name.value, name.content_span
        first = self._first.setdefault(text, span)
        if first is not span:
            new = next(n for i in itertools.count(2) if (n := f"{text}_{i}") not in self._first)
            rename = Fix(f"Rename this one to `{new}`", (TextEdit(span, quote(new)[1:-1]),), preferred=False)
            self._report(name, f"{self._kind} `{text}` is declared twice", first, None, rename)
        elif self._outer and text in self._outer._first:
            message = f"{self._kind} `{text}` hides the {self._kind} of the model with the same name"
            self._report(name, message, self._outer._first[text], Severity.WARNING)

    def use(self, name: JsonString) -> None:
        if name.value not in self._first:
            self._notes.unknown(self._kind, name.value, name.content_span, self._first)

    def _report(
        self, name: JsonString, message: str, first: Span, severity: Severity | None = None, *fixes: Fix
    ) -> None:
        related = (Related(first, "declared here"),)
        self._notes.add(Finding(NAME, name.content_span, message, severity, fixes, related))
