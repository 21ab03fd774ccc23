# SPDX-License-Identifier: Apache-2.0
"""The rule `inconsistent-branch`, which inconsistent_branch.md describes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import rename_tag, without_tags
from roaml.model.tree import TreeNode, nodes
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.words import difference
from roaml.text import Span, TextEdit

_MIN_ALIKE = 3
"""How many branches must be alike before another one is suspicious."""
_MAX_NODES = 20
"""How many nodes a branch has at most that is compared with others."""


def check(context: TreeContext) -> Iterator[Finding]:
    for tree in context.file.trees:
        for node in nodes(tree):
            if len(node.children) > 1:
                yield from _odd_branch(context, node.children)


def _odd_branch(context: TreeContext, branches: Sequence[TreeNode]) -> Iterator[Finding]:
    """Report the only branch that differs from the others with these leaves in one node with children."""
    by_leaves: dict[tuple[str, ...], list[TreeNode]] = defaultdict(list)
    for branch in branches:
        inside = _inside(branch)
        leaves = tuple(node.type_name for node in inside if not node.children) if len(inside) <= _MAX_NODES else ()
        if len(leaves) > 1:  # single conditions are often inverted or not, as each requires
            by_leaves[leaves].append(branch)
    for alike in by_leaves.values():
        by_shape: dict[tuple[str, ...], list[TreeNode]] = defaultdict(list)
        for branch in alike:
            by_shape[_shape(branch)].append(branch)
        if len(alike) == 2 and len(by_shape) == 2 and _are_numbered(alike):
            yield from _inverted_once(context, alike)
        most = max(by_shape.values(), key=len)
        if len(most) >= _MIN_ALIKE and len(alike) == len(most) + 1:
            (odd,) = (branch for branch in alike if branch not in most)
            is_end = odd in (alike[0], alike[-1])
            if _are_alike([*most, odd]) and not (is_end and _delays(odd) != _delays(most[0])):
                yield from _compare(context, odd, most[0])


def _are_numbered(branches: Sequence[TreeNode]) -> bool:
    """Whether the names of all leaves of two branches differ only in a number: `IsDone1`, `Visit1` and `IsDone2`,
    `Visit2`."""
    first, second = ([node.name.value for node in _inside(b) if not node.children and node.name] for b in branches)
    leaves = sum(not node.children for node in _inside(branches[0]))
    different = [difference(a, b) for a, b in zip(first, second, strict=False)]
    return leaves == len(first) == len(second) and all(
        words is not None and all(word.isdigit() for word in words) for words in different
    )


def _inverted_once(context: TreeContext, branches: Sequence[TreeNode]) -> Iterator[Finding]:
    """Report the `Inverter` that one of two numbered branches lacks."""
    first, second = branches
    for odd, usual in ((first, second), (second, first)):
        names = [node.type_name for node in _inside(usual)]
        if sorted(names) == sorted([*(node.type_name for node in _inside(odd)), "Inverter"]):
            yield from _compare(context, odd, usual)


def _delays(branch: TreeNode) -> int:
    """How often a branch pauses. The first and the last one of a series often need no pause before or after them."""
    return sum(node.type_name == "Delay" for node in _inside(branch))


def _are_alike(branches: Sequence[TreeNode]) -> bool:
    """Whether the names of the leaves of branches differ from those of the first branch in at most one word."""
    names = [[node.name.value if node.name else "" for node in _inside(b) if not node.children] for b in branches]
    first, *others = names
    return all(
        name == of_first or difference(name, of_first) is not None
        for other in others
        for name, of_first in zip(other, first, strict=True)
    )


def _compare(context: TreeContext, odd: TreeNode, usual: TreeNode) -> Iterator[Finding]:
    """Report the only node in which a branch differs from the usual ones."""
    while odd.type_name == usual.type_name and len(odd.children) == len(usual.children):
        pairs = zip(odd.children, usual.children, strict=True)
        different = [(a, b) for a, b in pairs if _shape(a) != _shape(b)]
        if len(different) != 1:
            return
        ((odd, usual),) = different
    name, other = odd.type_name, usual.type_name
    if len(usual.children) == 1 and _shape(usual.children[0]) == _shape(odd):
        message = f"`{name}` has no `{other}` here, unlike the similar branches; add it"
        fixes = () if usual.element.attributes or not usual.compact else (_within(context, odd, other),)
    elif len(odd.children) == 1 and _shape(odd.children[0]) == _shape(usual):
        message = f"only this branch has a `{name}` here; all similar branches have none"
        fixes = (without_tags(context.document, odd.element, f"Remove `{name}`"),)
    elif odd.children and [*map(_shape, odd.children)] == [*map(_shape, usual.children)]:
        message = f"all similar branches have a `{other}` here, not a `{name}`; did you mean `{other}`?"
        fixes = (rename_tag(odd.element, other),) if odd.compact and usual.compact else ()
    else:
        return
    related = [Related(usual.element.name_span, "one of the similar branches")]
    yield RULE.at(odd.element.name_span, message, *fixes, related=related)


def _within(context: TreeContext, node: TreeNode, name: str) -> Fix:
    span = node.element.span
    text = context.source.text[span.start : span.end]
    return Fix(f"Add `{name}`", (TextEdit(Span(span.start, span.end), f"<{name}>{text}</{name}>"),))


def _inside(node: TreeNode) -> list[TreeNode]:
    """A node and those below it, parents before children, but hardly more than are compared."""
    found: list[TreeNode] = []
    stack = [node]
    while stack and len(found) <= _MAX_NODES:
        found.append(stack.pop())
        stack.extend(reversed(found[-1].children))
    return found


def _shape(node: TreeNode) -> tuple[str, ...]:
    """The types of a node and those below it, with their nesting."""
    inside = tuple(part for child in node.children for part in _shape(child))
    return (node.type_name, "(", *inside, ")")


RULE = Rule(
    "inconsistent-branch",
    Severity.WARNING,
    "One of several similar branches of a tree lacks a decorator, or has another control node.",
    tree=check,
)
