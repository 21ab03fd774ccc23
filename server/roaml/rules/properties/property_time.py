# SPDX-License-Identifier: Apache-2.0
"""property-time: see property_time.md."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.TIME,
    Severity.ERROR,
    "The times of a property cannot be measured.",
)
