# SPDX-License-Identifier: Apache-2.0
"""Collects the input of the translation of a checked system from an analysis."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.comparison import read_comparison
from roaml.jani.properties import Property
from roaml.lower.program import TranslatableSystem
from roaml.model.expand import nodes_of
from roaml.model.kinds import FileKind
from roaml.model.property_file import PortVariableKind
from roaml.model.property_links import LinkedFile, LinkedProperty
from roaml.model.property_ports import LinkedVariable
from roaml.model.tree import TreeNode
from roaml.project.analysis import Analysis
from roaml.project.placed import placed
from roaml.record import replace
from roaml.scxml.model import Network
from roaml.scxml.observed import ObservedPort, ObservedProperty, ObservedVariable
from roaml.text import Location


def properties_of(analysis: Analysis, path: str) -> tuple[Property, ...]:
    """The properties in the JANI property files that a system lists, in order."""
    if (expanded := analysis.expanded(path)) is not None:
        return placed(properties_of(expanded.analysis, path), expanded.location)
    files = (f.path for f in analysis.listed(path) if f.required_kind is FileKind.PROPERTIES and f.usable)
    return tuple(declared for file in files for declared in analysis.properties(file)[0])


def observed_properties_of(analysis: Analysis, path: str) -> tuple[ObservedProperty, ...]:
    """The guarantees in the XML property files that a system lists, in order, each with the assumptions of its file."""
    if (expanded := analysis.expanded(path)) is not None:
        return placed(observed_properties_of(expanded.analysis, path), expanded.location)
    files = (f.path for f in analysis.listed(path) if f.required_kind is FileKind.XML_PROPERTIES and f.usable)
    linked = (analysis.linked_properties(file, path) for file in files)
    return tuple(guarantee for file in linked if file is not None for guarantee in _guarantees(file))


def _guarantees(file: LinkedFile) -> Iterator[ObservedProperty]:
    assumptions = tuple(_observed(property_) for property_ in file.properties if property_.is_assumption)
    for property_ in file.properties:
        if not property_.is_assumption:
            yield replace(_observed(property_), assumptions=assumptions)


def _observed(property_: LinkedProperty) -> ObservedProperty:
    ports = tuple(ObservedPort(p.events, tuple(map(_observed_variable, p.variables))) for p in property_.ports)
    conditions = {name: condition.tree for name, condition in property_.conditions.items()}
    origin = Location(property_.path, property_.written.element.name_span)
    expect = property_.written.expect
    return ObservedProperty(
        property_.name,
        property_.property,
        conditions,
        ports,
        origin,
        property_.sentence,
        expected=None if expect is None else read_comparison(expect.value),
    )


def _observed_variable(variable: LinkedVariable) -> ObservedVariable:
    initial = None if variable.kind is PortVariableKind.EVENT else variable.written.initial
    tree = None if initial is None else initial.tree
    return ObservedVariable(variable.id, variable.kind.value, variable.type, variable.parameter, tree)


def network_of(analysis: Analysis, path: str) -> Network:
    """The system in the file `path` as plain SCXML. The system must have no errors."""
    if (expanded := analysis.expanded(path)) is not None:
        return placed(network_of(expanded.analysis, path), expanded.location)
    from roaml.lower.system import lower  # noqa: PLC0415 - a check only needs the size of the translation

    return lower(program_of(analysis, path))


def program_of(analysis: Analysis, path: str) -> TranslatableSystem:
    """The input of the translation: the system in the file `path`, with all its files. The system must have no
    errors."""
    system, file = analysis.system(path), analysis.system_file(path)
    assert system is not None
    assert file is not None
    written: dict[tuple[str, str], tuple[TreeNode, ...]] = {}
    nodes = {}
    for instance in system.instances:
        source = instance.source
        key = (source.path, source.tree)
        if key not in written:
            tree = analysis.tree(source.path)
            written[key] = nodes_of(tree, source.tree) if tree else ()
        if source.position < len(written[key]):
            nodes[instance.number] = Location(source.path, written[key][source.position].element.span)
    place = Location(path, file.element.name_span)
    library = analysis.library_tree(path)
    return TranslatableSystem(
        system, analysis.machines_in(system), analysis.environment(path), place, nodes, system.parameters, library
    )
