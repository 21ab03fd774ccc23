# SPDX-License-Identifier: Apache-2.0
"""Computations with paths as text. No function accesses the disk."""

from __future__ import annotations

import os


def name_of(path: str) -> str:
    return os.path.basename(path)


def folder_of(path: str) -> str:
    return os.path.dirname(path)


def split_name(path: str) -> tuple[str, str]:
    """The name without its extension, and the extension with its dot."""
    return os.path.splitext(os.path.basename(path))


def full(folder: str, written: str) -> str:
    """The path to which `written` refers, relative to a folder. `file://` URLs and `~` are treated as plain names."""
    return os.path.normpath(os.path.join(folder, written.replace("\0", "\ufffd")))


def resolve(base: str, src: str) -> str:
    """The path to which `src`, written in the file `base`, refers."""
    return full(os.path.dirname(base), src)


def is_below(path: str, folder: str) -> bool:
    """Whether a path is in a folder, at any depth."""
    return path.startswith(os.path.join(folder, ""))


def is_on_disk(path: str) -> bool:
    """Whether `path` can be the path of a file on the disk. Documents that were never saved have a URI instead."""
    return os.path.isabs(path)


def slashed(path: str) -> str:
    """A path with `/` on every system."""
    return path.replace(os.sep, "/")


def relative(path: str, folder: str) -> str:
    """The path relative to a folder, with `/`; the absolute path if the folder is on another drive."""
    try:
        return slashed(os.path.relpath(path, folder))
    except ValueError:
        return slashed(path)


def seen_from(path: str, base: str) -> str:
    """A path relative to the file `base`, with `/`."""
    return relative(path, os.path.dirname(base))
