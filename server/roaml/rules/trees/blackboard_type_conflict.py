# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-type-conflict`, which blackboard_type_conflict.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.facts import Facts
from roaml.model.system import BoundPort
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.blackboard import places


class TypeConflict(Facts, frozen=True):
    """The facts of a finding: `other_type` is the type of another port that is bound to the same variable as `port`."""

    port: str
    other_type: str


def check(context: TreeContext) -> Iterator[Finding]:
    """Report ports of different types that are bound to one variable (docs/spec/trees.md#blackboard)."""
    if context.system is None:
        return
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


RULE = Rule(
    "blackboard-type-conflict",
    Severity.ERROR,
    "A blackboard variable is used with different types.",
    tree=check,
    facts=TypeConflict,
)
