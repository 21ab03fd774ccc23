# SPDX-License-Identifier: Apache-2.0
"""The rule `never-taken`, which never_taken.md describes. `roaml.project.explored_findings` reports it, because it
needs all reachable states of a system."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import Rule
from roaml.text import Span


def finding(
    condition: Span,
    *,
    holds: bool,
    related: Iterable[Related],
    no_run: str,
    is_instant: bool,
    where: str = "",
    values: str = "",
) -> Finding:
    """The finding that a condition stops a system.

    Args:
        condition: the place of the condition.
        holds: whether the condition always holds, so that what follows it is never executed.
        no_run: the subject of the statement, such as "no run of this system".
        is_instant: whether this is only known if all machines react at once.
        where: to what this is restricted, as an adverbial phrase; "" if there is no restriction.
        values: the values that occur when the condition is evaluated, as a clause; "" if they are not known.
    """
    assumed = " if all machines react at once" if is_instant else ""
    restricted = f" {where}" if where else ""
    if holds:
        what, why = "the transition or branch after this one", "this condition holds whenever it is evaluated"
    else:
        what, why = "this transition or branch", "its condition is evaluated, but never holds"
    why += f" ({values} here in simulated runs)" if values else ""
    message = (
        f"{no_run} takes {what}{restricted}{assumed}: {why}; the related places have no effect because of "
        "this; check the condition, and where its values come from"
    )
    return RULE.at(condition, message, related=related)


RULE = Rule(
    "never-taken", Severity.WARNING, "A condition stops the system, because it never or always holds.", whole=True
)
