# SPDX-License-Identifier: Apache-2.0
"""The rule `misplaced-element`, which misplaced_element.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import rename_tag
from roaml.language import HL_SCXML, PLAIN_SCXML, Grammar
from roaml.language.validate import MisplacedElement
from roaml.model.vocabulary import BRANCH_MARKERS
from roaml.rules.rule import FileContext, Rule, listing
from roaml.rules.support.children import has_counted_children

SAME_PARTS = {"param": "field", "field": "param"}
"""Elements with the same meaning in different parents: the wrong element, and the one that the parent allows."""


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if isinstance(violation, MisplacedElement):
            name, parent = violation.element.name, violation.parent.name
            assert context.grammar is not None
            if parent in BRANCH_MARKERS and context.grammar in (HL_SCXML, PLAIN_SCXML):
                continue  # branch-order reports this with more detail
            if has_counted_children(violation.parent):
                continue
            message = f"`<{name}>` is not allowed in `<{parent}>`{_where(context, name, parent)}"
            yield RULE.at(violation.element.name_span, message, *_fixes(violation))


def _where(context: FileContext, name: str, parent: str) -> str:
    grammar = context.grammar
    assert grammar is not None
    if name == "state" and parent == "state":
        return "; states are flat: they cannot contain other states"
    parents = [p for p in grammar.parents(name) if _is_current(context, p)]
    if grammar is HL_SCXML and len(parents) > 4:
        return _group(grammar, name)
    return f"; it is allowed in {listing(f'<{p}>' for p in parents)}" if 0 < len(parents) <= 4 else ""


def _is_current(context: FileContext, name: str) -> bool:
    """Whether a name is neither the older name of an element nor the root of another kind of file."""
    assert context.grammar is not None
    root = context.document.root if context.document else None
    if root is not None and name in context.grammar.roots:
        return name == root.name
    element = context.grammar.elements.get(name)  # `None` for an element that is declared inside others
    return element is None or not element.use


def _group(grammar: Grammar, name: str) -> str:
    """A phrase for the parents of an element that is allowed in many places; an empty string for other elements."""
    if name in grammar.groups["Executable"]:
        return "; it is allowed in a transition, a `<target>`, `<onentry>`, `<onexit>` or `<if>`"
    return {
        "target": "; it is allowed in a transition",
        "field": "; it is allowed in the elements that send data to other nodes",
        "bt_get_input": "; it is allowed in a value element such as `<expr>`",
    }.get(name, "")


def _fixes(violation: MisplacedElement) -> Iterator[Fix]:
    other = SAME_PARTS.get(violation.element.name)
    if other is not None and other in violation.parent.children:
        yield rename_tag(violation.element, other)


RULE = Rule("misplaced-element", Severity.ERROR, "An element is in a place where it is not allowed.", file=check)
