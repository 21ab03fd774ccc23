# SPDX-License-Identifier: Apache-2.0
"""The rule `event-false-at-start`, which event_false_at_start.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.FALSE_AT_START,
    Severity.WARNING,
    "A property of the pattern `universality` requires an event at all times.",
)
