# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-structure`, which tree_structure.md describes."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.forest.forest import Forest
from roaml.language import BEHAVIOR_TREE
from roaml.model.expand import NodeOutline, TreeOutline, main_tree
from roaml.model.syntax import Name
from roaml.model.tree import Tree, nodes
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext, close_names, listing, replacements, unused
from roaml.rules.support import misspelled
from roaml.suggest import alternatives, are_similar
from roaml.text import Span, TextEdit
from roaml.xml_syntax.escapes import escape

MAIN = "MainTree"
"""The conventional name of the executed tree."""

REFUSED_NAMES = ("", "Root", "root")
"""Names of trees that BehaviorTree.CPP refuses."""

MAX_EXECUTABLE_FIXES = 5
"""The maximum number of trees for which a fix offers to execute them."""


def check(context: TreeContext) -> Iterator[Finding]:
    known: dict[str, list[TreeOutline]] = {}
    for outline in (tree for file in context.files for tree in file.trees):
        if outline.id:
            known.setdefault(outline.id, []).append(outline)
    # Without a system, an element with the name of a tree executes this tree.
    lone = context.forest if context.forest is not None and context.forest.system is None else None
    # The rule `tree-name` reports a tree with the name of a node.
    compact = {
        name: sorted(other for other in called if lone is not None and lone.node(other) is None)
        for name, called in (lone.subtrees if lone is not None else {}).items()
    }
    uses = {name: dict.fromkeys((*_subtrees(trees[-1].root), *compact.get(name, ()))) for name, trees in known.items()}
    circular = _circular(uses)
    for tree in context.file.trees:
        yield from _id(context, tree, known)
        for node in nodes(tree):
            if node.plugin is None:
                continue
            compact_use = lone is not None and lone.calls_tree(node) and lone.known_node(node) is None
            if node.is_subtree or (compact_use and node.plugin.value in uses):
                yield from _subtree(context, tree, node.plugin, uses, circular)
    if context.files and context.files[0].path == context.source.path:
        yield from _main(context)


def _id(context: TreeContext, tree: Tree, known: Mapping[str, Sequence[TreeOutline]]) -> Iterator[Finding]:
    count = sum(len(file.trees) for file in context.files)
    if tree.id is None:
        if count > 1:
            name = unused("Tree", known)
            at = tree.element.name_span.end
            edits = (TextEdit(Span(at, at), f' ID="{name}"'),)
            fix = Fix(f'Add `ID="{name}"`', edits, preferred=False)
            yield RULE.at(tree.element.name_span, "if there are several trees, each needs an `ID`", fix)
        return
    same = known.get(tree.id.value, ()) or [t for f in context.files for t in f.trees if t.id == tree.id.value]
    if len(same) > 1 and not (context.forest is not None and _is_first(context, tree)):
        here = [t.id.span for t in context.file.trees if t.id and t.id.value == tree.id.value and t is not tree]
        elsewhere = [Symbol(t.path, SymbolKind.TREE, t.id) for t in same if t.path != context.source.path]
        related = [Related(span, "another tree with this name") for span in here]
        related += [Related(symbol, "another tree with this name") for symbol in elsewhere]
        name = unused(tree.id.value, known)
        rename = Fix(f"Rename this tree to `{name}`", (TextEdit(tree.id.span, name),), preferred=False)
        message = f"there are {len(same)} trees `{tree.id.value}`; give each tree its own name"
        yield RULE.at(tree.id.span, message, rename, related=related)


def _is_first(context: TreeContext, tree: Tree) -> bool:
    """Whether a tree is the first with its name. The first tree keeps the name and is not reported."""
    assert context.forest is not None
    return tree.id is not None and context.forest.trees[tree.id.value][1] is tree


def _subtree(
    context: TreeContext, tree: Tree, name: Name, uses: Mapping[str, Iterable[str]], circular: Set[str]
) -> Iterator[Finding]:
    own = tree.id.value if tree.id else ""
    if name.value not in uses:
        around = _around(own, uses)
        yield from _no_tree(context, name, [other for other in uses if other not in around])
    elif name.value in circular and own in circular:
        if context.forest is not None and (own, name.value) not in _closing(context, uses):
            return
        cycle = _cycle(own, name.value, uses)
        if cycle:
            message = f"a tree cannot contain itself: {' → '.join(cycle)}"
            yield RULE.at(name.span, message, severity=Severity.WARNING if _is_never_created(context, own) else None)


def _is_never_created(context: TreeContext, name: str) -> bool:
    """Whether a tree is not part of the executed one, so that BehaviorTree.CPP reads it but does not create it."""
    forest, main = context.forest, context.file.main
    if context.system is not None or forest is None or forest.is_included or main is None:
        return False
    return main.value in forest.trees and name not in forest.reached(main.value)


def _closing(context: TreeContext, uses: Mapping[str, Iterable[str]]) -> Set[tuple[str, str]]:
    """The uses that close cycles, in a traversal of the trees that begins at the executed tree or, without it, the
    first one."""
    main = context.files[0].main if context.files else ""
    first = (main,) if main in uses else ()
    closing: set[tuple[str, str]] = set()
    entered: set[str] = set()
    left: set[str] = set()
    for start in (*first, *uses):
        stack = [(start, iter(uses[start]))] if start not in entered else []
        entered.add(start)
        while stack:
            name, inner = stack[-1]
            below = next(inner, None)
            if below is None:
                left.add(name)
                stack.pop()
            elif below in entered and below not in left:
                closing.add((name, below))
            elif below in uses and below not in entered:
                entered.add(below)
                stack.append((below, iter(uses[below])))
    return closing


def _no_tree(context: TreeContext, name: Name, known: Iterable[str]) -> Iterator[Finding]:
    """Report that there is no tree `name`; `known` are the names to suggest.

    Nothing is reported if the tree may be in a file that cannot be read or is unknown, or may be a misspelled
    `<BehaviorTree>` or a tree without a name.
    """
    if context.missing_includes or _has_misspelled_tree(context) or _has_nameless_tree(context):
        return
    trees = tuple(known)
    close = close_names(name.value, trees)
    message = f"there is no tree `{name.value}`"
    hint = alternatives(close, trees, "tree")
    forest = context.forest
    if forest is not None and not forest.complete:
        return
    if forest is None or close:
        yield RULE.at(name.span, f"{message}{hint}", *replacements(name.span, close))
    elif name.value not in (*forest.trees, *forest.beside, *forest.subtree_models):
        where = " in this file, the files that it includes, or its folder"
        yield RULE.at(name.span, f"{message}{where}{hint}", severity=Severity.WARNING)


def _circular(uses: Mapping[str, Iterable[str]]) -> Set[str]:
    """The names of all trees that contain themselves, and of some trees that lie on paths between them."""
    left = {name: {inner for inner in inners if inner in uses} for name, inners in uses.items()}
    for _ in range(2):
        users: dict[str, set[str]] = {name: set() for name in left}
        for name, inners in left.items():
            for inner in inners:
                users[inner].add(name)
        ended = [name for name, inners in left.items() if not inners]
        while ended:
            name = ended.pop()
            del left[name]
            for user in users.pop(name):
                left[user].discard(name)
                if not left[user]:
                    ended.append(user)
        left = {name: users[name] for name in left}  # repeat in the other direction
    return left.keys()


def _around(own: str, uses: Mapping[str, Iterable[str]]) -> Set[str]:
    """The trees that contain the tree `own`, including itself."""
    users: dict[str, list[str]] = {}
    for name, inners in uses.items():
        for inner in inners:
            users.setdefault(inner, []).append(name)
    containing = {own}
    pending = [own]
    while pending:
        for user in users.get(pending.pop(), ()):
            if user not in containing:
                containing.add(user)
                pending.append(user)
    return containing


def _cycle(start: str, first: str, uses: Mapping[str, Iterable[str]]) -> list[str]:
    """The names on a path from `start` through `first` back to `start`; empty if there is no path."""
    came_from = {first: start}
    stack = [first]
    while stack:
        name = stack.pop()
        if name == start:
            return [start, first] if first == start else _back(start, came_from[start], came_from)
        for inner in uses.get(name, ()):
            if inner not in came_from:
                came_from[inner] = name
                stack.append(inner)
    return []


def _back(start: str, last: str, came_from: Mapping[str, str]) -> list[str]:
    path = [start]
    while last != start:
        path.append(last)
        last = came_from[last]
    return [start, *path[::-1]]


def _subtrees(node: NodeOutline | None) -> Iterator[str]:
    if node is not None:
        if node.is_subtree:
            yield node.plugin
        for child in node.children:
            yield from _subtrees(child)


def _main(context: TreeContext) -> Iterator[Finding]:
    executed, main = main_tree(context.files), context.file.main
    if context.forest is not None and main is not None:
        yield from _main_of_forest(context, context.forest, main)
    elif not isinstance(executed, tuple):
        if main is not None and executed.id and executed.id != main.value:
            yield from _another(context, main, executed.id)
    elif main is not None and executed:
        yield from _no_tree(context, main, executed)
    elif context.system is not None and not context.missing_includes:
        if executed:
            yield from _ambiguous(context, executed)
        elif not _has_misspelled_tree(context):
            yield RULE.at(
                context.file.element.name_span,
                "there is no `<BehaviorTree>` that can be executed; add one with an `ID`",
            )


def _main_of_forest(context: TreeContext, forest: Forest, main: Name) -> Iterator[Finding]:
    """Report a tree to execute that does not exist. Unlike in a system, BehaviorTree.CPP never executes another tree
    instead."""
    if main.value in forest.trees or any(tree.id and tree.id.value in REFUSED_NAMES for tree in context.file.trees):
        return  # the tree may be one whose name is refused, which is reported
    trees = context.file.trees
    if len(trees) == 1 and trees[0].id is None and not context.missing_includes:
        name = trees[0].element.name_span
        fix = Fix("Add the `ID`", (TextEdit(Span(name.end, name.end), f' ID="{escape(main.value, chr(34))}"'),))
        yield RULE.at(name, f"this tree needs the `ID` `{main.value}`: `main_tree_to_execute` names it", fix)
        return
    yield from _no_tree(context, main, forest.trees)


def _ambiguous(context: TreeContext, candidates: tuple[str, ...]) -> Iterator[Finding]:
    """Report an ambiguous main tree, only if it is clear which trees no other tree uses.

    If a name is missing, repeated or unknown, or if every tree is part of a cycle, that error is reported instead.
    """
    trees = [tree for file in context.files for tree in file.trees]
    names = {tree.id for tree in trees}
    used = {name for tree in trees for name in _subtrees(tree.root)}
    if "" in names or len(names) < len(trees) or not used <= names or names == used:
        return
    root = context.file.element.name_span
    fixes = (
        Fix(
            f"Execute `{name}`",
            (TextEdit(Span(root.end, root.end), f' main_tree_to_execute="{name}"'),),
            preferred=name == MAIN,
        )
        for name in candidates
        if context.file.element.get("main_tree_to_execute") is None
    )
    message = f"the executed tree is ambiguous; set `main_tree_to_execute` to one of {listing(candidates)}"
    yield RULE.at(root, message, *itertools.islice(fixes, MAX_EXECUTABLE_FIXES))


def _has_misspelled_tree(context: TreeContext) -> bool:
    return misspelled.among(context.file.element.elements, "BehaviorTree", BEHAVIOR_TREE)


def _has_nameless_tree(context: TreeContext) -> bool:
    """Whether a file without a system has several trees and one of them has no name; that error is reported."""
    names = [tree.id for file in context.files for tree in file.trees]
    return context.forest is not None and len(names) > 1 and "" in names


def _another(context: TreeContext, main: Name, executed: str) -> Iterator[Finding]:
    """Report a `main_tree_to_execute` that does not name the only tree. The tree is executed whatever its name is
    (docs/spec/trees.md#main-tree). Nothing is reported if the named tree may be in an unknown file, as in
    `_no_tree`."""
    known = context.system is not None or are_similar(main.value, executed)
    if known and not context.missing_includes:
        message = f"there is no tree `{main.value}`; the only tree, `{executed}`, is executed instead"
        yield RULE.at(main.span, message, *replacements(main.span, [executed]), severity=Severity.WARNING)


RULE = Rule("tree-structure", Severity.ERROR, "Trees are missing, ambiguous or contain themselves.", tree=check)
