# SPDX-License-Identifier: Apache-2.0
"""The types of HL-SCXML values (docs/spec/types.md) and functions on them.

Types are values: equal types compare equal, whichever file they were read from. A struct contains its members' types,
so no lookup is needed; ROS messages and event data are structs as well.
"""

from __future__ import annotations

import enum
import re
from collections.abc import Callable, Iterator
from typing import TypeAlias

from roaml.exhaustive import Vocabulary
from roaml.record import Record
from roaml.regex import regex


class ScalarKind(Vocabulary):
    BOOL = "bool"
    INT = "int"
    REAL = "real"
    STRING = "string"


class Scalar(Record, frozen=True):
    """A base type; `name` is its spelling, "" for a number without a declared width, such as a literal."""

    kind: ScalarKind
    name: str = ""

    def __str__(self) -> str:
        return self.name or ("float" if self.kind is ScalarKind.REAL else str(self.kind))


class Array(Record, frozen=True):
    """An array of at most `bound` elements. If `bound` is `None`, the maximum is `max_array_size` of the system."""

    element: Type
    bound: int | None = None

    def __str__(self) -> str:
        inner, bounds = unwrap(self)
        return f"{inner}{''.join('[]' if bound is None else f'[{bound}]' for bound in bounds)}"


class StructKind(enum.Enum):
    """What a struct describes."""

    DECLARED = enum.auto()
    """A struct of the models."""
    ROS = enum.auto()
    """A message, or a part of a service or action."""
    EVENT = enum.auto()
    """The parameters of an event."""
    HANDLER = enum.auto()
    """The data that a handler provides in addition to a message or event, such as the status of a child."""


class Struct(Record, frozen=True):
    """Named members in order.

    Attributes:
        name: the name of the declared struct, or of the ROS type with the section of a service or action, such as
            "std_srvs/SetBool request"; "" for other structs.
        what: a noun for messages that says what the struct describes, such as struct, message or event data.
        event: for `StructKind.EVENT`, the event whose parameters the members are.
    """

    name: str
    members: tuple[tuple[str, Type], ...]
    what: str = "struct"
    kind: StructKind = StructKind.DECLARED
    event: str = ""

    def __str__(self) -> str:
        return self.name or self.what

    def member(self, name: str) -> Type | None:
        for key, type_ in self.members:
            if key == name:
                return type_
        return None


class EmptyArray(Record, frozen=True):
    """The type of `[]`, which fits every array."""

    def __str__(self) -> str:
        return "[]"


class Unknown(Record, frozen=True):
    """The type of an expression with a reported error. It fits every type, so that each error is reported only once."""

    def __str__(self) -> str:
        return "unknown"


Type: TypeAlias = Scalar | Array | Struct | EmptyArray | Unknown

BOOL = Scalar(ScalarKind.BOOL, "bool")
INT = Scalar(ScalarKind.INT)
REAL = Scalar(ScalarKind.REAL)
STRING = Scalar(ScalarKind.STRING, "string")
UNKNOWN = Unknown()
EMPTY_ARRAY = EmptyArray()

INTEGER_RANGES = {f"int{n}": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)} | {
    f"uint{n}": (0, 2**n - 1) for n in (8, 16, 32, 64)
}
"""The smallest and greatest value of each integer type."""

BASE_TYPES: dict[str, Scalar] = {
    "bool": BOOL,
    **{name: Scalar(ScalarKind.INT, name) for name in INTEGER_RANGES},
    "float32": Scalar(ScalarKind.REAL, "float32"),
    "float64": Scalar(ScalarKind.REAL, "float64"),
    "string": STRING,
}

_TYPE = regex(r"([A-Za-z_]\w*)((?:\[\d*\])*)\Z", re.ASCII)


class TypeName(Record, frozen=True):
    """A type as it is written: the name of a base type or struct, and the dimensions of an array, outermost first. A
    dimension without a bound is `None`."""

    base: str
    dimensions: tuple[int | None, ...] = ()


def parse_type(text: str) -> TypeName | None:
    """`int32[3][]` -> TypeName("int32", (3, None)); `None` if `text` does not have the form of a type
    (docs/spec/types.md#type-names)."""
    match = _TYPE.match(text)
    if match is None:
        return None
    bounds = re.findall(r"\[(\d*)\]", match[2])
    return TypeName(match[1], tuple(int(bound[:9]) if bound else None for bound in bounds))


def resolve_type(name: TypeName, struct: Callable[[str], Type | None]) -> Type | None:
    """The type with the name `name`; `None` if its base is neither a base type nor known to `struct`."""
    type_: Type | None = BASE_TYPES.get(name.base) or struct(name.base)
    if type_ is None:
        return None
    return wrap(type_, name.dimensions)


def wrap(type_: Type, dimensions: tuple[int | None, ...]) -> Type:
    """`type_` in arrays with the given bounds, outermost first."""
    for bound in reversed(dimensions):
        type_ = Array(type_, bound)
    return type_


def unwrap(type_: Type) -> tuple[Type, tuple[int | None, ...]]:
    """The innermost element type and the bounds around it, outermost first: the inverse of `wrap`."""
    bounds: list[int | None] = []
    while isinstance(type_, Array):
        bounds.append(type_.bound)
        type_ = type_.element
    return type_, tuple(bounds)


def leaves(type_: Type, prefix: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Type]]:
    """The leaf members of a type in declaration order, depth first, with the names of the members that lead to them
    (docs/spec/types.md#leaves).

    The dimensions of enclosing arrays come first: in a member of type `Vec[4]`, the member `x: float64[]` of `Vec`
    gives `float64[4][]`.
    """
    inner, bounds = unwrap(type_)
    if isinstance(inner, Struct):
        for name, member in inner.members:
            for path, leaf in leaves(member, (*prefix, name)):
                yield path, wrap(leaf, bounds)
    else:
        yield prefix, type_


def member_type(type_: Type, name: str) -> Type | None:
    """The type of a member of a struct; for an array of structs, an array of this type. `None` if there is no member
    with this name (docs/spec/types.md#leaves)."""
    inner, bounds = unwrap(type_)
    member = inner.member(name) if isinstance(inner, Struct) else None
    return None if member is None else wrap(member, bounds)


def is_number(type_: Type) -> bool:
    return isinstance(type_, Scalar) and type_.kind in (ScalarKind.INT, ScalarKind.REAL)


def is_kind(type_: Type, kind: ScalarKind) -> bool:
    return isinstance(type_, Scalar) and type_.kind is kind


def fits(value: Type, target: Type) -> bool:
    """Whether a value of type `value` may be stored where `target` is declared.

    An int fits a real. Widths and bounds are not compared, because integers are mathematical
    (docs/spec/types.md#conversion). A struct fits a struct with the same name. An unknown type fits every type.
    """
    match value, target:
        case (Unknown(), _) | (_, Unknown()):
            return True
        case Scalar(kind=given), Scalar(kind=required):
            return given is required or (given is ScalarKind.INT and required is ScalarKind.REAL)
        case EmptyArray(), Array() | EmptyArray():
            return True
        case Array(element=given), Array(element=required):
            return fits(given, required)
        case Struct(), Struct():
            return value.name == target.name
        case _:
            return False


def join(left: Type, right: Type) -> Type | None:
    """The common type of values of two types; `None` if there is none. The common type of two arrays has the greater
    bound, or none if one of the two has none."""
    if isinstance(left, Array) and isinstance(right, Array):
        element = join(left.element, right.element)
        bounded = left.bound is not None and right.bound is not None
        bound = max(left.bound or 0, right.bound or 0) if bounded else None
        return None if element is None else Array(element, bound)
    if fits(left, right):
        return left if isinstance(right, Unknown) else right
    if fits(right, left):
        return left
    return None


def same_kind(left: Type, right: Type) -> bool:
    """Whether the translation stores values of both types in the same JANI type. Bounds are not compared; an unknown
    type is equal to every type, and a struct to none."""
    match left, right:
        case (Unknown(), _) | (_, Unknown()) | (EmptyArray(), EmptyArray() | Array()) | (Array(), EmptyArray()):
            return True
        case Array(), Array():
            return same_kind(left.element, right.element)
        case Scalar(), Scalar():
            return left.kind is right.kind
    return False


def type_of_empty(declared: Type) -> Type:
    """The type of the values that are sent if only `[]` is sent for a field of the type `declared` and a receiver reads
    the data: that of an array of numbers does not depend on the field (docs/spec/jani.md#global-variables)."""
    element, bounds = unwrap(declared)
    is_number = is_kind(element, ScalarKind.INT) or is_kind(element, ScalarKind.REAL)
    return EMPTY_ARRAY if is_number and len(bounds) == 1 else declared


def type_of_text(text: str) -> str:
    """The name of the probable type of a value that is written without quotes, such as `float64` for `0.5`."""
    stripped = text.strip()
    if stripped in ("true", "false"):
        return "bool"
    for convert, name in ((int, "int32"), (float, "float64")):
        try:
            convert(stripped)
        except ValueError:
            continue
        return name
    return "string"
