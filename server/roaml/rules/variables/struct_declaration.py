# SPDX-License-Identifier: Apache-2.0
"""The rule `struct-declaration`, which struct_declaration.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.types import BASE_TYPES
from roaml.model.name_forms import VARIABLE
from roaml.model.nesting import MAX_DEPTH, MAX_FIELDS, TypeExtent
from roaml.model.structs import StructDeclaration, struct_cycles, struct_extents
from roaml.model.syntax import Name
from roaml.rules.rule import Rule, StructsContext


def check(context: StructsContext) -> Iterator[Finding]:
    first: dict[str, Name] = {}
    outlines = {outline.name: outline for outline in context.outlines}
    cycles = struct_cycles(outlines)
    sizes = struct_extents(outlines)
    for declaration in context.declarations:
        name = declaration.name
        if name is None:
            continue
        if name.value in BASE_TYPES:
            yield RULE.at(name.span, f"`{name.value}` is a base type and cannot be the name of a struct")
        elif not VARIABLE.match(name.value):
            rule = "it must begin with a letter or `_` and contain only letters, digits and `_`"
            yield RULE.at(name.span, f"`{name.value}` is not a valid struct name: {rule}")
        else:
            yield from _other(context, declaration, first.setdefault(name.value, name))
        if outlines.get(name.value) == declaration.outline:
            yield from _cycles(declaration, name.value, cycles)
        yield from _members(declaration)
        if name.value in sizes and sizes[name.value].is_too_large:
            yield from _too_large(declaration, sizes)


def _other(context: StructsContext, declaration: StructDeclaration, first: Name) -> Iterator[Finding]:
    """Report a second declaration of a struct in this file, or a different declaration in another file of the
    system."""
    name, outline = declaration.name, declaration.outline
    assert name is not None
    same = [other for other in context.outlines if other.name == name.value]
    here = [d for d in context.declarations if d.name and d.name.value == name.value]
    if first is not name:
        message = (
            f"there are two structs `{name.value}`; only the last declaration is used; rename or remove the others"
        )
        yield RULE.at(
            name.span, message, severity=Severity.WARNING, related=(Related(first.span, "the first declaration"),)
        )
    elif len(same) > len(here) and any(other != outline for other in same):
        which = "this" if outline == same[-1] else "the last"
        message = (
            f"there is another struct `{name.value}` in the system, with other members; {which} declaration is used"
        )
        yield RULE.at(name.span, message, severity=Severity.WARNING)


def _cycles(
    declaration: StructDeclaration, name: str, cycles: Mapping[tuple[str, str], tuple[str, ...]]
) -> Iterator[Finding]:
    """Report each cycle once, at the member that closes it."""
    for member in declaration.members:
        cycle = cycles.get((name, member.name.value)) if member.name else None
        if cycle is not None and member.type is not None:
            yield RULE.at(member.type.span, f"a struct cannot contain itself: {' → '.join(cycle)}")


def _too_large(declaration: StructDeclaration, sizes: Mapping[str, TypeExtent]) -> Iterator[Finding]:
    """Report the member that makes a struct too large, or the struct itself if no member contains a struct. Only the
    innermost struct that is too large is reported."""
    assert declaration.name is not None
    types = (m.type for m in declaration.members if m.type and m.type.name)
    inner = [(sizes[type_.name.base], type_) for type_ in types if type_.name and type_.name.base in sizes]
    if any(extent.is_too_large for extent, _ in inner):
        return
    extent = sizes[declaration.name.value]
    largest = max(inner, key=lambda entry: (entry[0].depth, entry[0].fields), default=None)
    amount = f"{extent.fields:,} fields" if extent.fields > MAX_FIELDS else f"{extent.depth:,} nested structs"
    most = f"{MAX_FIELDS:,}" if extent.fields > MAX_FIELDS else f"{MAX_DEPTH}"
    message = f"with all nested members, `{declaration.name.value}` has {amount}, but at most {most} are read"
    yield RULE.at(largest[1].span if largest else declaration.name.span, message)


def _members(declaration: StructDeclaration) -> Iterator[Finding]:
    first: dict[str, Name] = {}
    for member in declaration.members:
        name, type_ = member.name, member.type
        if name is not None:
            if name.value == "length":
                yield RULE.at(name.span, "`length` has a special meaning and cannot be the name of a member")
            elif not VARIABLE.match(name.value) or name.value.endswith("_"):
                rule = "it must begin with a letter or `_`, contain only letters, digits and `_`, and not end in `_`"
                yield RULE.at(name.span, f"`{name.value}` is not a valid member name: {rule}")
            elif first.setdefault(name.value, name) is not name:
                related = (Related(first[name.value].span, "the first member with this name"),)
                message = f"there are two members `{name.value}`; rename one of them"
                yield RULE.at(name.span, message, related=related)
        if type_ is not None and type_.name is not None:
            several = len(type_.name.dimensions) > 1
            if several and type_.name.base not in BASE_TYPES:
                yield RULE.at(
                    type_.span,
                    "an array of structs can have only one dimension; use a struct with an array as its element",
                )


RULE = Rule("struct-declaration", Severity.ERROR, "The declaration of a struct is not valid.", structs=check)
