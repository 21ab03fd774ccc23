# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-property-port`, which unknown_property_port.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.UNKNOWN_PORT,
    Severity.ERROR,
    "A port names an interface, node or event that the system does not have.",
)
