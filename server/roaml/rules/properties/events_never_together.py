# SPDX-License-Identifier: Apache-2.0
"""The rule `events-never-together`, which events_never_together.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.NEVER_TOGETHER,
    Severity.WARNING,
    "A condition requires two events at the same time.",
)
