# SPDX-License-Identifier: Apache-2.0
"""The rule `inexact-max-time`, which inexact_max_time.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.durations import NANOSECONDS
from roaml.model.timing import periods
from roaml.rules.rule import Rule, SystemContext
from roaml.text import Span, TextEdit

NAMES = {nanoseconds: name for name, nanoseconds in NANOSECONDS.items()}


def check(context: SystemContext) -> Iterator[Finding]:
    end = context.file.parameters.max_time
    unit = min((period.unit for period in periods(context.system)), default=1)
    if end is None or end % unit == 0:
        return
    given = context.file.parameter("max_time")
    value, written = (given.get("value"), given.get("unit")) if given else (None, None)
    if value is None or written is None:
        return
    name, count = NAMES[unit], -(-end // unit)
    message = f"`max_time` must be a whole number of {name}, because the timers need a clock with this unit"
    edits = (TextEdit(value.value_span, str(count)), TextEdit(written.value_span, name))
    place = Span(min(value.span.start, written.span.start), max(value.span.end, written.span.end))
    yield RULE.at(place, message, Fix(f"Round up to {count} {name}", edits, preferred=False))


RULE = Rule("inexact-max-time", Severity.ERROR, "`max_time` is not a multiple of the unit of the clock.", system=check)
