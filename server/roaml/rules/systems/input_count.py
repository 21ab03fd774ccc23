# SPDX-License-Identifier: Apache-2.0
"""The rule `input-count`, which input_count.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import remove
from roaml.facts import Facts
from roaml.model.kinds import FileKind
from roaml.model.outline import MachineOutline
from roaml.model.system import System
from roaml.model.system_file import TREE_ATTRIBUTE, ListedFile, SystemSection
from roaml.roles import Direction
from roaml.rules.rule import Rule, SystemContext
from roaml.suggest import close_names, did_you_mean, listing
from roaml.xml_syntax import Attribute


class InputCount(Facts, frozen=True):
    """The facts of a finding: the system lists no file of the kind `kind`."""

    kind: FileKind


def check(context: SystemContext) -> Iterator[Finding]:
    yield from _trees(context)
    yield from _property_files(context)
    section = context.file.element.find(SystemSection.BEHAVIOR_TREE.value)
    kinds = [f.required_kind for f in context.files if f.input.section is SystemSection.BEHAVIOR_TREE]
    # An input with an unknown or misspelled type may be the tree; other rules report it.
    unread = SystemSection.BEHAVIOR_TREE in context.file.unread
    if section is not None and not unread and kinds and all(kind is FileKind.MACHINE for kind in kinds):
        message = "there are plugins but no tree: an `<input>` of type `bt.cpp-xml` is missing"
        yield RULE.at(section.name_span, message, facts=InputCount(FileKind.TREE))


def _trees(context: SystemContext) -> Iterator[Finding]:
    """Report trees without a name in a system with several trees, names that two of them have, and plugins of trees
    that do not exist."""
    trees = [f for f in context.files if f.required_kind is FileKind.TREE]
    named: dict[str, ListedFile] = {}
    unnamed = [tree for tree in trees if not tree.input.tree]
    if len(unnamed) > 1:
        del unnamed[0]  # with a name for each other one, it is reported
    for tree in trees:
        name = tree.input.tree
        place = tree.input.element.get("name")
        if len(trees) > 1 and any(tree is other for other in unnamed):
            message = (
                "a system with several trees needs a `name` for each of them; add the attribute, or remove this "
                "`<input>`, if another file includes the trees"
            )
            yield RULE.at(tree.input.element.name_span, message, _remove(context, tree))
        elif place is not None and ("__" in name or name != name.strip("_")):
            message = (
                f"`{name}` cannot be the name of a tree, because names of blackboard variables begin with it; use "
                "single underscores between letters and digits"
            )
            yield RULE.at(place.value_span, message)
        elif place is not None and name in named:
            related = (Related(named[name].input.element.name_span, f"the first tree `{name}`"),)
            message = f"there are two trees `{name}`; give one of them another `name`"
            yield RULE.at(place.value_span, message, related=related)
        else:
            named[name] = tree
    yield from _equal_trees(context)
    yield from _different_plugins(context)
    for listed in context.files:
        owner = listed.input.element.get(TREE_ATTRIBUTE)
        if not listed.input.tree:
            continue
        if listed.required_kind is FileKind.MACHINE and owner is not None and listed.input.tree not in named:
            close = close_names(listed.input.tree, named)
            known = [name for name in named if name]
            hint = did_you_mean(close) if close or not known else f"; the trees are {listing(known)}"
            yield RULE.at(owner.value_span, f"there is no tree `{listed.input.tree}`{hint}")
        elif owner is not None:
            yield from _foreign_plugin(context.system, listed, owner)


def _foreign_plugin(system: System, listed: ListedFile, owner: Attribute) -> Iterator[Finding]:
    """Report a plugin of a tree that another tree uses, too."""
    names = {outline.name for path, outline in system.plugins if path == listed.path}
    for node in system.instances:
        if node.plugin in names and system.plugin(node.plugin, node.tree)[1] is None:
            message = (
                f"the tree `{node.tree}` uses `{node.plugin}`, too, which belongs to the tree `{listed.input.tree}`; "
                "remove the attribute, or list the plugin for both trees"
            )
            yield RULE.at(owner.value_span, message)
            return


def _different_plugins(context: SystemContext) -> Iterator[Finding]:
    """Report plugins with the same name and different ports, if trees that share a file use them."""
    system = context.system
    places = {f.path: a for f in context.files if (a := f.input.element.get(TREE_ATTRIBUTE)) is not None}
    first: dict[tuple[str, str], tuple[str, MachineOutline]] = {}
    for node in system.instances:
        path, outline = system.plugin(node.plugin, node.tree)
        if outline is None or path not in places:
            continue
        tree, other = first.setdefault((node.source.path, node.plugin), (node.tree, outline))
        if _ports(other) != _ports(outline):
            message = (
                f"the trees `{tree}` and `{node.tree}` execute one file, in which their plugins `{node.plugin}` have "
                "different ports; declare the same ports, or list a copy of the file for one of the trees"
            )
            yield RULE.at(places.pop(path).value_span, message)


def _ports(outline: MachineOutline) -> frozenset[tuple[str, str, Direction]]:
    return frozenset((port.key, port.type, port.direction) for port in outline.ports)


def _equal_trees(context: SystemContext) -> Iterator[Finding]:
    """Report files that contain different trees with the same name."""
    first: dict[str, str] = {}
    listed = {f.path: f for f in context.files if f.required_kind is FileKind.TREE}
    for use in context.system.tree_uses:
        tree = use.frame.tree
        before = first.setdefault(tree.id, tree.path)
        if before != tree.path and tree.path in listed:
            message = f"two trees are called `{tree.id}`, here and in another file of the system; rename one of them"
            yield RULE.at(listed.pop(tree.path).span, message)


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
    "A system lists too many or too few files of a kind, or does not distinguish its trees.",
    system=check,
    facts=InputCount,
)
