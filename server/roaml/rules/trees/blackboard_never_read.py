# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-never-read`, which blackboard_never_read.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.entries import Use
from roaml.forest.forest import Forest
from roaml.libraries import node_in_libraries
from roaml.model.gaps import GapAct
from roaml.model.system import System
from roaml.model.tree import TreeNode
from roaml.roles import Direction, NodeKind
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, replacements
from roaml.rules.support.blackboard import described, places, renamings
from roaml.rules.support.entries import entries_of, is_of_subtree
from roaml.rules.support.forest import trees_of
from roaml.rules.support.unread_entries import unread_entries
from roaml.scxml.names import BLACKBOARD_WRITE_PREFIX
from roaml.suggest import nearest_name


def check(context: TreeContext) -> Iterator[Finding]:
    """Report variables that are written but not read. Variables that a property observes are not reported.
    blackboard-never-written reports variables that are neither read nor written."""
    system = context.system
    yield from _instead_of_others(context)
    if system is None:
        yield from _in_vain(context)
        yield from _lost(context)
        return
    board = system.blackboard
    read = [name for name, ports in board.items() if any(bound.port.read for bound in ports)]
    unwritten = [name for name in read if not any(bound.port.written for bound in board[name])]
    for variable, ports in board.items():
        entry = system.entries.get(variable)
        if variable in read or (entry is not None and entry.read) or not any(bound.port.written for bound in ports):
            continue
        if not _is_unobserved(system, variable):
            continue
        for bound, span, written in places(context, variable, ports):
            if bound.port.direction is Direction.IN:
                message = f"`{bound.automaton.outline.name}` never reads its port `{bound.port.key}`"
                yield RULE.at(span, message)
            else:
                prefix = bound.automaton.board
                own = variable.removeprefix(prefix)
                close = close_names(own, [name.removeprefix(prefix) for name in unwritten if name.startswith(prefix)])
                message = f"no node reads {described(own, written)}{did_you_mean(close)}"
                yield RULE.at(span, message, *renamings(span, written, own, close))


def _instead_of_others(context: TreeContext) -> Iterator[Finding]:
    """Report entries that are probably written in the place of another one. A port of a system that writes such an
    entry is reported in any case."""
    forest, system = trees_of(context), context.system
    for unread in unread_entries(forest).values() if forest is not None else ():
        use = unread.writer.use
        name = described(unread.writer.variable, use.name)
        if system is not None and not (use.script and _is_unobserved(system, unread.writer.variable)):
            continue
        if unread.meant is not None and use.path == context.source.path:
            message = f"no node reads {name}, and `{unread.meant}` is always {unread.value}"
            message += did_you_mean((unread.meant,))
            fixes = () if use.script else replacements(use.span, [f"{{{unread.meant}}}"])
            yield RULE.at(use.span, message, *fixes)


def _is_unobserved(system: System, variable: str) -> bool:
    is_observed = system.is_observed(f"{BLACKBOARD_WRITE_PREFIX}{variable}")
    return not is_observed and not system.may(GapAct.VARIABLE, variable)


def _in_vain(context: TreeContext) -> Iterator[Finding]:
    """Report the outputs of library nodes in trees without a system that have no other effect, such as `TruncatePath`.
    Nodes that no library describes may read any entry."""
    forest = context.forest
    if forest is None or not all(_is_described(forest, node) for _, _, node in forest.all_nodes):
        return
    entries = entries_of(forest)
    unwritten = {
        bound.use.name: bound.use.type
        for uses in entries.by_entry.values()
        for bound in uses
        if bound.use.reads and not any(other.use.writes is not False for other in uses)
    }
    missing = unwritten.keys() - forest.host_entries
    in_vain: dict[TreeNode, list[Use]] = {}
    useful: set[TreeNode] = set()
    for uses in entries.by_entry.values():
        is_used = any(bound.use.reads is not False or bound.use.remaps for bound in uses)
        for bound in uses:
            use = bound.use
            if not use.writes or use.script or use.port not in _outputs(forest, use.node):
                continue
            name = use.name.removeprefix("@")
            is_own = bound.executed and use.name not in bound.frame.remapped and name not in forest.host_entries
            if is_used or not is_own or use.path != context.source.path or _is_misread(name, missing, use.port):
                useful.add(use.node)
            else:
                in_vain.setdefault(use.node, []).append(use)
    for node, outputs in in_vain.items():
        if node in useful:
            continue
        use, type_ = outputs[0], node.plugin.value if node.plugin is not None else ""
        named = [use.port] if use.port in missing else []
        alike = [name for name, read_as in unwritten.items() if read_as == use.type and name in missing]
        meant = (*(named or alike),) if named or len(alike) == 1 else ()
        if type_.endswith(_OPTIONAL) and not named:
            continue
        message = f"no node reads {described(use.name, use.name)}, and `{type_}` has no other effect"
        yield RULE.at(use.span, message + did_you_mean(meant), *replacements(use.span, [f"{{{n}}}" for n in meant]))


def _lost(context: TreeContext) -> Iterator[Finding]:
    """Report nodes that models describe, in subtrees, if all their outputs are entries of the subtree that nothing
    reads. If an entry of the subtree is read and never written, this is reported instead."""
    forest = trees_of(context)
    if forest is None or any(forest.is_unknown(node) for _, _, node in forest.all_nodes):
        return
    by_entry, unread = entries_of(forest).by_entry, unread_entries(forest)
    lacking = {
        bound.use.tree
        for uses in by_entry.values()
        for bound in uses
        if bound.use.reads
        and bound.use.name not in bound.frame.remapped
        and not any(other.use.writes is not False for other in uses)
    }
    lost: dict[TreeNode, Use] = {}
    useful: set[TreeNode] = set()
    for key, uses in by_entry.items():
        is_read = any(bound.use.reads is not False or bound.use.remaps or bound.use.script for bound in uses)
        is_own = all(bound.executed and is_of_subtree(forest, bound) for bound in uses) and key not in unread
        for use in (bound.use for bound in uses if bound.use.writes and not bound.use.script):
            known = forest.known_node(use.node)
            if is_read or not is_own or use.tree in lacking or known is None or known.behaviour:
                useful.add(use.node)
            elif use.path == context.source.path:
                lost.setdefault(use.node, use)
    for node, use in lost.items():
        if node not in useful:
            yield RULE.at(use.span, f"no node reads `{use.name}`, which is a variable of this subtree only")


def _is_misread(name: str, unwritten: Iterable[str], port: str) -> bool:
    """Whether an entry that nothing writes has a similar name, so that blackboard-never-written reports the mistake
    where it is read. An entry with the name of the port that writes `name` is probably the right one."""
    others = [other for other in unwritten if other != port]
    return nearest_name(name, unwritten) is not None or any(other in name or name in other for other in others)


_OPTIONAL = "Selector"
"""The end of the types that let users choose a part of Nav2. Many trees have them although nothing reads the choice."""
_FOR_ERRORS = frozenset(("error_code_id", "error_msg"))
_WITH_EFFECT = frozenset(("server_name", "service_name"))
"""Ports of nodes that call an action or a service, so that their outputs are not their only effect."""


def _outputs(forest: Forest, node: TreeNode) -> frozenset[str]:
    """The output ports of a node that are its only effect."""
    known = forest.known_node(node)
    library = node_in_libraries(known.name) if known is not None and known.behaviour else None
    if library is None or library.kind is NodeKind.CONDITION:
        return frozenset()
    names = {port.name for port in library.ports}
    outputs = {port.name for port in library.ports if port.direction is Direction.OUT} - _FOR_ERRORS
    return frozenset() if names & _WITH_EFFECT else frozenset(outputs)


def _is_described(forest: Forest, node: TreeNode) -> bool:
    known = forest.known_node(node)
    return forest.calls_tree(node) or (known is not None and known.behaviour != "")


RULE = Rule("blackboard-never-read", Severity.WARNING, "A blackboard variable is written but never read.", tree=check)
