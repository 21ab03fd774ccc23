# SPDX-License-Identifier: Apache-2.0
"""The rule `property-condition`, which property_condition.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.CONDITION,
    Severity.ERROR,
    "A condition of a property is not a boolean expression over the variables of the ports.",
)
