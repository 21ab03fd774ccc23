# SPDX-License-Identifier: Apache-2.0
"""Names of elements, variables and types that several parts of the tool use, grouped by their meaning."""

from __future__ import annotations

from roaml.expr.types import ScalarKind
from roaml.interfaces import types as interfaces
from roaml.language import HL_SCXML
from roaml.roles import SymbolKind

DECLARING_ELEMENTS = {
    SymbolKind.PUBLISHER: "ros_topic_publisher",
    SymbolKind.SUBSCRIBER: "ros_topic_subscriber",
    SymbolKind.SERVICE_CLIENT: "ros_service_client",
    SymbolKind.SERVICE_SERVER: "ros_service_server",
    SymbolKind.ACTION_CLIENT: "ros_action_client",
    SymbolKind.ACTION_SERVER: "ros_action_server",
    SymbolKind.TIMER: "ros_time_rate",
}
"""Kind of handle -> the element that declares it."""

EVENT_VARIABLES = {
    binding.name: element.name for element in HL_SCXML.elements.values() for binding in reversed(element.binds)
}
"""Variable with the data of an event -> the name of an element in which it is available."""

BRANCH_MARKERS = ("else", "elseif")
"""The elements that begin the next branch of an `<if>`."""

INSIDE_THREADS = ("ros_action_handle_thread_start", "ros_action_thread_free")
"""The elements that are allowed only in an action thread."""
OUTSIDE_THREADS = ("ros_action_start_thread", "ros_action_handle_thread_free")
"""The elements that are not allowed in an action thread."""
UNUSUAL_IN_THREADS = ("ros_action_handle_goal",)
"""The elements that are allowed in an action thread but cause a warning there."""

DEFAULT_TYPES = {
    ScalarKind.INT: "int32",
    ScalarKind.REAL: "float64",
    ScalarKind.BOOL: "bool",
    ScalarKind.STRING: "string",
}
"""Kind of value -> the type with which a variable for it is declared."""

FOREIGN_TYPES = {
    **interfaces.FOREIGN_TYPES, "byte": "uint8", "char": "uint8", "String": "string",
    "integer8": "int8", "integer16": "int16", "integer32": "int32", "integer64": "int64",
}  # fmt: skip
"""Name of a type in another language -> the corresponding name in HL-SCXML."""
