# SPDX-License-Identifier: Apache-2.0
"""The problems of parameters, instances and channels, as findings of the rules that `roaml.rules.expansion_rules`
defines."""

from __future__ import annotations

import enum
from collections.abc import Iterable, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity, Tag
from roaml.text import Span, TextEdit


class ExpansionProblem(enum.Enum):
    """The kind of a problem. The value is the code of the rule that reports it."""

    DECLARATION = "parameter-declaration"
    DUPLICATE = "duplicate-parameter"
    VALUE = "parameter-value"
    UNKNOWN = "undeclared-parameter"
    UNUSED = "unused-parameter"
    HIDDEN = "hidden-parameter"
    ASSIGNED = "assigned-parameter"
    INSTANCE = "invalid-instance"
    NAMESPACE = "repeated-namespace"
    INCONSISTENT = "inconsistent-parameter"
    INVERTED = "inverted-rate"
    CHANNEL = "invalid-channel"
    DISTRIBUTION = "invalid-distribution"
    MISPLACED = "misplaced-random"
    REMAP = "unused-remap"
    REFERENCE = "not-in-reference"


class Problems:
    """Collects the problems of one file. Equal problems, such as those of several instances, are kept once."""

    def __init__(self) -> None:
        self._findings: dict[Finding, None] = {}

    @property
    def findings(self) -> tuple[Finding, ...]:
        return tuple(self._findings)

    def add(
        self,
        kind: ExpansionProblem,
        span: Span,
        message: str,
        *,
        close: Sequence[str] = (),
        fixes: Iterable[Fix] = (),
        related: Iterable[tuple[Span, str]] = (),
        severity: Severity | None = None,
        tags: tuple[Tag, ...] = (),
    ) -> None:
        """Add a problem.

        Args:
            close: similar names, each of which may be intended at `span`.
        """
        replaced = (
            Fix(f"Change to `{name}`", (TextEdit(span, name),), preferred=number == 0)
            for number, name in enumerate(close)
        )
        places = tuple(Related(place, text) for place, text in related)
        finding = Finding(kind.value, span, message, severity, (*fixes, *replaced), places, tags)
        self._findings[finding] = None
