# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-type`, which missing_type.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import infer
from roaml.expr.types import Scalar, unwrap
from roaml.language import HL_SCXML
from roaml.language.validate import misspelled_attribute
from roaml.model.machine import Data
from roaml.model.syntax import Expression
from roaml.model.vocabulary import DEFAULT_TYPES
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Span, TextEdit

KNOWN = HL_SCXML.elements["data"].attributes


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for data in chart.data:
            if data.type is None and data.id is not None and not misspelled_attribute(data.element, "type", KNOWN):
                span = data.id.span
                message = f"the variable `{data.id.value}` has no type; add `type`"
                yield RULE.at(span, message, *_fix(data))


def _fix(data: Data) -> Iterator[Fix]:
    """A fix that adds the type that the initial value suggests."""
    attribute, type_ = data.element.get("id"), _type_of_value(data)
    if type_ is None or attribute is None or not attribute.has_value:
        return
    empty, at = data.element.get("type"), attribute.span.end
    if empty is None:
        yield Fix(f'Add `type="{type_}"`', (TextEdit(Span(at, at), f' type="{type_}"'),))
    else:
        yield Fix(f'Write `type="{type_}"`', (TextEdit(empty.span, f'type="{type_}"'),))


def _type_of_value(data: Data) -> str | None:
    if not isinstance(data.value, Expression) or data.value.broken:
        return None
    element, bounds = unwrap(infer(data.value.tree, lambda _: None)[0])
    return DEFAULT_TYPES[element.kind] + "[]" * len(bounds) if isinstance(element, Scalar) else None


RULE = Rule("missing-type", Severity.ERROR, "A variable has no type.", machine=check)
