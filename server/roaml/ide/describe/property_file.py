# SPDX-License-Identifier: Apache-2.0
"""Descriptions, as Markdown, for property files in JANI: operators, keys, formulas in the usual notation, and global
variables."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.ide.describe.markdown import code, lines, name, paragraphs
from roaml.ide.json_tree import members
from roaml.ide.property_values import compared_global, names_of_global
from roaml.jani.operators import BINARY_OPERATORS, UNARY_OPERATORS
from roaml.json_syntax import JsonArray, JsonBool, JsonNumber, JsonObject, JsonString, JsonValue
from roaml.language.json_schema import PROPERTIES, Key
from roaml.model.globals import GlobalVariable
from roaml.model.value_types import GOAL_STATUSES
from roaml.scxml.names import FLAG, flagged_by

_DEPTH = 12
"""The maximum depth of nesting that the text of a formula shows."""
_LENGTH = 400
"""The maximum number of characters of the text of a formula."""

_SAYS: Mapping[str, str] = {
    "∨": "At least one operand holds.",
    "∧": "Both operands hold.",
    "⇒": "If the left operand holds, the right one does as well.",
    "¬": "The operand does not hold.",
    "=": "Both operands are equal.",
    "≠": "The operands differ.",
    "<": "The left operand is less than the right one.",
    "≤": "The left operand is less than or equal to the right one.",
    ">": "The left operand is greater than the right one.",
    "≥": "The left operand is greater than or equal to the right one.",
    "+": "The sum.",
    "-": "The difference.",
    "*": "The product.",
    "min": "The smaller of the operands.",
    "max": "The greater of the operands.",
    "abs": "The absolute value.",
    "floor": "The greatest integer that is not greater than the operand.",
    "ceil": "The smallest integer that is not less than the operand.",
    "%": "The remainder, never negative.",
    "/": "The quotient, a real number.",
    "pow": "`left` to the power of `right`.",
    "log": "The logarithm of `left` to the base `right`.",
    "sgn": "−1, 0 or 1 for a negative number, 0 or a positive number.",
    "trc": "The number without its fractional part.",
    "F": "`exp` holds at some time.",
    "G": "`exp` holds always.",
    "X": "`exp` holds after the next step.",
    "U": "`right` holds at some time, and `left` holds until then.",
    "W": "`right` holds at some time, and `left` holds until then; or `left` holds for ever.",
    "R": "`right` holds up to and including the time at which `left` holds, or for ever.",
    "Pmin": "The minimum probability of the paths that `exp` describes, over all schedulers.",
    "Pmax": "The maximum probability of the paths that `exp` describes, over all schedulers.",
    "initial": "Holds in the initial states.",
    "deadlock": "Holds where no step is possible.",
    "timelock": "Holds where time cannot pass.",
}
"""The descriptions of the operators for which the schema has no description."""


def operator(symbol: str) -> str:
    """The description of an operator as it is written after `op`; "" if it is unknown."""
    described = dict(PROPERTIES.operators("formula")).get(symbol)
    if described is None:
        return ""
    known = BINARY_OPERATORS.get(symbol) or UNARY_OPERATORS.get(symbol)
    usual = known.symbol if known else symbol
    is_function = symbol in UNARY_OPERATORS
    text = "The function with this name; angles in radians." if is_function else PROPERTIES.text(described)
    return paragraphs(
        _SAYS.get(usual, text),
        lines(
            f"Takes {known.signature.value}".replace("->", "→") if known else "",
            f"Another spelling of {name(usual)}" if usual != symbol else "",
        ),
    )


def member(key: Key) -> str:
    """The description of a key of a JSON object."""
    title = PROPERTIES.title(key.schema)
    head = (f"**{title}**" if title else "", name(key.name), "required" if key.required else "")
    return paragraphs(" · ".join(filter(None, head)), PROPERTIES.text(key.schema))


def number(written: JsonNumber, around: Mapping[str, JsonValue]) -> str:
    """The meaning of a number that is compared with the status of a node or the code of a result; "" if it has none.

    Args:
        around: the members of the comparison.
    """
    values = names_of_global(compared_global(around, written))
    if not values:
        return ""
    called = next((name for value, name in values.items() if str(value) == written.text), "")
    every = ", ".join(f"{value} = {name}" for value, name in values.items())
    meaning = (
        "Codes of action results (`action_msgs/GoalStatus`)" if values is GOAL_STATUSES else "Statuses of tree nodes"
    )
    return paragraphs(code(f"{written.text} = {called}") if called else "", f"{meaning}: {every}")


def global_variable(variable: GlobalVariable) -> str:
    """The description of a global variable of the translated system."""
    if variable.parameter == FLAG and flagged_by(variable.name):
        meaning = f"Whether event {name(variable.event)} has been sent"
    elif variable.name.endswith("_len"):
        meaning = f"The number of elements of {name(variable.name.rpartition('.')[0])}"
    else:
        meaning = f"The value in the last event {name(variable.event)}"
    return paragraphs(code(f"{variable.name} : {variable.type}"), meaning)


def formula(value: JsonValue) -> str:
    """A formula in the usual notation, in one line of at most `_LENGTH` characters."""
    text = _formula(value, 0)
    return text if len(text) <= _LENGTH else f"{text[: _LENGTH - 1]}…"


def _formula(value: JsonValue | None, depth: int) -> str:
    if depth > _DEPTH:
        return "…"
    match value:
        case JsonString():
            return value.value or "…"
        case JsonNumber():
            return value.text
        case JsonBool():
            return str(value.value).lower()
        case JsonArray():
            return f"[{', '.join(_formula(item, depth + 1) for item in value.items)}]"
        case JsonObject():
            return _operation(members(value), depth)
    return "…"


def _operation(parts: Mapping[str, JsonValue], depth: int) -> str:
    def part(key: str) -> str:
        return _formula(parts.get(key), depth + 1)

    def inner(key: str) -> str:
        """The text of an operand, in parentheses if it consists of two operands and an operator between them."""
        value = parts.get(key)
        has_two = isinstance(value, JsonObject) and value.get("left") is not None
        text = part(key)
        return f"({text})" if has_two and " " in text else text

    operator = parts.get("op")
    op = operator.value if isinstance(operator, JsonString) else ""
    if op in BINARY_OPERATORS and BINARY_OPERATORS[op].symbol.isalpha():
        return f"{op}({part('left')}, {part('right')})"
    if "left" in parts and "right" in parts:
        return f"{inner('left')} {op} {inner('right')}"
    match op:
        case "filter":
            fun = part("fun")
            return part("values") if fun == "values" else f"{fun} {inner('values')} in {part('states')}"
        case "ite":
            return f"{inner('if')} ? {inner('then')} : {inner('else')}"
        case "aa":
            return f"{inner('exp')}[{part('index')}]"
        case "av":
            return part("elements")
        case "Pmin" | "Pmax" | "Emin" | "Emax" | "Smin" | "Smax":
            return f"{op}({part('exp')})"
        case "F" | "G" | "X" | "¬" | "!" | "∀" | "∃":
            return f"{op} {inner('exp')}" if op.isalpha() else f"{op}{inner('exp')}"
    if not op:
        return part("constant") if "constant" in parts else "…"
    return f"{op}({part('exp')})" if "exp" in parts else op
