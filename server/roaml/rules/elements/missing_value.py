# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-value`, which missing_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.types import Array, Scalar, Type
from roaml.expr.zero import zero_text
from roaml.language import HL_SCXML
from roaml.language.validate import misspelled_attribute
from roaml.model.machine import Assign, Param, RosSend, Send
from roaml.model.syntax import Value
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        types = context.typed.variables.get(chart.scope, {})
        for data in chart.data:
            if data.id is not None and is_missing(data.element, data.value):
                message = f"the variable `{data.id.value}` has no initial value; add `expr`"
                yield RULE.at(data.element.name_span, message, *_fix(data.element, types.get(data.id.value)))
        for statement in chart.statements:
            match statement:
                case Assign(value=value) if is_missing(statement.element, value):
                    target = f" for `{statement.location.text}`" if statement.location else ""
                    yield RULE.at(statement.element.name_span, f"the value{target} is missing; add `expr`")
                case Send(params=params) | RosSend(fields=params):
                    for param in params:
                        if param.name is not None and is_missing(param.element, param.value):
                            yield _param(param, param.name.value)


def is_missing(element: Element, value: Value | None) -> bool:
    """Whether an element has no value, and no attribute that may be an incomplete or misspelled value."""
    if value is not None or element.get("expr") is not None:
        return False
    return not misspelled_attribute(element, "expr", HL_SCXML.elements[element.name].attributes)


def _param(param: Param, name: str) -> Finding:
    location = param.element.get("location")
    if location is None:
        return RULE.at(param.element.name_span, f"the value of `{name}` is missing; add `expr`")
    fix = Fix("Change to `expr`", (TextEdit(location.name_span, "expr"),))
    return RULE.at(
        param.element.name_span, f"the value of `{name}` is missing; write `expr` instead of `location`", fix
    )


def _fix(element: Element, type_: Type | None) -> Iterator[Fix]:
    if isinstance(type_, (Scalar, Array)) and element.find("expr") is None:
        value = zero_text(type_)
        at = element.attributes[-1].span.end if element.attributes else element.name_span.end
        yield Fix(f'Add `expr="{value}"`', (TextEdit(Span(at, at), f' expr="{value}"'),))


RULE = Rule("missing-value", Severity.ERROR, "A value is missing.", machine=check)
