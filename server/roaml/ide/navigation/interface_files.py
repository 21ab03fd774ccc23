# SPDX-License-Identifier: Apache-2.0
"""Navigation into the definition files of ROS interfaces."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.ide.describe.ros import definition_and_section
from roaml.interfaces.registry import NotFound
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind
from roaml.text import Location, Span


def locate_ros(analysis: Analysis, symbol: Symbol) -> Location | None:
    """The definition of a ROS type or of one of its fields; `None` if its file is not found."""
    if symbol.kind is SymbolKind.ROS_TYPE:
        return locate_type(analysis, symbol.scope, symbol.name)
    definition, section = definition_and_section(analysis.registry, symbol.scope)
    field = definition.section(section).field(symbol.name) if definition else None
    return Location(definition.path, field.name_span) if definition and field else None


def locate_type(analysis: Analysis, kind: str, name: str) -> Location | None:
    """The beginning of the file that defines a ROS type; `None` if the file is not found."""
    definition = analysis.registry.resolve(kind, name)  # type: ignore[arg-type]
    return None if isinstance(definition, NotFound) else Location(definition.path, Span(0, 0))


def type_of_field(analysis: Analysis, symbol: Symbol) -> Location | None:
    """The definition of the type of a field; `None` if the type is not a message."""
    definition, section = definition_and_section(analysis.registry, symbol.scope)
    field = definition.section(section).field(symbol.name) if definition else None
    return None if field is None or field.type.is_primitive else locate_type(analysis, "msg", field.type.name)
