# SPDX-License-Identifier: Apache-2.0
"""Into the definition files of ROS interfaces."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.interfaces.registry import NotFound
from roaml.interfaces.types import SECTION_NAMES, Definition, Kind
from roaml.project.analysis import Analysis
from roaml.text import Location, Span


def locate_ros(analysis: Analysis, symbol: Symbol) -> Location | None:
    """Where a type or a field is defined; None if its file is not found."""
    if symbol.kind == "ros-type":
        return locate_type(analysis, symbol.scope, symbol.name)
    definition, section = _section(analysis, symbol.scope)
    field = definition.section(section).field(symbol.name) if definition else None
    return Location(definition.path, field.name_span) if definition and field else None


def locate_type(analysis: Analysis, kind: str, name: str) -> Location | None:
    """The file that defines a type, as a place at its beginning."""
    definition = analysis.registry.resolve(kind, name)  # type: ignore[arg-type]
    return None if isinstance(definition, NotFound) else Location(definition.path, Span(0, 0))


def type_of_field(analysis: Analysis, symbol: Symbol) -> Location | None:
    """The message that a field holds; None if it is no message."""
    definition, section = _section(analysis, symbol.scope)
    field = definition.section(section).field(symbol.name) if definition else None
    return None if field is None or field.type.is_primitive else locate_type(analysis, "msg", field.type.name)


def _section(analysis: Analysis, struct: str) -> tuple[Definition | None, str]:
    """What a struct of `roaml.model.ros` is made of; it is called `package/Name` or `package/Name section`."""
    name, _, section = struct.partition(" ")
    section = section or "message"
    kind: Kind = next((kind for kind, sections in SECTION_NAMES.items() if section in sections), "msg")
    definition = analysis.registry.resolve(kind, name)
    return (None if isinstance(definition, NotFound) else definition), section
