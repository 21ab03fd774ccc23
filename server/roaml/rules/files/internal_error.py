# SPDX-License-Identifier: Apache-2.0
"""internal-error: see internal_error.md. Reported where a rule crashes (`roaml.project.checking`)."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.rule import Rule

RULE = Rule("internal-error", Severity.WARNING, "A rule has failed with an internal error.")
