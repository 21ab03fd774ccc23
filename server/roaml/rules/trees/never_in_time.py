# SPDX-License-Identifier: Apache-2.0
"""The rule `never-in-time`, which never_in_time.md describes. `roaml.project.late_children` reports it, because
it needs the runs of a system."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import Rule
from roaml.text import Span


def finding(place: Span, *, no_run: str, time: int, longer: int, related: Iterable[Related]) -> Finding:
    """The finding that a child never succeeds in the time of its `Timeout`.

    Args:
        no_run: the subject of the statement, such as "no run of this system".
        time: the time in ms.
        longer: a time in ms in which the child succeeds.
    """
    message = (
        f"the child succeeds in {no_run} before this timeout of {time:,} ms; with {longer:,} ms it does; allow more "
        "time, or check the durations of the machines that execute the child"
    )
    return RULE.at(place, message, related=related)


RULE = Rule(
    "never-in-time", Severity.WARNING, "A child succeeds in no run of the system before its `Timeout`.", whole=True
)
