# SPDX-License-Identifier: Apache-2.0
"""The parts of files that pictures show: what the element at a span is in the model of its file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeAlias

from roaml.ide.picture_edits.palette import Palette
from roaml.model.machine import Chart, Declaration, Handler, Machine, State, Target
from roaml.model.syntax import Name
from roaml.model.tree import PortSetting, Tree, TreeNode
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.text import Span


class ChartPart(Record, frozen=True, eq=False):
    """A machine, or one of its action threads."""

    machine: Machine
    chart: Chart


class StatePart(Record, frozen=True, eq=False):
    machine: Machine
    chart: Chart
    state: State


class HandlerPart(Record, frozen=True, eq=False):
    """A transition, or one of the `<target>` elements of a transition if `target` is not `None`."""

    handler: Handler
    target: Target | None = None


class DeclarationPart(Record, frozen=True, eq=False):
    declaration: Declaration


class TreePart(Record, frozen=True, eq=False):
    tree: Tree


class TreeNodePart(Record, frozen=True, eq=False):
    """A node of a tree.

    Attributes:
        parent: the parent of the node; `None` if it is the root of its tree.
        children: the minimum and maximum number of children of the node.
        parent_children: those of its parent; a tree has one root.
    """

    tree: Tree
    node: TreeNode
    parent: TreeNode | None
    children: tuple[int, int]
    parent_children: tuple[int, int]

    @property
    def siblings(self) -> tuple[TreeNode, ...]:
        """The children of the parent, or the roots of the tree, with the node itself."""
        return self.tree.roots if self.parent is None else self.parent.children


class PortPart(Record, frozen=True, eq=False):
    setting: PortSetting


Part: TypeAlias = ChartPart | StatePart | HandlerPart | DeclarationPart | TreePart | TreeNodePart | PortPart


def parts_of(analysis: Analysis, path: str) -> Mapping[Span, Part]:
    """The parts of a file, by the spans that pictures use as their places."""
    machine, file = analysis.machine(path), analysis.tree(path)
    if machine is not None:
        return dict(_of_machine(machine))
    return dict(_of_trees(file.trees, Palette(analysis, path))) if file is not None else {}


def _of_machine(machine: Machine) -> Iterator[tuple[Span, Part]]:
    for declaration in machine.declarations:
        yield declaration.element.span, DeclarationPart(declaration)
    elements = [machine.element, *(thread.element for thread in machine.threads)]
    for element, chart in zip(elements, machine.charts, strict=True):
        yield element.span, ChartPart(machine, chart)
        for state in chart.states:
            yield state.element.span, StatePart(machine, chart, state)
            for handler in state.handlers:
                yield handler.element.span, HandlerPart(handler)
                for target in handler.targets:
                    if target.element is not None:
                        yield target.element.span, HandlerPart(handler, target)


def _of_trees(trees: tuple[Tree, ...], palette: Palette) -> Iterator[tuple[Span, Part]]:
    for tree in trees:
        yield tree.element.span, TreePart(tree)
        pending: list[tuple[TreeNode, TreeNode | None, tuple[int, int]]] = [(node, None, (1, 1)) for node in tree.roots]
        while pending:
            node, parent, around = pending.pop()
            children = palette.children(node)
            yield node.element.span, TreeNodePart(tree, node, parent, children, around)
            for setting in node.ports:
                yield setting.attribute.span, PortPart(setting)
            pending += [(child, node, children) for child in node.children]


def name_offset(part: Part) -> int | None:
    """An offset in the name that a picture shows for a part; `None` if the picture shows no name that is written in the
    file."""
    match part:
        case ChartPart(machine, chart):
            name = machine.name if chart is machine.chart else None
        case StatePart():
            name = part.state.id
        case DeclarationPart(declaration):
            name = declaration.interface if isinstance(declaration.interface, Name) else None
        case TreePart(tree):
            name = tree.id
        case TreeNodePart():
            name = part.node.name or part.node.plugin
        case PortPart(setting):
            # A reference to the blackboard begins with a brace.
            return setting.attribute.value_span.start + 1 if setting.variable is not None else None
        case HandlerPart():
            return None
    return name.span.start if name is not None else None
