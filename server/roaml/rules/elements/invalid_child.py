# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-child`, which invalid_child.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.types import ScalarKind, Unknown, is_kind
from roaml.model.machine import CallChild, Chart
from roaml.model.syntax import Name
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support import misspelled


def check(context: MachineContext) -> Iterator[Finding]:
    counts = [len(a.instance.children) for a in context.automata if a.instance is not None]
    for chart in context.machine.charts:
        for name in _children(chart):
            if name.value.isascii() and name.value.isdigit():
                # If only some of the nodes have too few children, child-count reports it.
                if counts and int(name.value[:9]) >= max(counts):
                    most = max(counts)
                    if most == 0:
                        reason = "in the tree, no node of this plugin has children"
                    else:
                        children = f"{most} {'child' if most == 1 else 'children'}"
                        reason = f"in the tree, nodes of this plugin have at most {children}, numbered from 0"
                    message = f"there is no child `{name.value}`: {reason}"
                    yield RULE.at(name.span, message)
            else:
                yield from _variable(context, chart, name)


def _children(chart: Chart) -> Iterator[Name]:
    for statement in chart.statements:
        if isinstance(statement, CallChild) and statement.child is not None:
            yield statement.child
    for state in chart.states:
        for handler in state.handlers:
            if handler.child is not None:
                yield handler.child


def _variable(context: MachineContext, chart: Chart, name: Name) -> Iterator[Finding]:
    variables = context.typed.variables.get(chart.scope, {})
    type_ = variables.get(name.value)
    if type_ is None:
        if misspelled.declaration(context.machine, "data", name.value):
            return
        close = close_names(name.value, variables)
        hint = did_you_mean(close) or "; write a whole number of at least 0 or the name of an integer variable"
        yield RULE.at(name.span, f"`{name.value}` is not the index of a child{hint}", *replacements(name.span, close))
    elif not (isinstance(type_, Unknown) or is_kind(type_, ScalarKind.INT)):
        yield RULE.at(name.span, f"the index of a child must be an integer, not `{type_}`")


RULE = Rule("invalid-child", Severity.ERROR, "The index of a child is not valid.", machine=check)
