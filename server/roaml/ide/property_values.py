# SPDX-License-Identifier: Apache-2.0
"""The names of numbers in properties that represent statuses of tree nodes or codes of action results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Name, Number, walk
from roaml.ide.json_tree import members, values
from roaml.jani.operators import BINARY_OPERATORS
from roaml.json_syntax import JsonNumber, JsonString, JsonValue
from roaml.model.property_file import Port, PortKind, PortVariable, PortVariableKind, PropertyFile
from roaml.model.value_types import GOAL_STATUSES
from roaml.regex import regex
from roaml.scxml.names import STATUSES

_STATUS_NAMES: Mapping[int, str] = {number: name for name, number in STATUSES.items()}
_STATUS = regex(r"bt_\d+_response__status")
_CODE = regex(r"\w+_result(?:_handle_client_\w+)?__code")
_COMPARISONS = ("=", "≠", "<", "≤", ">", "≥")
_COMPARING = frozenset(
    (
        Operator.EQUAL,
        Operator.NOT_EQUAL,
        Operator.LESS,
        Operator.LESS_EQUAL,
        Operator.GREATER,
        Operator.GREATER_EQUAL,
    )
)


def names_of_port(port: Port, variable: PortVariable) -> Mapping[int, str]:
    """The names of the values of a variable; empty if they have none."""
    if port.kind is PortKind.NODE and variable.kind is PortVariableKind.STATE:
        return _STATUS_NAMES
    return GOAL_STATUSES if variable.kind is PortVariableKind.RESULT_CODE else {}


def names_of_global(variable: str) -> Mapping[int, str]:
    """The names of the values of a global variable of the translation; empty if they have none."""
    if _STATUS.fullmatch(variable):
        return _STATUS_NAMES
    return GOAL_STATUSES if _CODE.fullmatch(variable) else {}


def named_numbers(file: PropertyFile, condition: Expr) -> Iterator[tuple[Number, str]]:
    """The numbers in a condition that are compared with a variable whose values have names, each with its name."""
    names = {v.id.value: names_of_port(port, v) for port, v in file.variables if v.id is not None}
    for node in walk(condition):
        if isinstance(node, Binary) and node.operator in _COMPARING:
            for variable, number in ((node.left, node.right), (node.right, node.left)):
                if isinstance(variable, Name) and isinstance(number, Number) and not number.is_real:
                    name = names.get(variable.name, {}).get(int(number.value))
                    if name is not None:
                        yield number, name


def compared_global(around: Mapping[str, JsonValue], number: JsonNumber | None = None) -> str:
    """The name of the global variable with which a number in a JANI expression is compared; "" if there is none.

    Args:
        around: the members of the comparison.
        number: the value of one of these members; `None` if the number has not been written yet.
    """
    operator = around.get("op")
    known = BINARY_OPERATORS.get(operator.value) if isinstance(operator, JsonString) else None
    sides = [around.get("left"), around.get("right")]
    if known is None or known.symbol not in _COMPARISONS or (number is not None and number not in sides):
        return ""
    return next((side.value for side in sides if isinstance(side, JsonString)), "")


def named_json_numbers(value: JsonValue) -> Iterator[tuple[JsonNumber, str]]:
    """The numbers in JANI that are compared with a global variable whose values have names, each with its name."""
    for part in values(value):
        around = members(part)
        for side in (around.get("left"), around.get("right")):
            if isinstance(side, JsonNumber):
                names = names_of_global(compared_global(around, side))
                name = names.get(int(side.text)) if side.text.isdecimal() else None
                if name is not None:
                    yield side, name
