# SPDX-License-Identifier: Apache-2.0
"""Rename the symbol at a caret, in all files of all systems in which it is used.

A rename to an unused name changes only the name: the findings and the translation stay the same, and renaming back
restores the files byte by byte. A rename that cannot keep this property is rejected, with a reason for the user.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from roaml.diagnostics import Symbol
from roaml.ide.names.lookup import SymbolGroup, SymbolUse, occurrences_at, symbol_group_at
from roaml.ide.names.occurrence import DEFINED_BY_ROS, HANDLES, Form
from roaml.ide.names.occurrences import from_parameters
from roaml.ide.rename.new_name import OF_NODES, problem
from roaml.model.system import CHILDREN_COUNT, CLOCK_TOPIC
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.scxml.names import safe_name, sanitise
from roaml.text import Span, TextEdit

_NEED_A_DEFINITION = frozenset(
    (
        SymbolKind.STATE,
        SymbolKind.VARIABLE,
        SymbolKind.PORT,
        SymbolKind.MACHINE,
        SymbolKind.PLUGIN,
        SymbolKind.TREE,
        SymbolKind.STRUCT,
        SymbolKind.MEMBER,
        *HANDLES,
    )
)
_OF_THE_NODE = ("name", "ID", CHILDREN_COUNT)
"""The names of ports whose values come from the node of the tree."""


class RenameRefusal(Record, frozen=True):
    """A rename that is not possible. `reason` states why, as a clause for the user."""

    reason: str


class Prepared(Record, frozen=True):
    """The place and the current name of the symbol to rename."""

    span: Span
    name: str


class Renaming(Record, frozen=True):
    """The edits of a rename: path of a file -> its edits, in the order of the text."""

    edits: Mapping[str, tuple[TextEdit, ...]]


def prepare(analysis: Analysis, path: str, offset: int) -> Prepared | RenameRefusal:
    """The symbol to rename at a caret, or why it cannot be renamed."""
    group, source = symbol_group_at(analysis, path, offset), analysis.source(path)
    if group is None or source is None:
        return RenameRefusal("there is no name at this position")
    reason = _fixed(group) or _of_instances(analysis, group)
    if reason:
        return RenameRefusal(reason)
    span = occurrences_at(analysis, path, offset)[0].span
    return Prepared(span, source.text[span.start : span.end])


def rename(analysis: Analysis, path: str, offset: int, new: str) -> Renaming | RenameRefusal:
    """The edits that rename the symbol at a caret to `new`, or why it cannot have this name."""
    group = symbol_group_at(analysis, path, offset)
    if group is None:
        return RenameRefusal("there is no name at this position")
    new = new.strip()
    if SymbolKind.TOPIC in group.kinds:
        new = new.removeprefix("/")
    reason = _fixed(group) or _of_instances(analysis, group) or problem(analysis, group, new)
    if reason:
        return RenameRefusal(reason)
    edits: dict[str, list[TextEdit]] = {}
    for use in group.uses:
        edits.setdefault(use.path, []).append(TextEdit(use.occurrence.span, _spelled(new, use)))
    return Renaming({edited: tuple(sorted(changes)) for edited, changes in edits.items()})


def _spelled(new: str, use: SymbolUse) -> str:
    match use.occurrence.form:
        case Form.AS_IS:
            return new
        case Form.SANITISED:
            return sanitise(new)
        case Form.SAFE:
            return safe_name(new)
        case Form.WORD:
            return re.sub(r"\W", "_", new, flags=re.ASCII)
        case Form.FLAT:
            return new.replace(".", "__")


_OF_INTERFACES = (SymbolKind.TOPIC, SymbolKind.SERVICE, SymbolKind.ACTION, SymbolKind.EVENT)


def _of_instances(analysis: Analysis, group: SymbolGroup) -> str:
    """Why a name cannot be renamed because parameters are a part of it, or because instances have other names for the
    interface or event; "" if it can."""
    for use in group.uses:
        symbol = use.occurrence.symbol
        if "$(" in symbol.name:
            return f"a parameter is a part of `{symbol.name}`"
        for system in analysis.systems_of(use.path):
            if symbol.kind in OF_NODES and system is not None and (found := _from_parameter(analysis, system, symbol)):
                return (
                    f"`{found}` takes the name `{symbol.name}` from the value of a parameter, which would not be "
                    "changed; change both by hand"
                )
        if symbol.kind not in _OF_INTERFACES:
            continue
        for system in analysis.systems_of(use.path):
            expanded = analysis.expanded(system) if system else None
            names = expanded.expansion.renamed.get(use.path, ()) if expanded else ()
            if symbol.name.lstrip("/") in {name.lstrip("/") for name in names}:
                return (
                    f"instances of its machine have other names for `{symbol.name}` (`namespace` or `<remap>` in the "
                    "system file), which would not be changed"
                )
    return ""


def _from_parameter(analysis: Analysis, system: str, symbol: Symbol) -> str:
    """The name of a property file with the path of a node in which the value of a parameter is the name of `symbol`;
    "" if there is none."""
    for path in analysis.files_of(system):
        if any(occurrence.symbol == symbol for occurrence in from_parameters(analysis, path, system)):
            return re.split(r"[/\\]", path)[-1]
    return ""


def _fixed(group: SymbolGroup) -> str:
    """Why a symbol cannot be renamed at all; "" if it can."""
    for symbol in group.symbols:
        name = symbol.name
        if symbol.kind in DEFINED_BY_ROS:
            return f"`{name}` is defined by ROS, not by this model"
        if symbol.kind is SymbolKind.PLUGIN and not symbol.path:
            return f"`{name}` is a node of BehaviorTree.CPP, whose name is fixed"
        if symbol.kind is SymbolKind.PORT and name in _OF_THE_NODE:
            return f"the port `{name}` has a special meaning in a tree"
        if symbol.kind is SymbolKind.TOPIC and name == CLOCK_TOPIC:
            return f"the topic `{name}` is the clock of ROS, whose name is fixed"
        in_prefix = any(use.occurrence.symbol == symbol and use.occurrence.form is Form.WORD for use in group.uses)
        if in_prefix and not (name[:1].isalpha() or name[:1] == "_"):
            return f"`{name}` is spelled differently in the translation, so the uses in properties cannot be renamed"
    if group.kinds & _NEED_A_DEFINITION and not group.definitions:
        return f"`{group.symbols[0].name}` is not defined in this workspace"
    return ""
