# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-type-conflict`, which blackboard_type_conflict.md describes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.facts import Facts
from roaml.forest.cpp_types import ANY, STRING
from roaml.forest.entries import Use
from roaml.model.system import BoundPort
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.blackboard import places
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import forest_of


def check(context: TreeContext) -> Iterator[Finding]:
    yield from _alone(context) if context.system is None else _of_system(context)


class TypeConflict(Facts, frozen=True):
    """The facts of a finding: `other_type` is the type of another port that is bound to the same variable as `port`."""

    port: str
    other_type: str


def _of_system(context: TreeContext) -> Iterator[Finding]:
    """Report ports of different types that are bound to one variable (docs/spec/trees.md#blackboard)."""
    assert context.system is not None
    for variable, ports in context.system.blackboard.items():
        typed = [bound for bound in ports if bound.port.type != "any"]
        if len({bound.port.type for bound in typed}) < 2:
            continue
        for bound, span, _ in places(context, variable, ports):
            other = next((o for o in typed if o.port.type != bound.port.type), None)
            if other is not None and bound.port.type != "any":
                yield RULE.at(
                    span,
                    f"`{variable}` is `{bound.port.type}` at the port `{bound.port.key}` and `{other.port.type}` at "
                    f"`{other.port.key}` of `{other.automaton.outline.name}`; use the same type",
                    related=_related(bound, other),
                    facts=TypeConflict(bound.port.key, other.port.type),
                )


def _related(*ports: BoundPort) -> list[Related]:
    return [
        Related(Symbol(bound.automaton.path, SymbolKind.PORT, bound.port.key), f"declared as `{bound.port.type}`")
        for bound in ports
        if bound.automaton.path
    ]


# ------------------------------------------------------------ trees without a system


def _alone(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for uses in entries_of(forest).by_entry.values():
        typed = [use for use in uses if use.type != ANY]
        if len({use.type for use in typed}) > 1:
            for use, first in _conflicts(typed):
                if use.path == context.source.path:
                    yield _finding(use, first)


def _conflicts(typed: list[Use]) -> Iterator[tuple[Use, Use]]:
    """The uses with a type other than that of the entry, each with the use that determines the type of the entry.

    The first port determines the type of the entry, unless most ports agree on another type. If the first port is a
    string, ports of other types may use the entry, but values of only one type may be written to it. If all of these
    are strings, the other ports must have types to which BehaviorTree.CPP converts a text.
    """
    first = _first(typed)
    for use in typed:
        if use.type != first.type:
            if typed[0].type != STRING:
                yield use, first
            elif use.writes and (writer := next((u for u in typed if u.writes and u.type != use.type), None)):
                yield use, writer
            elif not use.writes:
                strings = all(u.type == STRING for u in typed if u.writes)
                if strings and any(u.writes for u in typed) and not use.type.startswith(_CONVERTED):
                    yield use, first


def _first(typed: list[Use]) -> Use:
    """The first use whose type is the type of the entry. This is the most frequent type, unless the first port is a
    string."""
    if typed[0].type == STRING:
        return typed[0]
    counts = Counter(use.type for use in typed)
    most = max(counts.values())
    return next(use for use in typed if counts[use.type] == most)


_CONVERTED = ("int", "uint", "unsigned", "double", "float", "bool", "vector", "NodeStatus", "chrono")
"""The types to which BehaviorTree.CPP converts a text; the program may register others."""


def _finding(use: Use, first: Use) -> Finding:
    related = [Related(first.span, f"`{first.type}` here")] if first.path == use.path else []
    types = f"has the type `{first.type}`, but this port has the type `{use.type}`"
    message = f"the entry `{use.name}` {types}; use another entry"
    severity = Severity.ERROR if use.from_library and first.from_library else Severity.WARNING
    return RULE.at(use.span, message, severity=severity, related=related)


RULE = Rule(
    "blackboard-type-conflict",
    Severity.ERROR,
    "A blackboard variable is used with different types.",
    tree=check,
    facts=TypeConflict,
)
