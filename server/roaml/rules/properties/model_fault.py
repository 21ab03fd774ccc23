# SPDX-License-Identifier: Apache-2.0
"""The rule `model-fault`, which model_fault.md describes. `roaml.smc` reports it where it runs a model."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.rule import Rule
from roaml.smc.fault import MODEL_FAULT

RULE = Rule(MODEL_FAULT, Severity.ERROR, "The model executes an undefined operation.")
