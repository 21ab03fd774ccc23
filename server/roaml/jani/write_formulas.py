# SPDX-License-Identifier: Apache-2.0
"""Writes expressions and property formulas as compact JSON.

- The writer collects the features that a file with these formulas must declare.
- A formula that was read from a file is written as the same JSON value, except that operators have their JANI symbols.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TypeAlias

from roaml.exhaustive import assert_never
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
from roaml.jani.features import Feature
from roaml.jani.node import CommentedNode
from roaml.jani.operators import Operator
from roaml.jani.properties import (
    Accumulation,
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    ConditionalFormula,
    Expectation,
    Filter,
    Formula,
    Interval,
    PathBounds,
    Predicate,
    Probability,
    Quantified,
    RewardBound,
    RewardInstant,
    SteadyState,
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
)
from roaml.json_syntax import quote

Part: TypeAlias = "str | Formula"
"""A piece of JSON: finished text, or a formula that is not written yet."""

_DERIVED_PATHS = {UnaryPathOperator.FINALLY, UnaryPathOperator.GLOBALLY, BinaryPathOperator.RELEASE}


class FormulaWriter:
    """Writes formulas. `features` contains the features that the formulas written so far require."""

    def __init__(self) -> None:
        self.features: set[Feature] = set()

    def text(self, formula: Formula) -> str:
        """The JSON text of `formula`.

        Raises:
            ValueError: a part of the formula is missing, or is a number that is not finite.
        """
        done: list[str] = []
        stack: list[Part] = [formula]
        while stack:
            part = stack.pop()
            if isinstance(part, str):
                done.append(part)
            else:
                stack.extend(reversed(self.parts(part)))
        return "".join(done)

    def parts(self, node: Formula) -> list[Part]:
        """The JSON of `node` as a list of pieces, in which the operands are not written yet."""
        match node:
            case Name(identifier):
                return [quote(identifier)]
            case Integer(value):
                return [str(value)]
            case Binary(operator, left, right) | BinaryFormula(operator, left, right):
                self.require(operator)
                return [f'{_start(node)}"op":"{operator.symbol}","left":', left, ',"right":', right, "}"]
            case Unary(operator, operand) | UnaryFormula(operator, operand):
                self.require(operator)
                return [f'{_start(node)}"op":"{operator.symbol}","exp":', operand, "}"]
            case Boolean(value):
                return ["true" if value else "false"]
            case Real(value):
                return [_real(value)]
            case NamedNumber(constant):
                return [f'{_start(node)}"constant":"{constant.symbol}"}}']
            case Conditional(test, then, otherwise) | ConditionalFormula(test, then, otherwise):
                return [f'{_start(node)}"op":"ite","if":', test, ',"then":', then, ',"else":', otherwise, "}"]
            case ArrayAccess() | ArrayValue() | ArrayConstructor():
                self.features.add(Feature.ARRAYS)
                return _array(node)
            case DatatypeAccess() | DatatypeValue() | OptionAccess() | OptionValue() | EmptyOption():
                self.features.add(Feature.DATATYPES)
                return _datatype(node)
            case Call(function, arguments):
                self.features.add(Feature.FUNCTIONS)
                return [f'{_start(node)}"op":"call","function":{quote(function)},"args":', *_list(arguments), "}"]
            case Selection(variable, condition):
                self.features.add(Feature.NONDET_SELECTION)
                return [f'{_start(node)}"op":"nondet","var":{quote(variable)},"exp":', condition, "}"]
            case Sample(distribution, arguments):
                return [f'{_start(node)}"distribution":"{distribution.symbol}","args":', *_list(arguments), "}"]
            case Derivative(variable):
                return [f'{_start(node)}"op":"der","var":{quote(variable)}}}']
            case Missing():
                raise ValueError("a model with missing expressions cannot be written")
            case _:
                return self.property_parts(node)

    def property_parts(
        self,
        node: Filter | Probability | Quantified | Expectation | SteadyState | UnaryPath | BinaryPath | Predicate,
    ) -> list[Part]:
        match node:
            case Filter(function, values, states):
                start = f'{_start(node)}"op":"filter","fun":"{function.value}","values":'
                return [start, values, ',"states":', states, "}"]
            case Probability(operator, path):
                return [f'{_start(node)}"op":"{operator.value}","exp":', path, "}"]
            case Quantified(quantifier, path):
                return [f'{_start(node)}"op":"{quantifier.value}","exp":', path, "}"]
            case Expectation():
                return self.expectation(node)
            case SteadyState(operator, value, accumulate):
                start = f'{_start(node)}"op":"{operator.value}","exp":'
                return [start, value, *self.accumulation(accumulate), "}"]
            case UnaryPath(operator, operand):
                self.require_path(operator)
                return [f'{_start(node)}"op":"{operator.value}","exp":', operand, *self.bounds(node), "}"]
            case BinaryPath(operator, left, right):
                self.require_path(operator)
                start = f'{_start(node)}"op":"{operator.value}","left":'
                return [start, left, ',"right":', right, *self.bounds(node), "}"]
            case Predicate(predicate):
                return [f'{_start(node)}"op":"{predicate.value}"}}']
            case _:
                return assert_never(node)

    def expectation(self, node: Expectation) -> list[Part]:
        parts: list[Part] = [f'{_start(node)}"op":"{node.operator.value}","exp":', node.reward]
        parts += self.accumulation(node.accumulate)
        parts += _optional("reach", node.reach)
        parts += _optional("step-instant", node.step_instant)
        parts += _optional("time-instant", node.time_instant)
        if node.reward_instants is not None:
            parts += [',"reward-instants":', *_join(map(self.reward_instant, node.reward_instants))]
        return [*parts, "}"]

    def reward_instant(self, node: RewardInstant) -> list[Part]:
        start = f'{_start(node)}"exp":'
        return [start, node.reward, *self.accumulation(node.accumulate), ',"instant":', node.instant, "}"]

    def bounds(self, path: PathBounds) -> list[Part]:
        parts: list[Part] = []
        if path.step_bounds is not None:
            parts += [',"step-bounds":', *_interval(path.step_bounds)]
        if path.time_bounds is not None:
            parts += [',"time-bounds":', *_interval(path.time_bounds)]
        if path.reward_bounds is not None:
            parts += [',"reward-bounds":', *_join(map(self.reward_bound, path.reward_bounds))]
        return parts

    def reward_bound(self, node: RewardBound) -> list[Part]:
        start = f'{_start(node)}"exp":'
        bounds = _interval(node.bounds)
        return [start, node.reward, *self.accumulation(node.accumulate), ',"bounds":', *bounds, "}"]

    def accumulation(self, accumulate: tuple[Accumulation, ...] | None) -> list[Part]:
        if accumulate is None:
            return []
        if Accumulation.EXIT in accumulate:
            self.features.add(Feature.STATE_EXIT_REWARDS)
        return [',"accumulate":[', ",".join(f'"{moment.value}"' for moment in accumulate), "]"]

    def require(self, operator: Operator) -> None:
        if operator.feature is not None:
            self.features.add(operator.feature)

    def require_path(self, operator: UnaryPathOperator | BinaryPathOperator) -> None:
        if operator in _DERIVED_PATHS:
            self.features.add(Feature.DERIVED_OPERATORS)


def _start(node: CommentedNode) -> str:
    """The beginning of the JSON object of a node, with its comment."""
    return "{" if node.comment is None else f'{{"comment":{quote(node.comment)},'


def _array(node: ArrayAccess | ArrayValue | ArrayConstructor) -> list[Part]:
    match node:
        case ArrayAccess(array, index):
            return [f'{_start(node)}"op":"aa","exp":', array, ',"index":', index, "}"]
        case ArrayValue(elements):
            return [f'{_start(node)}"op":"av","elements":', *_list(elements), "}"]
        case ArrayConstructor(variable, length, body):
            return [f'{_start(node)}"op":"ac","var":{quote(variable)},"length":', length, ',"exp":', body, "}"]


def _datatype(node: DatatypeAccess | DatatypeValue | OptionAccess | OptionValue | EmptyOption) -> list[Part]:
    match node:
        case DatatypeAccess(record, member):
            return [f'{_start(node)}"op":"da","exp":', record, f',"member":{quote(member)}}}']
        case DatatypeValue(datatype, members):
            values = _join([f'{{"member":{quote(name)},"value":', value, "}"] for name, value in members)
            return [f'{_start(node)}"op":"dv","type":{quote(datatype)},"values":', *values, "}"]
        case OptionAccess(option):
            return [f'{_start(node)}"op":"oa","exp":', option, "}"]
        case OptionValue(content):
            return [f'{_start(node)}"op":"ov","exp":', content, "}"]
        case EmptyOption():
            return [f'{_start(node)}"op":"empty"}}']


def _interval(node: Interval) -> list[Part]:
    parts = [*_optional("lower", node.lower), *_flag("lower-exclusive", node.lower_exclusive)]
    parts += [*_optional("upper", node.upper), *_flag("upper-exclusive", node.upper_exclusive)]
    if node.comment is not None:
        parts = [f',"comment":{quote(node.comment)}', *parts]
    if parts and isinstance(parts[0], str):
        parts[0] = parts[0][1:]
    return ["{", *parts, "}"]


def _optional(key: str, value: Formula | None) -> list[Part]:
    return [] if value is None else [f',"{key}":', value]


def _flag(key: str, value: bool | None) -> list[Part]:
    return [] if value is None else [f',"{key}":{"true" if value else "false"}']


def _list(items: Iterable[Formula]) -> list[Part]:
    return _join([item] for item in items)


def _join(items: Iterable[list[Part]]) -> list[Part]:
    parts: list[Part] = ["["]
    for item in items:
        if len(parts) > 1:
            parts.append(",")
        parts += item
    return [*parts, "]"]


def _real(value: float) -> str:
    if not math.isfinite(value):
        raise ValueError(f"JSON cannot express {value}")
    return repr(value)
