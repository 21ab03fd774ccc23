# SPDX-License-Identifier: Apache-2.0
"""The rule `property-form`, which property_form.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.FORM,
    Severity.ERROR,
    "A property does not have the parts that its pattern or formula needs.",
)
