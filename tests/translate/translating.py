# SPDX-License-Identifier: Apache-2.0
"""Systems given as texts, translated in memory."""

from __future__ import annotations

import os
from collections.abc import Mapping

from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.jani.model import Model
from roaml.lower import lower
from roaml.project.settings import Settings
from roaml.project.translation import program_of
from roaml.scxml.model import Network
from roaml.to_jani import translate

FOLDER = os.path.abspath(os.sep + "model")


def checked(files: Mapping[str, str], main: str = "main.xml") -> api.CheckResult:
    texts = {os.path.join(FOLDER, name): text for name, text in files.items()}
    return api.check([os.path.join(FOLDER, main)], settings=Settings(), texts=texts)


def errors(result: api.CheckResult) -> list[Diagnostic]:
    return [d for d in result.diagnostics if d.severity is Severity.ERROR]


def lowered(files: Mapping[str, str], main: str = "main.xml") -> Network:
    """
    Raises:
        AssertionError: the system has errors.
    """
    result = checked(files, main)
    assert not errors(result), [f"{d.path}: {d.message}" for d in errors(result)]
    return lower(program_of(result.snapshot.analysis, os.path.join(FOLDER, main)))


def translated(files: Mapping[str, str], main: str = "main.xml") -> Model:
    return translate(lowered(files, main))
