# SPDX-License-Identifier: Apache-2.0
"""The rule `type-mismatch`, which type_mismatch.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import DivisionByZero, infer
from roaml.expr.tree import ArrayLiteral, Expr, Name, Number, ObjectLiteral, String, walk
from roaml.expr.types import Array, Scalar, ScalarKind, Struct, Type, Unknown, fits, is_kind, is_number, leaves, unwrap
from roaml.model.initial import WrongType
from roaml.model.syntax import Expression, PortRead
from roaml.model.value_types import HOLDING, TypedValue, ValueUse
from roaml.model.vocabulary import DEFAULT_TYPES
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.divisors import possible_zeros
from roaml.rules.support.retype import as_type
from roaml.rules.support.types import phrase
from roaml.text import Span, TextEdit

CHECKED = (ValueUse.ASSIGNED, ValueUse.FIELD, ValueUse.ARGUMENT, ValueUse.OUTPUT)


def check(context: MachineContext) -> Iterator[Finding]:
    size = context.system.parameters.max_array_size if context.system else None
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, WrongType):
                message = f"{_what(value)} must be `{problem.required}`, not {phrase(problem.given)}"
                yield RULE.at(
                    problem.span, message, *_fixes(context, value, problem.given, problem.required, problem.span)
                )
        if value.use is ValueUse.PARAMETER and isinstance(value.value, Expression):
            yield from _too_long(value.value.tree, value.type, size)
        if value.required is None:
            continue
        if (value.use in CHECKED or isinstance(value.value, PortRead)) and not can_hold(value.required, value.type):
            yield _mismatch(context, value, value.required)
        if value.use in HOLDING and isinstance(value.value, Expression):
            yield from _too_long(value.value.tree, value.required, size)


def can_hold(required: Type, given: Type) -> bool:
    """Whether a value of the type `given` fits where the type `required` is needed. Structs are assigned leaf by leaf,
    so a struct with the same leaves fits as well."""
    inner, bounds = unwrap(required)
    other, more = unwrap(given)
    if isinstance(inner, Struct) and isinstance(other, Struct) and len(bounds) == len(more):
        known = dict(leaves(other))
        return all(path in known and fits(known[path], leaf) for path, leaf in leaves(inner))
    return fits(given, required)


def _mismatch(context: MachineContext, value: TypedValue, required: Type) -> Finding:
    message = f"{_what(value)} must be `{required}`, not {phrase(value.type)}"
    edits = _without_points(context, value, required)
    if not edits:
        return RULE.at(value.value.span, message, *_fixes(context, value, value.type, required, value.value.span))
    new = "remove `.0`" if len(edits) == 1 else "remove each `.0`"
    fix = Fix(new.capitalize(), tuple(edits))
    return RULE.at(value.value.span, f"{message}; {new}", fix, severity=Severity.WARNING)


def _without_points(context: MachineContext, value: TypedValue, required: Type) -> list[TextEdit]:
    """The edits that write a real value as the integer to which the translation converts it
    (docs/spec/expressions.md#whole-reals); empty if the translation does not convert it."""
    if not isinstance(value.value, Expression):
        return []
    tree = value.value.tree
    reals = [node for node in walk(tree) if isinstance(node, Number) and node.is_real]
    points = [node for node in reals if float(node.value).is_integer()]
    if not points or points != reals or any(isinstance(n, Name) and n.name.startswith("_") for n in walk(tree)):
        return []
    variables = context.typed.variables.get(value.place.chart.scope, {})
    reprinted, _ = infer(tree, variables.get, reprinted=True)
    if isinstance(reprinted, Unknown) or not fits(reprinted, required):
        return []
    return [TextEdit(node.span, str(int(node.value))) for node in points]


def _too_long(tree: Expr, required: Type, size: int | None) -> Iterator[Finding]:
    """Report arrays with more elements, and strings with more bytes, than the variable can hold. `size` is the number
    of elements of an array without a bound and of bytes of a string; `None` if it is unknown."""
    match tree, required:
        case ArrayLiteral(), Array():
            yield from _longer(tree.span, f"`{required}` holds", "elements", len(tree.elements), required.bound or size)
            for element in tree.elements:
                yield from _too_long(element, required.element, size)
        case ObjectLiteral(), Struct():
            for member in tree.members:
                type_ = required.member(member.key)
                if type_ is not None:
                    yield from _too_long(member.value, type_, size)
        case String(), _ if is_kind(required, ScalarKind.STRING):
            length = len(tree.value.encode("utf-8", "replace"))
            yield from _longer(tree.span, "a string holds", "bytes", length, size)


def _longer(span: Span, holder: str, parts: str, length: int, most: int | None) -> Iterator[Finding]:
    if most is not None and length > most:
        yield RULE.at(span, f"{holder} at most {most} {parts}, not {length}")


def _what(value: TypedValue) -> str:
    target = f" `{value.target}`" if value.target else ""
    match value.use:
        case ValueUse.FIELD:
            return f"the field{target}"
        case ValueUse.OUTPUT:
            return f"the port{target}"
        case ValueUse.ARGUMENT | ValueUse.ASSIGNED | ValueUse.LOCATION:
            return target.strip() or "this"
        case ValueUse.BOUND:
            return f"a bound of{target}"
    return f"the variable{target}"


def _fixes(context: MachineContext, value: TypedValue, given: Type, required: Type, span: Span) -> Iterator[Fix]:
    """Fixes that rewrite the value, or change the type of the variable to the type of the value."""
    if not isinstance(value.value, Expression) or _divides_by_zero(context, value):
        return
    is_whole_value = span == value.value.span
    if is_whole_value:
        yield from _other_value(value.value, value.use, given, required)
    if is_whole_value and is_number(given) and is_number(required) and isinstance(given, Scalar):
        yield from as_type(context, value, given.name or DEFAULT_TYPES[given.kind])


def _divides_by_zero(context: MachineContext, value: TypedValue) -> bool:
    """Whether a divisor is or can be 0: then another type or a rounded value does not help."""
    return any(isinstance(p, DivisionByZero) for p in value.problems) or any(possible_zeros(context, value))


def _other_value(value: Expression, use: ValueUse, given: Type, required: Type) -> Iterator[Fix]:
    span, text = value.span, value.text.strip()
    if isinstance(value.tree, String) and is_number(required) | is_kind(required, ScalarKind.BOOL):
        written, pattern = value.tree.value, r"-?\d+" if is_kind(required, ScalarKind.INT) else r"-?\d+(\.\d+)?"
        if re.fullmatch("true|false" if is_kind(required, ScalarKind.BOOL) else pattern, written):
            yield Fix(f"Change to `{written}`", (TextEdit(span, written),))
    if is_kind(given, ScalarKind.REAL) and is_kind(required, ScalarKind.INT):
        if text.endswith(".0") and text[:-2].isdigit():
            yield Fix(f"Change to `{text[:-2]}`", (TextEdit(span, text[:-2]),))
        elif use not in (ValueUse.INITIAL, ValueUse.BOUND):
            edits = (TextEdit(Span(span.start, span.start), "Math.floor("), TextEdit(Span(span.end, span.end), ")"))
            yield Fix(f"Change to `Math.floor({text})`", edits)
    elif is_kind(given, ScalarKind.INT) and is_kind(required, ScalarKind.REAL) and text.removeprefix("-").isdigit():
        yield Fix(f"Change to `{text}.0`", (TextEdit(span, f"{text}.0"),))
    elif is_kind(given, ScalarKind.INT) and is_kind(required, ScalarKind.BOOL) and text in ("0", "1"):
        literal = "true" if text == "1" else "false"
        yield Fix(f"Change to `{literal}`", (TextEdit(span, literal),))


RULE = Rule("type-mismatch", Severity.ERROR, "The type of a value does not match.", machine=check)
