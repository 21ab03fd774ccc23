# SPDX-License-Identifier: Apache-2.0
"""The rule `duplicate-field`, which duplicate_field.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import removal
from roaml.model.machine import Param, RosSend, Send
from roaml.model.syntax import Name
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            match statement:
                case RosSend():
                    yield from _twice(context, statement.fields, "field")
                case Send():
                    yield from _twice(context, statement.params, "parameter")


def _twice(context: MachineContext, params: tuple[Param, ...], kind: str) -> Iterator[Finding]:
    """Report fields or parameters that are set twice; in the translation, `a.b` and `a__b` are the same name
    (docs/spec/plain-scxml.md#flattening)."""
    first: dict[str, Name] = {}
    for param in params:
        if param.name is None:
            continue
        before = first.setdefault(param.name.value.replace(".", "__"), param.name)
        if before is not param.name:
            again = "" if before.value == param.name.value else f" (as `{before.value}`)"
            yield RULE.at(
                param.name.span,
                f"the {kind} `{param.name.value}` is set twice{again}; set it only once",
                Fix(f"Remove this {kind}", (removal(context.source.text, param.element.span),), preferred=False),
                related=(Related(before.span, "set first here"),),
            )


RULE = Rule("duplicate-field", Severity.ERROR, "A field or parameter is set twice.", machine=check)
