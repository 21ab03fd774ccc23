# SPDX-License-Identifier: Apache-2.0
"""The rule `unexpected-value`, which unexpected_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.machine import RosSend
from roaml.model.message_constants import MessageField, constant_of, sent_fields
from roaml.model.value_types import find_handle
from roaml.model.waits import fixed_variables
from roaml.rules.rule import MachineContext, Rule, TreeContext
from roaml.rules.support.enumerations import enumerations
from roaml.rules.support.instances import instances
from roaml.rules.support.message_constants import port_constant, wrong_fields
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the fields that contain the only constant that nothing expects."""
    yield from _unnamed(context)
    if context.system is None:
        return
    wrong = {
        field: numbers
        for automaton in context.automata
        for field, numbers in wrong_fields(context.system, automaton).items()
    }
    for chart in context.machine.charts if wrong else ():
        fixed = fixed_variables(chart)
        for statement in chart.statements:
            for field, param in sent_fields(context.machine, statement):
                if field in wrong and param.value is not None and constant_of(param, fixed) == wrong[field][0]:
                    yield _finding(param.value.span, field, *wrong[field])


def _unnamed(context: MachineContext) -> Iterator[Finding]:
    """Report the fields that contain a number which no constant of the field has."""
    for chart in context.machine.charts:
        fixed = fixed_variables(chart)
        for statement in chart.statements:
            declaration = find_handle(context.machine, statement) if isinstance(statement, RosSend) else None
            if declaration is None or not isinstance(statement, RosSend):
                continue
            known = enumerations(context, declaration, statement.part)
            for param in statement.fields if known else ():
                field = known.get(param.name.value) if param.name is not None else None
                number = constant_of(param, fixed)
                if param.value is not None and field is not None and number is not None and not field.has(number):
                    yield RULE.at(param.value.span, f"no constant has the value {number}: {field.described}")


def in_tree(context: TreeContext) -> Iterator[Finding]:
    """Report the ports from whose constants plugins send the only constant that nothing expects."""
    if context.system is None:
        return
    reported: set[Span] = set()
    for node, automaton in instances(context):
        wrong = wrong_fields(context.system, automaton)
        for sent in automaton.outline.constants if wrong else ():
            for setting in node.ports if sent.field in wrong else ():
                number = port_constant(automaton, setting.key.value) if setting.key.value in sent.ports else None
                if number == wrong[sent.field][0] and setting.value.span not in reported:
                    reported.add(setting.value.span)
                    yield _finding(setting.value.span, sent.field, *wrong[sent.field])


def _finding(span: Span, field: MessageField, number: Fraction, missing: Fraction) -> Finding:
    message = (
        f"no machine that receives `{field.handle}` does anything if `{field.path}` is {number}, and they expect "
        f"{missing}, which is never sent; did you mean {missing}?"
    )
    return RULE.at(span, message, Fix(f"Change to `{missing}`", (TextEdit(span, str(missing)),)))


RULE = Rule(
    "unexpected-value",
    Severity.WARNING,
    "A constant is sent that no receiver expects, or that its interface does not name.",
    machine=check,
    tree=in_tree,
    whole=True,
)
