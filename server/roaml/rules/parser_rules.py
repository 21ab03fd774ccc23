# SPDX-License-Identifier: Apache-2.0
"""The rules whose findings the parsers make: each passes on those with its code."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.diagnostics import Finding
from roaml.rules.rule import FileContext


def passes_on(code: str) -> Callable[[FileContext], Iterator[Finding]]:
    """A check that reports what the parsers found under `code`."""

    def check(context: FileContext) -> Iterator[Finding]:
        return (finding for finding in context.findings if finding.code == code)

    return check
