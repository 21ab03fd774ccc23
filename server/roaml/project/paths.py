# SPDX-License-Identifier: Apache-2.0
"""Paths as text: their parts, and one seen from another. Nothing here looks at the disk."""

from __future__ import annotations

import os


def name_of(path: str) -> str:
    return os.path.basename(path)


def folder_of(path: str) -> str:
    return os.path.dirname(path)


def split_name(path: str) -> tuple[str, str]:
    """The name without its extension, and the extension with its dot."""
    return os.path.splitext(os.path.basename(path))


def inside(folder: str, name: str) -> str:
    return os.path.join(folder, name)


def is_below(path: str, folder: str) -> bool:
    return path.startswith(folder + os.sep)


def is_on_disk(path: str) -> bool:
    """Whether a path could be that of a file; documents that were never saved have a URI."""
    return os.path.isabs(path)


def seen_from(path: str, base: str) -> str:
    """A path as the file `base` would name it, with `/`."""
    return os.path.relpath(path, os.path.dirname(base)).replace(os.sep, "/")
