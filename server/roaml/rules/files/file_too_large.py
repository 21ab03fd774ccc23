# SPDX-License-Identifier: Apache-2.0
"""The rule `file-too-large`, which file_too_large.md describes. `roaml.project.checking` reports it
where files are read."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.rule import Rule

RULE = Rule("file-too-large", Severity.ERROR, "A file is too large to be checked.")
