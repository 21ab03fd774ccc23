# SPDX-License-Identifier: Apache-2.0
"""The rule `wrong-file-kind`, which wrong_file_kind.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import remove
from roaml.model.kinds import FileKind
from roaml.model.syntax import Name
from roaml.model.system_file import ListedFile, SystemSection
from roaml.rules.rule import Rule, SystemContext
from roaml.text import TextEdit

TYPES = {
    (SystemSection.BEHAVIOR_TREE, FileKind.TREE): "bt.cpp-xml",
    (SystemSection.BEHAVIOR_TREE, FileKind.MACHINE): "bt-plugin-ascxml",
    (SystemSection.PROPERTIES, FileKind.PROPERTIES): "jani",
    (SystemSection.PROPERTIES, FileKind.XML_PROPERTIES): "xml",
    (SystemSection.DATA_DECLARATIONS, FileKind.STRUCTS): "xml",
    (SystemSection.DATA_DECLARATIONS, FileKind.JSON_STRUCTS): "json",
}
"""The value of `type` for each section and kind of file."""


def check(context: SystemContext) -> Iterator[Finding]:
    for listed in context.files:
        src = listed.input.src
        if src is None or listed.problem is not None or listed.required_kind is None:
            continue
        if listed.usable:
            yield from _other_machine(context, listed, src)
            continue
        actual = "" if listed.kind is FileKind.UNKNOWN else f", but {_with_article(listed.kind)}"
        message = f"`{src.value}` is not {_with_article(listed.required_kind)}{actual}"
        yield RULE.at(src.span, message, *_other_type(listed, context.files))


def _other_machine(context: SystemContext, listed: ListedFile, src: Name) -> Iterator[Finding]:
    """Report a machine that is listed as a plugin but is a node, or is listed as a node but is a plugin."""
    system, section = context.system, listed.input.section
    ticked = section is SystemSection.NODE_MODELS and listed.path in system.ticked_nodes
    same = (f for f in context.files if f.path == listed.path and f.input.section is SystemSection.BEHAVIOR_TREE)
    plugins = list(same) if ticked else []
    reason = ""
    if plugins:  # otherwise tree-element-in-node reports it
        reason = "also listed as a plugin of the behavior tree, so it cannot be a node; name the file of the node"
    elif section is SystemSection.BEHAVIOR_TREE and listed.path in system.idle_plugins:
        reason = "not a plugin of the behavior tree: it has no `<bt_tick>`; name the file of the plugin"
    if reason:
        drop = remove(context.document, listed.input.element)
        related = [Related(p.input.src.span, "listed as a plugin") for p in plugins if p is not listed and p.input.src]
        yield RULE.at(src.span, f"`{src.value}` is {reason}", drop, related=related)


def _with_article(kind: FileKind) -> str:
    if kind in (FileKind.STRUCTS, FileKind.JSON_STRUCTS):
        return f"a file of {kind.value}"
    return f"{'an' if kind.value[0] in 'aeiou' else 'a'} {kind.value}"


def _other_type(listed: ListedFile, files: Iterable[ListedFile]) -> Iterator[Fix]:
    type_ = TYPES.get((listed.input.section, listed.kind))
    if type_ is not None and listed.input.type is not None:
        second_tree = listed.kind is FileKind.TREE and any(f.usable and f.kind is FileKind.TREE for f in files)
        edits = (TextEdit(listed.input.type.span, type_),)
        yield Fix(f"Change the type to `{type_}`", edits, preferred=not second_tree)


RULE = Rule("wrong-file-kind", Severity.ERROR, "A system lists a file with the wrong kind.", system=check)
