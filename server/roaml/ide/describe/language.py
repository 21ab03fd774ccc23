# SPDX-License-Identifier: Apache-2.0
"""Descriptions of parts of the languages, as Markdown: elements, attributes, values, functions, operators.

All are pure functions of an entry in a grammar or in a table, so that completion, hover and signature help show the
same text.
"""

from __future__ import annotations

from collections.abc import Mapping

from roaml.distributions.laws import LawFunction
from roaml.expr.operators import FUNCTIONS, Function, Operator, UnaryOperator
from roaml.expr.types import BASE_TYPES, INTEGER_RANGES, Scalar, Struct, Type, unwrap
from roaml.ide.describe.markdown import code, lines, name, names, paragraphs
from roaml.language import AttributeType, ElementType, PortType, ValueChoice
from roaml.roles import NodeKind, ValueRole

_VALUE_PHRASES = {
    ValueRole.EXPRESSION: "an expression",
    ValueRole.CONSTANT: "a constant expression",
    ValueRole.LOCATION: "a location expression",
}
_ROS = {"msg": "a message type", "srv": "a service type", "action": "an action type"}


def element(type_: ElementType) -> str:
    """The description of an element: its syntax, its meaning, and the event variables that are available in it."""
    if type_.node and type_.node is not NodeKind.SUBTREE:
        return builtin_node(type_)
    required = "".join(f' {a.name}="…"' for a in type_.attributes.values() if a.required)
    known = names(binding.name for binding in type_.binds)
    return paragraphs(
        code(f"<{type_.name}{required}>", "xml"),
        type_.documentation,
        lines(_successor(type_.use), f"Available in this element: {known}" if known else ""),
    )


def builtin_node(type_: ElementType) -> str:
    """The description of a node of BehaviorTree.CPP: its ports and its behavior."""
    ports = "".join(f"\n  {port(setting.name, setting.port)}" for setting in type_.ports if setting.port)
    cannot = "" if type_.translated else "This node cannot be translated."
    kind = "node" if type_.node in (None, NodeKind.SUBTREE) else f"{type_.node} node"
    return paragraphs(
        code(f"{kind} {type_.name}{ports}"),
        type_.documentation,
        lines(_successor(type_.use), cannot),
        "" if type_.name in ("Action", "Condition", "Control", "Decorator") else "*BehaviorTree.CPP*",
    )


def port(key: str, type_: PortType) -> str:
    """The signature of a port of a node of BehaviorTree.CPP, in one line: direction, name, type and default."""
    default = f" = {type_.default}" if type_.default else ""
    return f"{type_.direction} {key} : {type_.type}{default}"


def attribute(type_: AttributeType) -> str:
    """The description of an attribute: the kind of its value, its meaning, and the values of an enumeration."""
    if type_.port:
        must = "must be set" if type_.port.required else ""
        constant = "must be a constant" if type_.port.constant else ""
        return paragraphs(
            code(f"{port(type_.name, type_.port)}"),
            type_.documentation,
            " · ".join(filter(None, (must, constant))),
        )
    facts = [f"{phrase}" if (phrase := _value_phrase(type_)) else "", "required" if type_.required else ""]
    shown = " · ".join(filter(None, facts))
    return paragraphs(
        code(f'{type_.name}="…"', "xml"),
        type_.documentation,
        lines(
            *(f"{name(option.value)}: {option.documentation}" for option in type_.simple.choices if not option.use),
            shown[:1].upper() + shown[1:],
            _successor(type_.use),
        ),
    )


def _value_phrase(type_: AttributeType) -> str:
    """A noun phrase for the values that an attribute accepts; "" if there is none."""
    if type_.value is ValueRole.ROS_TYPE:
        return _ROS.get(type_.value_type, "")
    phrase = _VALUE_PHRASES.get(type_.value, "") if type_.value else ""
    if type_.value is ValueRole.EXPRESSION and type_.value_type not in ("", "any"):
        phrase = f"{phrase} of type {name(type_.value_type)}"
    simple = type_.simple
    if simple.above is not None:
        phrase = f"a number above {simple.above:g}"
    if simple.least is not None and simple.most is not None:
        phrase = f"a number from {simple.least:g} to {simple.most:g}"
    return phrase


def choice(value: ValueChoice) -> str:
    """The description of one of the values of an attribute with an enumeration type."""
    return paragraphs(code(value.value), value.documentation, _successor(value.use))


def _successor(use: str) -> str:
    return f"Older spelling of {name(use)}" if use else ""


# ----------------------------------------------------------------- expressions


def function(math_function: Function) -> str:
    """The description of a function of `Math`."""
    return paragraphs(code(signature(math_function)), math_function.documentation)


def signature(math_function: Function) -> str:
    """The signature of a function of `Math`: its parameters, with `?` after the optional ones and `…` if more
    can be given, and its result."""
    needed = len(math_function.parameters) - math_function.optional
    parameters = [f"{parameter}{'?' if i >= needed else ''}" for i, parameter in enumerate(math_function.parameters)]
    parameters += ["…"] if math_function.repeats else []
    return f"Math.{math_function.name}({', '.join(parameters)}) : {math_function.result}"


def law(distribution: LawFunction) -> str:
    """The description of a distribution."""
    rounded = " Its numbers are rounded to multiples of `step`." if distribution.is_continuous else ""
    return paragraphs(code(distribution.signature), f"{distribution.documentation}{rounded}")


def math() -> str:
    """The description of the object `Math`: a list of its functions."""
    return paragraphs(code("Math"), f"Functions: {names(FUNCTIONS, len(FUNCTIONS))}")


_OPERATORS: Mapping[Operator | UnaryOperator, tuple[str, str]] = {
    Operator.OR: ("bool || bool : bool", "True if at least one operand is true."),
    Operator.AND: ("bool && bool : bool", "True if both operands are true."),
    Operator.EQUAL: ("x == y : bool", "Whether both operands are equal."),
    Operator.NOT_EQUAL: ("x != y : bool", "Whether the operands differ."),
    Operator.LESS: ("number < number : bool", "Whether the left operand is less than the right one."),
    Operator.LESS_EQUAL: (
        "number <= number : bool",
        "Whether the left operand is less than or equal to the right one.",
    ),
    Operator.GREATER: ("number > number : bool", "Whether the left operand is greater than the right one."),
    Operator.GREATER_EQUAL: (
        "number >= number : bool",
        "Whether the left operand is greater than or equal to the right one.",
    ),
    Operator.ADD: ("number + number : int or float", "The sum: an int if both operands are ints."),
    Operator.SUBTRACT: ("number - number : int or float", "The difference: an int if both operands are ints."),
    Operator.MULTIPLY: ("number * number : int or float", "The product: an int if both operands are ints."),
    Operator.DIVIDE: ("number / number : float", "The quotient, never rounded: `1 / 2` is `0.5`."),
    Operator.REMAINDER: ("number % number : int or float", "The remainder of the division."),
    UnaryOperator.NEGATE: ("-number : int or float", "The negative."),
    UnaryOperator.PLUS: ("+number : int or float", "The number itself."),
    UnaryOperator.NOT: ("!bool : bool", "True if the operand is false."),
}


def operator(token: Operator | UnaryOperator) -> str:
    """The description of an operator of expressions: its operands and its result."""
    head, text = _OPERATORS[token]
    return paragraphs(code(head), text)


def conditional() -> str:
    """The description of the operator `? :`."""
    return paragraphs(code("bool ? x : y"), "The first value if the condition holds, otherwise the second.")


EVENT_VARIABLES = {
    "_msg": "The message that has arrived.",
    "_req": "The request that has arrived.",
    "_res": "The response that has arrived.",
    "_goal": "The goal that has arrived.",
    "_feedback": "The feedback that has arrived.",
    "_wrapped_result": "The result that has arrived, with its code.",
    "_action": "The goal to which this event belongs.",
    "_event": "The event that has arrived.",
    "_bt": "The status that the child has returned.",
}


def event_variable(called: str, type_: Type) -> str:
    """The description of an event variable, such as `_msg`. `type_` is its type at the place of its use."""
    inner, _ = unwrap(type_)
    of = f" : {inner.name}" if isinstance(inner, Struct) and inner.name else ""
    rows = _rows(inner) if isinstance(inner, Struct) else []
    return paragraphs(code("\n".join((f"{called}{of}", *rows))), EVENT_VARIABLES.get(called, ""))


def event_data(struct: Struct) -> str:
    """The description of `_event.data`, with the parameters of the event."""
    return paragraphs(code("\n".join(("_event.data", *_rows(struct)))), "The parameters of the event.")


def status(called: str, value: int) -> str:
    """The description of a name for the status of a tree node, such as `SUCCESS`, and its numeric value."""
    return paragraphs(code(f"{called} = {value}"), "The status of a tree node.")


def length(of: str) -> str:
    """The description of the member `length` of the array `of`."""
    return paragraphs(
        code("length : int"),
        f"The current number of elements of {name(of)}. A smaller number shortens the array, and 0 empties it.",
    )


# ----------------------------------------------------------------------- types


def value_range(type_: Type) -> str:
    """The smallest and greatest value of the numbers in a type, as a phrase; "" if the type has no range."""
    inner, _ = unwrap(type_)
    if not isinstance(inner, Scalar) or inner.name not in INTEGER_RANGES:
        return ""
    least, most = INTEGER_RANGES[inner.name]
    return f"from {number(least)} to {number(most)}"


def number(value: int) -> str:
    """A number; if it has at least five digits, with a thin space between groups of three digits."""
    return f"{value:,}".replace(",", "\u202f").replace("-", "−") if abs(value) >= 10000 else str(value)


def type_(type_: Type) -> str:
    """The description of a type: its range, its size, or its members."""
    inner, bounds = unwrap(type_)
    if isinstance(inner, Struct):
        return code(members(inner))
    rest = value_range(type_)
    facts = " · ".join(filter(None, (rest, array_size(bounds))))
    return paragraphs(code(str(type_)), f"{facts[:1].upper()}{facts[1:]}")


def array_size(bounds: tuple[int | None, ...]) -> str:
    """The maximum number of elements of an array with the bounds `bounds`, as a phrase; "" if there are no bounds."""
    if not bounds:
        return ""
    size = " times ".join("`max_array_size`" if bound is None else str(bound) for bound in bounds)
    return f"at most {size} elements"


def members(struct: Struct, most: int = 24) -> str:
    """The name of a struct, message or event and its members, one per line. If there are more than `most` + 1 members,
    `most` are shown, and the others are counted."""
    head = " ".join(filter(None, (struct.what, struct.name if struct.name not in struct.what else "")))
    return "\n".join([head, *_rows(struct, most)])


def _rows(struct: Struct, most: int = 24) -> list[str]:
    rows = [f"  {key} : {type_}" for key, type_ in struct.members]
    return [*rows[:most], f"  … {len(rows) - most} more"] if len(rows) > most + 1 else rows


def base_type(written: str) -> str:
    """The description of the base type with the name `written`; "" if there is no such type."""
    known = BASE_TYPES.get(written)
    return type_(known) if known is not None else ""
