# SPDX-License-Identifier: Apache-2.0
"""model-fault: see model_fault.md. Reported where a model is run (`roaml.smc`)."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.rule import Rule
from roaml.smc.fault import MODEL_FAULT

RULE = Rule(MODEL_FAULT, Severity.ERROR, "The model executes an undefined operation.")
