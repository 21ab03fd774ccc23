# SPDX-License-Identifier: Apache-2.0
"""Hover texts for the settings in a configuration file."""

from __future__ import annotations

from roaml.model.config_files import CONFIG_FILE, PROJECT_FILE
from roaml.project.files import MAX_CHARACTERS
from roaml.project.paths import name_of
from roaml.project.settings import SETTING_DOCUMENTATION, VALUES_OF_SETTINGS
from roaml.text import Span
from roaml.toml import TomlError, loads, places

_PREFIXES = {CONFIG_FILE: (), PROJECT_FILE: ("tool", "as2fm")}


def setting_at(path: str, text: str, offset: int) -> tuple[Span, str] | None:
    """The name of a setting at a place, and what the setting means; `None` if there is none, or if the file is not
    valid TOML."""
    prefix = _PREFIXES.get(name_of(path))
    if prefix is None or len(text) > MAX_CHARACTERS:
        return None
    try:
        loads(text)
    except TomlError:
        return None
    for key, span in places(text).keys.items():
        if span.start <= offset <= span.end and key[: len(prefix)] == prefix:
            name = ".".join(map(str, key[len(prefix) :]))
            if name in SETTING_DOCUMENTATION:
                values = ", ".join(f"`{value}`" for value in VALUES_OF_SETTINGS.get(name, ()))
                return span, SETTING_DOCUMENTATION[name] + (f"\n\nValues: {values}" if values else "")
    return None
