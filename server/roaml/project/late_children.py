# SPDX-License-Identifier: Apache-2.0
"""Children that never succeed in the time of their `Timeout`, but do with more time."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.model.expand import Instance, node_at
from roaml.model.tree import TreeNode
from roaml.project.analysis import Analysis
from roaml.project.exploration import Reached
from roaml.project.optional_branches import ByNumber, edited
from roaml.rules.trees import never_in_time
from roaml.text import Location, TextEdit
from roaml.xml_syntax import Attribute

FACTORS = (2, 5, 10, 100)
"""How many times the time of a node is tried."""


def late_children(analysis: Analysis, path: str, nodes: ByNumber, reached: Reached) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and findings about nodes in them that always end their child before it succeeds. Each
    place is examined once, if no instance of it has a child that succeeds."""
    places = {node.source for node in nodes.values() if node.plugin == "Timeout"}
    for source in places:
        instances = [node for node in nodes.values() if node.source == source and _is_ticked(reached, node)]
        tree = analysis.tree(source.path)
        written = None if tree is None else node_at(tree, source)
        attribute = None if written is None else written.element.get("msec")
        if written is None or attribute is None or not attribute.value.isdecimal():
            continue
        if instances and all(_is_late(reached, nodes, node) for node in instances):
            longer = _sufficient(analysis, path, instances, attribute)
            if longer is not None:
                yield source.path, _finding(written, attribute, longer, reached, source.path)


def _finding(written: TreeNode, attribute: Attribute, longer: int, reached: Reached, path: str) -> Finding:
    related = [Related(Location(path, written.children[0].element.name_span), "never returns SUCCESS")]
    time = int(attribute.value)
    return never_in_time.finding(attribute.value_span, no_run=reached.no_run, time=time, longer=longer, related=related)


def _is_ticked(reached: Reached, node: Instance) -> bool:
    return reached.ticks.get(node.number, False)


def _is_late(reached: Reached, nodes: ByNumber, node: Instance) -> bool:
    """Whether the child of a node runs, but never succeeds, and the node fails, which matters to its parent."""
    around = None if node.parent is None else nodes[node.parent]
    is_ignored = around is not None and around.plugin in ("ForceSuccess", "Inverter")
    of_child = reached.statuses.get(node.children[0], frozenset())
    is_late = RUNNING in of_child and SUCCESS not in of_child
    return is_late and not is_ignored and FAILURE in reached.statuses.get(node.number, ())


def _sufficient(analysis: Analysis, path: str, instances: list[Instance], attribute: Attribute) -> int | None:
    """A time in ms with which the child of one of the instances of a node succeeds in some simulated run; `None` if it
    never does."""
    from roaml.project.simulation import SimulatedFaultError, simulated  # noqa: PLC0415 - few systems are simulated

    for factor in FACTORS:
        time = factor * int(attribute.value)
        file = instances[0].source.path
        other = edited(analysis, path, {file: [TextEdit(attribute.value_span, str(time))]})
        try:
            again = next(simulated(other, path), None)
        except SimulatedFaultError:
            return None
        if again is not None and any(SUCCESS in again.statuses.get(node.children[0], ()) for node in instances):
            return time
    return None
