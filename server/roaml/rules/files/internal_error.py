# SPDX-License-Identifier: Apache-2.0
"""The rule `internal-error`, which internal_error.md describes. `roaml.project.checking` reports it
where a rule, or the construction of the model that the rules check, fails."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.rule import Rule

RULE = Rule("internal-error", Severity.WARNING, "A rule has failed with an internal error.")
