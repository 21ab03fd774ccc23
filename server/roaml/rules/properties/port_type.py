# SPDX-License-Identifier: Apache-2.0
"""The rule `port-type`, which port_type.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.PORT_TYPE,
    Severity.ERROR,
    "The type of a port differs from the type of the interface.",
)
