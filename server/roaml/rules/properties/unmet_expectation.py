# SPDX-License-Identifier: Apache-2.0
"""The rule `unmet-expectation`, which unmet_expectation.md describes. `roaml.project.explored_findings` reports it,
because it needs the reachable states or runs of a system."""

from __future__ import annotations

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule
from roaml.text import Span


def finding(span: Span, name: str, expectation: str, values: str, *, is_instant: bool) -> Finding:
    """The finding that the value of a property cannot meet its expectation.

    Args:
        values: the values that the property has, as a phrase.
        is_instant: whether this is only known if all machines react at once.
    """
    assumed = " if all machines react at once" if is_instant else ""
    message = (
        f"`{name}` is {values}{assumed}, so the expectation `{expectation}` is never met; check it, and the property"
    )
    return RULE.at(span, message)


RULE = Rule("unmet-expectation", Severity.WARNING, "No value of a property meets its expectation.", whole=True)
