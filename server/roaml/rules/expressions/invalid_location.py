# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-location`, which invalid_location.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Severity
from roaml.expr.tree import Index, Member, Name, access_path
from roaml.expr.types import Type
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue, ValueUse
from roaml.model.vocabulary import EVENT_VARIABLES
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if value.use is ValueUse.LOCATION and isinstance(value.value, Expression) and not value.value.broken:
            reason = _reason(value, context.typed.variables.get(value.place.chart.scope, {}))
            if reason:
                yield RULE.at(value.value.tree.span, reason)


def _reason(value: TypedValue, variables: Mapping[str, Type]) -> str:
    assert isinstance(value.value, Expression)
    tree = value.value.tree
    path = access_path(tree)
    if not isinstance(tree, (Name, Member, Index)) or path is None:
        return "not assignable; write a variable, an element `v[i]` or a member `s.m`"
    if path[0] in EVENT_VARIABLES and path[0] not in variables:
        return f"`{path[0]}` is received data and cannot be changed; to send data, use `<send>` or a ROS element"
    return ""


RULE = Rule("invalid-location", Severity.ERROR, "The location of an assignment is not assignable.", machine=check)
