# SPDX-License-Identifier: Apache-2.0
"""Entries of the blackboard in a translated tree. Their values are numbers or texts (docs/spec/mocks.md#blackboard)."""

from __future__ import annotations

import enum

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Boolean, Conditional, Expr, Number, String, Unary
from roaml.lower.build import binary, integer
from roaml.record import Record
from roaml.scxml.names import ENTRY_PREFIX
from roaml.text import NO_SPAN


class EntryKind(enum.Enum):
    INTEGER = "an integer"
    REAL = "a real number"
    TEXT = "a text"


class BoardEntry(Record, frozen=True):
    """An entry that scripts or nodes of the libraries read.

    Attributes:
        variable: the full name of the entry, which is unique in the tree.
        initial: the value before the first write; `None` if the entry does not exist then.
        type: the type of the variable of the blackboard if a plugin determines it; "" if `kind` determines it.
        text: the text that scripts read, if the entry is a constant text whatever `kind` is; otherwise `None`.
        is_text: whether the library stores the numbers as texts, because constants of `SetBlackboard` set the entry.
    """

    variable: str
    kind: EntryKind
    initial: int | float | str | None = None
    type: str = ""
    text: str | None = None
    is_text: bool = False

    @property
    def local(self) -> str:
        """The name of the variable in which an automaton stores the value that it has read last."""
        return f"{ENTRY_PREFIX}{self.variable}"

    @property
    def zero(self) -> Expr:
        """The default value of the entry: 0 or an empty text."""
        return constant(self.kind, "" if self.kind is EntryKind.TEXT else 0)

    @property
    def start(self) -> Expr:
        """The initial value of the variable of the blackboard."""
        value = self.zero if self.initial is None else constant(self.kind, self.initial)
        return Boolean(NO_SPAN, bool(self.initial)) if self.type == "bool" else value

    def read(self, value: Expr) -> Expr:
        """`value`, read from the variable of the blackboard, as a value of `kind`. A boolean becomes 0 or 1."""
        return Conditional(NO_SPAN, value, integer(1), integer(0)) if self.type == "bool" else value

    def written(self, value: Expr) -> Expr:
        """`value`, of the kind `kind`, as a value for the variable of the blackboard."""
        return binary(value, Operator.NOT_EQUAL, integer(0)) if self.type == "bool" else value

    @property
    def type_name(self) -> str:
        """The name of the type of the variable of the blackboard."""
        names = {EntryKind.INTEGER: "int64", EntryKind.REAL: "float64", EntryKind.TEXT: "string"}
        return self.type or names[self.kind]


def constant(kind: EntryKind, value: int | float | str) -> Expr:
    """A literal of the kind `kind` for `value`."""
    if kind is EntryKind.TEXT:
        return String(NO_SPAN, str(value))
    number = float(value) if kind is EntryKind.REAL else int(value)
    literal = Number(NO_SPAN, abs(number), kind is EntryKind.REAL)
    return literal if number >= 0 else Unary(NO_SPAN, UnaryOperator.NEGATE, literal)


def kind_of_cpp(type_: str) -> EntryKind | None:
    """The kind of the values of a C++ type, which is given by its normal name; `None` if they are neither numbers nor
    texts, or if the type is not known."""
    if type_ in ("double", "float"):
        return EntryKind.REAL
    if type_ == "string":
        return EntryKind.TEXT
    if type_ in ("bool", "int", "unsigned") or type_.removeprefix("u").startswith("int"):
        return EntryKind.INTEGER
    return None


def read_literal(text: str) -> tuple[EntryKind, int | float | str]:
    """The kind and the value of a text in a port. Texts that are numbers or booleans become numbers."""
    stripped = text.strip()
    if stripped in ("true", "false", "True", "False", "TRUE", "FALSE"):
        return EntryKind.INTEGER, int(stripped.lower() == "true")
    for kind, read in ((EntryKind.INTEGER, int), (EntryKind.REAL, float)):
        try:
            return kind, read(stripped)
        except ValueError:
            continue
    return EntryKind.TEXT, text
