# SPDX-License-Identifier: Apache-2.0
"""From a checked system to plain SCXML and JANI: collects what lowering needs from the files of one moment."""

from __future__ import annotations

from roaml.lower import Program
from roaml.model.expand import node_at
from roaml.model.system_file import Parameters
from roaml.project.analysis import Analysis
from roaml.text import Location


def program_of(analysis: Analysis, path: str, parameters: Parameters | None = None) -> Program:
    """The system file at `path` with all that it names. `parameters` replace those of the file."""
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
        parameters or system.parameters,
    )
