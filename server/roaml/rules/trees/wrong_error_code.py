# SPDX-License-Identifier: Apache-2.0
"""The rule `wrong-error-code`, which wrong_error_code.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.entries import BoundUse
from roaml.forest.forest import Forest
from roaml.libraries import Node, node_in_libraries
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext, listing, replacements
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import forest_of


def check(context: TreeContext) -> Iterator[Finding]:
    """Report conditions about the error of one kind of node whose port reads the error of another kind."""
    forest = forest_of(context)
    if forest is None:
        return
    by_entry = entries_of(forest).by_entry
    reported: set[TreeNode] = set()
    for uses in by_entry.values():
        for bound in uses:
            use = bound.use
            expected = _expected(forest, use.node, use.port)
            if use.path != context.source.path or use.node in reported or not expected:
                continue
            writers = [other for other in uses if other.use.writes is not False]
            known = [_library_node(forest, other.use.node) for other in writers]
            if not writers or any(node is None or node.name in expected for node in known):
                continue
            reported.add(use.node)
            writer = writers[0].use
            names = listing([f"`{name}`" for name in expected])
            message = (
                f"`{use.node.type_name}` knows the error codes of {names}, but `{writer.node.type_name}` writes this "
                "entry"
            )
            intended = _intended(forest, by_entry.values(), expected, use.tree)
            related = [Related(writer.span, "written here")] if writer.path == use.path else []
            fixes = replacements(use.span, (f"{{{name}}}" for name in intended))
            hint = f"; did you mean `{intended[0]}`?" if intended else ""
            yield RULE.at(use.span, message + hint, *fixes, related=related)


def _intended(
    forest: Forest, entries: Iterable[tuple[BoundUse, ...]], expected: Sequence[str], tree: str
) -> tuple[str, ...]:
    """The names of the entries of a tree to which the expected nodes write their error codes."""
    names: dict[str, None] = {}
    for uses in entries:
        for bound in uses:
            use = bound.use
            node = _library_node(forest, use.node)
            if use.tree == tree and use.port == "error_code_id" and node is not None and node.name in expected:
                names[use.name] = None
    return tuple(names)


def _expected(forest: Forest, node: TreeNode, port: str) -> tuple[str, ...]:
    known = _library_node(forest, node)
    declared = known.port(port) if known is not None else None
    return declared.written_by if declared is not None else ()


def _library_node(forest: Forest, node: TreeNode) -> Node | None:
    """The declaration of a node of a library; `None` for other nodes."""
    known = forest.known_node(node)
    return node_in_libraries(known.name) if known is not None and known.behaviour else None


RULE = Rule(
    "wrong-error-code",
    Severity.WARNING,
    "A condition about an error reads the error code of another kind of node.",
    tree=check,
)
