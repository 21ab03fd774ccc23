# SPDX-License-Identifier: Apache-2.0
"""From a checked system to plain SCXML and JANI: collects what lowering needs from the files of one moment."""

from __future__ import annotations

from roaml.jani.properties import Property
from roaml.lower import Program
from roaml.model.expand import node_at
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import Location


def properties_of(analysis: Analysis, path: str) -> tuple[Property, ...]:
    """The properties in the files that a system lists, in their order."""
    files = (f.path for f in analysis.listed(path) if f.wanted is FileKind.PROPERTIES and f.usable)
    return tuple(each for file in files for each in analysis.properties(file)[0])


def program_of(analysis: Analysis, path: str) -> Program:
    """The system file at `path`, which must have no errors, with all that it names."""
    system, file = analysis.system(path), analysis.system_file(path)
    assert system is not None
    assert file is not None
    machines = {}
    for each in {p for p, _ in (*system.nodes, *system.plugins)}:
        machine = analysis.machine(each)
        assert machine is not None
        machines[each] = machine
    nodes = {}
    for instance in system.instances:
        tree = analysis.tree(instance.source.path)
        node = node_at(tree, instance.source) if tree else None
        if node is not None:
            nodes[instance.number] = Location(instance.source.path, node.element.span)
    return Program(
        system,
        machines,
        analysis.environment(path),
        Location(path, file.element.name_span),
        nodes,
        system.parameters,
    )
