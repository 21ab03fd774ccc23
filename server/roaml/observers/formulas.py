# SPDX-License-Identifier: Apache-2.0
"""Translates a formula of past-time metric temporal logic to its observer, with one window for each `Since`."""

from __future__ import annotations

from roaml.observers.parts import Builder, Recent
from roaml.observers.program import (
    TRUE,
    Expression,
    Input,
    Literal,
    Observer,
    Outputs,
    conjunction,
    disjunction,
    negation,
)
from roaml.observers.properties import And, Atom, Constant, Formula, FormulaProperty, Not, Or, Since


def observe_formula(property_: FormulaProperty) -> Observer:
    builder = Builder()
    violated = builder.flag("violated")
    builder.raise_if(violated, negation(_value(property_.formula, builder, {})))
    builder.finish()
    return Observer(property_.inputs, tuple(builder.registers), tuple(builder.assignments), Outputs(violated))


def _value(formula: Formula, builder: Builder, known: dict[Formula, Expression]) -> Expression:
    """An expression with the value of the formula, after assignments that update the registers of the formula."""
    if formula not in known:
        known[formula] = _computed(formula, builder, known)
    return known[formula]


def _computed(formula: Formula, builder: Builder, known: dict[Formula, Expression]) -> Expression:
    match formula:
        case Atom(name):
            return Input(name)
        case Constant(value):
            return Literal(value)
        case Not(operand):
            return negation(_value(operand, builder, known))
        case And(left, right):
            return conjunction(_value(left, builder, known), _value(right, builder, known))
        case Or(left, right):
            return disjunction(_value(left, builder, known), _value(right, builder, known))
        case Since(left, right, window):
            holds, begins = _value(left, builder, known), _value(right, builder, known)
            recent = Recent(builder, "since", window)
            recent.advance()
            if holds != TRUE:
                recent.clear(negation(holds))
            recent.add(begins)
            return recent.is_in_window
