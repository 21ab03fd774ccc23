# SPDX-License-Identifier: Apache-2.0
"""invalid-operand: see invalid_operand.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import BadComparison, BadIndex, BadOperand, MixedTypes
from roaml.expr.types import Array, Struct, is_kind, unwrap
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.type_mismatch import phrase


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            match problem:
                case BadOperand(operator="+") if is_kind(problem.given, "string"):
                    yield RULE.at(problem.span, "strings cannot be joined: `+` takes numbers")
                case BadOperand(operator="?"):
                    yield RULE.at(
                        problem.span, f"the condition of `?` is {problem.wanted}, not {phrase(problem.given)}"
                    )
                case BadOperand():
                    message = f"`{problem.operator}` takes {problem.wanted}, not {phrase(problem.given)}"
                    yield RULE.at(problem.span, message)
                case BadComparison():
                    yield RULE.at(problem.span, _comparison(problem))
                case MixedTypes():
                    message = f"{phrase(problem.first)} and {phrase(problem.other)} have no type in common"
                    yield RULE.at(problem.span, message)
                case BadIndex() if isinstance(problem.indexed, Array) or is_kind(problem.indexed, "string"):
                    yield RULE.at(problem.span, f"an index is an integer, not {phrase(problem.index)}")
                case BadIndex():
                    yield RULE.at(
                        problem.span, f"only arrays and strings have an index; this is {phrase(problem.indexed)}"
                    )


def _comparison(problem: BadComparison) -> str:
    if isinstance(unwrap(problem.left)[0], Struct) or isinstance(unwrap(problem.right)[0], Struct):
        return f"structs cannot be compared with `{problem.operator}`; compare their members one by one"
    return f"{phrase(problem.left)} and {phrase(problem.right)} cannot be compared with `{problem.operator}`"


RULE = Rule("invalid-operand", Severity.ERROR, "An operator is used on values that it does not take.", machine=check)
