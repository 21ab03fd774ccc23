# SPDX-License-Identifier: Apache-2.0
"""Systems given as texts, translated in memory."""

from __future__ import annotations

import os
from collections.abc import Mapping

from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.jani.model import Model
from roaml.project.settings import Settings
from roaml.scxml.model import Network

FOLDER = os.path.abspath(os.sep + "model")


def loaded(files: Mapping[str, str], main: str = "main.xml") -> api.LoadedSystem:
    """
    Args:
        files: name -> text.

    Raises:
        ModelError: the system has errors.
    """
    texts = {os.path.join(FOLDER, name): text for name, text in files.items()}
    return api.load(os.path.join(FOLDER, main), settings=Settings(), texts=texts)


def errors(files: Mapping[str, str], main: str = "main.xml") -> tuple[Diagnostic, ...]:
    """What keeps the system from being translated."""
    try:
        loaded(files, main)
    except api.ModelError as error:
        return error.result.diagnostics
    return ()


def reported(files: Mapping[str, str], name: str, main: str = "main.xml") -> tuple[Diagnostic, ...]:
    """The findings of a check in one file."""
    texts = {os.path.join(FOLDER, file): text for file, text in files.items()}
    result = api.check([os.path.join(FOLDER, main)], (), Settings(), texts)
    return tuple(finding for finding in result.diagnostics if finding.path == os.path.join(FOLDER, name))


def lowered(files: Mapping[str, str], main: str = "main.xml") -> Network:
    return api.to_scxml(loaded(files, main))


def translated(files: Mapping[str, str], main: str = "main.xml") -> Model:
    return api.to_jani(loaded(files, main))
