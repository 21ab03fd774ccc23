# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-value`, which invalid_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal, InvalidOperation

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language.validate import InvalidValue
from roaml.roles import ValueRole
from roaml.rules.rule import FileContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support.impossible_targets import ImpossibleTarget
from roaml.text import TextEdit


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, InvalidValue):
            continue
        attribute, type_ = violation.attribute, violation.type
        if not attribute.value.strip():
            required = "set" if violation.required == "something" else violation.required
            advice = f"; it should be {required}"
            choices = [choice.value for choice in type_.simple.choices if not choice.use]
            new = f'{attribute.name}="{choices[0]}"' if len(choices) == 1 else ""
            fixes = [Fix(f"Write `{new}`", (TextEdit(attribute.span, new),))] if new else []
            yield RULE.at(attribute.span, f"`{attribute.name}` is empty{advice}", *fixes)
        elif type_.value is not ValueRole.ROS_TYPE:  # unknown-ros-type reports these with more detail
            choices = [choice.value for choice in type_.simple.choices if not choice.use]
            close = tuple(choices) if len(choices) == 1 else close_names(attribute.value, choices)
            hint = did_you_mean(close) if len(choices) > 1 else ""
            message = f"`{attribute.name}` should be {violation.required}, not `{attribute.value[:40]}`{hint}"
            facts = ImpossibleTarget() if attribute.name == "prob" and _is_zero(attribute.value) else None
            yield RULE.at(attribute.value_span, message, *replacements(attribute.value_span, close), facts=facts)


def _is_zero(text: str) -> bool:
    try:
        return Decimal(text.strip()) == 0
    except InvalidOperation:
        return False


RULE = Rule(
    "invalid-value", Severity.ERROR, "The value of an attribute is not allowed.", file=check, facts=ImpossibleTarget
)
