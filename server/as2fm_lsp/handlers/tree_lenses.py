# SPDX-License-Identifier: Apache-2.0
"""Lenses above each behavior tree: run, debug and verify it, alone with mocks, in the tree that uses it, or in its
systems.

The protocol has no commands that debug or edit mocks. A client that has these commands names them in its
initialization options: `debugModel` is called with the URI of a system or tree and attributes of `launch`, `editMocks`
with the URI of a tree.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import RequestedDocument
from as2fm_lsp.handlers.results import TITLE, VERIFY, CurrentResults, result_commands, result_words
from roaml.diagnostics import Severity
from roaml.ide.system_names import system_names
from roaml.ide.verifiable import verifiable
from roaml.model.kinds import FileKind
from roaml.model.tree import Tree
from roaml.project.mock_files import executed_tree
from roaml.project.paths import is_on_disk
from roaml.text import Span

RUN, DEBUG, MOCKS = "Run", "Debug", "Mocks"


def lenses(context: Context, on: RequestedDocument, broken: Collection[str]) -> Iterator[types.CodeLens]:
    """The lenses of the trees in a file.

    Args:
        broken: the systems that have errors. Their trees cannot be run.
    """
    if on.analysis.kind(on.path) is not FileKind.TREE or not is_on_disk(on.path):
        return
    if on.analysis.memberships.get(on.path):
        yield from _in_systems(context, on, broken)
    else:
        executed = executed_tree(on.analysis, on.path)
        if executed is not None:
            yield from _alone(context, on, executed)


def _alone(context: Context, on: RequestedDocument, executed: Tree) -> Iterator[types.CodeLens]:
    (property_,) = verifiable(on.analysis, on.path)
    place, uri = on.range(property_.name_span), on.convert.uri(on.path)
    errors = [d for d in on.snapshot.checker.diagnostics(on.path) if d.severity is Severity.ERROR]
    if errors:
        title = f"{len(errors)} {'error' if len(errors) == 1 else 'errors'}: cannot be run or verified"
        yield types.CodeLens(place, types.Command(title, ""))
        return
    current = CurrentResults(context, on.snapshot, on.path)
    known = current.get(property_.name)

    def runs(where: str) -> list[types.Command]:
        title = f"{TITLE}{where}" if known is None else f"{TITLE}{where} · {result_words(current, known)}"
        return [*_debug(context, uri, where), types.Command(title, VERIFY, arguments=[uri, [property_.name]])]

    commands = runs("")
    commands += [] if known is None else result_commands(context, uri, property_.name, known.result)
    if context.client.edit_mocks:
        commands.append(types.Command(MOCKS, context.client.edit_mocks, arguments=[uri]))
    for command in commands:
        yield types.CodeLens(place, command)
    for subtree in _subtrees(on, executed):
        for command in runs(f" in {executed.id.value}" if executed.id is not None else ""):
            yield types.CodeLens(on.range(subtree), command)


def _subtrees(on: RequestedDocument, executed: Tree) -> Iterator[Span]:
    """The places of the names of the trees in a file that the executed tree contains as subtrees."""
    forest = on.analysis.forest(on.path)
    if forest is None or executed.id is None:
        return
    reached = forest.reached(executed.id.value)
    for tree in forest.file.trees:
        if tree.id is not None and tree is not executed and tree.id.value in reached:
            yield tree.id.span


def _in_systems(context: Context, on: RequestedDocument, broken: Collection[str]) -> Iterator[types.CodeLens]:
    file = on.analysis.tree(on.path)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        if system in broken or not is_on_disk(system):
            continue
        uri, where = on.convert.uri(system), f" in {name}" if len(systems) > 1 else ""
        commands = list(_debug(context, uri, where))
        if verifiable(on.analysis, system):
            commands.append(types.Command(f"{TITLE}{where}", VERIFY, arguments=[uri]))
        for tree in file.trees if file is not None else ():
            place = on.range(tree.id.span if tree.id is not None else tree.element.name_span)
            for command in commands:
                yield types.CodeLens(place, command)


def _debug(context: Context, uri: str, where: str) -> Iterator[types.Command]:
    if context.client.debug_model:
        for title, attributes in ((RUN, {"stopOnEntry": False, "noDebug": True}), (DEBUG, {"stopOnEntry": True})):
            arguments = [uri, attributes]
            yield types.Command(f"{title}{where}", context.client.debug_model, arguments=arguments)
