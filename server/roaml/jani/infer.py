# SPDX-License-Identifier: Apache-2.0
"""Infers the types of expressions and formulas, and reports type errors and undeclared names in them.

- The findings have the codes `jani-name` and `jani-type`. Their positions are the origins of the nodes.
- A part with a reported error has the type `UNKNOWN` and causes no further findings.
- An int can be used as a real; there is no other conversion (`types.fits`). Equality of arrays and nested path formulas
  are accepted, although most tools support neither.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.deep import Steps
from roaml.jani.expressions import (
    ArrayAccess,
    ArrayConstructor,
    ArrayValue,
    Binary,
    Boolean,
    Call,
    Conditional,
    DatatypeAccess,
    DatatypeValue,
    Derivative,
    EmptyOption,
    Expression,
    Integer,
    Missing,
    Name,
    NamedNumber,
    OptionAccess,
    OptionValue,
    Real,
    Sample,
    Selection,
    Unary,
)
from roaml.jani.model import Datatype, Function
from roaml.jani.node import Node
from roaml.jani.notes import Notes
from roaml.jani.operators import BinaryOperator, Operator, Signature
from roaml.jani.properties import (
    BinaryFormula,
    BinaryPath,
    ConditionalFormula,
    Expectation,
    Filter,
    FilterFunction,
    Formula,
    Interval,
    PathBounds,
    Predicate,
    Probability,
    ProperFormula,
    Quantified,
    SteadyState,
    UnaryFormula,
    UnaryPath,
)
from roaml.jani.types import (
    BOOL,
    INT,
    REAL,
    UNKNOWN,
    ArrayType,
    DatatypeType,
    OptionType,
    Type,
    UnknownType,
    describe,
    fits,
    is_number,
    join,
    value_type,
)
from roaml.record import Record, field
from roaml.text import Span


class TypeScope(Record, frozen=True):
    """The names that can be used in one place of a model. `variables` also contains constants and parameters; the names
    in `constants` cannot be assigned to."""

    variables: Mapping[str, Type]
    functions: Mapping[str, Function] = field(default_factory=dict)
    datatypes: Mapping[str, Datatype] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()


class PathKind(enum.Enum):
    """The kind of a path formula, which has no type: it holds on a path, not in a state."""

    PATH = "path"


PATH = PathKind.PATH

Kind: TypeAlias = Type | PathKind
Bound: TypeAlias = Mapping[str, Type]
"""The types of the names that enclosing expressions declare, such as the variable of an array constructor."""


_LITERAL_TYPES: dict[type, Type] = {
    Integer: INT,
    Real: REAL,
    Boolean: BOOL,
    NamedNumber: REAL,
    Missing: UNKNOWN,
}
"""The types of the expressions whose type depends on their class only."""


class Inference:
    """Infers types in `scope`, and collects the errors."""

    def __init__(self, scope: TypeScope) -> None:
        self.scope = scope
        self.notes = Notes()

    def expect(self, node: Formula, kind: Kind, target: Type, subject: str) -> None:
        """Report `node` if its kind or type `kind` does not fit `target`. `subject` is a phrase for `node` in the
        message."""
        if isinstance(kind, PathKind):
            self.notes.type(span_of(node), f"{subject} cannot be a path formula; use it in `Pmin` or `Pmax`")
        elif not fits(kind, target):
            needed = "true or false" if target is BOOL else "a number" if target is REAL else describe(target)
            self.notes.type(span_of(node), f"{subject} must be {needed}, not {describe(kind)}")

    # ---------------------------------------------------------------- expressions

    def type(self, node: Expression, bound: Bound) -> Steps[Type] | Type:
        if isinstance(node, Name):
            return self.name(node, node.identifier, bound)
        literal = _LITERAL_TYPES.get(type(node))
        return self._type(node, bound) if literal is None else literal

    def _type(self, node: Expression, bound: Bound) -> Steps[Type]:
        match node:
            case Unary(operator, operand):
                return self.apply(node, operator, [(operand, (yield self.type(operand, bound)))])
            case Binary(operator, left, right):
                left_type: Type = yield self.type(left, bound)
                right_type: Type = yield self.type(right, bound)
                return self.apply(node, operator, [(left, left_type), (right, right_type)])
            case Conditional(test, then, otherwise):
                self.expect(test, (yield self.type(test, bound)), BOOL, "a condition")
                return self.joined(node, (yield self.type(then, bound)), (yield self.type(otherwise, bound)))
            case ArrayAccess() | ArrayValue() | ArrayConstructor():
                array: Type = yield self.array(node, bound)
                return array
            case DatatypeAccess() | DatatypeValue():
                record: Type = yield self.record(node, bound)
                return record
            case OptionAccess(option):
                option_type: Type = yield self.type(option, bound)
                if isinstance(option_type, OptionType):
                    return option_type.content
                if not isinstance(option_type, UnknownType):
                    self.notes.type(span_of(option), f"this must be an option, not {describe(option_type)}")
                return UNKNOWN
            case OptionValue(content):
                return OptionType((yield self.type(content, bound)))
            case EmptyOption():
                return OptionType(UNKNOWN)
            case Call():
                result: Type = yield self.call(node, bound)
                return result
            case Selection(variable, condition):
                condition_type: Type = yield self.type(condition, {**bound, variable: UNKNOWN})
                self.expect(condition, condition_type, BOOL, "the condition of a choice")
                return UNKNOWN
            case Sample(distribution, arguments):
                for argument in arguments:
                    subject = f"an argument of `{distribution.symbol}`"
                    self.expect(argument, (yield self.type(argument, bound)), REAL, subject)
                return INT if distribution.is_discrete else REAL
            case Derivative(variable):
                self.name(node, variable, {})
                return REAL
            case Name(identifier):
                return self.name(node, identifier, bound)
            case Integer() | Boolean() | Real() | NamedNumber() | Missing():
                return _LITERAL_TYPES[type(node)]
            case _:
                return assert_never(node)

    def name(self, node: Node, identifier: str, bound: Bound) -> Type:
        type_ = bound.get(identifier) or self.scope.variables.get(identifier)
        if type_ is not None:
            return type_
        if identifier:
            self.notes.unknown("variable", identifier, span_of(node), (*bound, *self.scope.variables))
        return UNKNOWN

    def apply(self, node: Node, operator: Operator, operands: list[tuple[Formula, Type]]) -> Type:
        """The type of the result of `operator`. Operands whose types do not fit are reported."""
        types = [type_ for _, type_ in operands]
        signature = operator.signature
        if signature is Signature.EQUALITY:
            self.joined(node, *types)
            return BOOL
        operand_type = BOOL if signature is Signature.LOGICAL else REAL
        for operand, type_ in operands:
            self.expect(operand, type_, operand_type, f"an operand of `{operator.symbol}`")
        match signature:
            case Signature.LOGICAL | Signature.ORDER:
                return BOOL
            case Signature.ROUNDING:
                return INT
            case Signature.REAL:
                return REAL
            case Signature.ARITHMETIC:
                if not all(map(is_number, types)):
                    return UNKNOWN
                values = [value_type(type_) for type_ in types]
                if operator is BinaryOperator.POWER and not _is_natural(operands[1][0]):
                    values.append(REAL)
                return UNKNOWN if UNKNOWN in values else REAL if REAL in values else INT
            case _:
                return assert_never(signature)

    def joined(self, node: Node, left: Type, right: Type) -> Type:
        """The common type of two values; `UNKNOWN` and a finding if there is none."""
        result = join(left, right)
        if result is None:
            message = f"the two values must have the same type, but they are {describe(left)} and {describe(right)}"
            self.notes.type(span_of(node), message)
            return UNKNOWN
        return result

    def array(self, node: ArrayAccess | ArrayValue | ArrayConstructor, bound: Bound) -> Steps[Type]:
        match node:
            case ArrayAccess(array, index):
                array_type: Type = yield self.type(array, bound)
                self.expect(index, (yield self.type(index, bound)), INT, "an index")
                if isinstance(array_type, ArrayType):
                    return array_type.element
                if not isinstance(array_type, UnknownType):
                    self.notes.type(span_of(array), f"only an array has elements; this value is {describe(array_type)}")
                return UNKNOWN
            case ArrayValue(elements):
                common: Type | None = None
                for element in elements:
                    type_: Type = yield self.type(element, bound)
                    common = type_ if common is None else self.joined(element, common, type_)
                return ArrayType(common or UNKNOWN)
            case ArrayConstructor(variable, length, body):
                self.expect(length, (yield self.type(length, bound)), INT, "the length of an array")
                return ArrayType((yield self.type(body, {**bound, variable: INT})))
            case _:
                return assert_never(node)

    def record(self, node: DatatypeAccess | DatatypeValue, bound: Bound) -> Steps[Type]:
        match node:
            case DatatypeAccess(record, member):
                type_: Type = yield self.type(record, bound)
                if isinstance(type_, DatatypeType):
                    return self.member(node, type_.name, member)
                if not isinstance(type_, UnknownType):
                    self.notes.type(span_of(record), f"only a datatype has members; this value is {describe(type_)}")
                return UNKNOWN
            case DatatypeValue(datatype, members):
                declared = self.scope.datatypes.get(datatype)
                if declared is None and datatype:
                    self.notes.unknown("datatype", datatype, span_of(node), self.scope.datatypes, fix=False)
                for name, value in members:
                    member_type = self.member(node, datatype, name)
                    value_type_: Type = yield self.type(value, bound)
                    self.expect(value, value_type_, member_type, f"the member `{name}`")
                given = {name for name, _ in members}
                for part in declared.members if declared else ():
                    if part.name not in given:
                        self.notes.type(span_of(node), f"a value of `{datatype}` needs the member `{part.name}`")
                return DatatypeType(datatype) if declared else UNKNOWN
            case _:
                return assert_never(node)

    def member(self, node: Node, datatype: str, name: str) -> Type:
        declared = self.scope.datatypes.get(datatype)
        if declared is None:
            return UNKNOWN
        for member in declared.members:
            if member.name == name:
                return member.type
        if name:
            known = [member.name for member in declared.members]
            self.notes.unknown("member", name, span_of(node), known, fix=False, owner=f"`{datatype}`")
        return UNKNOWN

    def call(self, node: Call, bound: Bound) -> Steps[Type]:
        function = self.scope.functions.get(node.function)
        types: list[Type] = []
        for argument in node.arguments:
            types.append((yield self.type(argument, bound)))
        if function is None:
            if node.function:
                self.notes.unknown("function", node.function, span_of(node), self.scope.functions, fix=False)
            return UNKNOWN
        if len(types) != len(function.parameters):
            message = (
                f"wrong number of arguments of `{node.function}`: {len(types)} instead of {len(function.parameters)}"
            )
            self.notes.type(span_of(node), message)
            return function.type
        for parameter, argument, type_ in zip(function.parameters, node.arguments, types, strict=True):
            self.expect(argument, type_, parameter.type, f"`{parameter.name}` of `{function.name}`")
        return function.type

    # ---------------------------------------------------------------- formulas

    def formula(self, node: Formula) -> Steps[Kind]:
        if not isinstance(node, ProperFormula):
            type_: Type = yield self.type(node, {})
            return type_
        match node:
            case UnaryFormula(operator, operand):
                return self.combine(node, operator, [(operand, (yield self.formula(operand)))])
            case BinaryFormula(operator, left, right):
                left_kind: Kind = yield self.formula(left)
                right_kind: Kind = yield self.formula(right)
                return self.combine(node, operator, [(left, left_kind), (right, right_kind)])
            case ConditionalFormula(test, then, otherwise):
                self.expect(test, (yield self.formula(test)), BOOL, "a condition")
                kinds: list[Kind] = [(yield self.formula(then)), (yield self.formula(otherwise))]
                types = [kind for kind in kinds if not isinstance(kind, PathKind)]
                return PATH if len(types) < 2 else self.joined(node, *types)
            case Filter(function, values, states):
                self.expect(states, (yield self.formula(states)), BOOL, "the states of a filter")
                kind: Kind = yield self.formula(values)
                return self.filtered(function, values, kind)
            case Probability(path=path) | Quantified(path=path):
                path_kind: Kind = yield self.formula(path)
                if not isinstance(path_kind, (PathKind, UnknownType)):
                    name = node.operator.value if isinstance(node, Probability) else node.quantifier.value
                    self.notes.type(span_of(path), f"`{name}` needs a path formula, such as one with `F`, `G` or `U`")
                return REAL if isinstance(node, Probability) else BOOL
            case Expectation():
                yield self.expectation(node)
                return REAL
            case SteadyState(_, value):
                kind = yield self.formula(value)
                if kind != BOOL:
                    self.expect(value, kind, REAL, "the value of a steady-state formula")
                return REAL
            case UnaryPath(operator=path_operator, operand=inner):
                self.on_path(path_operator.value, inner, (yield self.formula(inner)))
                yield self.bounds(node)
                return PATH
            case BinaryPath(operator=until, left=before, right=after):
                self.on_path(until.value, before, (yield self.formula(before)))
                self.on_path(until.value, after, (yield self.formula(after)))
                yield self.bounds(node)
                return PATH
            case Predicate():
                return BOOL
            case _:
                return assert_never(node)

    def on_path(self, operator: str, node: Formula, kind: Kind) -> None:
        if not isinstance(kind, PathKind):
            self.expect(node, kind, BOOL, f"an operand of `{operator}`")

    def combine(self, node: Node, operator: Operator, operands: list[tuple[Formula, Kind]]) -> Kind:
        """The kind or type of the result of an operator on formulas. Logical operators may combine path formulas."""
        states = [(operand, kind) for operand, kind in operands if not isinstance(kind, PathKind)]
        if len(states) == len(operands):
            return self.apply(node, operator, states)
        for operand, kind in operands:
            if operator.signature is not Signature.LOGICAL or not isinstance(kind, PathKind):
                self.expect(operand, kind, BOOL, f"an operand of `{operator.symbol}`")
        return PATH if operator.signature is Signature.LOGICAL else UNKNOWN

    def filtered(self, function: FilterFunction, values: Formula, kind: Kind) -> Type:
        if isinstance(kind, PathKind):
            self.expect(values, kind, BOOL, "the argument of a filter")
            return UNKNOWN
        match function:
            case FilterFunction.FORALL | FilterFunction.EXISTS:
                self.expect(values, kind, BOOL, f"the argument of `{function.value}`")
                return BOOL
            case FilterFunction.COUNT:
                self.expect(values, kind, BOOL, "the argument of `count`")
                return INT
            case FilterFunction.MIN | FilterFunction.MAX | FilterFunction.SUM | FilterFunction.AVG:
                self.expect(values, kind, REAL, f"the argument of `{function.value}`")
                return REAL
            case FilterFunction.ARGMIN | FilterFunction.ARGMAX:
                self.expect(values, kind, REAL, f"the argument of `{function.value}`")
                return UNKNOWN
            case FilterFunction.VALUES:
                return kind
            case _:
                return assert_never(function)

    def expectation(self, node: Expectation) -> Steps[None]:
        self.expect(node.reward, (yield self.type(node.reward, {})), REAL, "a reward")
        if node.reach is not None:
            self.expect(node.reach, (yield self.formula(node.reach)), BOOL, "the condition to reach")
        for instant, target in ((node.step_instant, INT), (node.time_instant, REAL)):
            if instant is not None:
                self.expect(instant, (yield self.type(instant, {})), target, "an instant")
        for moment in node.reward_instants or ():
            self.expect(moment.reward, (yield self.type(moment.reward, {})), REAL, "a reward")
            self.expect(moment.instant, (yield self.type(moment.instant, {})), REAL, "an instant")

    def bounds(self, path: PathBounds) -> Steps[None]:
        intervals: list[tuple[Interval | None, Type]] = [(path.step_bounds, INT), (path.time_bounds, REAL)]
        for bound in path.reward_bounds or ():
            self.expect(bound.reward, (yield self.type(bound.reward, {})), REAL, "a reward")
            intervals.append((bound.bounds, REAL))
        for interval, target in intervals:
            for end in (interval.lower, interval.upper) if interval else ():
                if end is not None:
                    self.expect(end, (yield self.type(end, {})), target, "a bound")


def _is_natural(exponent: Formula) -> bool:
    """Whether `exponent` is a literal that is not negative, so that an int to this power is an int."""
    return isinstance(exponent, Integer) and exponent.value >= 0


def span_of(node: Node) -> Span:
    return node.origin.span if node.origin else Span(0, 0)
