# SPDX-License-Identifier: Apache-2.0
"""The rule `length-of-struct`, which length_of_struct.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import LengthOfStruct
from roaml.expr.types import Array, Unknown, leaves
from roaml.rules.rule import MachineContext, Rule
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, LengthOfStruct):
                path, type_ = next(leaves(problem.struct), ((), None))
                first = ".".join(path)
                if isinstance(type_, Array):
                    message = f"`{problem.struct}` is not an array; this is the length of its member `{first}`"
                    fix = Fix(f"Write `.{first}.length`", (TextEdit(problem.span, f"{first}.length"),))
                    yield RULE.at(problem.span, message, fix)
                elif not isinstance(type_, Unknown):
                    message = f"`{problem.struct}` is not an array and has no length"
                    yield RULE.at(problem.span, message, severity=Severity.ERROR)


RULE = Rule("length-of-struct", Severity.INFORMATION, "The length of a struct is read.", machine=check)
