# SPDX-License-Identifier: Apache-2.0
"""The rule `input-count`, which input_count.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import remove
from roaml.facts import Facts
from roaml.model.kinds import FileKind
from roaml.model.system_file import ListedFile, SystemSection
from roaml.rules.rule import Rule, SystemContext


class InputCount(Facts, frozen=True):
    """The facts of a finding: the system lists no file of the kind `kind`."""

    kind: FileKind


def check(context: SystemContext) -> Iterator[Finding]:
    trees = [f for f in context.files if f.required_kind is FileKind.TREE]
    for extra in trees[1:]:
        related = (Related(trees[0].input.element.name_span, "the first file of trees"),)
        message = "a system allows only one file of trees, which may include others"
        yield RULE.at(extra.input.element.name_span, message, _remove(context, extra), related=related)
    yield from _property_files(context)
    section = context.file.element.find(SystemSection.BEHAVIOR_TREE.value)
    kinds = [f.required_kind for f in context.files if f.input.section is SystemSection.BEHAVIOR_TREE]
    # An input with an unknown or misspelled type may be the tree; other rules report it.
    unread = SystemSection.BEHAVIOR_TREE in context.file.unread
    if section is not None and not unread and kinds and all(kind is FileKind.MACHINE for kind in kinds):
        message = "there are plugins but no tree: an `<input>` of type `bt.cpp-xml` is missing"
        yield RULE.at(section.name_span, message, facts=InputCount(FileKind.TREE))


def _property_files(context: SystemContext) -> Iterator[Finding]:
    """Report property files that are listed again: each of their properties would exist twice."""
    first: dict[str, ListedFile] = {}
    for listed in context.files:
        if listed.required_kind not in _PROPERTY_FILES or not listed.path:
            continue
        original = first.setdefault(listed.path, listed)
        if original is not listed and listed.input.src is not None:
            related = (Related(original.span, "the first `<input>` of this file"),)
            fix = remove(context.document, listed.input.element, "Remove this `<input>`", safe=True)
            message = (
                f"`{listed.input.src.value}` is listed twice, so each of its properties would exist twice; remove this "
                "`<input>`"
            )
            yield RULE.at(listed.span, message, fix, related=related)


_PROPERTY_FILES = (FileKind.PROPERTIES, FileKind.XML_PROPERTIES)


def _remove(context: SystemContext, listed: ListedFile) -> Fix:
    return remove(context.document, listed.input.element, "Remove this `<input>`")


RULE = Rule(
    "input-count",
    Severity.ERROR,
    "A system lists too many or too few files of a kind.",
    system=check,
    facts=InputCount,
)
