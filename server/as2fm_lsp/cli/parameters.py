# SPDX-License-Identifier: Apache-2.0
"""`--set NAME=VALUE` and `--params-file FILE`: values for the parameters that models declare
(docs/spec/parameters.md#values)."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from typing import Any

from as2fm_lsp.outputs import InputPath
from roaml.disk import MAX_BYTES, UnreadableReason, read
from roaml.project.settings import Settings
from roaml.record import replace

_ROS = "ros__parameters"


class ParameterFileError(ValueError):
    """A parameter file cannot be used; the message contains the reason."""


def add_set(parser: argparse._ActionsContainer) -> None:
    """Add the options `--set`, whose value is a list of pairs of a name and a text, and `--params-file`."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        type=setting,
        metavar="NAME=VALUE",
        help="sets a parameter that the models declare; INSTANCE.NAME is that of one instance; may be repeated",
    )
    parser.add_argument(
        "--params-file",
        action="append",
        default=[],
        type=InputPath,
        metavar="FILE",
        help="sets parameters from a parameter file of ROS 2 (YAML); may be repeated",
    )


def setting(text: str) -> tuple[str, str]:
    """`NAME=VALUE` as a pair; raises `argparse.ArgumentTypeError` for other texts."""
    name, equals, value = text.partition("=")
    if not name.strip() or not equals:
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE, not {text!r}")
    return name.strip(), value.strip()


def with_parameter_files(settings: Settings, paths: Iterable[str]) -> Settings:
    """The settings with the values in parameter files of ROS 2, which replace those of the configuration.

    Raises:
        ParameterFileError: a file cannot be read, or PyYAML is not installed.
    """
    values = [value for path in paths for value in _values_in(path)]
    return replace(settings, parameters=(*settings.parameters, *values)) if values else settings


def _values_in(path: str) -> Iterator[tuple[str, str]]:
    try:
        import yaml  # type: ignore[import-untyped]  # noqa: PLC0415 - an optional dependency
    except ImportError:
        raise ParameterFileError(f"{path}: --params-file needs PyYAML; install `as2fm-lsp[yaml]`") from None
    content = read(path, MAX_BYTES)
    if isinstance(content, UnreadableReason):
        raise ParameterFileError(f"{path}: {content.value}")
    try:
        nodes = yaml.safe_load(content)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise ParameterFileError(f"{path}: not valid YAML: {' '.join(str(error).split())}") from None
    if not isinstance(nodes, dict) or not any(True for _ in _nodes(nodes, "")):
        raise ParameterFileError(f"{path}: not a parameter file of ROS 2: no node has `{_ROS}`")
    for name, parameters in _nodes(nodes, ""):
        for parameter, value in _flat(parameters, ""):
            if name in ("*", "**"):
                yield parameter, value
            yield f"{'*' if name == '**' else name}.{parameter}", value


def _nodes(table: dict[Any, Any], name: str) -> Iterator[tuple[str, dict[Any, Any]]]:
    """The names of nodes, without their namespaces, with their parameters. Namespaces may be written as tables."""
    for key, value in table.items():
        if isinstance(value, dict):
            if key == _ROS:
                yield name, value
            else:
                yield from _nodes(value, str(key).rpartition("/")[2])


def _flat(parameters: dict[Any, Any], prefix: str) -> Iterator[tuple[str, str]]:
    """The names and texts of the scalars, with dots in the names of those in tables."""
    for key, value in parameters.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        elif isinstance(value, (bool, int, float, str)):
            yield f"{prefix}{key}", str(value).lower() if isinstance(value, bool) else str(value)
