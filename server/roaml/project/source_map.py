# SPDX-License-Identifier: Apache-2.0
"""A map from the parts of a JANI model to the places in the models from which they are translated."""

from __future__ import annotations

import os
from typing import TypedDict

from roaml.jani.model import Model, Variable
from roaml.project.analysis import Analysis
from roaml.project.paths import relative
from roaml.text import Location


class MappedPlace(TypedDict):
    """A place in a file. `file` is relative to the folder of the system file, with `/`. Lines and columns begin at 1;
    columns are code points."""

    file: str
    line: int
    column: int


class VariablePlace(MappedPlace):
    name: str


class EdgePlace(MappedPlace):
    """An edge with its source location; `action` is null if the edge has no action."""

    location: str
    action: str | None


class AutomatonPlaces(MappedPlace):
    """An automaton with its parts, in the order of the JANI file."""

    name: str
    variables: list[VariablePlace]
    edges: list[EdgePlace]


class SourceMap(TypedDict):
    """All global variables and all automata, in the order of the JANI file."""

    version: int
    system: str
    variables: list[VariablePlace]
    automata: list[AutomatonPlaces]


def source_map(model: Model, analysis: Analysis, system: str) -> SourceMap:
    """The places in the models from which the variables, automata and edges of a JANI model come.

    Args:
        model: a translation of the system, in which every part has an origin.
        analysis: the analysis from which it was translated.
        system: the path of the system file.
    """
    folder = os.path.dirname(system)

    def place(origin: Location | None) -> MappedPlace:
        assert origin is not None
        source = analysis.source(origin.path)
        assert source is not None
        start = source.lines.position(origin.span.start)
        file = relative(origin.path, folder)
        return {"file": file, "line": start.line + 1, "column": start.column + 1}

    def variables(declared: tuple[Variable, ...]) -> list[VariablePlace]:
        return [{"name": variable.name, **place(variable.origin)} for variable in declared]

    automata: list[AutomatonPlaces] = [
        {
            "name": automaton.name,
            **place(automaton.origin),
            "variables": variables(automaton.variables),
            "edges": [
                {"location": edge.source, "action": edge.action, **place(edge.origin)} for edge in automaton.edges
            ],
        }
        for automaton in model.automata
    ]
    return {
        "version": 1,
        "system": os.path.basename(system),
        "variables": variables(model.variables),
        "automata": automata,
    }
