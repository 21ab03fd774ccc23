# SPDX-License-Identifier: Apache-2.0
"""Refactorings: changes that do not fix a diagnostic. They are offered at the elements that they change."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.edit.elements import after, halts, last_in
from roaml.ide.code_actions import convert_property, migrate, new_mocks, new_parameter, new_plugin, node_form
from roaml.ide.code_actions.action import EXTRACT, REWRITE, CodeAction, WorkspaceEdit, known
from roaml.language import HL_SCXML
from roaml.model.kinds import FileKind
from roaml.model.machine import Declaration, Machine, State
from roaml.model.tree import TreeNode, nodes
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.project.workspace import Snapshot
from roaml.roles import ProtocolPart, SymbolKind
from roaml.text import Edit, Span
from roaml.xml_syntax import Element

_RESULTS = tuple(name for name, type_ in HL_SCXML.elements.items() if type_.receives is ProtocolPart.RESULT)
"""The names of the elements that handle the results of a ROS action."""


def refactorings(snapshot: Snapshot, path: str, place: Span) -> Iterator[CodeAction]:
    """The refactorings that are possible at a place."""
    analysis = snapshot.analysis
    machine = analysis.machine(path) if analysis.kind(path) is FileKind.MACHINE else None
    if machine is not None:
        yield from _halt(analysis, path, machine, place)
        yield from _results(analysis, path, machine, place)
    if analysis.kind(path) is FileKind.TREE:
        yield from _nodes(analysis, path, place)
        yield from new_mocks.actions(snapshot, path, _node_at(analysis, path, place), _is_top(analysis, path, place))
    yield from convert_property.actions(analysis, path, place)
    yield from new_parameter.actions(analysis, path, place)
    yield from migrate.actions(snapshot, path, place)


def _edited(analysis: Analysis, path: str, *edits: Edit) -> WorkspaceEdit:
    source = analysis.source(path)
    return WorkspaceEdit({path: tuple(in_layout(source, edits))}) if source else WorkspaceEdit()


# ------------------------------------------------------------------ machines


def _halt(analysis: Analysis, path: str, machine: Machine, place: Span) -> Iterator[CodeAction]:
    """Actions that add a `<bt_halt>` to the state at the caret, or to all states that handle ticks but not halts."""
    document, root = analysis.document(path), machine.element
    state = _state_at(machine, place)
    if document is None or state is None:
        return
    here = halts(document, root, [state.element])
    everywhere = halts(document, root, root.elements)
    if here:
        yield CodeAction("Add `<bt_halt>` to this state", REWRITE, known(_edited(analysis, path, *here)))
    if here and len(everywhere) > 1:
        title = "Add `<bt_halt>` to every state with `<bt_tick>`"
        yield CodeAction(title, REWRITE, known(_edited(analysis, path, *everywhere)))


def _results(analysis: Analysis, path: str, machine: Machine, place: Span) -> Iterator[CodeAction]:
    """Actions that add handlers to the state at the caret, for the results of a ROS action that the state does not
    handle."""
    document, state = analysis.document(path), _state_at(machine, place)
    if document is None or state is None or state.id is None or not state.element.complete:
        return
    for client in machine.declarations:
        if client.kind is not SymbolKind.ACTION_CLIENT or client.handle is None or not _sends_goals(machine, client):
            continue
        known_handlers = [
            h
            for h in state.handlers
            if h.trigger is ProtocolPart.RESULT and h.handle and h.handle.value == client.handle.value
        ]
        missing = [name for name in _RESULTS if name not in {h.element.name for h in known_handlers}]
        if missing:
            targets = [t.state.value for h in known_handlers for t in h.targets if t.state]
            target = targets[-1] if targets else state.id.value
            lines = [f'<{name} name="{client.handle.value}" target="{target}" />' for name in missing]
            edit = (
                after(document, known_handlers[-1].element, *lines)
                if known_handlers
                else last_in(document, state.element, *lines)
            )
            which = "the other" if known_handlers else "all"
            title = f"Handle {which} results of `{client.handle.value}` in this state"
            yield CodeAction(title, REWRITE, known(_edited(analysis, path, edit)))


def _sends_goals(machine: Machine, client: Declaration) -> bool:
    assert client.handle is not None
    senders = (e for e in machine.element.walk() if e.name == "ros_action_send_goal")
    return any((name := e.get("name")) is not None and name.value.strip() == client.handle.value for e in senders)


def _state_at(machine: Machine, place: Span) -> State | None:
    for chart in machine.charts:
        for state in chart.states:
            if state.element.span.start <= place.start and place.end <= state.element.span.end:
                return state
    return None


# --------------------------------------------------------------------- trees


def _nodes(analysis: Analysis, path: str, place: Span) -> Iterator[CodeAction]:
    node = _node_at(analysis, path, place)
    if node is None:
        yield from node_form.whole_file(analysis, path, place)
        return
    yield from node_form.one_node(analysis, path, node)
    if node.plugin is not None and not node.is_subtree and _is_unknown(analysis, path, node):
        for title, make in new_plugin.skeletons(analysis, path, node):
            yield CodeAction(title, EXTRACT, make, resources=("create",))


def _is_unknown(analysis: Analysis, path: str, node: TreeNode) -> bool:
    systems = [system for owner in analysis.memberships.get(path, ()) if (system := analysis.system(owner))]
    trees = [tree.id for tree_path in analysis.trees_from(path) if (f := analysis.tree(tree_path)) for tree in f.trees]
    name = node.plugin.value if node.plugin else ""
    is_tree = any(tree is not None and tree.value == name for tree in trees)
    return bool(systems) and not is_tree and all(system.plugin(name)[1] is None for system in systems)


def _node_at(analysis: Analysis, path: str, place: Span) -> TreeNode | None:
    """The node whose start tag contains the caret; `None` if there is none."""
    file = analysis.tree(path)
    for tree in file.trees if file else ():
        for node in nodes(tree):
            if _touches(node.element, place):
                return node
    return None


def _is_top(analysis: Analysis, path: str, place: Span) -> bool:
    """Whether the caret is in the start tag of the file's root or of a tree."""
    file = analysis.tree(path)
    return file is not None and any(
        _touches(element, place) for element in (file.element, *(tree.element for tree in file.trees))
    )


def _touches(element: Element, place: Span) -> bool:
    return element.open_span.start <= place.start and place.end <= element.open_span.end
