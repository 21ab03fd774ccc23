# SPDX-License-Identifier: Apache-2.0
"""Systems given as texts, translated in memory."""

from __future__ import annotations

import os
from collections.abc import Mapping

from roaml import api
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


def lowered(files: Mapping[str, str], main: str = "main.xml") -> Network:
    return api.to_scxml(loaded(files, main))


def translated(files: Mapping[str, str], main: str = "main.xml") -> Model:
    return api.to_jani(loaded(files, main))
