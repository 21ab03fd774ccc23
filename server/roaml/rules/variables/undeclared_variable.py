# SPDX-License-Identifier: Apache-2.0
"""The rule `undeclared-variable`, which undeclared_variable.md describes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import first_in, last_in
from roaml.expr.infer import UnknownName, infer
from roaml.expr.operators import Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import Binary, Conditional, Expr, Name, Unary
from roaml.expr.types import BOOL, Scalar, Type
from roaml.expr.zero import zero_text
from roaml.model.machine import Chart
from roaml.model.syntax import Expression
from roaml.model.value_types import CONDITIONS, TypedValue, ValueUse
from roaml.model.vocabulary import DEFAULT_TYPES
from roaml.rules.rule import MachineContext, Rule, close_names, replacements
from roaml.rules.support import misspelled
from roaml.scxml.names import STATUSES
from roaml.suggest import alternatives

LITERALS = {"True": "true", "False": "false", "TRUE": "true", "FALSE": "false"}
NO_VALUES = ("null", "undefined", "NaN", "Infinity", "None")


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, UnknownName) and not problem.name.startswith("_"):
                finding = _finding(context, value, problem)
                if finding is not None:
                    yield finding


def _finding(context: MachineContext, value: TypedValue, problem: UnknownName) -> Finding | None:
    name = problem.name
    if name in LITERALS:
        literal = LITERALS[name]
        return RULE.at(
            problem.span, f"there is no `{name}`; write `{literal}`", *replacements(problem.span, (literal,))
        )
    if name in NO_VALUES:
        return RULE.at(problem.span, f"there is no `{name}`: every variable always has a value of its type")
    variables = context.typed.variables.get(value.place.chart.scope, {})
    if value.use in (ValueUse.INITIAL, ValueUse.BOUND):
        subject = f"the variable `{name}`" if name in variables else f"a name like `{name}`"
        what = "a bound" if value.use is ValueUse.BOUND else "an initial value"
        return RULE.at(problem.span, f"{what} must be constant; it cannot use {subject}")
    if name in STATUSES:
        number = str(STATUSES[name])
        message = f"`{name}` is only available in the condition of `<bt_child_status>`; write `{number}`"
        return RULE.at(problem.span, message, *replacements(problem.span, (number,)))
    if misspelled.declaration(context.machine, "data", name):
        return None
    close = close_names(name, [*variables, *_answers(value)])
    known = [name for name in variables if not name.startswith("_")]
    hint = alternatives(close, known, "variable") or "; declare it with `<data>`"
    message = f"there is no variable `{name}`{hint}"
    if not close and any(name in known for known in context.typed.variables.values()):
        message = f"`{name}` is not available here: the machine and each of its threads have separate variables"
    return RULE.at(problem.span, message, *replacements(problem.span, close), *_declare(context, value, name))


def _answers(value: TypedValue) -> Iterable[str]:
    """The names of the statuses of a child where expressions can use them; otherwise empty."""
    handler = value.place.handler
    is_known = (
        value.use is ValueUse.CONDITION and handler is not None and any(b.name == "_bt" for b in handler.type.binds)
    )
    return STATUSES if is_known else ()


def _declare(context: MachineContext, value: TypedValue, name: str) -> Iterator[Fix]:
    """A fix that declares the variable, if its type can be inferred from its uses."""
    type_ = inferred_type(context, value, name)
    if type_ is not None:
        yield declaration(context, value.place.chart, name, str(type_), zero_text(type_))


def inferred_type(context: MachineContext, value: TypedValue, name: str) -> Scalar | None:
    """The base type of an undeclared name, inferred from its use in `value`: the value assigned to it, the variable
    that it is assigned to, or the operands next to it. `None` if the type cannot be inferred."""
    if not isinstance(value.value, Expression):
        return None
    tree = value.value.tree
    if isinstance(tree, Name) and tree.name == name:
        if value.use is not ValueUse.LOCATION:
            return _named(value.required)
        assigned = (v for v in context.typed.values if v.use is ValueUse.ASSIGNED and v.element is value.element)
        return next((_named(v.type) for v in assigned), None)
    variables = context.typed.variables.get(value.place.chart.scope, {})
    return _beside(tree, name, variables.get, BOOL if value.use in CONDITIONS else value.required)


def _beside(tree: Expr, name: str, variables: Callable[[str], Type | None], required: Type | None) -> Scalar | None:
    """The type of a name inside an expression that should have the type `required`."""
    match tree:
        case Name(name=written) if written == name:
            return _named(required)
        case Unary(operator=operator, operand=operand):
            is_not = operator is UnaryOperator.NOT
            return _beside(operand, name, variables, BOOL if is_not else required)
        case Binary(operator=Operator.AND | Operator.OR, left=left, right=right):
            return _beside(left, name, variables, BOOL) or _beside(right, name, variables, BOOL)
        case Binary(operator=operator, left=left, right=right):
            result_type = required if operator.kind is OperatorKind.ARITHMETIC else None
            types = (_closer(infer(side, variables)[0], result_type) for side in (right, left))
            found_types = (
                _beside(side, name, variables, type_) for side, type_ in zip((left, right), types, strict=True)
            )
            return next((type_ for type_ in found_types if type_), None)
        case Conditional(test=test, then=then, otherwise=otherwise):
            return _beside(test, name, variables, BOOL) or next(
                (type_ for side in (then, otherwise) if (type_ := _beside(side, name, variables, required))), None
            )
    return None


def _closer(beside: Type, result_type: Type | None) -> Type:
    """The more reliable of two types: the type of the other operand or, if that operand is a literal, the type of the
    result."""
    if (
        isinstance(beside, Scalar)
        and not beside.name
        and isinstance(result_type, Scalar)
        and result_type.kind == beside.kind
    ):
        return result_type
    return beside


def _named(type_: Type | None) -> Scalar | None:
    """The base type to declare for a scalar type: the type itself or, if it has no name, the default type of its kind.
    `None` for other types."""
    if not isinstance(type_, Scalar):
        return None
    return type_ if type_.name else Scalar(type_.kind, DEFAULT_TYPES[type_.kind])


def declaration(context: MachineContext, chart: Chart, name: str, type_: str, value: str) -> Fix:
    """A fix that adds a `<data>` to the datamodel of a chart, which is created if there is none."""
    data = f'<data id="{name}" type="{type_}" expr="{value}" />'
    model = chart.element.find("datamodel")
    if model is None:
        edit = first_in(context.document, chart.element, "<datamodel>", f"    {data}", "</datamodel>")
    else:
        edit = last_in(context.document, model, data)
    return Fix(f"Declare `{name}` as {type_}", (edit,), preferred=False)


RULE = Rule("undeclared-variable", Severity.ERROR, "A variable is used but not declared.", machine=check)
