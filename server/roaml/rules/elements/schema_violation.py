# SPDX-License-Identifier: Apache-2.0
"""The rule `schema-violation`, which schema_violation.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.language import HL_SCXML
from roaml.language.validate import SchemaViolation
from roaml.rules.rule import FileContext, Rule


def check(context: FileContext) -> Iterator[Finding]:
    """Report violations of the schema that no other rule explains."""
    for violation in context.violations:
        if isinstance(violation, SchemaViolation) and not _is_reported_elsewhere(context, violation):
            yield RULE.at(violation.element.name_span, f"invalid according to the schema: {violation.reason}")


def _is_reported_elsewhere(context: FileContext, violation: SchemaViolation) -> bool:
    """Whether another rule reports the violation: branch-order the order in an `<if>`, transition-target the siblings
    of a `<target>`."""
    name = violation.element.name
    return context.grammar is HL_SCXML and (name == "if" or name in HL_SCXML.groups["Transition"])


RULE = Rule("schema-violation", Severity.ERROR, "The file violates the schema of its language.", file=check)
