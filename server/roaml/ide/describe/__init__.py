# SPDX-License-Identifier: Apache-2.0
"""What is known of a named thing, as Markdown: the one text that hover, completion and hints show of it.

What the languages say by themselves (elements, attributes, functions) is in `describe_language`, ROS definitions are in
`describe_ros`.
"""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.ide.describe import machine as describe_machine
from roaml.ide.describe import ros as describe_ros
from roaml.ide.describe import system as describe_system
from roaml.ide.names.occurrence import HANDLES
from roaml.project.analysis import Analysis


def describe(analysis: Analysis, symbol: Symbol, written: str = "") -> str:
    """What is known of a symbol; "" if nothing is.

    Args:
        symbol: as occurrences have it (`roaml.ide.names.occurrence`).
        written: how it is spelled where it is asked about, if that matters (a topic may begin with a slash).
    """
    match symbol.kind:
        case "variable":
            return describe_machine.variable(analysis, symbol)
        case "state":
            return describe_machine.state(analysis, symbol)
        case "port":
            return describe_machine.port(analysis, symbol)
        case "machine":
            return describe_machine.machine(analysis, symbol)
        case "event":
            return describe_system.event(analysis, symbol)
        case "parameter":
            return describe_system.parameter(analysis, symbol)
        case "topic" | "service" | "action":
            return describe_system.interface(analysis, symbol, written)
        case "blackboard":
            return describe_system.blackboard(analysis, symbol)
        case "plugin":
            return describe_system.plugin(symbol)
        case "tree":
            return describe_system.tree(analysis, symbol)
        case "tree-node":
            return describe_system.tree_node(analysis, symbol)
        case "struct":
            return describe_system.struct(analysis, symbol)
        case "member":
            return describe_system.member(analysis, symbol)
        case "ros-type":
            return describe_ros.ros_type(analysis.registry, symbol.scope, symbol.name)  # type: ignore[arg-type]
        case "field":
            return describe_ros.field(analysis.registry, symbol.scope, symbol.name)
        case kind if kind in HANDLES:
            return describe_machine.handle(analysis, symbol)
    return ""
