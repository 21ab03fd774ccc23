# SPDX-License-Identifier: Apache-2.0
"""The rule `jani-type`, which jani_type.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.types import Scalar, ScalarKind, Type, unwrap
from roaml.jani.infer import TypeScope
from roaml.jani.notes import TYPE
from roaml.jani.typecheck import check_property
from roaml.jani.types import BOOL, INT, REAL, ArrayType, UnknownType
from roaml.jani.types import Type as JaniType
from roaml.rules.rule import PropertiesContext, Rule


def check(context: PropertiesContext) -> Iterator[Finding]:
    if context.variables is None:
        return
    scope = TypeScope({variable.name: _jani_type(variable.type) for variable in context.variables.values()})
    for property_ in context.properties:
        yield from (finding for finding in check_property(property_, scope) if finding.code == TYPE)


_KINDS = {ScalarKind.BOOL: BOOL, ScalarKind.INT: INT, ScalarKind.REAL: REAL}


def _jani_type(type_: Type) -> JaniType:
    element, bounds = unwrap(type_)
    jani_type: JaniType = _KINDS.get(element.kind, UnknownType()) if isinstance(element, Scalar) else UnknownType()
    for _ in bounds:
        jani_type = ArrayType(jani_type)
    return jani_type


RULE = Rule(
    TYPE,
    Severity.ERROR,
    "In a property, the types of the operands do not fit their operator.",
    properties=check,
)
