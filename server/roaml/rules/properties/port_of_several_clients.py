# SPDX-License-Identifier: Apache-2.0
"""The rule `port-of-several-clients`, which port_of_several_clients.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.SEVERAL_CLIENTS,
    Severity.WARNING,
    "A port of a service or action does not choose one of several clients.",
)
