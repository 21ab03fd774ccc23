# SPDX-License-Identifier: Apache-2.0
"""The leaves of a system's trees that have no plugin, and paths for their mocks."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from roaml.forest.forest import node_of
from roaml.libraries import Node
from roaml.mocks.system_leaves import SystemLeaf, leaves_without_plugins
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.project.paths import folder_of, full
from roaml.regex import regex
from roaml.text import SourceFile

_CAMEL = regex(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def missing_leaves(analysis: Analysis, system: System) -> tuple[SystemLeaf, ...]:
    """The leaves without a plugin, with the ports that models in the tree files and libraries declare."""
    models: dict[str, Node] = {}
    for path in system.tree_paths:
        file = analysis.tree(path)
        for model in file.models if file else ():
            if model.id is not None and not model.is_subtree:
                models.setdefault(model.id.value, node_of(model))
    return leaves_without_plugins(system, models.get)


def plugin_paths(analysis: Analysis, system: str) -> Callable[[str], str]:
    """A function that returns a path beside the system file for the plugin with a name. There is no file at the path,
    and no path is returned twice."""
    taken: set[str] = set()

    def path_of(name: str) -> str:
        stem, number = f"mock_{_CAMEL.sub('_', name).lower()}", 1
        path = full(folder_of(system), f"{stem}.ascxml")
        while isinstance(analysis.files.read(path), SourceFile) or path in taken:
            number += 1
            path = full(folder_of(system), f"{stem}_{number}.ascxml")
        taken.add(path)
        return path

    return path_of


def tick_rates(system: System) -> Callable[[str], Fraction]:
    """A function that returns the ticks per second of the tree with a name."""
    return lambda tree: Fraction(str(system.tick_rate(tree)))
