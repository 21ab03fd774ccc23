# SPDX-License-Identifier: Apache-2.0
"""Quick fixes that a rule cannot offer, because they change other files or create new ones.

A function for each rule takes a diagnostic and returns actions. Other files are read when the fixes are requested, so
that the fixes are always up to date.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from functools import partial

from roaml.diagnostics import Diagnostic
from roaml.disk import UnreadableReason
from roaml.edit.elements import after, first_in, removal
from roaml.ide.code_actions import new_file
from roaml.ide.code_actions.action import QUICK_FIX, CodeAction, WorkspaceEdit, known
from roaml.ide.code_actions.inputs import add_input, move_input
from roaml.ide.code_actions.move_expectation import movable_expectations, moved
from roaml.ide.code_actions.new_plugin import port_of, skeletons
from roaml.ide.rename import Renaming, rename
from roaml.language import SYSTEM
from roaml.model.kinds import FileKind
from roaml.model.machine import Machine
from roaml.model.syntax import Name
from roaml.model.system import CHILDREN_COUNT
from roaml.model.system_file import ListedFile, SystemSection
from roaml.model.tree import TreeNode, nodes
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.project.paths import folder_of, is_below, is_on_disk, name_of, split_name
from roaml.project.workspace import Snapshot
from roaml.roles import Direction, SymbolKind
from roaml.rules.elements.missing_element import MissingChild
from roaml.rules.files.missing_file import UnusableFile
from roaml.rules.interfaces.invalid_rate import rate_problem
from roaml.rules.support.names import WrongName
from roaml.rules.systems.input_count import InputCount
from roaml.rules.systems.small_clock_step import BetterRate
from roaml.rules.trees.blackboard_type_conflict import TypeConflict
from roaml.suggest import close_names
from roaml.text import SourceFile, Span, TextEdit

_MAX_FILES = 3
"""The maximum number of files that are offered for a diagnostic."""

_Edits = dict[str, tuple[TextEdit, ...]]


def repairs(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """The quick fixes of a diagnostic that its rule does not offer itself."""
    repair = FIXES_ACROSS_FILES.get(diagnostic.code)
    if repair is not None:
        yield from repair(snapshot, diagnostic)


def _action(
    diagnostic: Diagnostic,
    title: str,
    make: Callable[[], WorkspaceEdit],
    *,
    preferred: bool = False,
    creates: bool = False,
) -> CodeAction:
    return CodeAction(title, QUICK_FIX, make, diagnostic, preferred, ("create",) if creates else ())


# --------------------------------------------------------- files that are missing


def _missing_file(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """Actions that use a file with a similar name, or that create the missing file."""
    analysis, system = snapshot.analysis, diagnostic.path
    listed = next((f for f in analysis.listed(system) if f.input.src and f.input.src.span == diagnostic.span), None)
    if listed is None:
        return
    there = {f.path for f in analysis.listed(system)}
    of_kind = (p for p in snapshot.listed if p not in there and analysis.kind(p) is listed.required_kind)
    yield from _other_files(analysis, diagnostic, listed.path, of_kind)
    text = _NEW.get(listed.input.type.value if listed.input.type else "")
    is_missing = diagnostic.facts == UnusableFile(UnreadableReason.MISSING)
    if text is not None and is_missing and is_on_disk(listed.path):
        yield from _create(diagnostic, listed, text)


def _create(diagnostic: Diagnostic, listed: ListedFile, text: Callable[[str], str]) -> Iterator[CodeAction]:
    path, stem = listed.path, new_file.stem_of(listed.path)
    if split_name(path)[1] and stem:
        content = text(new_file.camel_case(stem))
        yield _action(
            diagnostic, f"Create `{name_of(path)}`", known(WorkspaceEdit(created={path: content})), creates=True
        )


_NEW: dict[str, Callable[[str], str]] = {
    "node-ascxml": new_file.node,
    "bt-plugin-ascxml": new_file.plugin,
    "bt.cpp-xml": lambda _: new_file.tree(),
    "jani": lambda _: new_file.properties(),
}


def _missing_include(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    analysis = snapshot.analysis
    file = analysis.tree(diagnostic.path)
    include = next((i for i in file.includes if i.path and i.path.span == diagnostic.span), None) if file else None
    if include is None or include.path is None:
        return
    target = analysis.include_path(diagnostic.path, include)
    if target is not None and not isinstance(analysis.files.read(target), SourceFile):
        trees = (p for p in snapshot.listed if analysis.kind(p) is FileKind.TREE and p != diagnostic.path)
        trees = (p for p in trees if diagnostic.path not in analysis.trees_from(p))
        yield from _other_files(analysis, diagnostic, target, trees)


def _other_files(analysis: Analysis, diagnostic: Diagnostic, path: str, others: Iterable[str]) -> Iterator[CodeAction]:
    """Actions that replace `path` by a file that was probably intended: one with the same name in another folder, or
    one with a similar name."""
    written = _text_at(analysis, diagnostic)
    by_name: dict[str, list[str]] = {}
    for other in others:
        if other != path:
            by_name.setdefault(name_of(other), []).append(other)
    name = name_of(path)
    close = dict.fromkeys((*([name] if name in by_name else []), *close_names(name, by_name)))
    similar = [other for file_name in close for other in by_name[file_name]]
    for number, other in enumerate(similar[:_MAX_FILES]):
        new = new_file.relative(other, diagnostic.path, [written])
        change = WorkspaceEdit({diagnostic.path: (TextEdit(diagnostic.span, _attribute(new)),)})
        yield _action(diagnostic, f"Change to `{new}`", known(change), preferred=number == 0)


# ------------------------------------------------------------ plugins and inputs


def _unknown_node(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """Actions that list the file of the plugin in the system, or that create a new plugin."""
    analysis = snapshot.analysis
    node = _node_at(analysis, diagnostic)
    systems = analysis.memberships.get(diagnostic.path, ())
    if not systems or node is None or node.plugin is None or (node.type is not None and not node.type.translated):
        return
    name = node.plugin.value
    for system in systems[:1]:
        as_node = next(
            (
                f
                for f in analysis.listed(system)
                if f.input.section is SystemSection.NODE_MODELS and f.usable and _is_machine(analysis, f.path, name)
            ),
            None,
        )
        if as_node is not None:
            yield _move(analysis, diagnostic, system, as_node)
            return
        for path in snapshot.listed:
            if analysis.kind(path) is FileKind.MACHINE and _is_machine(analysis, path, name):
                title = f"List `{name_of(path)}` in `{name_of(system)}`"
                yield _action(diagnostic, title, partial(_list, analysis, systems, path), preferred=True)
                return
    for title, make in skeletons(analysis, diagnostic.path, node):
        yield _action(diagnostic, title, make, creates=True)


def _endpoint(kinds: tuple[SymbolKind, ...], snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that lists a machine of the system's folder that declares the missing side of a topic, service or
    action.

    Args:
        kinds: the declarations that are missing, for example a server.
    """
    analysis, name = snapshot.analysis, _text_at(snapshot.analysis, diagnostic).strip("/")
    for system in analysis.memberships.get(diagnostic.path, ())[:1] if name else ():
        listed = {file.path for file in analysis.listed(system)}
        for path in snapshot.listed:
            if path not in listed and is_below(path, folder_of(system)) and _declares(analysis, path, kinds, name):
                title = f"List `{name_of(path)}` in `{name_of(system)}`"
                edits = add_input(analysis, system, SystemSection.NODE_MODELS, "node-ascxml", path)
                yield _action(diagnostic, title, known(WorkspaceEdit({system: edits} if edits else {})), preferred=True)
                return


def _declares(analysis: Analysis, path: str, kinds: tuple[SymbolKind, ...], name: str) -> bool:
    machine = analysis.machine(path) if analysis.kind(path) is FileKind.MACHINE else None
    return machine is not None and any(
        d.kind in kinds and isinstance(d.interface, Name) and d.interface.value.strip("/") == name
        for d in machine.declarations
    )


def _is_machine(analysis: Analysis, path: str, name: str) -> bool:
    machine = analysis.machine(path)
    return machine is not None and machine.name is not None and machine.name.value == name


def _list(analysis: Analysis, systems: Iterable[str], path: str) -> WorkspaceEdit:
    edits = {s: add_input(analysis, s, SystemSection.BEHAVIOR_TREE, "bt-plugin-ascxml", path) for s in systems}
    return WorkspaceEdit({system: edit for system, edit in edits.items() if edit})


def _element_in_node(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that lists a machine as a plugin instead of as a ROS node."""
    analysis = snapshot.analysis
    for system in analysis.memberships.get(diagnostic.path, ()):
        if not analysis.tree_paths(system):
            continue  # the system would have plugins but no tree
        for listed in analysis.listed(system):
            if listed.path == diagnostic.path and listed.input.section is SystemSection.NODE_MODELS:
                yield _move(analysis, diagnostic, system, listed)
                return


def _move(analysis: Analysis, diagnostic: Diagnostic, system: str, listed: ListedFile) -> CodeAction:
    title = f"List `{name_of(listed.path)}` as a plugin in `{name_of(system)}`"

    def make() -> WorkspaceEdit:
        edits = move_input(analysis, system, listed, SystemSection.BEHAVIOR_TREE, "bt-plugin-ascxml")
        return WorkspaceEdit({system: edits}) if edits else WorkspaceEdit()

    return _action(diagnostic, title, make, preferred=True)


def _no_tree(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    if diagnostic.facts == InputCount(FileKind.TREE):
        yield from _list_file(snapshot, diagnostic, SystemSection.BEHAVIOR_TREE, "bt.cpp-xml", FileKind.TREE)


def _slower_timer(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that changes the rate of a timer so that the clock of the system advances in larger steps."""
    facts, system = diagnostic.facts, snapshot.analysis.system(diagnostic.path)
    if not isinstance(facts, BetterRate) or system is None:
        return
    if not system.automata_of(facts.path) or rate_problem(facts.rate):
        return
    machine = snapshot.analysis.machine(facts.path)
    for declaration in machine.declarations if machine else ():
        handle, rate = declaration.handle, declaration.rate
        if declaration.kind is SymbolKind.TIMER and handle and handle.value == facts.timer and isinstance(rate, Name):
            change = WorkspaceEdit({facts.path: (TextEdit(rate.span, facts.rate),)})
            yield _action(diagnostic, f"Change the rate of `{facts.timer}` to {facts.rate} Hz", known(change))


def _no_section(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """Actions for a system file without properties: each lists a property file from the folder of the system file."""
    facts = diagnostic.facts
    if (
        isinstance(facts, MissingChild)
        and facts.parent in SYSTEM.roots
        and facts.name == SystemSection.PROPERTIES.value
    ):
        yield from _list_file(snapshot, diagnostic, SystemSection.PROPERTIES, "jani", FileKind.PROPERTIES)


def _list_file(
    snapshot: Snapshot, diagnostic: Diagnostic, section: SystemSection, type_: str, kind: FileKind
) -> Iterator[CodeAction]:
    """Actions that list a file from the folder of the system file, or from a folder below it."""
    analysis, system = snapshot.analysis, diagnostic.path
    folder = folder_of(system)
    for number, path in enumerate(p for p in snapshot.listed if is_below(p, folder) and analysis.kind(p) is kind):
        if number < _MAX_FILES:
            title = f"List `{new_file.relative(path, system)}`"
            edits = add_input(analysis, system, section, type_, path)
            change = WorkspaceEdit({system: edits}) if edits else WorkspaceEdit()
            if change:
                yield _action(diagnostic, title, known(change), preferred=number == 0)


# --------------------------------------------------------------------- ports


def _unused_port(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that removes a port, and the attributes that set it in the trees."""
    if diagnostic.fixes:
        return
    machine = snapshot.analysis.machine(diagnostic.path)
    port = next((p for p in machine.ports if p.key and p.key.span == diagnostic.span), None) if machine else None
    if machine is None or port is None or port.key is None:
        return
    key, element = port.key.value, port.element

    def make() -> WorkspaceEdit:
        edits = _settings(snapshot.analysis, machine, diagnostic.path, key)
        source = snapshot.analysis.source(diagnostic.path)
        assert source is not None
        return WorkspaceEdit({**edits, diagnostic.path: _removals(source, element.span)})

    preferred = not _feeds_others(snapshot.analysis, diagnostic.path, key)
    yield _action(diagnostic, f"Remove the port `{key}` here and in the tree", make, preferred=preferred)


def _feeds_others(analysis: Analysis, path: str, key: str) -> bool:
    """Whether an output port of a plugin is bound to a variable that other ports read. If so, the missing statement
    that writes the port is probably the error, and not the declaration of the port."""
    systems = (analysis.system(system) for system in analysis.memberships.get(path, ()))
    for variable in (ports for system in systems if system for ports in system.blackboard.values()):
        own = [bound for bound in variable if bound.automaton.path == path and bound.port.key == key]
        if any(bound.port.direction is Direction.OUT for bound in own) and any(bound.port.read for bound in variable):
            return True
    return False


def _settings(analysis: Analysis, machine: Machine, path: str, key: str) -> _Edits:
    """The edits that remove a port of a plugin from all nodes of trees that set it."""
    name = machine.name.value if machine.name else ""
    edits: _Edits = {}
    for tree_path in _trees(analysis, path):
        file, source = analysis.tree(tree_path), analysis.source(tree_path)
        if file is None or source is None:
            continue
        spans = [
            s.attribute.span
            for n in _all_nodes(analysis, tree_path)
            if n.plugin and n.plugin.value == name
            for s in n.ports
            if s.key.value == key
        ]
        models = [m for m in file.models if m.id and m.id.value == name]
        spans += [p.element.span for m in models for p in m.ports if p.name and p.name.value == key]
        if spans:
            edits[tree_path] = _removals(source, *spans)
    return edits


def _unknown_port(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that declares a port in the plugin, if all nodes of the plugin set it."""
    if any(fix.preferred for fix in diagnostic.fixes):
        return
    analysis = snapshot.analysis
    node = _node_at(analysis, diagnostic)
    setting = next((s for s in node.ports if s.key.span == diagnostic.span), None) if node else None
    for path in analysis.memberships.get(diagnostic.path, ())[:1]:
        system = analysis.system(path)
        if system is None or node is None or node.plugin is None or setting is None:
            return
        plugin = system.seen_from(diagnostic.path).plugin(node.plugin.value)[0]
        machine, document = (analysis.machine(plugin), analysis.document(plugin)) if plugin else (None, None)
        source = analysis.source(plugin) if plugin else None
        same = [
            n
            for t in analysis.tree_paths(path)
            for n in _all_nodes(analysis, t)
            if n.plugin and n.plugin.value == node.plugin.value
        ]
        everywhere = all(n.element.get(setting.key.value) is not None for n in same)
        if (
            machine is None
            or document is None
            or source is None
            or not everywhere
            or setting.key.value == CHILDREN_COUNT
        ):
            return
        way, key, type_ = port_of(system, setting)
        text = f'<bt_declare_port_{way} key="{key}" type="{type_}" />'
        edit = (
            after(document, machine.ports[-1].element, text)
            if machine.ports
            else first_in(document, machine.element, text)
        )
        change = WorkspaceEdit({plugin: tuple(in_layout(source, (edit,)))})
        yield _action(diagnostic, f"Declare the port `{key}` in `{node.plugin.value}`", known(change))


def _unused_plugin(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that removes an unused plugin from the system, unless a tree that is not executed uses it."""
    analysis, system = snapshot.analysis, diagnostic.path
    source = analysis.source(system)
    listed = next((f for f in analysis.listed(system) if f.input.src and f.input.src.span == diagnostic.span), None)
    machine = analysis.machine(listed.path) if listed else None
    if source is None or listed is None or machine is None or machine.name is None:
        return
    used = (n.plugin.value for tree in analysis.tree_paths(system) for n in _all_nodes(analysis, tree) if n.plugin)
    if machine.name.value not in used:
        change = WorkspaceEdit({system: _removals(source, listed.input.element.span)})
        yield _action(diagnostic, "Remove this `<input>`", known(change), preferred=True)


def _type_conflict(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """Actions that declare one of two ports that are bound to the same variable with the type of the other one."""
    analysis = snapshot.analysis
    facts, node = diagnostic.facts, _node_at(analysis, diagnostic)
    if not isinstance(facts, TypeConflict) or node is None or node.plugin is None:
        return
    own, other = (node.plugin.value, facts.port), (facts.other_node, facts.other_port)
    for system in analysis.memberships.get(diagnostic.path, ())[:1]:
        linked = analysis.system(system)
        for (plugin, key), type_ in ((own, facts.other_type), (other, facts.type)):
            path = linked.plugin(plugin)[0] if linked else ""
            machine = analysis.machine(path) if path else None
            port = next((p for p in machine.ports if p.key and p.key.value == key), None) if machine else None
            if port is not None and port.type is not None:
                change = WorkspaceEdit({path: (TextEdit(port.type.span, type_),)})
                yield _action(diagnostic, f"Declare `{key}` of `{plugin}` as {type_}", known(change))


# --------------------------------------------------------------------- names


def _name(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that replaces an invalid name at the definition and at all uses of its symbol."""
    if diagnostic.fixes or not isinstance(diagnostic.facts, WrongName):
        return
    analysis = snapshot.analysis
    new = re.sub(r"\W", "_", diagnostic.facts.name, flags=re.ASCII).strip("_")
    if not new:
        return
    new = new if not new[0].isdigit() else f"n{new}"
    renaming = rename(analysis, diagnostic.path, diagnostic.span.start, new)
    if not isinstance(renaming, Renaming):
        new = f"{new}_value"
        renaming = rename(analysis, diagnostic.path, diagnostic.span.start, new)
    if isinstance(renaming, Renaming):
        change = WorkspaceEdit(renaming.edits)
        yield _action(diagnostic, f"Rename to `{new}`", known(change), preferred=True)


# ---------------------------------------------------------------- expectations


def _move_expectations(snapshot: Snapshot, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """An action that moves the expectations of the property file to the configuration."""
    analysis, path = snapshot.analysis, diagnostic.path
    expectations = movable_expectations(analysis, path)
    for system in analysis.memberships.get(path, ())[:1] if expectations else ():
        file = snapshot.configuration_of(system)
        subject = "the expectation" if len(expectations) == 1 else f"{len(expectations)} expectations"
        make = partial(moved, analysis, path, expectations, file)
        yield _action(diagnostic, f"Move {subject} to `{name_of(file)}`", make, creates=analysis.source(file) is None)


# -------------------------------------------------------------------- helpers


def _text_at(analysis: Analysis, diagnostic: Diagnostic) -> str:
    source = analysis.source(diagnostic.path)
    return source.text[slice(*diagnostic.span)] if source else ""


def _removals(source: SourceFile, *spans: Span) -> tuple[TextEdit, ...]:
    return tuple(in_layout(source, (removal(source.text, span) for span in spans)))


def _attribute(text: str) -> str:
    return text.replace("&", "&amp;").replace('"', "&quot;").replace("'", "&apos;").replace("<", "&lt;")


def _all_nodes(analysis: Analysis, path: str) -> Iterator[TreeNode]:
    file = analysis.tree(path)
    for tree in file.trees if file else ():
        yield from nodes(tree)


def _node_at(analysis: Analysis, diagnostic: Diagnostic) -> TreeNode | None:
    """The innermost node of a tree that contains the span of a diagnostic; `None` if there is none."""
    around = [n for n in _all_nodes(analysis, diagnostic.path) if n.element.span.encloses(diagnostic.span)]
    return min(around, key=lambda n: n.element.span.end - n.element.span.start, default=None)


def _trees(analysis: Analysis, path: str) -> tuple[str, ...]:
    """The tree files of all systems to which a file belongs."""
    return tuple(dict.fromkeys(t for s in analysis.memberships.get(path, ()) for t in analysis.tree_paths(s)))


FIXES_ACROSS_FILES: dict[str, Callable[[Snapshot, Diagnostic], Iterator[CodeAction]]] = {
    "blackboard-type-conflict": _type_conflict,
    "input-count": _no_tree,
    "invalid-name": _name,
    "machine-name": _name,
    "missing-client": partial(_endpoint, (SymbolKind.SERVICE_CLIENT, SymbolKind.ACTION_CLIENT)),
    "missing-element": _no_section,
    "missing-file": _missing_file,
    "missing-include": _missing_include,
    "missing-server": partial(_endpoint, (SymbolKind.SERVICE_SERVER, SymbolKind.ACTION_SERVER)),
    "small-clock-step": _slower_timer,
    "topic-without-publisher": partial(_endpoint, (SymbolKind.PUBLISHER,)),
    "topic-without-subscriber": partial(_endpoint, (SymbolKind.SUBSCRIBER,)),
    "tree-element-in-node": _element_in_node,
    "unknown-node": _unknown_node,
    "unknown-port": _unknown_port,
    "unportable-expectation": _move_expectations,
    "unused-plugin": _unused_plugin,
    "unused-port": _unused_port,
}
