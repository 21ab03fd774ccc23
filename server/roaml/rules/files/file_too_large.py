# SPDX-License-Identifier: Apache-2.0
"""file-too-large: see file_too_large.md. Reported where files are read (`roaml.project.checking`)."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.rules.rule import Rule

RULE = Rule("file-too-large", Severity.ERROR, "A file is too large to be checked.")
