# SPDX-License-Identifier: Apache-2.0
"""The rule `integer-range`, which integer_range.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import constant
from roaml.expr.tree import ArrayLiteral, Conditional, Expr, Number, ObjectLiteral, walk
from roaml.expr.types import INTEGER_RANGES, Array, Scalar, ScalarKind, Struct, Type, is_kind, unwrap
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.retype import as_type, wide_enough
from roaml.text import Span


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if not isinstance(value.value, Expression):
            continue
        tree = value.value.tree
        integers = [n for n in walk(tree) if isinstance(n, Number) and not n.is_real]
        if value.required is not None and is_kind(value.required, ScalarKind.REAL):
            integers = [n for n in integers if n is not tree]  # it is converted to a real number
        too_large = [n for n in integers if not n.is_whole]
        for literal in too_large:
            message = "this number does not fit into 64 bits, the size of an integer in a model"
            yield RULE.at(literal.span, f"{message}; write a real number with a point", severity=Severity.ERROR)
        if not too_large and value.required is not None:
            for span, number, type_ in outside(value.value.tree, value.required):
                low, high = INTEGER_RANGES[type_]
                wider = wide_enough(number, type_)
                fixes = as_type(context, value, wider) if wider and not _is_nested(value.required) else ()
                message = f"{number} does not fit into `{type_}`, whose range is {low} to {high}"
                yield RULE.at(span, message, *fixes)


def _is_nested(required: Type) -> bool:
    """Whether the integer is a member of a struct, whose type is declared elsewhere."""
    return isinstance(unwrap(required)[0], Struct)


def outside(expr: Expr, required: Type) -> Iterator[tuple[Span, int, str]]:
    """The constants in `expr` outside the range of the integer type that they must have, each as its place, its value
    and the name of the type."""
    match expr, required:
        case ArrayLiteral(), Array():
            for element in expr.elements:
                yield from outside(element, required.element)
        case ObjectLiteral(), Struct():
            for member in expr.members:
                if type_ := required.member(member.key):
                    yield from outside(member.value, type_)
        case Conditional(), _:
            yield from outside(expr.then, required)
            yield from outside(expr.otherwise, required)
        case _, Scalar(kind=ScalarKind.INT, name=name) if name in INTEGER_RANGES:
            number = constant(expr)
            if isinstance(number, int) and not INTEGER_RANGES[name][0] <= number <= INTEGER_RANGES[name][1]:
                yield expr.span, number, name


RULE = Rule(
    "integer-range",
    Severity.WARNING,
    "A constant is outside the range of its integer type.",
    machine=check,
)
