# SPDX-License-Identifier: Apache-2.0
"""Sets the constants of a model to values that the user chooses."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

from roaml.exact_number import exact_fraction
from roaml.jani.expressions import Boolean, Expression, Integer, Real
from roaml.jani.model import Constant, Model
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.jani.types import BOOL, INT, REAL, BasicType, BoundedType
from roaml.record import replace
from roaml.regex import regex
from roaml.suggest import nearest_name

_INTEGER = regex(r"[+-]?[0-9]{1,19}")
_TYPE_PHRASES: dict[BasicType, str] = {
    BOOL: "true or false",
    INT: "a whole number of 64 bits",
    REAL: "a number or a fraction",
}


def with_constants(model: Model, texts: Iterable[str]) -> Model:
    """A copy of `model` in which some constants have values.

    Args:
        texts: assignments of the form `NAME=VALUE`.

    Raises:
        ValueError: a text does not have this form, the constant does not exist, or the value does not have the type of
            the constant. The message states the reason.

    A value replaces the one that the model declares.
    """
    given: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not name or not equals or not value:
            raise ValueError(f"a constant must have the form `NAME=VALUE`, such as `N=20`, not `{text}`")
        if name in given:
            raise ValueError(f"the constant `{name}` is given twice")
        if ":" in value or "," in value:
            raise ValueError(
                f"`{text}` gives the constant `{name}` several values; use `as2fm-lsp experiment`, which computes "
                "them all"
            )
        given[name] = value
    if not given:
        return model
    known = {constant.name: constant for constant in model.constants}
    for name in given:
        if name not in known:
            close = nearest_name(name, known)
            hint = (
                f"did you mean `{close}`?" if close else f"the constants of the model are: {', '.join(known) or 'none'}"
            )
            raise ValueError(f"there is no constant `{name}`; {hint}")
    values: dict[str, Value] = {}
    constants = []
    for constant in model.constants:
        if constant.name in given:
            constant = replace(constant, value=_value(constant, given[constant.name], values))  # noqa: PLW2901
        constants.append(constant)
        _add_value(values, constant)
    return replace(model, constants=tuple(constants))


def constant_values(model: Model) -> dict[str, Value]:
    """The values of the constants of a model. A constant whose value depends on one without a value, or calls a
    function, is left out."""
    values: dict[str, Value] = {}
    for constant in model.constants:
        _add_value(values, constant)
    return values


def _add_value(values: dict[str, Value], constant: Constant) -> None:
    if constant.value is not None:
        with suppress(EvaluationError):  # bounds that depend on it are not checked
            values[constant.name] = evaluate(constant.value, values, {})


def _value(constant: Constant, text: str, known: dict[str, Value]) -> Expression:
    type_ = constant.type
    base = type_.base if isinstance(type_, BoundedType) else type_
    value: Boolean | Integer | Real | None = None
    if base is BOOL and text in ("true", "false"):
        value = Boolean(text == "true")
    elif base is INT and _INTEGER.fullmatch(text) and abs(int(text)) < 1 << 63:
        value = Integer(int(text))
    elif base is REAL and (number := exact_fraction(text)) is not None:
        value = Real(float(number))
    if value is None:
        type_phrase = _TYPE_PHRASES.get(base) if isinstance(base, BasicType) else None
        if type_phrase is None:
            raise ValueError(f"the constant `{constant.name}` has a type whose values cannot be given")
        raise ValueError(f"the constant `{constant.name}` must be {type_phrase}, not `{text}`")
    if isinstance(type_, BoundedType):
        for end, is_lower in ((type_.lower, True), (type_.upper, False)):
            bound = None if end is None else _number(end, known)
            if bound is not None and (value.value < bound if is_lower else value.value > bound):
                side = "at least" if is_lower else "at most"
                raise ValueError(f"the constant `{constant.name}` must be {side} {bound:g}, not `{text}`")
    return value


def _number(expression: Expression, known: dict[str, Value]) -> int | float | None:
    try:
        value = evaluate(expression, known, {})
    except EvaluationError:
        return None
    return value if isinstance(value, (int, float)) else None
