# SPDX-License-Identifier: Apache-2.0
"""Mocks for a system: plugins for the leaves of its tree that have none (docs/spec/mocks.md#systems)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from xml.sax.saxutils import quoteattr

from roaml.libraries.node import EVENT_ATTRIBUTE
from roaml.libraries.programs.assembly import reads_world
from roaml.mocks.mock import ALL, Mock, mock_for
from roaml.mocks.plugin import mock_plugin
from roaml.mocks.system_leaves import SystemLeaf
from roaml.model.expand import node_at
from roaml.model.system import System
from roaml.model.tree import TreeFile
from roaml.record import Record
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element


class PlannedMock(Record, frozen=True):
    """A plugin for a type of leaves. `path` is the path of its file, which need not exist; `text` is its content."""

    leaf: SystemLeaf
    mock: Mock
    path: str
    text: str


def plan(
    leaves: Iterable[SystemLeaf], mocks: Sequence[Mock], rate: Fraction, paths: Mapping[str, str]
) -> tuple[list[PlannedMock], list[SystemLeaf]]:
    """The plugins for leaves, and the leaves without a matching mock.

    Args:
        rate: the ticks of the tree per second.
        paths: type of a leaf -> the path of its plugin.
    """
    planned: list[PlannedMock] = []
    missing: list[SystemLeaf] = []
    for leaf in leaves:
        name = leaf.names[0] if len(leaf.names) == 1 else leaf.type
        mock = mock_for(mocks, name, leaf.type, leaf.succeeds)
        if mock is None:
            missing.append(leaf)
            continue
        text = mock_plugin(leaf.type, mock, rate, leaf.ports, is_condition=leaf.is_condition)
        planned.append(PlannedMock(leaf, mock, paths[leaf.type], text))
    return planned, missing


def listing(section: Element, sources: Iterable[str]) -> TextEdit:
    """The edit that adds plugins to the `<behavior_tree>` section of a system file. It inserts them on the line where
    the section ends, so that all lines keep their numbers."""
    close = section.close_name_span
    at = section.open_span.end if close is None else close.start - len("</")
    entries = "".join(f'<input type="bt-plugin-ascxml" src={quoteattr(source)} />' for source in sources)
    return TextEdit(Span(at, at), entries)


def defaults(root: Element, leaves: Iterable[SystemLeaf]) -> TextEdit | None:
    """The edit of a tree file that declares defaults for the ports of mocks that only some nodes set; `None` if there
    are none. It inserts the declarations on the line where the root element ends."""
    models = "".join(f"<Action ID={quoteattr(leaf.type)}>{_ports(leaf)}</Action>" for leaf in leaves if leaf.optional)
    close = root.close_name_span
    if not models or close is None:
        return None
    at = close.start - len("</")
    return TextEdit(Span(at, at), f"<TreeNodesModel>{models}</TreeNodesModel>")


def _ports(leaf: SystemLeaf) -> str:
    return "".join(
        f'<output_port name={quoteattr(port.key)} default="{{=}}" />'
        if port.is_output
        else f'<input_port name={quoteattr(port.key)} default="{_DEFAULTS.get(port.type, "0")}" />'
        for port in leaf.ports
        if port.key in leaf.optional
    )


_DEFAULTS = {"bool": "false", "string": "", "float32": "0.0", "float64": "0.0"}


def event_edits(system: System, files: Mapping[str, TreeFile], mocks: Sequence[Mock]) -> dict[str, list[TextEdit]]:
    """The edits, by file, that set the probabilities of the events of the world that nodes read, such as a new goal, to
    those of the mocks."""
    exact = [mock for mock in mocks if mock.pattern != ALL]
    edits: dict[str, dict[int, TextEdit]] = {}
    for instance in system.instances:
        mock = mock_for(exact, instance.name, instance.plugin)
        if mock is None or not reads_world(instance.plugin) or system.plugin(instance.plugin)[0]:
            continue
        node = node_at(files[instance.source.path], instance.source)
        if node is None:
            continue
        given = node.element.get(EVENT_ATTRIBUTE)
        at = node.element.name_span.end
        edit = TextEdit(Span(at, at), f' {EVENT_ATTRIBUTE}="{mock.probability!r}"')
        if given is not None:
            edit = TextEdit(given.value_span, repr(mock.probability))
        edits.setdefault(instance.source.path, {})[edit.span.start] = edit
    return {path: list(changes.values()) for path, changes in edits.items()}
