# SPDX-License-Identifier: Apache-2.0
"""The nodes of the behavior tree libraries BehaviorTree.CPP and Nav2, as data.

Kinds, ports, types and defaults of nodes are defined only in the XML files of this package. `docs/build.py` writes from
them the node elements of `schemas/behaviortree.xsd`, and the tables that this package reads.
"""

from __future__ import annotations

import functools

from roaml.disk import path_of_resource, resource
from roaml.libraries.node import Absent, Library, Node, Port, PortLimits, Renamed
from roaml.record import decoded

__all__ = [
    "BEHAVIORTREE_CPP",
    "LIBRARIES",
    "Absent",
    "Library",
    "Node",
    "Port",
    "PortLimits",
    "Renamed",
    "library",
    "library_node",
    "node_in_libraries",
    "table_of",
]

BEHAVIORTREE_CPP = "behaviortree_cpp"
"""The library that is available in all trees."""

LIBRARIES = ("nav2",)
"""The names of the other libraries, as users write them in settings."""


@functools.cache
def library(name: str) -> Library:
    """The library with this name: `BEHAVIORTREE_CPP` or one of `LIBRARIES`."""
    return decoded(resource(*_table(name)), Library)


def table_of(name: str) -> str:
    """The path of the file with the table of a library."""
    return path_of_resource(*_table(name))


def _table(name: str) -> tuple[str, ...]:
    return (__name__, "tables", f"{name}.json")


def node_in_libraries(name: str) -> Node | None:
    """The declaration of a node in one of `LIBRARIES`, whether or not the settings name the library; `None` if there is
    none."""
    return next((library(known).nodes[name] for known in LIBRARIES if name in library(known).nodes), None)


def library_node(name: str) -> Node | None:
    """The declaration of a node of any library; `name` may be its name in version 3. `None` if there is none."""
    cpp = library(BEHAVIORTREE_CPP)
    renamed = cpp.renamed.get(name)
    return cpp.nodes.get(renamed.now if renamed else name) or node_in_libraries(name)
