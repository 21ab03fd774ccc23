# SPDX-License-Identifier: Apache-2.0
"""The rule `large-array-size`, which large_array_size.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, SystemContext

LARGE = 10_000
"""The greatest `max_array_size`, in elements, that is not reported."""


def check(context: SystemContext) -> Iterator[Finding]:
    size = context.file.parameters.max_array_size
    given = context.file.parameter("max_array_size")
    last = given.get("value") if given else None
    if last is not None and size > LARGE:
        message = (
            f"every array without a bound gets {size} elements, which slows down translation and verification; reduce "
            "the value"
        )
        yield RULE.at(last.value_span, message)


RULE = Rule("large-array-size", Severity.WARNING, "The default array size is very large.", system=check)
