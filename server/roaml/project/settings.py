# SPDX-License-Identifier: Apache-2.0
"""What the user has configured, the same for editor and CI.

Read from `as2fm.toml` or `[tool.as2fm]` of a `pyproject.toml` in the root folder. A mistake in it is a message; what is
right is still used.
"""

from __future__ import annotations

import glob
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from roaml.diagnostics import Severity
from roaml.disk import MAX_CONFIGURATION, NotReadableError, Problem, required
from roaml.model.size import DEFAULT_LIMITS, Limits
from roaml.model.system_file import NO_OVERRIDES, Overrides
from roaml.rules import BY_CODE

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CONFIG_FILE = "as2fm.toml"
SCHEDULERS = ("uniform",)
SEVERITIES = {severity.label: severity for severity in Severity}


@dataclass(frozen=True, slots=True)
class Settings:
    """Attributes:
    roots: folders in which systems are looked for; empty means the folders that are open or named.
    ros_paths: folders with ROS interface packages.
    exclude: glob patterns of paths that are passed over, with all that is below them; those that are not absolute are
        relative to each root.
    select: codes to report; empty means all. ignore: codes not to report.
    severities: code -> severity in place of the rule's own.
    scheduler: "uniform" if `verify` is meant to answer for uniform choices, also where a property asks for the minimum
        or maximum over all schedulers; else empty.
    limits: how large a system may be to be translated.
    overrides: parameters in place of those in system files; not read from a configuration.
    """

    roots: tuple[str, ...] = ()
    ros_paths: tuple[str, ...] = ()
    ament_prefixes: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    select: frozenset[str] = frozenset()
    ignore: frozenset[str] = frozenset()
    severities: Mapping[str, Severity] = field(default_factory=dict)
    warnings_as_errors: bool = False
    scheduler: str = ""
    limits: Limits = DEFAULT_LIMITS
    overrides: Overrides = NO_OVERRIDES


def ament_prefixes(environment: Mapping[str, str] = os.environ) -> tuple[str, ...]:
    """The folders in `AMENT_PREFIX_PATH`."""
    return tuple(part for part in environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part)


def read_settings(folder: str, base: Settings) -> tuple[Settings, tuple[str, ...]]:
    """`base` with what the configuration in `folder` says, and what is wrong with it (sentences with the file)."""
    for name, keys in ((CONFIG_FILE, ()), ("pyproject.toml", ("tool", "as2fm"))):
        path = os.path.join(folder, name)
        try:
            table: Any = tomllib.loads(required(path, MAX_CONFIGURATION).decode("utf-8").replace("\r\n", "\n"))
        except NotReadableError as error:
            if error.problem is Problem.MISSING:
                continue
            return base, (str(error),)
        except (ValueError, RecursionError) as error:
            if name == CONFIG_FILE:
                words = "brackets are nested too deep" if isinstance(error, RecursionError) else str(error)
                return base, (f"{path}: {words}",)
            continue
        for key in keys:
            table = table.get(key) if isinstance(table, dict) else None
        if isinstance(table, dict):
            return settings_from(table, folder, base, path)
    return base, ()


def find_settings(path: str) -> tuple[Settings, tuple[str, ...]]:
    """The configuration in the nearest folder around `path` that has one, and what is wrong with it."""
    for folder in _folders_above(path):
        settings, problems = read_settings(folder, Settings())
        if problems or settings != Settings():
            return settings, problems
    return Settings(), ()


def settings_from(
    table: Mapping[str, Any], folder: str, base: Settings, origin: str
) -> tuple[Settings, tuple[str, ...]]:
    """`base` with the values of a configuration table; paths in it are relative to `folder`."""
    problems: list[str] = []
    changes: dict[str, Any] = {}
    for key, value in table.items():
        if key not in _KEYS:
            problems.append(f"{origin}: unknown setting `{key}`; there are {', '.join(sorted(_KEYS))}")
            continue
        if key == "verify":
            problems += _verify_problems(value, origin)
            if isinstance(value, dict) and value.get("scheduler") in SCHEDULERS:
                changes["scheduler"] = value["scheduler"]
            continue
        read = _KEYS[key](value)
        if read is None:
            problems.append(f"{origin}: `{key}` is not {_WANTED[key]}")
            continue
        if key in _OF_CODES:
            problems += [f"{origin}: `{key}` names `{code}`, and there is no such rule" for code in _unknown(read)]
        name = _FIELDS.get(key, key.replace("-", "_"))
        if key in ("roots", "ros-path"):
            read = tuple(os.path.normpath(os.path.join(folder, path)) for path in read)
        if key == "exclude":
            read = tuple(os.path.join(glob.escape(folder), pattern) for pattern in read)
        if key in _LIMITS:
            changes["limits"] = replace(changes.get("limits", base.limits), **{_LIMITS[key]: read})
            continue
        before = getattr(base, name)
        changes[name] = (*before, *read) if key == "ros-path" else type(before)(read) if key in _SETS else read
    return replace(base, **changes), tuple(problems)


def _verify_problems(value: Any, origin: str) -> Iterator[str]:
    """What is wrong with the table `[verify]`."""
    if not isinstance(value, dict):
        yield f"{origin}: `verify` is not a table"
        return
    for key, said in value.items():
        if key != "scheduler":
            yield f"{origin}: unknown setting `verify.{key}`; there is scheduler"
        elif said not in SCHEDULERS:
            yield f"{origin}: `verify.scheduler` is not {' or '.join(SCHEDULERS)}"


def _strings(value: Any) -> tuple[str, ...] | None:
    if isinstance(value, str):
        return (value,)
    return tuple(value) if isinstance(value, list) and all(isinstance(v, str) for v in value) else None


def _severities(value: Any) -> dict[str, Severity] | None:
    if not isinstance(value, dict) or not all(isinstance(v, str) and v in SEVERITIES for v in value.values()):
        return None
    return {code: SEVERITIES[label] for code, label in value.items()}


def _boolean(value: Any) -> bool | None:
    return value if isinstance(value, bool) else None


def _count(value: Any) -> int | None:
    return value if isinstance(value, int) and not isinstance(value, bool) and value > 0 else None


def _unknown(codes: Iterable[str]) -> list[str]:
    return [code for code in codes if code not in BY_CODE]


_SETS = ("select", "ignore")
_LIMITS = {"max-cells": "cells", "max-parts": "parts"}
_OF_CODES = (*_SETS, "severity")
_FIELDS = {"ros-path": "ros_paths", "severity": "severities"}
_KEYS: dict[str, Any] = {
    "roots": _strings,
    "ros-path": _strings,
    "exclude": _strings,
    "select": _strings,
    "ignore": _strings,
    "severity": _severities,
    "warnings-as-errors": _boolean,
    "verify": None,
    "max-cells": _count,
    "max-parts": _count,
}
_WANTED = {
    **dict.fromkeys(("roots", "ros-path", "exclude", "select", "ignore"), "a list of texts"),
    "severity": "a table of codes with " + ", ".join(SEVERITIES),
    "warnings-as-errors": "true or false",
    **dict.fromkeys(_LIMITS, "a whole number above 0"),
}


def enclosing_root(path: str) -> str | None:
    """The nearest folder around `path` that is a repository or holds our configuration."""
    for folder in _folders_above(path):
        if any(os.path.exists(os.path.join(folder, mark)) for mark in (".git", ".hg", CONFIG_FILE)):
            return folder
    return None


def _folders_above(path: str) -> Iterator[str]:
    folder = path if os.path.isdir(path) else os.path.dirname(path)
    while True:
        yield folder
        parent = os.path.dirname(folder)
        if parent == folder:
            return
        folder = parent
