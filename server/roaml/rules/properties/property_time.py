# SPDX-License-Identifier: Apache-2.0
"""The rule `property-time`, which property_time.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.TIME,
    Severity.ERROR,
    "The clock of the system cannot measure the times of a property.",
)
