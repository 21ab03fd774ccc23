# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-port-variable`, which unused_port_variable.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.UNUSED,
    Severity.WARNING,
    "No property uses a variable of a port, or a port has no variables.",
)
