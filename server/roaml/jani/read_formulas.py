# SPDX-License-Identifier: Apache-2.0
"""Reads expressions and property formulas from JSON.

- A missing or unreadable operand is reported and becomes a `Missing` node; the other parts are read.
- Names are not resolved and types are not checked; see `roaml.jani.typecheck`.
- The origin of a name, or of a derivative, is the text of the name without quotes. The origin of any other node is the
  whole JSON value.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Callable, Iterable
from typing import TypeVar

from roaml.diagnostics import Finding, Fix
from roaml.jani.deep import Steps, run
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
    LValue,
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
from roaml.jani.members import Members, ObjectShape, ValueSource, shape
from roaml.jani.notes import SYNTAX
from roaml.jani.operators import BINARY_OPERATORS, DISTRIBUTIONS, NUMBER_CONSTANTS, UNARY_OPERATORS
from roaml.jani.properties import (
    Accumulation,
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    ConditionalFormula,
    Expectation,
    ExpectationOperator,
    Filter,
    FilterFunction,
    Formula,
    Interval,
    PathQuantifier,
    Predicate,
    Probability,
    ProbabilityOperator,
    ProperFormula,
    Quantified,
    RewardBound,
    RewardInstant,
    StatePredicate,
    SteadyState,
    SteadyStateOperator,
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
)
from roaml.json_syntax import JsonBool, JsonNumber, JsonObject, JsonString, JsonValue
from roaml.record import Record
from roaml.suggest import did_you_mean
from roaml.text import Span, TextEdit

E = TypeVar("E", bound=enum.Enum)


class FormulaReader(ValueSource):
    """Reads the expressions and formulas of one file."""

    def expression(self, value: JsonValue) -> Expression:
        return run(self._compound(value)) if isinstance(value, JsonObject) else self._simple(value)

    def formula(self, value: JsonValue) -> Formula:
        """The formula of a property in `value`."""
        return run(self._formula(value))

    def lvalue(self, value: JsonValue) -> LValue:
        """The target of an assignment in `value`; `Missing` and a finding if it is not a valid target."""
        target = self.expression(value)
        if type(target) is Name:  # Most targets; the general test takes longer.
            return target
        if isinstance(target, LValue) and isinstance(_root(target), (Name, Missing)):
            return target
        self.notes.syntax(value.span, "the target of an assignment must be a variable or a part of one")
        return Missing(origin=target.origin)

    # ---------------------------------------------------------------- any kind

    def _expression(self, value: JsonValue) -> Steps[Expression] | Expression:
        return self._compound(value) if isinstance(value, JsonObject) else self._simple(value)

    def _compound(self, value: JsonObject) -> Steps[Expression]:
        formula: Formula = yield self._object(value)
        if not isinstance(formula, ProperFormula):
            return formula
        self.notes.syntax(value.span, "this is only allowed in a property, not in an expression")
        return Missing(origin=formula.origin)

    def _formula(self, value: JsonValue) -> Steps[Formula] | Formula:
        return self._object(value) if isinstance(value, JsonObject) else self._simple(value)

    def _simple(self, value: JsonValue) -> Expression:
        """An expression that contains no others."""
        match value:
            case JsonString():
                if not value.value:
                    self.notes.syntax(value.span, "a name must not be empty")
                return Name(value.value, origin=self.content_origin(value))
            case JsonNumber():
                return self._number(value)
            case JsonBool():
                return Boolean(value.value, origin=self.origin(value))
            case _:
                self.wrong_kind(value, "an expression must be a number, true, false, a name or an object `{ }`")
                return Missing(origin=self.origin(value))

    def _number(self, value: JsonNumber) -> Integer | Real | Missing:
        origin = self.origin(value)
        if isinstance(value.value, int):
            return Integer(value.value, origin=origin)
        if math.isfinite(value.value):
            return Real(value.value, origin=origin)
        self.notes.syntax(value.span, "this number is too large; the greatest real number is about 1.8e308")
        return Missing(origin=origin)

    def _object(self, value: JsonObject) -> Steps[Formula] | Formula:
        op = value.get("op")
        if op is None and value.get("constant") is not None:
            return self._constant(Members(value, _CONSTANT, self))
        if op is None and value.get("distribution") is not None:
            return self._sample(Members(value, _DISTRIBUTION, self))
        if isinstance(op, JsonString) and (form := _FORMS.get(op.value)):
            return form.build(self, Members(value, form.shape, self), op.value)
        if isinstance(op, JsonString):
            self._unknown_operator(op)
        elif op is not None:
            self.wrong_kind(op, "`op` must be a string")
        elif not any(member.key == "op" for member in value.members):
            self.notes.syntax(Span(value.start, value.start + 1), "an expression needs `op`")
        return Missing(origin=self.origin(value))

    def _unknown_operator(self, op: JsonString) -> None:
        similar = _SPELLINGS.get(op.value.lower().strip())
        if similar is None:
            self.notes.unknown("operator", op.value, op.content_span, _FORMS, code=SYNTAX)
        else:
            fix = Fix(f"Change to `{similar}`", (TextEdit(op.content_span, similar),))
            message = f"there is no operator `{op.value}`{did_you_mean((similar,))}"
            self.notes.add(Finding(SYNTAX, op.content_span, message, None, (fix,)))

    # ---------------------------------------------------------------- members

    def _part(self, members: Members, key: str) -> Steps[Expression] | Expression:
        value = members.values.get(key)
        return Missing(origin=members.origin) if value is None else self._expression(value)

    def _formula_part(self, members: Members, key: str) -> Steps[Formula] | Formula:
        value = members.values.get(key)
        return Missing(origin=members.origin) if value is None else self._formula(value)

    def _optional(self, members: Members, key: str) -> Steps[Expression] | Expression | None:
        return self._part(members, key) if key in members.values else None

    def _parts(self, members: Members, key: str) -> Steps[tuple[Expression, ...]]:
        parts: list[Expression] = []
        for item in members.items(key):
            parts.append((yield self._expression(item)))
        return tuple(parts)

    def choice(self, value: JsonValue | None, kind: str, choices: type[E]) -> E | None:
        """The member of the enumeration `choices` with the value `value`; `None` if there is none, with a finding
        unless `value` is missing or not valid JSON."""
        if not isinstance(value, JsonString):
            self.wrong_kind(value, f"a {kind} must be a string")
            return None
        try:
            return choices(value.value)
        except ValueError:
            self.notes.unknown(kind, value.value, value.content_span, [c.value for c in choices], code=SYNTAX)
            return None

    # ---------------------------------------------------------------- expressions

    def _constant(self, members: Members) -> Formula:
        symbol = members.string("constant")
        if symbol and symbol.value in NUMBER_CONSTANTS:
            constant = NUMBER_CONSTANTS[symbol.value]
            return NamedNumber(constant, comment=members.comment(), origin=members.origin)
        if symbol:
            self.notes.unknown("constant", symbol.value, symbol.content_span, NUMBER_CONSTANTS, code=SYNTAX)
        return Missing(origin=members.origin)

    def _sample(self, members: Members) -> Steps[Formula]:
        arguments: tuple[Expression, ...] = yield self._parts(members, "args")
        name = members.string("distribution")
        if name is None:
            return Missing(origin=members.origin)
        if name.value not in DISTRIBUTIONS:
            self.notes.unknown("distribution", name.value, name.content_span, DISTRIBUTIONS, code=SYNTAX)
            return Missing(origin=members.origin)
        distribution = DISTRIBUTIONS[name.value]
        if "args" in members.values and len(arguments) != distribution.arity:
            message = f"wrong number of arguments of `{name.value}`: {len(arguments)} instead of {distribution.arity}"
            self.notes.syntax(members.values["args"].span, message)
        return Sample(distribution, arguments, comment=members.comment(), origin=members.origin)

    def _unary(self, members: Members, op: str) -> Steps[Formula]:
        operator = UNARY_OPERATORS[op]
        operand: Formula = yield self._formula_part(members, "exp")
        comment, origin = members.comment(), members.origin
        if isinstance(operand, ProperFormula):
            return UnaryFormula(operator, operand, comment=comment, origin=origin)
        return Unary(operator, operand, comment=comment, origin=origin)

    def _binary(self, members: Members, op: str) -> Steps[Formula]:
        operator = BINARY_OPERATORS[op]
        left: Formula = yield self._formula_part(members, "left")
        right: Formula = yield self._formula_part(members, "right")
        comment, origin = members.comment(), members.origin
        if isinstance(left, ProperFormula) or isinstance(right, ProperFormula):
            return BinaryFormula(operator, left, right, comment=comment, origin=origin)
        return Binary(operator, left, right, comment=comment, origin=origin)

    def _ite(self, members: Members, _op: str) -> Steps[Formula]:
        test: Formula = yield self._formula_part(members, "if")
        then: Formula = yield self._formula_part(members, "then")
        otherwise: Formula = yield self._formula_part(members, "else")
        comment, origin = members.comment(), members.origin
        if isinstance(test, ProperFormula) or isinstance(then, ProperFormula) or isinstance(otherwise, ProperFormula):
            return ConditionalFormula(test, then, otherwise, comment=comment, origin=origin)
        return Conditional(test, then, otherwise, comment=comment, origin=origin)

    def _array_access(self, members: Members, _op: str) -> Steps[Formula]:
        array: Expression = yield self._part(members, "exp")
        index: Expression = yield self._part(members, "index")
        return ArrayAccess(array, index, comment=members.comment(), origin=members.origin)

    def _array_value(self, members: Members, _op: str) -> Steps[Formula]:
        elements: tuple[Expression, ...] = yield self._parts(members, "elements")
        return ArrayValue(elements, comment=members.comment(), origin=members.origin)

    def _array_constructor(self, members: Members, _op: str) -> Steps[Formula]:
        variable = members.text("var") or ""
        length: Expression = yield self._part(members, "length")
        body: Expression = yield self._part(members, "exp")
        return ArrayConstructor(variable, length, body, comment=members.comment(), origin=members.origin)

    def _datatype_access(self, members: Members, _op: str) -> Steps[Formula]:
        record: Expression = yield self._part(members, "exp")
        member = members.text("member") or ""
        return DatatypeAccess(record, member, comment=members.comment(), origin=members.origin)

    def _datatype_value(self, members: Members, _op: str) -> Steps[Formula]:
        datatype = members.text("type") or ""
        pairs: list[tuple[str, Expression]] = []
        for item in members.items("values"):
            if pair := self.members(item, _DATATYPE_MEMBER):
                pairs.append((pair.text("member") or "", (yield self._part(pair, "value"))))
        return DatatypeValue(datatype, tuple(pairs), comment=members.comment(), origin=members.origin)

    def _option_access(self, members: Members, _op: str) -> Steps[Formula]:
        option: Expression = yield self._part(members, "exp")
        return OptionAccess(option, comment=members.comment(), origin=members.origin)

    def _option_value(self, members: Members, _op: str) -> Steps[Formula]:
        content: Expression = yield self._part(members, "exp")
        return OptionValue(content, comment=members.comment(), origin=members.origin)

    def _empty_option(self, members: Members, _op: str) -> Formula:
        return EmptyOption(comment=members.comment(), origin=members.origin)

    def _call(self, members: Members, _op: str) -> Steps[Formula]:
        function = members.text("function") or ""
        arguments: tuple[Expression, ...] = yield self._parts(members, "args")
        return Call(function, arguments, comment=members.comment(), origin=members.origin)

    def _selection(self, members: Members, _op: str) -> Steps[Formula]:
        variable = members.text("var") or ""
        condition: Expression = yield self._part(members, "exp")
        return Selection(variable, condition, comment=members.comment(), origin=members.origin)

    def _derivative(self, members: Members, _op: str) -> Formula:
        variable = members.string("var")
        if variable is None:
            return Missing(origin=members.origin)
        origin = self.content_origin(variable)
        return Derivative(variable.value, comment=members.comment(), origin=origin)

    # ---------------------------------------------------------------- properties

    def _filter(self, members: Members, _op: str) -> Steps[Formula]:
        function = self.choice(members.values.get("fun"), "filter function", FilterFunction) or FilterFunction.VALUES
        values: Formula = yield self._formula_part(members, "values")
        states: Formula = yield self._formula_part(members, "states")
        return Filter(function, values, states, comment=members.comment(), origin=members.origin)

    def _probability(self, members: Members, op: str) -> Steps[Formula]:
        path: Formula = yield self._formula_part(members, "exp")
        return Probability(ProbabilityOperator(op), path, comment=members.comment(), origin=members.origin)

    def _quantified(self, members: Members, op: str) -> Steps[Formula]:
        path: Formula = yield self._formula_part(members, "exp")
        return Quantified(PathQuantifier(op), path, comment=members.comment(), origin=members.origin)

    def _expectation(self, members: Members, op: str) -> Steps[Formula]:
        reward: Expression = yield self._part(members, "exp")
        reach: Formula | None = None
        if "reach" in members.values:
            reach = yield self._formula_part(members, "reach")
        step_instant: Expression | None = yield self._optional(members, "step-instant")
        time_instant: Expression | None = yield self._optional(members, "time-instant")
        instants: list[RewardInstant] = []
        for item in members.items("reward-instants"):
            if parts := self.members(item, _REWARD_INSTANT):
                instants.append((yield self._reward_instant(parts)))
        return Expectation(
            ExpectationOperator(op),
            reward,
            self._accumulate(members),
            reach,
            step_instant,
            time_instant,
            tuple(instants) if "reward-instants" in members.values else None,
            comment=members.comment(),
            origin=members.origin,
        )

    def _reward_instant(self, members: Members) -> Steps[RewardInstant]:
        reward: Expression = yield self._part(members, "exp")
        instant: Expression = yield self._part(members, "instant")
        accumulate = self._accumulate(members) or ()
        return RewardInstant(reward, accumulate, instant, comment=members.comment(), origin=members.origin)

    def _steady_state(self, members: Members, op: str) -> Steps[Formula]:
        value: Formula = yield self._formula_part(members, "exp")
        return SteadyState(
            SteadyStateOperator(op),
            value,
            self._accumulate(members),
            comment=members.comment(),
            origin=members.origin,
        )

    def _accumulate(self, members: Members) -> tuple[Accumulation, ...] | None:
        if "accumulate" not in members.values:
            return None
        moments = (self.choice(item, "kind of accumulation", Accumulation) for item in members.items("accumulate"))
        return tuple(moment for moment in moments if moment is not None)

    def _unary_path(self, members: Members, op: str) -> Steps[Formula]:
        operand: Formula = yield self._formula_part(members, "exp")
        return UnaryPath(
            UnaryPathOperator(op),
            operand,
            step_bounds=(yield self._interval(members.values.get("step-bounds"))),
            time_bounds=(yield self._interval(members.values.get("time-bounds"))),
            reward_bounds=(yield self._reward_bounds(members)),
            comment=members.comment(),
            origin=members.origin,
        )

    def _binary_path(self, members: Members, op: str) -> Steps[Formula]:
        left: Formula = yield self._formula_part(members, "left")
        right: Formula = yield self._formula_part(members, "right")
        return BinaryPath(
            BinaryPathOperator(op),
            left,
            right,
            step_bounds=(yield self._interval(members.values.get("step-bounds"))),
            time_bounds=(yield self._interval(members.values.get("time-bounds"))),
            reward_bounds=(yield self._reward_bounds(members)),
            comment=members.comment(),
            origin=members.origin,
        )

    def _interval(self, value: JsonValue | None) -> Steps[Interval | None]:
        members = None if value is None else self.members(value, _INTERVAL)
        if members is None:
            return None
        lower: Expression | None = yield self._optional(members, "lower")
        upper: Expression | None = yield self._optional(members, "upper")
        return Interval(
            lower,
            upper,
            members.flag("lower-exclusive"),
            members.flag("upper-exclusive"),
            comment=members.comment(),
            origin=members.origin,
        )

    def _reward_bounds(self, members: Members) -> Steps[tuple[RewardBound, ...] | None]:
        if "reward-bounds" not in members.values:
            return None
        rewards: list[RewardBound] = []
        for item in members.items("reward-bounds"):
            if parts := self.members(item, _REWARD_BOUND):
                rewards.append((yield self._reward_bound(parts)))
        return tuple(rewards)

    def _reward_bound(self, members: Members) -> Steps[RewardBound]:
        reward: Expression = yield self._part(members, "exp")
        bounds: Interval | None = yield self._interval(members.values.get("bounds"))
        accumulate = self._accumulate(members) or ()
        comment, origin = members.comment(), members.origin
        return RewardBound(reward, accumulate, bounds or Interval(), comment=comment, origin=origin)

    def _predicate(self, members: Members, op: str) -> Formula:
        return Predicate(StatePredicate(op), comment=members.comment(), origin=members.origin)


def _root(target: LValue) -> Expression:
    """The innermost expression of a target: the variable that it changes, if it is valid."""
    inner: Expression = target
    while True:
        match inner:
            case ArrayAccess(composite, _) | DatatypeAccess(composite, _) | OptionAccess(composite):
                inner = composite
            case _:
                return inner


class _Form(Record, frozen=True):
    """The shape of the objects with a certain `op`, and the function that creates the node from them."""

    shape: ObjectShape
    build: Callable[[FormulaReader, Members, str], Steps[Formula] | Formula]


def _symbols(operators: type[enum.Enum]) -> list[str]:
    return [operator.value for operator in operators]


def _forms(
    ops: Iterable[str],
    build: Callable[[FormulaReader, Members, str], Steps[Formula] | Formula],
    required: str = "",
    optional: str = "",
) -> dict[str, _Form]:
    return {op: _Form(shape(f"`{op}`", f"op {required}", f"comment {optional}"), build) for op in ops}


_BOUNDS = "step-bounds time-bounds reward-bounds"
_INSTANTS = "reach step-instant time-instant reward-instants"

_CONSTANT = shape("a named number", "constant", "comment")
_DISTRIBUTION = shape("a distribution", "distribution args", "comment")
_DATATYPE_MEMBER = shape("a member of a datatype's value", "member value")
_INTERVAL = shape("an interval", "", "lower lower-exclusive upper upper-exclusive comment")
_REWARD_BOUND = shape("a reward bound", "exp accumulate bounds", "comment")
_REWARD_INSTANT = shape("a reward instant", "exp accumulate instant", "comment")

_SPELLINGS = {
    **dict.fromkeys(("==", "===", "eq", "equal", "equals"), "="),
    **dict.fromkeys(("!=", "!==", "<>", "neq", "ne"), "≠"),
    **dict.fromkeys(("<=", "=<", "le", "leq"), "≤"),
    **dict.fromkeys((">=", "=>", "ge", "geq"), "≥"),
    **dict.fromkeys(("&&", "&", "and"), "∧"),
    **dict.fromkeys(("||", "|", "or"), "∨"),
    **dict.fromkeys(("!", "not", "~"), "¬"),
    **dict.fromkeys(("->", "implies", "→"), "⇒"),
    **dict.fromkeys(("**", "^"), "pow"),
    "lt": "<",
    "gt": ">",
    "mod": "%",
}
"""Name of an operator in other languages, in lower case -> the operator of JANI."""

_FORMS: dict[str, _Form] = {
    **_forms(UNARY_OPERATORS, FormulaReader._unary, "exp"),
    **_forms(BINARY_OPERATORS, FormulaReader._binary, "left right"),
    **_forms(["ite"], FormulaReader._ite, "if then else"),
    **_forms(["aa"], FormulaReader._array_access, "exp index"),
    **_forms(["av"], FormulaReader._array_value, "elements"),
    **_forms(["ac"], FormulaReader._array_constructor, "var length exp"),
    **_forms(["da"], FormulaReader._datatype_access, "exp member"),
    **_forms(["dv"], FormulaReader._datatype_value, "type values"),
    **_forms(["oa"], FormulaReader._option_access, "exp"),
    **_forms(["ov"], FormulaReader._option_value, "exp"),
    **_forms(["empty"], FormulaReader._empty_option),
    **_forms(["call"], FormulaReader._call, "function args"),
    **_forms(["nondet"], FormulaReader._selection, "var exp"),
    **_forms(["der"], FormulaReader._derivative, "var"),
    **_forms(["filter"], FormulaReader._filter, "fun values states"),
    **_forms(_symbols(ProbabilityOperator), FormulaReader._probability, "exp"),
    **_forms(_symbols(PathQuantifier), FormulaReader._quantified, "exp"),
    **_forms(_symbols(ExpectationOperator), FormulaReader._expectation, "exp", f"accumulate {_INSTANTS}"),
    **_forms(_symbols(SteadyStateOperator), FormulaReader._steady_state, "exp", "accumulate"),
    **_forms(_symbols(UnaryPathOperator), FormulaReader._unary_path, "exp", _BOUNDS),
    **_forms(_symbols(BinaryPathOperator), FormulaReader._binary_path, "left right", _BOUNDS),
    **_forms(_symbols(StatePredicate), FormulaReader._predicate),
}
"""Every `op` that JANI defines -> its form."""
