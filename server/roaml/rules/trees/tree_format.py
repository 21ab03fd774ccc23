# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-format`, which tree_format.md describes."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal, rename_tag
from roaml.forest.forest import CPP, Forest
from roaml.language import BEHAVIOR_TREE
from roaml.language.validate import misspelled_attribute
from roaml.model.tree import TreeNode, nodes
from roaml.regex import regex
from roaml.rules.rule import Rule, TreeContext
from roaml.text import Edit, Span, TextEdit, computed
from roaml.xml_syntax import Attribute, Element
from roaml.xml_syntax.escapes import escape

CURRENT = "4"
_YES = ("1", "true", "True", "TRUE")
_SHARING = ("__shared_blackboard", "__autoremap")
_NAME = regex(r"[A-Za-z_]\w*\Z", re.ASCII)
_ENTRY = regex(r"\{(@?[A-Za-z_]\w*)\}\Z", re.ASCII)
_LITERAL = regex(r"-?\d+(\.\d+)?\Z|true\Z|false\Z", re.ASCII)
_CHECKS = frozenset(name for name, type_ in CPP.nodes.items() if type_.until and name.startswith("BlackboardCheck"))
_PARALLEL = {"success_threshold": "success_count", "failure_threshold": "failure_count", "threshold": "success_count"}


def check(context: TreeContext) -> Iterator[Finding]:
    if context.forest is None:
        return
    root, version = context.file.element, context.file.element.get("BTCPP_format")
    if context.forest.is_version_3:
        span = version.value_span if version else root.name_span
        message = _reason(context.forest)
        fix = Fix("Convert to version 4", functools.partial(_plan, context), preferred=True)
        yield RULE.at(span, message, fix)
    elif version is None and context.file.trees and not _is_misspelled(root):
        fix = Fix(f'Add `BTCPP_format="{CURRENT}"`', tuple(_version(context)), preferred=True)
        message = f"`BTCPP_format` is missing; version {CURRENT} of BehaviorTree.CPP warns about this"
        yield RULE.at(root.name_span, message, fix, severity=Severity.INFORMATION)
    elif version is not None and context.file.format != CURRENT:
        fix = Fix(f"Change to `{CURRENT}`", (TextEdit(version.value_span, CURRENT),), preferred=True)
        yield RULE.at(version.value_span, f"the format must be `3` or `4`, not `{version.value}`", fix)


def _reason(forest: Forest) -> str:
    """Why a file is written for version 3. A program reads all files of a tree with the same version."""
    own, others = forest.signs[forest.path], {p: signs for p, signs in forest.signs.items() if p != forest.path}
    unreadable = "no version reads both"
    if not own.format and own.old and own.new:
        both = f"the file uses `{own.old}` of version 3 of BehaviorTree.CPP and `{own.new}` of version 4"
        return f"{both}; {unreadable}"
    newer = next((path for path, signs in others.items() if signs.is_version_3 is False), None)
    if newer is not None:
        name = _file_name(newer)
        return f"this file is written for version 3 of BehaviorTree.CPP, but `{name}` for version 4; {unreadable}"
    if own.is_version_3 is None:
        older = next(path for path, signs in others.items() if signs.is_version_3)
        name = _file_name(older)
        return (
            f"`{name}`, which belongs to the same tree, is written for version 3 of BehaviorTree.CPP; version 4 reads "
            "both differently"
        )
    return "this file is written for version 3 of BehaviorTree.CPP; version 4 reads it differently"


def _file_name(path: str) -> str:
    return path.replace("\\", "/").rpartition("/")[2]


def _is_misspelled(root: Element) -> bool:
    return misspelled_attribute(root, "BTCPP_format", BEHAVIOR_TREE.elements[root.name].attributes)


def _plan(context: TreeContext) -> tuple[TextEdit, ...]:
    return tuple(sorted(computed(_edits(context))))


def _edits(context: TreeContext) -> Iterator[Edit]:
    """The edits that convert the file to version 4."""
    yield from _version(context)
    for tree in context.file.trees:
        for node in nodes(tree):
            yield from _node(context, node)


def _version(context: TreeContext) -> Iterator[TextEdit]:
    root = context.file.element
    version = root.get("BTCPP_format")
    if version is None:
        yield TextEdit(Span(root.name_span.end, root.name_span.end), f' BTCPP_format="{CURRENT}"')
    else:
        yield TextEdit(version.value_span, CURRENT)


def _node(context: TreeContext, node: TreeNode) -> Iterator[Edit]:
    name = node.plugin.value if node.plugin else ""
    renamed = CPP.renamed.get(name)
    if node.is_subtree:
        if node.element.name == "SubTreePlus":
            yield from rename_tag(node.element, "SubTree").edits
        yield from _subtree(context, node)
    elif renamed is not None and node.plugin is not None:
        yield from (
            rename_tag(node.element, renamed.now).edits if node.compact else (TextEdit(node.plugin.span, renamed.now),)
        )
    elif name == "Parallel":
        for attribute in node.element.attributes:
            if attribute.name in _PARALLEL:
                yield TextEdit(attribute.name_span, _PARALLEL[attribute.name])
    elif name in _CHECKS:
        yield from _precondition(context, node, is_text=name == "BlackboardCheckString")


def _precondition(context: TreeContext, node: TreeNode, *, is_text: bool) -> Iterator[Edit]:
    """The edits that replace a `BlackboardCheck…` by a `Precondition`; none if a script cannot contain a value."""
    element = node.element
    first, second, status = (element.get(port) for port in ("value_A", "value_B", "return_on_mismatch"))
    if first is None or second is None or node.plugin is None:
        return
    left, right = (_operand(attribute.value.strip(), is_text=is_text) for attribute in (first, second))
    if left is None or right is None:
        return
    yield from (
        rename_tag(element, "Precondition").edits if node.compact else (TextEdit(node.plugin.span, "Precondition"),)
    )
    yield TextEdit(first.span, f'if="{escape(f"{left} == {right}")}"')
    yield removal(context.source.text, second.span)
    if status is not None:
        yield TextEdit(status.name_span, "else")


def _operand(value: str, *, is_text: bool) -> str | None:
    """A value of a port as an operand of a script; `None` if a script cannot express it."""
    if match := _ENTRY.match(value):
        return match[1]
    if is_text:
        return None if "'" in value else f"'{value}'"
    return value if _LITERAL.match(value) else None


def _subtree(context: TreeContext, node: TreeNode) -> Iterator[Edit]:
    """The edits that convert a subtree. In version 3, values of a `SubTree` are names of entries without braces; values
    of a `SubTreePlus` are written as in version 4."""
    has_current = node.element.get("_autoremap") is not None
    for attribute in node.element.attributes:
        if attribute.name in _SHARING:
            if has_current or attribute.value.strip() not in _YES:
                yield removal(context.source.text, attribute.span)
            else:
                has_current = True
                yield TextEdit(attribute.name_span, "_autoremap")
        elif node.element.name == "SubTree" and _is_entry(attribute):
            yield TextEdit(attribute.value_span, f"{{{attribute.value.strip()}}}")


def _is_entry(attribute: Attribute) -> bool:
    if attribute.name in ("ID", "name") or attribute.name.startswith("_") or ":" in attribute.name:
        return False
    return bool(_NAME.match(attribute.value.strip()))


RULE = Rule("tree-format", Severity.WARNING, "A tree file is not in the format of version 4.", tree=check)
