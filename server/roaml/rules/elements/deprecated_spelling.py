# SPDX-License-Identifier: Apache-2.0
"""The rule `deprecated-spelling`, which deprecated_spelling.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity, Tag
from roaml.edit.elements import removal, rename_tag
from roaml.language import BEHAVIOR_TREE, AttributeType
from roaml.language.grammar import ElementType
from roaml.record import replace
from roaml.rules.rule import FileContext, MachineContext, Rule, SystemContext, TreeContext
from roaml.rules.support.elements import known_elements
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Attribute, Element

ROOT = "ascxml"
EXTENSION = ".ascxml"


def check(context: FileContext) -> Iterator[Finding]:
    if context.grammar is not BEHAVIOR_TREE:
        yield from _spellings(context)


def check_tree(context: TreeContext) -> Iterator[Finding]:
    """Report older spellings in trees of a system that declare a format other than 3. In trees without a system,
    `unknown-node` and similar rules report the names of version 3."""
    if context.forest is None and _is_newer_tree(context.document.root):
        yield from _spellings(FileContext(context.source, (), context.document, BEHAVIOR_TREE, older=context.older))


def _spellings(context: FileContext) -> Iterator[Finding]:
    grammar, document = context.grammar, context.document
    if grammar is None or document is None:
        return
    for element, type_, parent in known_elements(document, grammar):
        if type_.use:
            yield _element(context, element, type_, parent)
        for attribute in element.attributes:
            known = type_.attributes.get(attribute.name)
            if known is not None:
                yield from _attribute(context, element, attribute, known)


def check_machine(context: MachineContext) -> Iterator[Finding]:
    """Report the older root of machines. The system determines the dialect (docs/spec/files.md#dialects); the current
    dialect has only one root."""
    machine = context.machine
    if context.system is not None and not context.older and machine.root != ROOT:
        message = f"machines of a `<roaml>` system need the root `<{ROOT}>`, not `<{machine.root}>`"
        rename = replace(rename_tag(machine.element, ROOT), safe=True)
        yield RULE.at(machine.element.name_span, message, rename, severity=Severity.ERROR, tags=(Tag.DEPRECATED,))


def check_system(context: SystemContext) -> Iterator[Finding]:
    """Report machines of the current dialect in files whose name does not end in `.ascxml`: the reference translator
    also uses the name of a file to decide whether it is a machine (docs/spec/files.md#kinds)."""
    roots = {path: outline.root for path, outline in (*context.system.nodes, *context.system.plugins)}
    for listed in context.files:
        src = listed.input.src
        # `check_machine` reports a machine that also has the older root.
        if src is not None and not context.file.older and roots.get(listed.path) == ROOT:
            name = re.split(r"[/\\]", src.value)[-1]
            if not name.endswith(EXTENSION):
                new = (name.rpartition(".")[0] or name) + EXTENSION
                message = f"machines of a `<roaml>` system need the extension `{EXTENSION}`; rename the file to `{new}`"
                yield RULE.at(src.span, message, severity=Severity.ERROR, tags=(Tag.DEPRECATED,))


def _is_newer_tree(root: Element | None) -> bool:
    """Whether a tree declares a format in which the older spellings are not valid."""
    version = root.get("BTCPP_format") if root else None
    return version is not None and version.value.strip() not in ("", "3")


def _element(context: FileContext, element: Element, type_: ElementType, parent: Element | None) -> Finding:
    if parent is not None and parent.find(type_.use) is not None and context.grammar is not BEHAVIOR_TREE:
        message = f"`<{element.name}>` is ignored: it is the older name of `<{type_.use}>`, which is also given"
        return _unread(context, element.name_span, message, element.span)
    message = f"`<{element.name}>` is now called `<{type_.use}>`"
    # The root decides how the other files of the system are read, so it must be changed last.
    inside = parent is not None
    rename = replace(rename_tag(element, type_.use, preferred=inside), safe=inside)
    return RULE.at(element.name_span, message, rename, tags=(Tag.DEPRECATED,))


def _attribute(context: FileContext, element: Element, attribute: Attribute, known: AttributeType) -> Iterator[Finding]:
    if known.use and element.get(known.use) is not None:
        message = f"`{attribute.name}` is ignored: it is the older name of `{known.use}`, which is also given"
        yield _unread(context, attribute.name_span, message, attribute.span)
    elif known.use:
        fix = Fix(f"Change to `{known.use}`", (TextEdit(attribute.name_span, known.use),), safe=True)
        message = f"`{attribute.name}` of `<{element.name}>` is now called `{known.use}`"
        # In the current dialect, the reference translator does not know the older attribute.
        severity = None if context.older or context.grammar is BEHAVIOR_TREE else Severity.ERROR
        yield RULE.at(attribute.name_span, message, fix, severity=severity, tags=(Tag.DEPRECATED,))
    for choice in known.simple.choices:
        if choice.use and choice.value == attribute.value:
            fix = Fix(f"Change to `{choice.use}`", (TextEdit(attribute.value_span, choice.use),), safe=True)
            message = f"`{choice.value}` is now called `{choice.use}`"
            yield RULE.at(attribute.value_span, message, fix, tags=(Tag.DEPRECATED,))


def _unread(context: FileContext, span: Span, message: str, superfluous: Span) -> Finding:
    remove = Fix("Remove the older spelling", (removal(context.source.text, superfluous),), safe=True)
    severity = None if context.older else Severity.WARNING
    return RULE.at(span, message, remove, severity=severity, tags=(Tag.DEPRECATED,))


RULE = Rule(
    "deprecated-spelling",
    Severity.HINT,
    "An older spelling is used.",
    file=check,
    tree=check_tree,
    machine=check_machine,
    system=check_system,
)
