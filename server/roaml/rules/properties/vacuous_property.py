# SPDX-License-Identifier: Apache-2.0
"""The rule `vacuous-property`, which vacuous_property.md describes. `roaml.project.explored_findings` reports it,
because it needs the reachable states or runs of a system."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import Rule
from roaml.text import Span


def finding(
    span: Span, name: str, why: str, related: Iterable[Related], *, is_instant: bool, simulated: int = 0
) -> Finding:
    """The finding that nothing tests a property.

    Args:
        why: what never happens, as a sentence.
        is_instant: whether this is only known if all machines react at once.
        simulated: the number of simulated runs from which this is known; 0 if all runs are known.
    """
    assumed = " if all machines react at once" if is_instant else ""
    always = " and always holds (vacuous)"
    where = f"any of {simulated} simulated runs of this system" if simulated else f"any run{assumed}{always}"
    message = (
        f"{why}, so the property `{name}` requires nothing in {where}; check this condition and the initial values, or "
        "allow more time (max_time)"
    )
    return RULE.at(span, message, related=related)


RULE = Rule("vacuous-property", Severity.WARNING, "No run of the system tests a property.", whole=True)
