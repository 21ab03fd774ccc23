# SPDX-License-Identifier: Apache-2.0
"""Short names for systems, for texts that contain several of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeVar

MAX_NAMES = 3
"""The maximum number of systems in a list."""

T = TypeVar("T")


def system_names(paths: Iterable[str]) -> dict[str, str]:
    """A short name for each system file: the end of its path, with the fewest folders that make it unique."""
    parts = {path: path.replace("\\", "/").split("/") for path in dict.fromkeys(paths)}

    def name(path: str) -> str:
        own = parts[path]
        others = [other for system, other in parts.items() if system != path]
        for count in range(1, len(own)):
            if all(other[-count:] != own[-count:] for other in others):
                return "/".join(own[-count:])
        return path

    return {path: name(path) for path in parts}


def grouped(texts: Mapping[str, T]) -> list[tuple[T, str]]:
    """The texts about systems, without duplicates, each with the names of its systems.

    Args:
        texts: the hashable text of each system, by the path of the system.

    Returns:
        Pairs of a text and the names, in the order of the systems. The names are "" if all systems have the same text.
    """
    names = system_names(texts)
    groups: dict[T, list[str]] = {}
    for path, text in texts.items():
        groups.setdefault(text, []).append(names[path])
    if len(groups) == 1:
        return [(next(iter(groups)), "")]
    return [(text, _listed(systems)) for text, systems in groups.items()]


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + more
