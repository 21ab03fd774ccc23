# SPDX-License-Identifier: Apache-2.0
"""Translates expressions of HL-SCXML to plain SCXML (docs/spec/plain-scxml.md#expressions). Event variables are
renamed, structs are flattened, and indices follow the whole name.

- `a[i].b[j].c` becomes `a__b__c[i][j]`, `_msg.pose.x` becomes `_event.data.ros_fields__pose__x`, and `points.length`
  becomes `points__x.length`.
- The value of a struct becomes one value for each leaf.
- `2.0` becomes `2`, as in the reference translator (docs/spec/expressions.md#whole-reals).
"""

from __future__ import annotations

from collections.abc import Mapping

from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Index,
    Member,
    Name,
    Number,
    ObjectLiteral,
    Unary,
)
from roaml.expr.types import UNKNOWN, Array, Type, leaves, member_type
from roaml.lower.build import event_data, indexed, integer, length, name
from roaml.record import Record, replace
from roaml.scxml.names import FIELD_PREFIX
from roaml.text import Span

SEPARATOR = "__"
Path = tuple[str, ...]


class LoweringScope(Record, frozen=True):
    """The names that expressions in one place can use.

    Attributes:
        variables: variable of the machine -> its type.
        event: event variable (`_msg`, `_event`, ...) -> its type.
        constants: name of a number, such as `SUCCESS` in the condition of `<bt_child_status>` -> the number.
    """

    variables: Mapping[str, Type]
    event: Mapping[str, Type]
    constants: Mapping[str, int]


class AccessedVariable(Record, frozen=True):
    """A variable or parameter, or a part of one, to which an expression refers.

    Attributes:
        event: whether it is data of an event.
        names: the variable, followed by the members that are accessed.
        indexes: the lowered indices, in order.
        length: whether the `.length` of the part is accessed.
        type: the type of the part, without `.length`.
    """

    span: Span
    event: bool
    names: Path
    indexes: tuple[Expr, ...]
    length: bool
    type: Type

    def leaf(self, path: Path = ()) -> Expr:
        """The plain expression for the leaf at `path`."""
        identifier = SEPARATOR.join((*self.names, *path))
        variable = event_data(identifier, self.span) if self.event else name(identifier, self.span)
        expr = indexed(variable, self.indexes, self.span)
        return length(expr, self.span) if self.length else expr


def lower_expr(expr: Expr, scope: LoweringScope) -> Expr:
    """The plain expression for a value that is not a struct."""
    match expr:
        case Number():
            return integer(int(expr.value), expr.span) if expr.is_real and expr.is_whole else expr
        case Name() if expr.name in scope.constants:
            return integer(scope.constants[expr.name], expr.span)
        case Name() | Member() | Index():
            access = access_of(expr, scope)
            return access.leaf(first_leaf(access.type)) if access is not None else _lower_part(expr, scope)
        case Binary():
            left, right = lower_expr(expr.left, scope), lower_expr(expr.right, scope)
            return Binary(expr.span, expr.operator, expr.operator_span, left, right)
        case Unary():
            return Unary(expr.span, expr.operator, lower_expr(expr.operand, scope))
        case Call():
            return Call(expr.span, expr.function, tuple(lower_expr(argument, scope) for argument in expr.arguments))
        case Conditional():
            test, then, otherwise = (lower_expr(part, scope) for part in (expr.test, expr.then, expr.otherwise))
            return Conditional(expr.span, test, then, otherwise)
        case ArrayLiteral():
            return ArrayLiteral(expr.span, tuple(lower_expr(item, scope) for item in expr.elements))
        case ObjectLiteral() | ErrorExpr():
            raise AssertionError("a rule reports what cannot be lowered")
        case _:
            return expr


def _lower_part(expr: Name | Member | Index, scope: LoweringScope) -> Expr:
    """The plain expression for a part of a value that is not a variable, such as `'abc'.length`."""
    chosen = _chosen_part(expr)
    if chosen is not None:
        return lower_expr(chosen, scope)
    match expr:
        case Member():
            return replace(expr, object=lower_expr(expr.object, scope))
        case Index():
            return Index(expr.span, lower_expr(expr.object, scope), lower_expr(expr.index, scope))
    return expr


def _chosen_part(expr: Expr) -> Conditional | None:
    """`b ? p.x : q.x` for an expression of the form `(b ? p : q).x`; `None` for other forms. In plain SCXML, only
    variables have parts."""
    match expr:
        case Conditional():
            return expr
        case Member() | Index() if (chosen := _chosen_part(expr.object)) is not None:
            then, otherwise = replace(expr, object=chosen.then), replace(expr, object=chosen.otherwise)
            return Conditional(expr.span, chosen.test, then, otherwise)
    return None


def lower_leaves(expr: Expr, scope: LoweringScope, type_: Type) -> list[tuple[Path, Expr]]:
    """The paths of the leaves of a value with their plain expressions. A value that is not a struct has one leaf, with
    an empty path.

    Args:
        type_: the type that is required for the value.
    """
    chosen = _chosen_part(expr)
    if chosen is not None:
        test = lower_expr(chosen.test, scope)
        parts = zip(lower_leaves(chosen.then, scope, type_), lower_leaves(chosen.otherwise, scope, type_), strict=False)
        return [(path, Conditional(expr.span, test, then, otherwise)) for (path, then), (_, otherwise) in parts]
    if isinstance(expr, ArrayLiteral) and not expr.elements:
        return [(path, expr) for path, _ in leaves(type_)]
    access = access_of(expr, scope)
    if access is not None and not access.length:
        return [(path, access.leaf(path)) for path, _ in leaves(access.type)]
    return [((), lower_expr(expr, scope))]


def first_leaf(type_: Type) -> Path:
    """The path of the first leaf of a struct; empty for other types."""
    return next((path for path, _ in leaves(type_)), ())


def access_of(expr: Expr, scope: LoweringScope) -> AccessedVariable | None:
    """The variable, or the part of one, to which `expr` refers; `None` if `expr` is not a chain of members and indices
    that begins with a name."""
    steps: list[Member | Index] = []
    root = expr
    while isinstance(root, (Member, Index)):
        steps.append(root)
        root = root.object
    if not isinstance(root, Name):
        return None
    steps.reverse()
    is_event = root.name in scope.event or root.name == "_event"
    type_ = (scope.event if is_event else scope.variables).get(root.name, UNKNOWN)
    names: list[str] = []
    indexes: list[Expr] = []
    ends_with_length = False
    for step in steps:
        if isinstance(step, Index):
            indexes.append(lower_expr(step.index, scope))
            type_ = type_.element if isinstance(type_, Array) else UNKNOWN
        elif step is steps[-1] and step.name == "length" and member_type(type_, "length") is None:
            ends_with_length = True
        else:
            names.append(step.name)
            type_ = member_type(type_, step.name) or UNKNOWN
    path = _event_parameter(root.name, names) if is_event else (root.name, *names)
    return AccessedVariable(expr.span, is_event, path, tuple(indexes), ends_with_length, type_)


def _event_parameter(variable: str, names: list[str]) -> Path:
    """The path of the event parameter to which an event variable with the members `names` refers
    (docs/spec/machines.md#event-variables)."""
    match variable:
        case "_event":
            return tuple(names[1:])
        case "_action" | "_bt":
            return tuple(names)
        case "_wrapped_result" if names[:1] == ["code"]:
            return tuple(names)
        case "_wrapped_result":
            names = names[1:]
    first, *rest = names or [""]
    return (FIELD_PREFIX + first, *rest)
