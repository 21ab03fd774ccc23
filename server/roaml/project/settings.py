# SPDX-License-Identifier: Apache-2.0
"""The user's settings, which are the same in the editor and in CI.

The settings are read from the nearest `as2fm.toml`, or `pyproject.toml` with `[tool.as2fm]`, in a folder or its
enclosing folders (`roaml.project.configuration`). Errors are reported in that file, and the valid settings are still
used.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

from roaml.comparison import Comparison, UniformPolicy, read_comparison
from roaml.diagnostics import Severity, current_code
from roaml.durations import REACTION_TIME, ReactionTime, reaction_time
from roaml.forest.settings import NEWEST, TreeSettings
from roaml.libraries import LIBRARIES
from roaml.libraries.version import Version, read_version
from roaml.model.config_files import CONFIG_FILE
from roaml.model.parameters import NO_OVERRIDES, SEMANTICS, Overrides, TreeSemantics
from roaml.model.size import DEFAULT_LIMITS, Limits
from roaml.project import exclude
from roaml.project.exclude import NOTHING, Exclude
from roaml.project.paths import full
from roaml.record import Record, field, replace
from roaml.suggest import close_names, did_you_mean, listing
from roaml.toml import Path

SEVERITIES = {severity.label: severity for severity in Severity}


class Settings(Record, frozen=True):
    """The user's settings.

    Attributes:
        roots: the folders that are searched for systems; if empty, the folders that are open in the editor or named on
            the command line.
        ros_paths: folders with ROS interface packages.
        ament_prefixes: folders in which ROS packages are installed.
        exclude: the files that are ignored.
        select: the codes of the rules that are reported; empty for all rules.
        ignore: the codes of the rules that are not reported.
        severities: code -> the severity that replaces the default of the rule.
        warnings_as_errors: whether warnings are reported as errors.
        only_uniform: whether `verify` assumes uniform choices even if a property requests the minimum or maximum over
            all schedulers.
        uniform: what an expectation is worth that is met under uniform choices only.
        expectations: name of a property -> the result that `verify` expects.
        reaction_time: the reaction time of trees with mocks, and of systems that state none; `None` for `instant` in
            trees and `any` in systems.
        limits: the maximum size of a system that is translated.
        overrides: parameters that replace those in system files; they are not read from a configuration.
        parameters: names and texts of values for parameters that models declare (docs/spec/parameters.md#values).
        trees: the settings for trees.
        origin: the path of the configuration file; "" if there is none.
    """

    roots: tuple[str, ...] = ()
    ros_paths: tuple[str, ...] = ()
    ament_prefixes: tuple[str, ...] = ()
    exclude: Exclude = NOTHING
    select: frozenset[str] = frozenset()
    ignore: frozenset[str] = frozenset()
    severities: Mapping[str, Severity] = field(default_factory=dict)
    warnings_as_errors: bool = False
    only_uniform: bool = False
    uniform: UniformPolicy = UniformPolicy.WARN
    expectations: Mapping[str, Comparison] = field(default_factory=dict)
    reaction_time: ReactionTime | None = None
    limits: Limits = DEFAULT_LIMITS
    overrides: Overrides = NO_OVERRIDES
    parameters: tuple[tuple[str, str], ...] = ()
    trees: TreeSettings = NEWEST
    origin: str = ""


def ament_prefixes(environment: Mapping[str, str] = os.environ) -> tuple[str, ...]:
    """The folders in the variable `AMENT_PREFIX_PATH` of an environment, in which ROS packages are installed."""
    return tuple(part for part in environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part)


class SettingProblem(Record, frozen=True):
    """An error in a configuration table.

    Attributes:
        path: the place of the error in the table: keys of tables and indices of lists.
        message: a message that states the error and the correction.
        is_key: whether the key is wrong, not its value.
        instead: similar valid names.
    """

    path: Path
    message: str
    is_key: bool = False
    instead: tuple[str, ...] = ()


class Folder(Record, frozen=True):
    """A folder in a configuration. `path` is its place in the table, `written` its text, `full` the absolute path."""

    path: Path
    written: str
    full: str


def settings_from(table: Mapping[str, Any], folder: str, base: Settings) -> tuple[Settings, tuple[SettingProblem, ...]]:
    """A copy of `base` with the valid values of a configuration table, and the errors in the table.

    Args:
        folder: the base of relative paths in the table.
    """
    problems: list[SettingProblem] = []
    changes: dict[str, Any] = {}
    for key, value in table.items():
        if key not in _KEYS:
            close = close_names(key, _KEYS)
            known = did_you_mean(close) if close else f"; valid settings are {', '.join(sorted(_KEYS))}"
            problems.append(SettingProblem((key,), f"there is no setting `{key}`{known}", is_key=True, instead=close))
            continue
        read = _KEYS[key]((key,), value, problems)
        if read is None:
            continue
        if key == "verify":
            changes.update(read)
            continue
        name = _FIELDS.get(key, key.replace("-", "_"))
        if key in _FOLDERS:
            read = tuple(full(folder, path) for path in read)
        if key == "exclude":
            read = Exclude(read, folder)
        if key in _TREES:
            if key == "tree-models":
                read = tuple(full(folder, path) for path in read)
            changes["trees"] = replace(changes.get("trees", base.trees), **{_TREES[key]: read})
            continue
        if key in _LIMITS:
            changes["limits"] = replace(changes.get("limits", base.limits), **{_LIMITS[key]: read})
            continue
        before = getattr(base, name)
        changes[name] = (*before, *read) if key == "ros-path" else type(before)(read) if key in _SETS else read
    return replace(base, **changes), tuple(problems)


def folders_in(table: Mapping[str, Any], folder: str) -> Iterator[Folder]:
    """The folders that a configuration table names."""
    for key in _FOLDERS:
        value = table.get(key)
        if isinstance(value, str):
            yield Folder((key,), value, full(folder, value))
        elif isinstance(value, list):
            for index, entry in enumerate(value):
                if isinstance(entry, str):
                    yield Folder((key, index), entry, full(folder, entry))


_Reader = Callable[[Path, Any, list[SettingProblem]], Any]
"""Reads the value at a path of the table, and adds errors to a list. The result is `None` for an unusable value."""


def _strings(path: Path, value: Any, problems: list[SettingProblem]) -> tuple[str, ...] | None:
    if isinstance(value, str):
        return (value,)
    if isinstance(value, list) and all(isinstance(entry, str) for entry in value):
        return tuple(value)
    problems.append(SettingProblem(path, f"`{path[0]}` must be a list of strings"))
    return None


def _patterns(path: Path, value: Any, problems: list[SettingProblem]) -> tuple[str, ...] | None:
    read = _strings(path, value, problems)
    if read is None:
        return None
    wrong = [exclude.problem(pattern) for pattern in read]
    for place, problem in zip(_places(path, value), wrong, strict=True):
        if problem:
            problems.append(SettingProblem(place, problem))
    return tuple(pattern for pattern, problem in zip(read, wrong, strict=True) if not problem)


def _places(path: Path, value: str | list[str]) -> list[Path]:
    """The paths of the strings that `_strings` reads from `value`."""
    return [path] if isinstance(value, str) else [(*path, index) for index in range(len(value))]


def _rule_codes() -> Collection[str]:
    from roaml.rules import BY_CODE  # noqa: PLC0415 - a model is verified faster without loading the rules

    return BY_CODE


def _codes(path: Path, value: Any, problems: list[SettingProblem]) -> tuple[str, ...] | None:
    read = _strings(path, value, problems)
    if read is None:
        return None
    read = tuple(map(current_code, read))
    for place, code in zip(_places(path, value), read, strict=True):
        if code not in _rule_codes():
            problems.append(_no_rule(place, code))
    return tuple(code for code in read if code in _rule_codes())


def _no_rule(place: Path, code: str, is_key: bool = False) -> SettingProblem:
    close = close_names(code, _rule_codes())
    return SettingProblem(place, f"there is no rule `{code}`{did_you_mean(close)}", is_key, close)


def _severities(path: Path, value: Any, problems: list[SettingProblem]) -> dict[str, Severity] | None:
    if not isinstance(value, dict):
        problems.append(SettingProblem(path, f"`{path[0]}` must be a table of rule codes and severities"))
        return None
    severities = {}
    for written, label in value.items():
        code = current_code(written)
        if code not in _rule_codes():
            problems.append(_no_rule((*path, code), code, is_key=True))
        elif not isinstance(label, str) or label not in SEVERITIES:
            known = ", ".join(f"`{severity}`" for severity in SEVERITIES)
            close = close_names(label, SEVERITIES) if isinstance(label, str) else ()
            text = f"the severity of `{code}` must be one of {known}{did_you_mean(close)}"
            problems.append(SettingProblem((*path, code), text, instead=close))
        else:
            severities[code] = SEVERITIES[label]
    return severities


def _parameters(path: Path, value: Any, problems: list[SettingProblem]) -> tuple[tuple[str, str], ...] | None:
    """Values for parameters of models: `capacity = 80`, and `[parameters.robot_1]` for those of an instance."""
    if not isinstance(value, dict):
        problems.append(SettingProblem(path, f"`{path[0]}` must be a table of names and values"))
        return None
    read: list[tuple[str, str]] = []
    for name, content in value.items():
        if isinstance(content, dict) and len(path) == 1:
            read += ((f"{name}.{key}", text) for key, text in _parameters((*path, name), content, problems) or ())
        elif isinstance(content, (bool, int, float, str)):
            read.append((name, str(content).lower() if isinstance(content, bool) else str(content)))
        else:
            message = f"the parameter `{name}` must be a boolean, a number or a string"
            problems.append(SettingProblem((*path, name), message))
    return tuple(read)


def _boolean(path: Path, value: Any, problems: list[SettingProblem]) -> bool | None:
    if isinstance(value, bool):
        return value
    problems.append(SettingProblem(path, f"`{path[0]}` must be true or false"))
    return None


def _count(path: Path, value: Any, problems: list[SettingProblem]) -> int | None:
    if isinstance(value, int) and not isinstance(value, bool) and value > 0:
        return value
    problems.append(SettingProblem(path, f"`{path[0]}` must be a whole number above 0"))
    return None


def _verify(path: Path, value: Any, problems: list[SettingProblem]) -> dict[str, Any] | None:
    """The fields of `Settings` that the table `verify` sets, by name."""
    if not isinstance(value, dict):
        problems.append(SettingProblem(path, f"`{path[0]}` must be a table with {_choice(_VERIFY)}"))
        return None
    fields: dict[str, Any] = {}
    for key, setting in value.items():
        if key == "expect":
            fields["expectations"] = _expectations((*path, key), setting, problems)
        elif key not in VALUES_OF_VERIFY:
            close = close_names(key, _VERIFY)
            message = f"there is no setting `verify.{key}`; valid settings are {listing(_VERIFY)}"
            problems.append(SettingProblem((*path, key), message, is_key=True, instead=close))
        elif setting not in VALUES_OF_VERIFY[key]:
            close = close_names(setting, VALUES_OF_VERIFY[key]) if isinstance(setting, str) else ()
            message = f"`verify.{key}` must be {_choice(VALUES_OF_VERIFY[key])}"
            problems.append(SettingProblem((*path, key), message, instead=close))
        elif key == "scheduler":
            fields["only_uniform"] = True
        else:
            fields["uniform"] = UniformPolicy(setting)
    return fields


def _choice(words: Collection[str]) -> str:
    """The words in backquotes, as in `a`, `b` or `c`."""
    *others, last = (f"`{word}`" for word in words)
    return f"{', '.join(others)} or {last}" if others else last


def _expectations(path: Path, value: Any, problems: list[SettingProblem]) -> dict[str, Comparison]:
    """Name of a property -> its expectation in the table `verify.expect`."""
    if not isinstance(value, dict):
        problems.append(SettingProblem(path, '`verify.expect` must be a table, such as `alarm = ">= 0.95"`'))
        return {}
    comparisons = {}
    for name, written in value.items():
        comparison = read_comparison(written) if isinstance(written, str) else None
        if comparison is None:
            message = f'the expectation of `{name}` must be a comparison with a number, such as `">= 0.95"`'
            problems.append(SettingProblem((*path, name), message))
        else:
            comparisons[name] = comparison
    return comparisons


def _libraries(path: Path, value: Any, problems: list[SettingProblem]) -> tuple[str, ...] | None:
    read = _strings(path, value, problems)
    if read is None:
        return None
    places = [path] if isinstance(value, str) else [(*path, index) for index in range(len(read))]
    for place, name in zip(places, read, strict=True):
        if name not in LIBRARIES:
            close = close_names(name, LIBRARIES)
            known = did_you_mean(close) or f"; valid names are {', '.join(f'`{library}`' for library in LIBRARIES)}"
            problems.append(SettingProblem(place, f"there is no tree library `{name}`{known}", instead=close))
    return tuple(name for name in read if name in LIBRARIES)


def _version(path: Path, value: Any, problems: list[SettingProblem]) -> Version | None:
    version = read_version(value) if isinstance(value, str) else None
    if version is None:
        message = f'`{path[0]}` must be a version of BehaviorTree.CPP 4, such as `"4.6"` or `"4.8.2"`'
        problems.append(SettingProblem(path, message))
    return version


def _reaction_time(path: Path, value: Any, problems: list[SettingProblem]) -> ReactionTime | None:
    time = reaction_time(value) if isinstance(value, str) else None
    if time is None:
        problems.append(SettingProblem(path, REACTION_TIME))
    return time


def _semantics(path: Path, value: Any, problems: list[SettingProblem]) -> TreeSemantics | None:
    semantics = SEMANTICS.get(value) if isinstance(value, str) else None
    if semantics is None:
        names = " or ".join(f'`"{name}"`' for name in SEMANTICS)
        problems.append(SettingProblem(path, f"`{path[0]}` must be {names}"))
    return semantics


VALUES_OF_VERIFY: Mapping[str, tuple[str, ...]] = {
    "scheduler": ("uniform",),
    "uniform": tuple(map(str, UniformPolicy)),
}
"""The values of the settings in the table `verify`, except `expect`."""
_VERIFY = ("expect", *VALUES_OF_VERIFY)
_SETS = ("select", "ignore")
_TREES = {
    "tree-models": "models",
    "tree-libraries": "libraries",
    "behaviortree-cpp": "version",
    "tree-semantics": "semantics",
}
_LIMITS = {"max-cells": "cells", "max-parts": "parts"}
_FOLDERS = ("roots", "ros-path")
_FIELDS = {"ros-path": "ros_paths", "severity": "severities"}
_KEYS: dict[str, _Reader] = {
    "roots": _strings,
    "ros-path": _strings,
    "exclude": _patterns,
    "select": _codes,
    "ignore": _codes,
    "severity": _severities,
    "warnings-as-errors": _boolean,
    "verify": _verify,
    "parameters": _parameters,
    "reaction-time": _reaction_time,
    "max-cells": _count,
    "max-parts": _count,
    "tree-models": _strings,
    "tree-libraries": _libraries,
    "behaviortree-cpp": _version,
    "tree-semantics": _semantics,
}


SETTING_NAMES = tuple(_KEYS)
"""The names of all settings, in the order of the documentation."""

VALUES_OF_SETTINGS: Mapping[str, tuple[str, ...]] = {
    "warnings-as-errors": ("true", "false"),
    "tree-libraries": tuple(LIBRARIES),
    "tree-semantics": tuple(SEMANTICS),
    **{f"verify.{name}": words for name, words in VALUES_OF_VERIFY.items()},
}
"""The values of those settings that have few; the settings of the table `verify` have its name before theirs."""
TABLES_OF_SETTINGS: Mapping[str, tuple[str, ...]] = {"": SETTING_NAMES, "verify": _VERIFY}
"""Table -> the names of its settings; "" is the table of all settings."""
SETTING_DOCUMENTATION: Mapping[str, str] = {
    "roots": "Folders with systems. Without it, the whole folder is searched.",
    "ros-path": "Folders with ROS interface packages.",
    "exclude": "Files that are ignored. Patterns are written as in `.gitignore`.",
    "select": "The rules that are reported. Without it, all rules are.",
    "ignore": "Rules that are not reported.",
    "severity": "The severities of rules: a table of rule codes and severities.",
    "warnings-as-errors": "Whether warnings are reported as errors.",
    "verify": "What `verify` expects and assumes: a table with `expect`, `scheduler` and `uniform`.",
    "verify.expect": 'The expected values of properties, such as `alarm = ">= 0.95"`.',
    "verify.scheduler": "With `uniform`, only uniform choices are considered, also for a property that asks for the "
    "minimum or maximum over all schedulers.",
    "verify.uniform": "What an expectation is worth that is met under uniform choices, but not known to be met under "
    "all schedulers: it is met (`accept`), met with a warning (`warn`, the default), or not met (`fail`).",
    "parameters": "Values for the parameters that models declare.",
    "reaction-time": "The reaction time of trees with mocks, and of systems that state none: `any`, `instant`, or a "
    "duration such as `20 ms`.",
    "max-cells": "The maximum number of array cells of a system that is translated.",
    "max-parts": "The maximum number of parts of a system that is translated.",
    "tree-models": "Files with models of nodes, for trees without a system.",
    "tree-libraries": "Libraries of nodes. The default is `nav2` for trees that use nodes of Nav2.",
    "behaviortree-cpp": "The version of BehaviorTree.CPP. The default is the newest one.",
    "tree-semantics": "The meaning of the nodes of BehaviorTree.CPP in systems: that of the library "
    "(`behaviortree-cpp`, the default), or of AS2FM (`as2fm`).",
}
"""What each setting means, in one or two sentences of Markdown. Settings in a table have its name before theirs."""


def enclosing_root(path: str) -> str | None:
    """The folder of `path`, or its nearest enclosing folder, that is a repository or contains an `as2fm.toml`; `None`
    if there is none."""
    for folder in folders_above(path):
        if any(os.path.exists(os.path.join(folder, mark)) for mark in (".git", ".hg", CONFIG_FILE)):
            return folder
    return None


def folders_above(path: str) -> Iterator[str]:
    """A folder, or the folder of a file, followed by all enclosing folders, the nearest first."""
    folder = path if os.path.isdir(path) else os.path.dirname(path)
    while True:
        yield folder
        parent = os.path.dirname(folder)
        if parent == folder:
            return
        folder = parent
