# SPDX-License-Identifier: Apache-2.0
"""The rule `port-variable`, which port_variable.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.PORT_VARIABLE,
    Severity.ERROR,
    "A variable of a port cannot get a value.",
)
