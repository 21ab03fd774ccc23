# SPDX-License-Identifier: Apache-2.0
"""Decides whether a symbol may have a new name: the name is valid, and no other symbol in its scope has it.

The decision is stricter than the rules: a valid name is also rejected if it would change the meaning of another name,
in the models or in the translation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.expr.types import BASE_TYPES
from roaml.ide.names.in_machine import is_implicit
from roaml.ide.names.lookup import SymbolGroup, possible_uses
from roaml.ide.names.occurrence import HANDLES
from roaml.ide.names.occurrences import trees_of
from roaml.language import BEHAVIOR_TREE
from roaml.model.kinds import FileKind
from roaml.model.machine import Declaration, Machine
from roaml.model.name_forms import EVENT, VARIABLE, is_reserved, variable_problem
from roaml.model.vocabulary import EVENT_VARIABLES
from roaml.project.analysis import Analysis
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.scxml.names import STATUSES, is_reserved_name, is_synchronising, sanitise

_WORD = regex(r"[A-Za-z_][A-Za-z0-9_.-]*\Z")
_INTERFACE = regex(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*\Z", re.ASCII)
_PROPERTY = regex(r"[\w.-]+\Z")
_INTERFACES = (SymbolKind.TOPIC, SymbolKind.SERVICE, SymbolKind.ACTION)
_JOINED = (SymbolKind.VARIABLE, SymbolKind.PARAMETER, SymbolKind.MEMBER, SymbolKind.EVENT)
"""Kinds of symbols whose names the translation joins with other names by `__`."""


def problem(analysis: Analysis, group: SymbolGroup, new: str) -> str:
    """Why a symbol cannot be named `new`, as a clause; "" if it can."""
    for symbol in group.symbols:
        if symbol.name == new:
            return f"the name is already `{new}`"
    for kind in sorted(group.kinds):
        if reason := _form(kind, new, group):
            return reason
    for symbol in group.symbols:
        for other in _neighbours(analysis, symbol):
            if other not in group.symbols and _clashes(symbol, other, new):
                return f"{_article(other.kind)} `{other.name}` already exists"
        if symbol.kind is SymbolKind.BLACKBOARD:
            trees = (trees_of(analysis, symbol.path, system) for system in analysis.systems_of(symbol.path))
            if any(tree.is_taken(symbol, new) for tree in trees):
                return f"a blackboard variable `{new}` already exists"
        if reason := _in_property_files(analysis, group, symbol, new):
            return reason
        if handle := _conflicting_handle(analysis, group, symbol, new):
            return f"{_article(handle.kind)} `{new}` already exists in a machine that uses `{symbol.name}`"
    return ""


def state_problem(name: str) -> str:
    """Why a new state cannot have a name, as a clause; "" if it can."""
    return "" if _is_word(name) else f"`{name}` is not a valid name of a state"


def tree_node_problem(name: str, *, in_system: bool) -> str:
    """Why a node of a tree cannot have a name, as a clause; "" if it can. Only in systems, the name is a part of names
    of the translation."""
    is_valid = _is_word(name) if in_system else bool(name)
    return "" if is_valid else f"`{name}` is not a valid name of a node"


def _is_word(name: str) -> bool:
    return _WORD.match(name) is not None and name not in STATUSES


OF_NODES = (SymbolKind.TREE_NODE, SymbolKind.MACHINE, SymbolKind.PLUGIN, SymbolKind.TREE)
"""Kinds of symbols that may occur in the paths of nodes in property files."""


def _in_property_files(analysis: Analysis, group: SymbolGroup, symbol: Symbol, new: str) -> str:
    """Why property files do not allow a new name: another property has the name, or a port of a property file would
    refer to another node. "" if they allow it."""
    if symbol.kind is SymbolKind.PROPERTY:
        listed_files = analysis.listed(symbol.path)
        paths = [file.path for file in listed_files if file.required_kind is FileKind.PROPERTIES and file.usable]
        properties = (declared.name for path in paths for declared in analysis.properties(path)[0])
        return f"a property `{new}` already exists" if new in properties else ""
    if symbol.kind not in OF_NODES:
        return ""
    files = {use.path for use in group.uses if analysis.kind(use.path) is FileKind.XML_PROPERTIES}
    for path in {system for file in files for system in analysis.systems_of(file) if system is not None}:
        system = analysis.system(path)
        names = {name for node in system.instances for name in (node.name, node.plugin)} if system else set()
        names |= {name for use in system.tree_uses for name in (use.name, use.tree)} if system else set()
        if new in names or "/" in new:
            return f"properties refer to nodes of the tree by their names, and another node or tree is called `{new}`"
    return ""


def _conflicting_handle(analysis: Analysis, group: SymbolGroup, symbol: Symbol, new: str) -> Declaration | None:
    """The declaration with which a new name of a handle, or of an interface whose name is used as a handle, would
    conflict; `None` if there is none."""
    if symbol.kind in HANDLES:
        machine = analysis.machine(symbol.path)
        return next((d for d in _declared(machine, new) if is_implicit(d)), None)
    if symbol.kind in _INTERFACES:
        for machine in map(analysis.machine, dict.fromkeys(use.path for use in group.uses)):
            own = (d for d in machine.declarations if is_implicit(d)) if machine else ()
            spans = {use.occurrence.span.end for use in group.uses if analysis.machine(use.path) is machine}
            if any(d.handle and d.handle.span.end in spans for d in own):
                return next(iter((*_declared(machine, new), *_declared(machine, f"/{new}"))), None)
    return None


def _declared(machine: Machine | None, name: str) -> tuple[Declaration, ...]:
    """The declarations in a machine whose handle is `name`."""
    return tuple(d for d in machine.declarations if d.handle and d.handle.value == name) if machine else ()


def _form(kind: SymbolKind, new: str, group: SymbolGroup) -> str:
    """Why `new` is not a valid name for symbols of a kind; "" if it is valid."""
    kind_name = _article(kind)
    cannot = f"`{new}` is not a valid name of {kind_name}"
    if kind in _JOINED and "__" in new and not any("__" in symbol.name for symbol in group.symbols):
        return f"{cannot}: `__` separates the parts of names in the translation"
    right: object
    match kind:
        case SymbolKind.VARIABLE:
            if new in EVENT_VARIABLES:
                return f"`{new}` is the name of an event variable"
            return variable_problem(new)
        case SymbolKind.EVENT:
            right = EVENT.match(new) and not new.endswith((".valid", "_"))
            if right and (is_synchronising(new) or is_reserved_name(new)):
                return f"{cannot}: the translation uses this name for an event that it generates"
        case SymbolKind.PARAMETER:
            right = all(VARIABLE.match(part) for part in new.split(".")) and not new.endswith("_")
        case SymbolKind.MEMBER:
            right = VARIABLE.match(new) and not new.endswith("_") and new != "length" and not is_reserved(new)
        case SymbolKind.STRUCT:
            right = VARIABLE.match(new) and new not in BASE_TYPES and not is_reserved(new)
        case SymbolKind.PORT:
            right = VARIABLE.match(new) and not new.startswith("_") and new not in ("name", "ID", "CHILDREN_COUNT")
        case SymbolKind.BLACKBOARD:
            right = VARIABLE.match(new) and not new.startswith("_") and not new.endswith("_")
            right = right and not is_reserved(new) and new not in ("name", "ID")
        case SymbolKind.PORT_VARIABLE:
            right = VARIABLE.match(new) and not is_reserved(new) and new != "Math"
        case SymbolKind.PROPERTY:
            right = _PROPERTY.match(new)
        case SymbolKind.TOPIC | SymbolKind.SERVICE | SymbolKind.ACTION:
            right = _INTERFACE.match(new)
        case SymbolKind.MACHINE | SymbolKind.PLUGIN:
            right = _WORD.match(new) and not is_reserved_name(new)
            if new in BEHAVIOR_TREE.elements:
                return f"`{new}` is the name of a node of BehaviorTree.CPP"
        case _:
            right = _is_word(new)
    return "" if right else cannot


def _neighbours(analysis: Analysis, symbol: Symbol) -> Iterator[Symbol]:
    """The symbols that occur in the files that can use `symbol`."""
    for _, uses in possible_uses(analysis, symbol):
        yield from uses.by_symbol


def _clashes(symbol: Symbol, other: Symbol, new: str) -> bool:
    """Whether the names of `symbol` and `other` would conflict if `symbol` were called `new`."""
    if symbol.kind in _INTERFACES:
        is_topic = symbol.kind is SymbolKind.TOPIC
        return (
            other.kind in _INTERFACES
            and (other.kind is SymbolKind.TOPIC) == is_topic
            and sanitise(other.name) == sanitise(new)
        )
    if symbol.kind in HANDLES:
        same_file = other.path == symbol.path and other.kind in HANDLES
        both_timers = symbol.kind == other.kind is SymbolKind.TIMER
        return (same_file or both_timers) and other.name == new
    if other.name != new:
        return False
    match symbol.kind:
        case SymbolKind.MACHINE | SymbolKind.PLUGIN:
            return other.kind in (SymbolKind.MACHINE, SymbolKind.PLUGIN)
        case SymbolKind.BLACKBOARD | SymbolKind.TREE_NODE:
            return False  # `Trees.is_taken` decides; nodes of a tree may have equal names
    return (other.kind, other.path, other.scope) == (symbol.kind, symbol.path, symbol.scope)


_WORDS = {
    SymbolKind.MACHINE: "state machine",
    SymbolKind.BLACKBOARD: "blackboard variable",
    SymbolKind.TREE: "behavior tree",
}


def _article(kind: SymbolKind) -> str:
    word = _WORDS.get(kind) or kind.value.replace("-", " ")
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"
