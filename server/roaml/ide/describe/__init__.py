# SPDX-License-Identifier: Apache-2.0
"""The description of a symbol, as Markdown, which hover, completion and hints share.

The module `language` describes parts of the languages (elements, attributes, functions), and the module `ros`
definitions of ROS.
"""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.ide.describe import machine as describe_machine
from roaml.ide.describe import parameters as describe_parameters
from roaml.ide.describe import ros as describe_ros
from roaml.ide.describe import system as describe_system
from roaml.ide.describe import xml_property_file as describe_xml_properties
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind


def describe(analysis: Analysis, symbol: Symbol, written: str = "") -> str:
    """The description of a symbol; "" if there is none.

    Args:
        symbol: the symbol of an occurrence (`roaml.ide.names.occurrence`).
        written: the spelling of the name at the requested place, if it may differ: a topic may be written with a slash
            at its beginning.
    """
    match symbol.kind:
        case SymbolKind.VARIABLE:
            return describe_machine.variable(analysis, symbol)
        case SymbolKind.STATE:
            return describe_machine.state(analysis, symbol)
        case SymbolKind.PORT:
            return describe_machine.port(analysis, symbol)
        case SymbolKind.MACHINE:
            return describe_machine.machine(analysis, symbol)
        case SymbolKind.EVENT:
            return describe_system.event(analysis, symbol)
        case SymbolKind.MODEL_PARAMETER:
            return describe_parameters.parameter(analysis, symbol)
        case SymbolKind.PARAMETER:
            return describe_system.parameter(analysis, symbol)
        case SymbolKind.TOPIC | SymbolKind.SERVICE | SymbolKind.ACTION:
            return describe_system.interface(analysis, symbol, written)
        case SymbolKind.BLACKBOARD:
            return describe_system.blackboard(analysis, symbol)
        case SymbolKind.PLUGIN:
            return describe_system.plugin(symbol)
        case SymbolKind.TREE:
            return describe_system.tree(analysis, symbol)
        case SymbolKind.TREE_NODE:
            return describe_system.tree_node(analysis, symbol)
        case SymbolKind.PROPERTY:
            return describe_xml_properties.property_(analysis, symbol)
        case SymbolKind.PORT_VARIABLE:
            return describe_xml_properties.variable(analysis, symbol)
        case SymbolKind.STRUCT:
            return describe_system.struct(analysis, symbol)
        case SymbolKind.MEMBER:
            return describe_system.member(analysis, symbol)
        case SymbolKind.ROS_TYPE:
            return describe_ros.ros_type(analysis.registry, symbol.scope, symbol.name)  # type: ignore[arg-type]
        case SymbolKind.FIELD:
            return describe_ros.field(analysis.registry, symbol.scope, symbol.name)
        case SymbolKind.PUBLISHER | SymbolKind.SUBSCRIBER | SymbolKind.TIMER:
            return describe_machine.handle(analysis, symbol)
        case SymbolKind.SERVICE_CLIENT | SymbolKind.SERVICE_SERVER:
            return describe_machine.handle(analysis, symbol)
        case SymbolKind.ACTION_CLIENT | SymbolKind.ACTION_SERVER:
            return describe_machine.handle(analysis, symbol)
        case SymbolKind.ELEMENT | SymbolKind.ATTRIBUTE | SymbolKind.ENUMERATION_VALUE | SymbolKind.JSON:
            return ""  # parts of the languages: `roaml.ide.completion.document`
        case SymbolKind.BASE_TYPE | SymbolKind.EVENT_VARIABLE | SymbolKind.FUNCTION:
            return ""
        case SymbolKind.GLOBAL | SymbolKind.TREE_INSTANCE:
            return ""
