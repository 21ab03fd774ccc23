# SPDX-License-Identifier: Apache-2.0
"""The rule `script-type`, which script_type.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Severity
from roaml.forest.cpp_types import ANY, STRING
from roaml.forest.entries import Entries, Key
from roaml.forest.forest import Forest
from roaml.forest.scripts import scripts_of
from roaml.libraries.version import CONSTANTS_TYPED_SINCE
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import forest_of
from roaml.rules.support.scripts import fixes, scripts
from roaml.script.infer import Type, assignments_as_conditions, check_condition, check_types, created_in

_TYPES = {
    STRING: Type.TEXT, "double": Type.REAL, "float": Type.REAL, "bool": Type.REAL,
    **dict.fromkeys(("int", "int8", "int16", "int64", "uint8", "uint16", "unsigned", "uint64"), Type.INTEGER),
}  # fmt: skip


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    entries = entries_of(forest)
    types = {**_assigned(forest, entries), **_types(entries), **_constants(forest, entries)}
    for tree, use, script, problems in scripts(context):
        own = tree.id.value if tree.id else ""

        def lookup(name: str, own: str = own) -> Type:
            return types.get(entries.entry(own, name), Type.UNKNOWN)

        if problems:
            continue
        for problem in check_types(script, lookup):
            yield RULE.at(problem.span, problem.message, *fixes(context, use.attribute, problem))
        if use.is_condition:
            for problem in check_condition(script, lookup):
                yield RULE.at(problem.span, f"`{use.attribute.name}` is a condition: {problem.message}")
            for problem in assignments_as_conditions(script):
                message = f"`{use.attribute.name}` is a condition: {problem.message}"
                yield RULE.at(problem.span, message, *fixes(context, use.attribute, problem), severity=Severity.WARNING)


def _types(entries: Entries) -> dict[Key, Type]:
    """The types of the entries whose ports all have the same type."""
    types_of: Mapping[Key, set[str]] = {
        key: {use.type for use in uses if not use.script} for key, uses in entries.by_entry.items()
    }
    single = {key: next(iter(types)) for key, types in types_of.items() if len(types) == 1}
    return {key: _TYPES[name] for key, name in single.items() if name != ANY and name in _TYPES}


def _assigned(forest: Forest, entries: Entries) -> dict[Key, Type]:
    """The types of the entries that only scripts use. An entry has a type if all assignments that create it assign
    values of one type."""
    others = {key for key, uses in entries.by_entry.items() if not all(use.script for use in uses)}
    types: dict[Key, set[Type]] = {}
    for _, tree, node in forest.all_nodes:
        own = tree.id.value if tree.id else ""
        for use in scripts_of(forest, node):
            for name, type_ in created_in(use.attribute.value):
                types.setdefault(entries.entry(own, name), set()).add(type_)
    return {key: given.pop() for key, given in types.items() if len(given) == 1 and key not in others}


def _constants(forest: Forest, entries: Entries) -> dict[Key, Type]:
    """The entries that only constants of `<SubTree>` nodes set, if the version of the library stores these as texts."""
    if forest.settings.version >= CONSTANTS_TYPED_SINCE:
        return {}
    writers = {key: [use for use in uses if use.writes is not False] for key, uses in entries.by_entry.items()}
    return {
        key: Type.TEXT
        for key, uses in writers.items()
        if uses and all(use.node.is_subtree and not use.script and use.creates for use in uses)
    }


RULE = Rule("script-type", Severity.ERROR, "An operation of a script always fails.", tree=check)
