# SPDX-License-Identifier: Apache-2.0
"""The attributes of nodes of BehaviorTree.CPP that contain scripts (docs/spec/scripts.md)."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from roaml.libraries import BEHAVIORTREE_CPP, library
from roaml.libraries.programs.assembly import programs

SCRIPT = "script"
"""The type of ports that contain scripts."""
CONDITIONS = ("_failureIf", "_successIf", "_skipIf", "_while")
"""The attributes with conditions that are evaluated before a node is ticked; `_while` also while it is RUNNING."""
AFTERWARDS = ("_onSuccess", "_onFailure", "_onHalted", "_post")
"""The attributes with scripts that are executed after a node has ended or was halted."""


@functools.cache
def script_ports() -> Mapping[str, tuple[str, ...]]:
    """The ports that contain scripts, by the name of the node."""
    nodes = library(BEHAVIORTREE_CPP).nodes.items()
    ports = {name: tuple(port.name for port in node.ports if port.type == SCRIPT) for name, node in nodes}
    return {name: names for name, names in ports.items() if names}


def is_condition(node: str, port: str) -> bool:
    """Whether the value of the script in a port of a node is used as a condition."""
    return port in CONDITIONS or (node in programs() and port in programs()[node].conditions)
