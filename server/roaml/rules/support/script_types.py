# SPDX-License-Identifier: Apache-2.0
"""The types of blackboard entries, and the scripts whose operations do not fit them (docs/spec/scripts.md#types)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Severity
from roaml.forest.cpp_types import ANY, STRING
from roaml.forest.entries import Entries
from roaml.forest.forest import Forest
from roaml.forest.scripts import ScriptUse, scripts_of
from roaml.libraries.version import CONSTANTS_TYPED_SINCE
from roaml.rules.rule import TreeContext
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.scripts import scripts
from roaml.script.infer import Type, assignments_as_conditions, check_condition, check_types, created_in
from roaml.script.parse import ScriptProblem

_TYPES = {
    STRING: Type.TEXT, "double": Type.REAL, "float": Type.REAL, "bool": Type.REAL,
    **dict.fromkeys(("int", "int8", "int16", "int64", "uint8", "uint16", "unsigned", "uint64"), Type.INTEGER),
}  # fmt: skip


def type_problems(context: TreeContext) -> Iterator[tuple[ScriptUse, ScriptProblem, bool, Severity | None]]:
    """The problems of the scripts of a file: the script, the problem, whether it is one of a condition, and its
    severity if it is not an error."""
    forest = trees_of(context)
    if forest is None:
        return
    entries = entries_of(forest)
    types = {**_assigned(forest, entries), **_types(entries), **_constants(forest, entries)}
    for tree, use, script, problems in scripts(context):
        own = tree.id.value if tree.id else ""

        def lookup(name: str, own: str = own) -> Type:
            known = {types.get(key, Type.UNKNOWN) for key in entries.entries(own, name)}
            return known.pop() if len(known) == 1 else Type.UNKNOWN

        if problems:
            continue
        for problem in check_types(script, lookup):
            yield use, _with_port(problem, entries, own, types), False, None
        if use.is_condition:
            yield from ((use, problem, True, None) for problem in check_condition(script, lookup))
            yield from ((use, problem, True, Severity.WARNING) for problem in assignments_as_conditions(script))


def _with_port(problem: ScriptProblem, entries: Entries, own: str, types: Mapping[str, Type]) -> ScriptProblem:
    """The problem with the port that makes an entry a string, if a port does. Then `..` is probably not intended,
    because the script uses the entry as a number."""
    keys = entries.entries(own, problem.number) if problem.number else ()
    ports = [bound.use for key in keys for bound in entries.by_entry.get(key, ()) if bound.use.type == STRING]
    if not ports or any(types.get(key) is not Type.TEXT for key in keys):
        return problem
    port = ports[0]
    node = port.node.type_name
    message = (
        f"`{problem.operator}` needs numbers, but the port `{port.port}` of `{node}` makes `{problem.number}` a "
        "string; compute the number in another entry"
    )
    return ScriptProblem(problem.span, message)


def _types(entries: Entries) -> dict[str, Type]:
    """The types of the entries whose ports all have the same type."""
    types_of: Mapping[str, set[str]] = {
        key: {bound.use.type for bound in uses if not bound.use.script} for key, uses in entries.by_entry.items()
    }
    single = {key: next(iter(types)) for key, types in types_of.items() if len(types) == 1}
    return {key: _TYPES[name] for key, name in single.items() if name != ANY and name in _TYPES}


def _assigned(forest: Forest, entries: Entries) -> dict[str, Type]:
    """The types of the entries that only scripts use. An entry has a type if all assignments that create it assign
    values of one type."""
    others = {key for key, uses in entries.by_entry.items() if not all(bound.use.script for bound in uses)}
    types: dict[str, set[Type]] = {}
    for _, tree, node in forest.all_nodes:
        own = tree.id.value if tree.id else ""
        for use in scripts_of(forest, node):
            for name, type_ in created_in(use.attribute.value):
                for key in entries.entries(own, name):
                    types.setdefault(key, set()).add(type_)
    return {key: given.pop() for key, given in types.items() if len(given) == 1 and key not in others}


def _constants(forest: Forest, entries: Entries) -> dict[str, Type]:
    """The entries that only constants of `<SubTree>` nodes set, if the version of the library stores these as texts."""
    if forest.settings.version >= CONSTANTS_TYPED_SINCE:
        return {}
    writers = {key: [b.use for b in uses if b.use.writes is not False] for key, uses in entries.by_entry.items()}
    return {key: Type.TEXT for key, uses in writers.items() if uses and all(use.into for use in uses)}
