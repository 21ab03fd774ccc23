# SPDX-License-Identifier: Apache-2.0
"""Mocks for a system: plugins for the leaves of its trees that have none (docs/spec/mocks.md#systems)."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from xml.sax.saxutils import quoteattr

from roaml.libraries.node import EVENT_ATTRIBUTE
from roaml.libraries.programs.assembly import reads_world
from roaml.mocks.mock import ALL, Mock, MockableWords, MockError, likeness_for, mock_for, node_words
from roaml.mocks.plugin import mock_plugin
from roaml.mocks.system_leaves import SystemLeaf
from roaml.model.expand import node_at
from roaml.model.system import System
from roaml.model.system_file import TREE_ATTRIBUTE
from roaml.model.tree import TreeFile
from roaml.record import Record
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element


class PlannedMock(Record, frozen=True):
    """A plugin for a type of leaves.

    Attributes:
        trees: the names of the trees to which it belongs; empty if it belongs to all trees.
        path: the path of its file, which need not exist.
        text: the content of the file.
    """

    leaf: SystemLeaf
    mock: Mock
    trees: tuple[str, ...]
    path: str
    text: str


def plan(
    leaves: Iterable[SystemLeaf],
    mocks: Sequence[Mock],
    rate: Callable[[str], Fraction],
    path: Callable[[str], str],
) -> tuple[list[PlannedMock], list[SystemLeaf]]:
    """The plugins for leaves, and the leaves without a matching mock. Trees whose plugins would be the same share one.

    Args:
        rate: returns the ticks per second of the tree with a name.
        path: returns the path for a plugin with a name.
    """
    planned: list[PlannedMock] = []
    missing: list[SystemLeaf] = []
    for leaf in leaves:
        chosen = {tree: _mock_in(tree, names, leaf, mocks) for tree, names in leaf.names}
        trees: dict[str, list[str]] = {}
        used: dict[str, Mock] = {}
        for tree, mock in chosen.items():
            if mock is not None:
                text = mock_plugin(leaf.type, mock, rate(tree), leaf.ports, is_condition=leaf.is_condition)
                trees.setdefault(text, []).append(tree)
                used.setdefault(text, mock)
        if None in chosen.values():
            missing.append(leaf)
        is_shared = leaf.is_shared and len(trees) == 1 and None not in chosen.values()
        for text, owners in trees.items():
            name = leaf.type if len(trees) == 1 else f"{owners[0]}_{leaf.type}"
            planned.append(PlannedMock(leaf, used[text], () if is_shared else tuple(owners), path(name), text))
    return planned, missing


def _mock_in(tree: str, names: tuple[str, ...], leaf: SystemLeaf, mocks: Sequence[Mock]) -> Mock | None:
    """The mock for the leaves of one type in a tree, in which they have `names`."""
    return mock_for(mocks, names[0] if len(names) == 1 else leaf.type, leaf.type, leaf.succeeds, tree)


def mockable_words(system: System, leaves: Iterable[SystemLeaf]) -> MockableWords:
    """What mocks can call the nodes of a system.

    Args:
        leaves: the leaves without a plugin.
    """
    shared = {(leaf.type, tree) for leaf in leaves for tree, names in leaf.names if len(names) > 1}
    nodes: dict[str, None] = {}
    ambiguous: dict[str, None] = {}
    plugged: dict[str, None] = {}
    for instance in system.instances:
        path, _ = system.plugin(instance.plugin, instance.tree)
        of_type = plugged if path else nodes
        of_name = ambiguous if (instance.plugin, instance.tree) in shared else of_type
        of_name.update(dict.fromkeys(node_words(instance.name, instance.tree)))
        of_type.update(dict.fromkeys(node_words(instance.plugin, instance.tree)))
    trees = "the tree" if len(system.trees) < 2 else "the trees"
    return MockableWords(trees, tuple(nodes), ambiguous=tuple(ambiguous), plugged=tuple(plugged))


def check_likenesses(system: System, mocks: Sequence[Mock]) -> None:
    """Check that no mock declares a node of a system to be executed like a node of a library.

    Raises:
        MockError: a mock does.
    """
    for instance in system.instances:
        if not instance.children or system.plugin(instance.plugin, instance.tree)[1] is not None:
            continue
        mock = likeness_for(mocks, instance.name, instance.plugin, instance.tree)
        if mock is not None:
            raise MockError(
                f"the mock `{mock.pattern}: {mock.behaviour()}` cannot be used for `{instance.plugin}`: in a system, a "
                f"node with children needs a plugin; write one, or write a node of a library instead of "
                f"`{instance.plugin}`"
            )


def inputs(mock: PlannedMock, source: str, trees: Container[str]) -> Iterator[str]:
    """The elements that list a plugin in a system file.

    Args:
        source: the path of the plugin in the file.
        trees: the names of the trees of the system.
    """
    written = f'<input type="bt-plugin-ascxml" src={quoteattr(source)}'
    owners = [tree for tree in mock.trees if tree in trees]
    if not owners:
        yield f"{written} />"
    for tree in owners:
        yield f'{written} {TREE_ATTRIBUTE}="{tree}" />'


def listing(section: Element, entries: Iterable[str]) -> TextEdit:
    """The edit that adds elements to the `<behavior_tree>` section of a system file. It inserts them on the line where
    the section ends, so that all lines keep their numbers."""
    close = section.close_name_span
    at = section.open_span.end if close is None else close.start - len("</")
    return TextEdit(Span(at, at), "".join(entries))


def all_defaults(
    system: System, root: Callable[[str], Element | None], planned: Iterable[PlannedMock]
) -> dict[str, TextEdit]:
    """The edits, by file, that declare defaults for the ports of mocks that only some nodes set: in the listed file of
    each tree with these nodes.

    Args:
        root: returns the root of a tree file.
    """
    leaves = dict.fromkeys(mock.leaf for mock in planned)
    edits: dict[str, TextEdit] = {}
    for path in dict.fromkeys(tree.path for tree in system.trees):
        names = {tree.name for tree in system.trees if tree.path == path}
        element = root(path)
        if element is None:
            continue
        edit = defaults(element, [leaf for leaf in leaves if names & leaf.trees])
        if edit is not None:
            edits[path] = edit
    return edits


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
    those of the mocks.

    Raises:
        MockError: several trees share a node, and the mocks give it different probabilities.
    """
    exact = [mock for mock in mocks if mock.pattern != ALL]
    edits: dict[str, dict[int, TextEdit]] = {}
    chosen: dict[tuple[str, int], Mock] = {}
    for instance in system.instances:
        mock = mock_for(exact, instance.name, instance.plugin, tree=instance.tree)
        if mock is None or not reads_world(instance.plugin) or system.plugin(instance.plugin, instance.tree)[0]:
            continue
        node = node_at(files[instance.source.path], instance.source)
        if node is None:
            continue
        first = chosen.setdefault((instance.source.path, node.element.span.start), mock)
        if first.probability != mock.probability:
            raise MockError(
                f"the mocks `{first.pattern}` and `{mock.pattern}` give different probabilities to one node of a file "
                "that several trees share; use the same probability, or list a copy of the file"
            )
        given = node.element.get(EVENT_ATTRIBUTE)
        at = node.element.name_span.end
        edit = TextEdit(Span(at, at), f' {EVENT_ATTRIBUTE}="{mock.probability!r}"')
        if given is not None:
            edit = TextEdit(given.value_span, repr(mock.probability))
        edits.setdefault(instance.source.path, {})[edit.span.start] = edit
    return {path: list(changes.values()) for path, changes in edits.items()}
