# SPDX-License-Identifier: Apache-2.0
"""The rule `unsent-port`, which unsent_port.md describes."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULE = problem_rule(
    ProblemKind.UNSENT,
    Severity.WARNING,
    "A port listens to an event that is never sent.",
)
