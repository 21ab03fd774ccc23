# SPDX-License-Identifier: Apache-2.0
"""Expands the files of a system (docs/spec/parameters.md#expansion)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from roaml.distributions import calls_distribution
from roaml.expansion.declarations import PARAMETER, declaration_elements, has_channels
from roaml.expansion.instances import instances
from roaml.expansion.problems import Problems
from roaml.xml_syntax import Document

if TYPE_CHECKING:
    from roaml.expansion.result import SystemExpansion
    from roaml.expansion.state import UserFiles


def needs_expansion(system: Document, texts: Iterator[str]) -> bool:
    """Whether a system uses parameters, instances, channels or distributions.

    Args:
        system: the system file.
        texts: the texts of the other files of the system.
    """
    if next(declaration_elements(system), None) is not None or "$(var" in system.text or has_channels(system):
        return True
    if any(not instance.is_plain for instance in instances(system, Problems())):
        return True
    return any(f"<{PARAMETER}" in text or "$(var" in text or calls_distribution(text) for text in texts)


def expand_file(
    path: str, sources: UserFiles, resolve: Callable[[str, str], str], *, varied: bool = False
) -> SystemExpansion:
    """Expand a file that is not in a system: its parameters have their own values. For `resolve` and `varied`, see
    `expand`."""
    # Most files have nothing to expand.
    from roaml.expansion.files import FileExpander, expand_draws  # noqa: PLC0415
    from roaml.expansion.state import ExpansionState  # noqa: PLC0415

    state = ExpansionState("", (path,), sources, (), resolve, varied=varied)
    FileExpander(state).expand(path, path, None, {})
    expand_draws(state)
    return state.result({})


def expand(
    path: str,
    others: tuple[str, ...],
    sources: UserFiles,
    given: tuple[tuple[str, str], ...],
    resolve: Callable[[str, str], str],
    *,
    varied: bool = False,
) -> SystemExpansion:
    """Expand a system.

    Args:
        path: the system file.
        others: the paths of all other files of the system.
        given: names and texts of values that replace those in the files; the last one of equal names is used.
        resolve: returns the path that a file names: (path of the file, text).
        varied: whether the parameters have other values than the given ones, which they could have as well.
    """
    # Most systems have nothing to expand.
    from roaml.expansion.state import ExpansionState  # noqa: PLC0415
    from roaml.expansion.system import SystemExpander  # noqa: PLC0415

    return SystemExpander(ExpansionState(path, others, sources, given, resolve, varied=varied)).expansion()
