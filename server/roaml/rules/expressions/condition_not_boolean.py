# SPDX-License-Identifier: Apache-2.0
"""The rule `condition-not-boolean`, which condition_not_boolean.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.tree import Conditional, access_path
from roaml.expr.types import BOOL, Array, ScalarKind, fits, is_kind, is_number
from roaml.model.syntax import Expression
from roaml.model.value_types import CONDITIONS, TypedValue
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.types import phrase
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if value.use in CONDITIONS and not fits(value.type, BOOL):
            span = value.value.tree.span if isinstance(value.value, Expression) else value.value.span
            yield RULE.at(span, f"a condition must be a boolean, not {phrase(value.type)}", *_fixes(value))


def _fixes(value: TypedValue) -> Iterator[Fix]:
    if not isinstance(value.value, Expression) or isinstance(value.value.tree, Conditional):
        return
    tree = value.value.tree
    end = Span(tree.span.end, tree.span.end)
    if is_number(value.type):
        yield Fix("Compare with 0", (TextEdit(end, " != 0"),), preferred=False)
    elif (is_kind(value.type, ScalarKind.STRING) or isinstance(value.type, Array)) and access_path(tree) is not None:
        yield Fix("Test whether the value is not empty", (TextEdit(end, ".length != 0"),), preferred=False)


RULE = Rule("condition-not-boolean", Severity.ERROR, "A condition is not a boolean.", machine=check)
