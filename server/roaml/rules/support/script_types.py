# SPDX-License-Identifier: Apache-2.0
"""The types of blackboard entries, and the scripts whose operations do not fit them (docs/spec/scripts.md#types)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Severity
from roaml.forest.cpp_types import ANY, STRING
from roaml.forest.entries import Entries, Use
from roaml.forest.forest import Forest
from roaml.forest.names import entry_of
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
    set_texts = _set_texts(forest, entries)
    types = {**_assigned(forest, entries), **_types(entries), **_constants(forest, entries), **set_texts}
    for tree, use, script, problems in scripts(context):
        own = tree.id.value if tree.id else ""

        def lookup(name: str, own: str = own) -> Type:
            known = {types.get(key, Type.UNKNOWN) for key in entries.entries(own, name)}
            return known.pop() if len(known) == 1 else Type.UNKNOWN

        if problems:
            continue
        for problem in check_types(script, lookup):
            yield use, _with_cause(problem, entries, own, types, set_texts), False, None
        if use.is_condition:
            yield from ((use, problem, True, None) for problem in check_condition(script, lookup))
            yield from ((use, problem, True, Severity.WARNING) for problem in assignments_as_conditions(script))


def _with_cause(
    problem: ScriptProblem, entries: Entries, own: str, types: Mapping[str, Type], set_texts: Mapping[str, Type]
) -> ScriptProblem:
    """The problem with the port or the `SetBlackboard` that makes an entry a string, if one does. Then `..` is probably
    not intended, because the script uses the entry as a number."""
    name, operator = problem.number, problem.operator
    keys = entries.entries(own, name) if name else ()
    if keys and all(key in set_texts for key in keys):
        message = (
            f"`{operator}` needs numbers, but `SetBlackboard` stores its constant in `{name}` as a string; "
            f'set `{name}` with a script, such as `<Script code="{name} := 4"/>`'
        )
        return ScriptProblem(problem.span, message)
    ports = [bound.use for key in keys for bound in entries.by_entry.get(key, ()) if _decides(bound.use, STRING)]
    if not ports or any(types.get(key) is not Type.TEXT for key in keys):
        return problem
    port = ports[0]
    node = port.node.type_name
    message = (
        f"`{operator}` needs numbers, but the port `{port.port}` of `{node}` makes `{name}` a string; "
        "compute the number in another entry"
    )
    return ScriptProblem(problem.span, message)


def _decides(use: Use, type_: str | None = None) -> bool:
    """Whether a port determines the type of its entry. A port that only reads a string, or a value of any type,
    converts what the entry contains."""
    is_typed = use.writes is not False or use.type not in (ANY, STRING)
    return is_typed and not use.script and (type_ is None or use.type == type_)


def _types(entries: Entries) -> dict[str, Type]:
    """The types of the entries whose ports all have the same type. A port that only reads a number accepts every
    number."""
    types: dict[str, Type] = {}
    for key, uses in entries.by_entry.items():
        ports = [bound.use for bound in uses if _decides(bound.use)]
        names = {use.type for use in ports}
        # blackboard-type-conflict reports ports of different types.
        is_single = len(names) == 1 and {bound.use.type for bound in uses if not bound.use.script} <= {*names, ANY}
        type_ = _TYPES.get(names.pop()) if is_single else None
        if type_ is not None:
            is_read_only = all(use.writes is False for use in ports)
            types[key] = Type.REAL if is_read_only and type_ is Type.INTEGER else type_
    return types


def _assigned(forest: Forest, entries: Entries) -> dict[str, Type]:
    """The types of the entries that only scripts set. An entry has a type if all assignments that create it assign
    values of one type."""
    ports = {key: [bound.use for bound in uses if not bound.use.script] for key, uses in entries.by_entry.items()}
    others = {key for key, uses in ports.items() if any(_decides(use) for use in uses)}
    # If a port reads a string, an entry of numbers also accepts strings.
    strings = {key for key, uses in ports.items() if any(use.type == STRING for use in uses)}
    types: dict[str, set[Type]] = {}
    for _, tree, node in forest.all_nodes:
        own = tree.id.value if tree.id else ""
        for use in scripts_of(forest, node):
            for name, type_ in created_in(use.attribute.value):
                for key in entries.entries(own, name):
                    types.setdefault(key, set()).add(type_)
    single = {key: given.pop() for key, given in types.items() if len(given) == 1 and key not in others}
    return {key: type_ for key, type_ in single.items() if type_ is Type.TEXT or key not in strings}


def _set_texts(forest: Forest, entries: Entries) -> dict[str, Type]:
    """The entries that the library stores as texts, because constants of `SetBlackboard` set them, and nothing else
    but scripts that assign texts does (docs/spec/mocks.md#stored-texts)."""
    if forest.system is not None:
        return {}
    created = {
        (tree.id.value if tree.id else "", name)
        for _, tree, node in forest.all_nodes
        for use in scripts_of(forest, node)
        for name, type_ in created_in(use.attribute.value)
        if type_ is not Type.TEXT
    }
    result: dict[str, Type] = {}
    for key, uses in entries.by_entry.items():
        deciding = [bound.use for bound in uses if _decides(bound.use)]
        scripts = any((bound.use.tree, bound.use.name) in created for bound in uses if bound.use.script)
        if deciding and not scripts and all(_sets_constant(use) for use in deciding):
            result[key] = Type.TEXT
    return result


def _sets_constant(use: Use) -> bool:
    """Whether a port is that of a `SetBlackboard` which sets an entry to a constant."""
    node = use.node
    is_setter = (
        use.port == "output_key" and (node.plugin.value if node.plugin else node.element.name) == "SetBlackboard"
    )
    return is_setter and any(port.key.value == "value" and entry_of(port) is None for port in node.ports)


def _constants(forest: Forest, entries: Entries) -> dict[str, Type]:
    """The entries that only constants of `<SubTree>` nodes set, if the version of the library stores these as texts."""
    if forest.settings.version >= CONSTANTS_TYPED_SINCE:
        return {}
    writers = {key: [b.use for b in uses if b.use.writes is not False] for key, uses in entries.by_entry.items()}
    return {key: Type.TEXT for key, uses in writers.items() if uses and all(use.into for use in uses)}
