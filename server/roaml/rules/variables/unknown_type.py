# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-type`, which unknown_type.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.types import BASE_TYPES, parse_type
from roaml.model.syntax import TypeRef
from roaml.model.vocabulary import FOREIGN_TYPES
from roaml.rules.rule import MachineContext, Rule, StructsContext, close_names, did_you_mean, replacements


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for data in chart.data:
            if data.type is not None:
                alone = context.system is None
                yield from unknown(data.type, context.struct_names, complete=context.all_structs, alone=alone)


def check_structs(context: StructsContext) -> Iterator[Finding]:
    names = [outline.name for outline in context.outlines]
    for declaration in context.declarations:
        for member in declaration.members:
            if member.type is not None:
                yield from unknown(member.type, names, complete=context.complete)


def unknown(type_: TypeRef, structs: Iterable[str], *, complete: bool, alone: bool = False) -> Iterator[Finding]:
    """The findings for a type that does not exist; none if the type is valid or may be a struct that cannot be read.

    Args:
        structs: the names of the known structs.
        complete: whether these are all structs; otherwise some declarations cannot be read.
        alone: whether the machine is checked without a system, so that its structs are unknown.
    """
    if type_.name is None:
        yield _no_type(type_)
        return
    known = [*BASE_TYPES, *structs]
    base = type_.name.base
    if base not in known and (complete or base in FOREIGN_TYPES):
        close = (FOREIGN_TYPES[base],) if base in FOREIGN_TYPES else close_names(base, known)
        brackets = type_.text[len(base) :]
        fixes = replacements(type_.span, [name + brackets for name in close])
        if alone and not close:
            message = f"there is no type `{base}`, unless it is a struct of a system: no system lists this file"
            yield RULE.at(type_.span, message, severity=Severity.INFORMATION)
        else:
            hint = did_you_mean(close) or "; use a type such as `int32` or `float64[3]`, or declare the struct"
            yield RULE.at(type_.span, f"there is no type `{base}`{hint}", *fixes)
    elif 0 in type_.name.dimensions:
        message = "an array must have at least one element; write a bound greater than 0, or `[]` for no bound"
        yield RULE.at(type_.span, message, *replacements(type_.span, [re.sub(r"\[0+\]", "[]", type_.text)]))


def _no_type(type_: TypeRef) -> Finding:
    close = "".join(type_.text.split())
    if parse_type(close) is not None:
        fixes = replacements(type_.span, (close,))
        return RULE.at(type_.span, f"`{type_.text}` is not a type{did_you_mean((close,))}", *fixes)
    if "/" in type_.text:
        message = (
            f"`{type_.text}` is a ROS type; the types of variables are base types and structs of `<data_declarations>`"
        )
        return RULE.at(type_.span, message)
    return RULE.at(
        type_.span,
        f"`{type_.text}` is not a type; valid types are for example `int32`, `Point`, `float64[3]`, `int8[][]`",
    )


RULE = Rule("unknown-type", Severity.ERROR, "A type does not exist.", machine=check, structs=check_structs)
