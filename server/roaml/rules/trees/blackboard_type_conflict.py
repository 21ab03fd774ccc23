# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-type-conflict`, which blackboard_type_conflict.md describes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.facts import Facts
from roaml.forest.cpp_types import ANY, STRING
from roaml.forest.entries import BoundUse, Use
from roaml.forest.forest import Forest
from roaml.model.tree import is_variable_name
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of


class TypeConflict(Facts, frozen=True):
    """The facts of a finding: the port of the node, and its type; another node, its port that is bound to the same
    variable, and the type of that port."""

    port: str
    type: str
    other_node: str
    other_port: str
    other_type: str


def check(context: TreeContext) -> Iterator[Finding]:
    """Report ports of different types that are bound to one variable (docs/spec/trees.md#blackboard,
    docs/spec/lone-trees.md#entries)."""
    forest = trees_of(context)
    if forest is None:
        return
    reported: set[Use] = set()
    for uses in entries_of(forest).by_entry.values():
        typed = list({bound.use: None for bound in uses if bound.use.type != ANY and _is_checked(forest, bound)})
        if len({use.type for use in typed}) > 1:
            for use, first in _conflicts(typed, is_converted=forest.system is None):
                if use.path == context.source.path and use not in reported:
                    reported.add(use)
                    yield _finding(forest, use, first)


def _is_checked(forest: Forest, bound: BoundUse) -> bool:
    return forest.system is None or (bound.executed and is_variable_name(bound.variable))


def _conflicts(typed: list[Use], *, is_converted: bool) -> Iterator[tuple[Use, Use]]:
    """The uses with a type other than that of the entry, each with the use that determines the type of the entry.

    The first port determines the type of the entry, unless most ports agree on another type. If BehaviorTree.CPP
    converts values (`is_converted`), and the first port is a string, ports of other types may use the entry, but values
    of only one type may be written to it. If all of these are strings, the other ports must have types to which
    BehaviorTree.CPP converts a text.
    """
    is_text = is_converted and typed[0].type == STRING
    first = typed[0] if is_text else _most_frequent(typed)
    for use in typed:
        if use.type != first.type:
            if not is_text:
                yield use, first
            elif use.writes and (writer := next((u for u in typed if u.writes and u.type != use.type), None)):
                yield use, writer
            elif not use.writes:
                strings = all(u.type == STRING for u in typed if u.writes)
                if strings and any(u.writes for u in typed) and not use.type.startswith(_CONVERTED):
                    yield use, first


def _most_frequent(typed: list[Use]) -> Use:
    """The first use with the most frequent type."""
    counts = Counter(use.type for use in typed)
    most = max(counts.values())
    return next(use for use in typed if counts[use.type] == most)


_CONVERTED = ("int", "uint", "unsigned", "double", "float", "bool", "vector", "NodeStatus", "chrono")
"""The types to which BehaviorTree.CPP converts a text; the program may register others."""


def _finding(forest: Forest, use: Use, first: Use) -> Finding:
    owner = first.node.plugin.value if first.node.plugin is not None else ""
    types = f"`{use.type}` at the port `{use.port}` and `{first.type}` at `{first.port}` of `{owner}`"
    message = f"`{use.name}` is {types}; use the same type or another variable"
    related = _declarations(forest, use, first)
    if not related and first.path == use.path:
        related = [Related(first.span, f"`{first.type}` here")]
    is_certain = forest.system is not None or (use.from_library and first.from_library)
    severity = Severity.ERROR if is_certain else Severity.WARNING
    facts = TypeConflict(use.port, use.type, owner, first.port, first.type)
    return RULE.at(use.span, message, severity=severity, related=related, facts=facts)


def _declarations(forest: Forest, *uses: Use) -> list[Related]:
    """The declarations of the ports in machines of the system."""
    plugins = ((use, use.node.plugin.value) for use in uses if use.node.plugin is not None)
    paths = ((use, forest.system.plugin(name)[0] if forest.system is not None else "") for use, name in plugins)
    return [
        Related(Symbol(path, SymbolKind.PORT, use.port), f"declared as `{use.type}`") for use, path in paths if path
    ]


RULE = Rule(
    "blackboard-type-conflict",
    Severity.ERROR,
    "A blackboard variable is used with different types.",
    tree=check,
    facts=TypeConflict,
)
