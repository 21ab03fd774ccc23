# SPDX-License-Identifier: Apache-2.0
"""ROS 2 interface definitions as data.

- Everything is frozen and hashable: definitions are part of memo keys.
- Equality ignores spans, comments and the spelling of values: a definition stays equal to itself when comments or white
  space of its file change. The paths of definitions are compared.
- A nested type is known by name only (`package/Name`); `roaml.interfaces.registry` resolves it.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import Literal, TypeAlias

from roaml.record import PartlyCompared, Record
from roaml.text import Span

Kind: TypeAlias = Literal["msg", "srv", "action"]
"""The kinds of definitions, which are also the folder and the file extension of a definition."""

KINDS: tuple[Kind, ...] = ("msg", "srv", "action")

KIND_NAMES: Mapping[Kind, str] = {"msg": "message", "srv": "service", "action": "action"}

SECTION_NAMES: Mapping[Kind, tuple[str, ...]] = {
    "msg": ("message",),
    "srv": ("request", "response"),
    "action": ("goal", "result", "feedback"),
}
"""The sections of a definition in their order in the file, separated by `---`."""

INTEGER_RANGES: Mapping[str, tuple[int, int]] = {
    "byte": (0, 255),
    "char": (0, 255),
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
}
"""The smallest and the greatest value of each integer type. In ROS 2, `byte` and `char` are unsigned."""

FLOATS = frozenset({"float32", "float64"})
STRINGS = frozenset({"string", "wstring"})
PRIMITIVES = frozenset({"bool", *INTEGER_RANGES, *FLOATS, *STRINGS})

FOREIGN_TYPES: Mapping[str, str] = {
    "boolean": "bool", "double": "float64", "float": "float32", "int": "int32", "integer": "int32", "long": "int64",
    "number": "float64", "real": "float64", "short": "int16", "str": "string", "uint": "uint32", "unsigned": "uint32",
}  # fmt: skip
"""Names of types in other languages, with the names that they have in ROS 2."""

Scalar: TypeAlias = bool | int | float | str
Value: TypeAlias = Scalar | tuple[Scalar, ...]
"""The value of a constant or default; that of an array is a tuple."""


class ArrayKind(enum.Enum):
    """The kind of an array, by its number of elements."""

    NONE = "none"
    """Not an array: `T`."""
    FIXED = "fixed"
    """Exactly `size` elements: `T[N]`."""
    BOUNDED = "bounded"
    """At most `size` elements: `T[<=N]`."""
    UNBOUNDED = "unbounded"
    """Any number of elements: `T[]`."""


class FieldType(Record, frozen=True):
    """The type of a field or constant.

    `name` is a primitive (`PRIMITIVES`) or the name of a message, `package/Name`; in a file with errors it may be
    neither, and is then treated as an unknown type. `string_bound` is the maximum number of characters of a `string<=N`
    or `wstring<=N`. `size` is set for the array kinds FIXED and BOUNDED.
    """

    name: str
    string_bound: int | None = None
    array: ArrayKind = ArrayKind.NONE
    size: int | None = None

    @property
    def is_primitive(self) -> bool:
        """Whether a value, or each element, is not a nested message."""
        return self.name in PRIMITIVES

    @property
    def is_array(self) -> bool:
        return self.array is not ArrayKind.NONE

    @property
    def element(self) -> FieldType:
        """The type of one element; the type itself if it is not an array."""
        return FieldType(self.name, self.string_bound)

    def __str__(self) -> str:
        """The type as it is written in a definition file."""
        bound = "" if self.string_bound is None else f"<={self.string_bound}"
        match self.array:
            case ArrayKind.NONE:
                suffix = ""
            case ArrayKind.FIXED:
                suffix = f"[{self.size}]"
            case ArrayKind.BOUNDED:
                suffix = f"[<={self.size}]"
            case ArrayKind.UNBOUNDED:
                suffix = "[]"
        return f"{self.name}{bound}{suffix}"


class Field(PartlyCompared, frozen=True):
    """A member of a message. Without `default`, its initial value is 0, false or empty.

    `default_text` is the default as written. `comment` contains the lines above, beside and below the field, without
    `#`.
    """

    UNCOMPARED = frozenset({"default_text", "comment", "name_span", "type_span", "default_span"})

    name: str
    type: FieldType
    default: Value | None = None
    default_text: str = ""
    comment: str = ""
    name_span: Span = Span(0, 0)
    type_span: Span = Span(0, 0)
    default_span: Span | None = None


class Constant(PartlyCompared, frozen=True):
    """A named value of a definition. It is not a field and not sent. `value` is `None` if the file has an error
    there."""

    UNCOMPARED = frozenset({"value_text", "comment", "name_span", "type_span", "value_span"})

    name: str
    type: FieldType
    value: Scalar | None
    value_text: str = ""
    comment: str = ""
    name_span: Span = Span(0, 0)
    type_span: Span = Span(0, 0)
    value_span: Span = Span(0, 0)


class Section(PartlyCompared, frozen=True):
    """A message, or one part of a service or action. `comment` is the block of comment lines at its beginning."""

    UNCOMPARED = frozenset({"comment"})

    fields: tuple[Field, ...] = ()
    constants: tuple[Constant, ...] = ()
    comment: str = ""

    def field(self, name: str) -> Field | None:
        return next((f for f in self.fields if f.name == name), None)

    def named_values(self, field: str) -> tuple[Constant, ...]:
        """The constants that are probably values of a field: those of its type that begin like the field; if there are
        none, all of its type."""
        declared = self.field(field)
        fitting = [c for c in self.constants if declared is not None and c.type.name == declared.type.element.name]
        return tuple([c for c in fitting if c.name.startswith(field.upper())] or fitting)


class Definition(Record, frozen=True):
    """A message, service or action type. It has all the sections of `SECTION_NAMES[kind]`, in that order.

    `path` is the file that contains the definition; "" if the definition was not read from a file. `is_complete` is
    false if the file has too few or too many lines `---`, so that fields may be in the wrong section.
    """

    package: str
    name: str
    kind: Kind
    sections: tuple[Section, ...]
    path: str = ""
    is_complete: bool = True

    @property
    def full_name(self) -> str:
        """The name of the type in models: `package/Name`."""
        return f"{self.package}/{self.name}"

    @property
    def comment(self) -> str:
        """The comment at the beginning of the file, which describes the whole type."""
        return self.sections[0].comment

    def section(self, name: str) -> Section:
        """The section with a name of `SECTION_NAMES[kind]`. Raises `KeyError` for other names."""
        try:
            return self.sections[SECTION_NAMES[self.kind].index(name)]
        except ValueError:
            raise KeyError(name) from None


def with_article(kind: Kind) -> str:
    return f"{'an' if kind == 'action' else 'a'} {KIND_NAMES[kind]}"
