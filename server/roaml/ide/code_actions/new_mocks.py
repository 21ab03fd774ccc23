# SPDX-License-Identifier: Apache-2.0
"""Creates mocks for leaves that have no plugin: plugins that the user can change (docs/spec/mocks.md#generated)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence, Set
from fractions import Fraction
from functools import partial

from roaml.edit.elements import last_in
from roaml.ide.code_actions.action import EXTRACT, CodeAction, WorkspaceEdit
from roaml.ide.code_actions.new_file import free_path, relative
from roaml.mocks.mock import ALL, Mock
from roaml.mocks.system_leaves import SystemLeaf
from roaml.mocks.system_mocks import PlannedMock, all_defaults, inputs, plan
from roaml.model.expand import ROOT_NUMBER
from roaml.model.system import System
from roaml.model.tree import TreeNode
from roaml.model.tree_paths import instance_of, short_paths
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.project.paths import folder_of, name_of, split_name
from roaml.project.system_leaves import missing_leaves, plugin_paths, tick_rates
from roaml.project.workspace import Snapshot
from roaml.text import TextEdit, apply_edits
from roaml.xml_syntax.escapes import escape

DEFAULT = Mock(ALL, 0.9, Fraction(1000))
"""The mock that is created for every leaf, and that the user can change."""
MAX_TIME_S = 600
"""The parameter `max_time` of a created system, in s."""
TICK_RATE = 10
"""The parameter `bt_tick_rate` of a created system, in Hz."""


def actions(snapshot: Snapshot, path: str, node: TreeNode | None, is_top: bool) -> Iterator[CodeAction]:
    """Actions that create mocks for the leaf at the caret, or for all leaves of the system that have no plugin. For a
    tree that belongs to no system, the action creates a system with mocks.

    Args:
        node: the node at the caret; `None` if there is none.
        is_top: whether the caret is in the start tag of the file's root or of a tree.
    """
    analysis = snapshot.analysis
    systems = analysis.memberships.get(path, ())
    if not systems:
        if is_top:
            make = partial(_new_system, snapshot, path)
            yield CodeAction("Create a system with mocks for the leaves", EXTRACT, make, resources=("create",))
        return
    system = analysis.system(systems[0])
    if system is None:
        return
    leaves = missing_leaves(analysis, system)
    own = tuple(leaf for leaf in leaves if node is not None and node.plugin and leaf.type == node.plugin.value)
    for chosen in dict.fromkeys((own, leaves if own or is_top else ())):
        if chosen:
            create = partial(_in_systems, analysis, systems, system, chosen)
            yield CodeAction(_title(chosen), EXTRACT, create, resources=("create",))


def _title(leaves: Sequence[SystemLeaf]) -> str:
    return f"Create a mock of `{leaves[0].type}`" if len(leaves) == 1 else f"Create mocks for {len(leaves)} leaves"


def _in_systems(
    analysis: Analysis, systems: Sequence[str], system: System, leaves: Sequence[SystemLeaf]
) -> WorkspaceEdit:
    planned = _planned(analysis, systems[0], system, leaves)
    edits = {path: _listed(analysis, path, planned) for path in systems} | _defaults(analysis, system, planned)
    created = {mock.path: mock.text for mock in planned}
    return WorkspaceEdit({path: changes for path, changes in edits.items() if changes}, created)


def _defaults(analysis: Analysis, system: System, planned: Iterable[PlannedMock]) -> dict[str, tuple[TextEdit, ...]]:
    """Edits of tree files that declare a default for each port that some nodes do not set."""
    roots = {path: tree.element for path in system.tree_paths if (tree := analysis.tree(path)) is not None}
    return {path: (edit,) for path, edit in all_defaults(system, roots.get, planned).items()}


def _planned(analysis: Analysis, path: str, system: System, leaves: Sequence[SystemLeaf]) -> list[PlannedMock]:
    return plan(leaves, (DEFAULT,), tick_rates(system), plugin_paths(analysis, path))[0]


def _listed(analysis: Analysis, path: str, planned: Iterable[PlannedMock]) -> tuple[TextEdit, ...]:
    file, document, source = analysis.system_file(path), analysis.document(path), analysis.source(path)
    section = file.element.find("behavior_tree") if file else None
    if file is None or document is None or source is None or section is None:
        return ()
    written = [entry.src.value for entry in file.inputs if entry.src]
    listed = analysis.system(path)
    trees = {tree.name for tree in listed.trees} if listed is not None else set()
    lines = [entry for mock in planned for entry in inputs(mock, relative(mock.path, path, written), trees)]
    return tuple(in_layout(source, (last_in(document, section, *lines),)))


# ------------------------------------------------------------ trees without a system


def _new_system(snapshot: Snapshot, path: str) -> WorkspaceEdit:
    """The change that creates a system for a tree, with mocks of its leaves and a property file."""
    analysis = snapshot.analysis
    folder, stem = folder_of(path), split_name(name_of(path))[0]
    main = free_path(analysis, folder, f"{stem}_system.xml")
    properties = free_path(analysis, folder, f"{stem}_properties.xml")
    # The system is analysed before it is written: first for its leaves, then for the names of its nodes.
    texts = {main: _system_text(name_of(path), name_of(properties), ()), properties: _EMPTY}
    without = snapshot.with_texts(texts).analysis
    system = without.system(main)
    if system is None:
        return WorkspaceEdit({}, texts)
    leaves = missing_leaves(without, system)
    planned = _planned(without, main, system, leaves)
    texts |= {mock.path: mock.text for mock in planned}
    texts[main] = _system_text(name_of(path), name_of(properties), planned)
    edits = _defaults(without, system, planned)
    source = without.source(path)
    changed = {path: apply_edits(source.text, edits[path])} if source is not None and path in edits else {}
    complete = snapshot.with_texts(texts | changed).analysis.system(main)
    if complete is not None:
        texts[properties] = _properties_text(complete, {leaf.type for leaf in leaves})
    return WorkspaceEdit(edits, texts)


_EMPTY = '<?xml version="1.0" encoding="UTF-8"?>\n<properties />\n'


def _system_text(tree: str, properties: str, planned: Iterable[PlannedMock]) -> str:
    entries = (entry for mock in planned for entry in inputs(mock, name_of(mock.path), ()))
    plugins = "".join(f"        {entry}\n" for entry in entries)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<roaml>
    <parameters>
        <max_time value="{MAX_TIME_S}" unit="s" />
        <bt_tick_rate value="{TICK_RATE}" />
    </parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="{escape(tree, chr(34))}" />
{plugins}    </behavior_tree>
    <properties>
        <input type="xml" src="{escape(properties, chr(34))}" />
    </properties>
</roaml>
"""


def _properties_text(system: System, leaves: Set[str]) -> str:
    """The text of a property file that requires that the tree succeeds and that each node whose type is in `leaves` is
    ticked, except siblings with equal names."""
    ports: list[str] = []
    guarantees: list[str] = []
    paths = short_paths(system)
    uses = Counter(paths.values())
    for number, text in paths.items():
        plugin = instance_of(system, number).plugin
        if uses[text] != 1:
            continue  # siblings with equal names cannot be told apart
        if number == ROOT_NUMBER:
            status = '            <state_var id="status" type="int32" field="status" expr="0" />\n'
            ports.append(_port(text, "response", "answered", status))
            guarantees.insert(0, _existence("tree_succeeds", "answered &amp;&amp; status == 1"))
        if plugin in leaves:
            ports.append(_port(text, "tick", f"tick_{number}"))
            guarantees.append(_existence(f"reaches_{plugin}_{number}", f"tick_{number}"))
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<properties>\n    <ports>\n'
        f"{''.join(ports)}    </ports>\n    <guarantees>\n{''.join(guarantees)}    </guarantees>\n</properties>\n"
    )


def _port(node: str, event: str, variable: str, more: str = "") -> str:
    return (
        f'        <bt_node node="{escape(node, chr(34))}" event="{event}">\n'
        f'            <event_var id="{variable}" />\n{more}        </bt_node>\n'
    )


def _existence(name: str, condition: str) -> str:
    return (
        f'        <property id="{name}" pattern="existence">\n            <event>{condition}</event>\n'
        '            <scope type="globally" />\n        </property>\n'
    )
