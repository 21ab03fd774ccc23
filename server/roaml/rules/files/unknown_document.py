# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-document`, which unknown_document.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import rename_tag
from roaml.language import BEHAVIOR_TREE, HL_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES
from roaml.rules.rule import FileContext, Rule, close_names, did_you_mean

ROOTS = tuple(root for grammar in (SYSTEM, HL_SCXML, BEHAVIOR_TREE, STRUCTS, XML_PROPERTIES) for root in grammar.roots)


def check(context: FileContext) -> Iterator[Finding]:
    """Report a file that a user or a system names and that is not a supported file."""
    if context.grammar is not None or context.document is None:
        return
    root = context.document.root
    if root is None or root.name == "specification":
        return
    if root.name in ROOTS:
        yield RULE.at(root.name_span, f"`<{root.name}>` contains no behavior tree")
        return
    close = close_names(root.name, ROOTS)
    fixes = [rename_tag(root, name, preferred=number == 0) for number, name in enumerate(close)]
    hint = (
        did_you_mean(tuple(f"<{name}>" for name in close))
        or "; the root is `<roaml>`, `<ascxml>`, `<root>`, `<types>` or `<properties>`"
    )
    yield RULE.at(root.name_span, f"unknown root element `<{root.name}>`{hint}", *fixes)


RULE = Rule("unknown-document", Severity.ERROR, "The file is not a supported file.", file=check)
