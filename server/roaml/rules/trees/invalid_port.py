# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-port`, which invalid_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import remove, rename_tag
from roaml.expr.types import BASE_TYPES, ScalarKind
from roaml.model.machine import Port
from roaml.model.syntax import Name, TypeRef
from roaml.model.system import CHILDREN_COUNT
from roaml.model.vocabulary import FOREIGN_TYPES
from roaml.regex import regex
from roaml.roles import Direction
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements

ATTRIBUTE = regex(r"[^\W\d][\w.-]*\Z")
"""The pattern of port names: ports are attributes in the tree."""


def check(context: MachineContext) -> Iterator[Finding]:
    first: dict[str, Name] = {}
    for port in context.machine.ports:
        if port.key is not None:
            before = first.setdefault(port.key.value, port.key)
            if before is not port.key:
                related = (Related(before.span, "the first declaration"),)
                fix = remove(context.document, port.element, "Remove this declaration")
                yield RULE.at(
                    port.key.span,
                    f"there are two ports `{port.key.value}`; remove or rename one of them",
                    fix,
                    related=related,
                )
            yield from _key(port, port.key)
        written = port.element.get("type")
        if port.type is not None:
            yield from _type(context, port.type)
        elif written is not None:
            yield RULE.at(written.span, "the type of the port is empty; set `type`")


def _key(port: Port, key: Name) -> Iterator[Finding]:
    if not ATTRIBUTE.match(key.value):
        yield RULE.at(key.span, f"a tree cannot set `{key.value}`: it is not a valid attribute name")
    elif key.value == CHILDREN_COUNT:
        if port.direction is Direction.OUT:
            to_input = rename_tag(port.element, "bt_declare_port_in")
            yield RULE.at(key.span, f"`{CHILDREN_COUNT}` is set by the tree, so it must be an input port", to_input)
        elif (
            port.type is not None
            and port.type.text in BASE_TYPES
            and BASE_TYPES[port.type.text].kind is not ScalarKind.INT
        ):
            fixes = replacements(port.type.span, ["int32"])
            yield RULE.at(port.type.span, f"`{CHILDREN_COUNT}` must be an integer, not `{port.type.text}`", *fixes)


def _type(context: MachineContext, type_: TypeRef) -> Iterator[Finding]:
    if type_.text in BASE_TYPES:
        return
    base = type_.name.base if type_.name else type_.text
    if base in BASE_TYPES or base in context.struct_names:
        yield RULE.at(type_.span, "a port holds a single value, so arrays and structs are not supported")
        return
    # A name like `Point` is the name of a struct, not a misspelled base type.
    is_struct = base[:1].isupper() and base.lower() not in BASE_TYPES and base not in FOREIGN_TYPES
    candidates = close_names(base, () if is_struct else BASE_TYPES)
    close = (FOREIGN_TYPES[base],) if base in FOREIGN_TYPES else candidates
    hint = did_you_mean(close) or "; a port is a `bool`, a `string`, or has an integer or float type"
    yield RULE.at(type_.span, f"there is no type `{type_.text}`{hint}", *replacements(type_.span, close))


RULE = Rule(
    "invalid-port",
    Severity.ERROR,
    "A port is declared twice, or with an invalid name, direction or type.",
    machine=check,
)
