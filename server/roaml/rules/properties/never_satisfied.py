# SPDX-License-Identifier: Apache-2.0
"""The rule `never-satisfied`, which never_satisfied.md describes. `roaml.project.explored_findings` reports it,
because it needs the reachable states or runs of a system."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import Rule
from roaml.text import Span


def finding(
    span: Span, name: str, why: str, related: Iterable[Related], *, is_instant: bool, simulated: int = 0
) -> Finding:
    """The finding that a property holds in no run.

    Args:
        why: the reason, or what to change, as a clause.
        is_instant: whether this is only known if all machines react at once.
        simulated: the number of simulated runs from which this is known, without those that do not test the property; 0
            if all runs are known.
    """
    assumed = " if all machines react at once" if is_instant else ""
    known = f"no run of this system satisfies the property `{name}`{assumed}"
    if simulated:
        known = f"none of {simulated} simulated runs of this system that test the property `{name}` satisfies it"
    message = f'{known}: {why}; check the property and the system, or write `expect="= 0"` if this is intended'
    return RULE.at(span, message, related=related)


RULE = Rule("never-satisfied", Severity.WARNING, "No run of the system satisfies a property.", whole=True)
