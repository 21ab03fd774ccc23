# SPDX-License-Identifier: Apache-2.0
"""Which existing files no output may replace: models and other files that people write."""

from __future__ import annotations

import os

from roaml.disk import MAX_BYTES, UnreadableReason, read
from roaml.model.config_files import CONFIG_FILES
from roaml.model.kinds import MOCKS_EXTENSION, PROJECT_EXTENSION, FileKind, kind_of
from roaml.scxml.names import TRANSLATION_MARK
from roaml.text import decode

_SOURCE_NAMES = ("package.xml", "CMakeLists.txt", *CONFIG_FILES)
_SOURCE_EXTENSIONS = (MOCKS_EXTENSION, PROJECT_EXTENSION)
"""Files that people write and that are read beside models, with contents that `kind_of` does not recognize."""


def reason_to_keep(path: str, *, translates: bool = False) -> str | None:
    """Why an output must not replace the file at `path`; `None` if there is no file, or if it may be replaced.

    Args:
        translates: whether the output is a translation, which may replace an older translation.
    """
    data = read(path, head=MAX_BYTES)
    if data is UnreadableReason.MISSING:
        return None
    if isinstance(data, UnreadableReason):
        return f"this file exists, and it is not known whether it is a model: {data.value}"
    source = decode(path, data).text
    kind = _kind(path, source)
    if kind is None or (translates and TRANSLATION_MARK in source):
        return None
    return f"this file exists, and it is not an output ({kind})"


def _kind(path: str, text: str) -> str | None:
    """The kind of a file that must be kept; `None` if the file may be replaced."""
    if not text.strip():
        return None
    name = os.path.basename(path)
    if name in _SOURCE_NAMES or name.endswith(_SOURCE_EXTENSIONS):
        return "source file"
    kind = kind_of(path, text)
    return None if kind is FileKind.UNKNOWN else kind.value
