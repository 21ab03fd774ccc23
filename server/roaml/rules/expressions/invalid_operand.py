# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-operand`, which invalid_operand.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import BadComparison, BadIndex, BadOperand, MixedTypes
from roaml.expr.types import BOOL, Array, EmptyArray, ScalarKind, Struct, is_kind, is_number, unwrap
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.types import phrase
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            match problem:
                case BadOperand(operator="+") if is_kind(problem.given, ScalarKind.STRING):
                    yield RULE.at(problem.span, "strings cannot be joined: `+` requires numbers")
                case BadOperand(operator="?"):
                    yield RULE.at(problem.span, f"the condition of `?` must be a boolean, not {phrase(problem.given)}")
                case BadOperand():
                    operand = "a boolean" if problem.required == BOOL else "a number"
                    message = f"`{problem.operator}` takes {operand}, not {phrase(problem.given)}"
                    yield RULE.at(problem.span, message, *_compare(problem))
                case BadComparison():
                    yield RULE.at(problem.span, _comparison(problem))
                case MixedTypes():
                    message = f"{phrase(problem.first)} and {phrase(problem.other)} have no common type"
                    yield RULE.at(problem.span, message)
                case BadIndex() if isinstance(problem.indexed, Array) or is_kind(problem.indexed, ScalarKind.STRING):
                    message = f"an index must be an integer, not {phrase(problem.index)}"
                    fixes = [_floor(problem.span)] if is_kind(problem.index, ScalarKind.REAL) else []
                    yield RULE.at(problem.span, message, *fixes)
                case BadIndex() if isinstance(problem.indexed, EmptyArray):
                    yield RULE.at(problem.span, "this array has no elements, because its value is always `[]`")
                case BadIndex():
                    yield RULE.at(
                        problem.span, f"only arrays and strings can be indexed, not {phrase(problem.indexed)}"
                    )


def _compare(problem: BadOperand) -> Iterator[Fix]:
    """A fix that compares a number with 0 where a boolean is required."""
    if problem.required == BOOL and is_number(problem.given):
        yield Fix("Compare with 0", tuple(_around(problem.span, "(", " != 0)")), preferred=False)


def _floor(span: Span) -> Fix:
    return Fix("Round down with `Math.floor`", tuple(_around(span, "Math.floor(", ")")), preferred=False)


def _around(span: Span, before: str, behind: str) -> Iterator[TextEdit]:
    yield TextEdit(Span(span.start, span.start), before)
    yield TextEdit(Span(span.end, span.end), behind)


def _comparison(problem: BadComparison) -> str:
    if isinstance(unwrap(problem.left)[0], Struct) or isinstance(unwrap(problem.right)[0], Struct):
        return f"structs cannot be compared with `{problem.operator}`; compare their members one by one"
    return f"{phrase(problem.left)} and {phrase(problem.right)} cannot be compared with `{problem.operator}`"


RULE = Rule("invalid-operand", Severity.ERROR, "An operator does not support the types of its operands.", machine=check)
