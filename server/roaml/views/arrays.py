# SPDX-License-Identifier: Apache-2.0
"""Arrays and strings as the models declare them. Arrays are cut to their lengths, which are separate variables of the
translation (docs/spec/jani.md#array-storage). The type of a variable states whether it is a string."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, TypeAlias

from roaml.jani.expressions import Expression
from roaml.jani.model import Automaton
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.jani.types import Type, element_of, is_text
from roaml.scxml.names import array_of, length_name
from roaml.smc.record import Plain, RecordedVariable, StoredText, TraceStep

DeclaredValue: TypeAlias = "bool | int | float | str | list[DeclaredValue]"
"""A value as the models declare it: an array without its unused elements, a string as text."""


class DeclaredChange(NamedTuple):
    """A change of a variable, with its values as the models declare them."""

    variable: RecordedVariable
    before: DeclaredValue
    after: DeclaredValue


def declared(name: str, value: Plain, stored: Mapping[str, Plain], index: tuple[int, ...] = ()) -> DeclaredValue:
    """A stored value as the model declares it.

    Args:
        name, index: the variable, and the indices of the value in it.
        stored: variables of the same automaton or of the network; the lengths of the array are among them. An array
            without length is not cut; a string without length ends before its last zeros.
    """
    if not isinstance(value, list):
        return value
    length = length_of(name, stored, index)
    used = value[:length]
    if isinstance(value, StoredText):
        text = _text(used)
        return text.rstrip("\0") if length is None else text
    return [declared(name, inner, stored, (*index, number)) for number, inner in enumerate(used)]


MAX_BYTE = 0xFF


def _text(elements: Iterable[Plain]) -> str:
    """The string with these bytes; other numbers and bytes that are not UTF-8 become replacement characters."""
    numbers = (number for number in elements if isinstance(number, int))
    return bytes(number if 0 <= number <= MAX_BYTE else MAX_BYTE for number in numbers).decode("utf-8", "replace")


def without_lengths(stored: Mapping[str, Plain]) -> dict[str, DeclaredValue]:
    """The variables except lengths, as the models declare them."""
    return {name: declared(name, value, stored) for name, value in stored.items() if not array_of(name)}


def length_of(name: str, stored: Mapping[str, Plain], index: Sequence[int]) -> int | None:
    """The length of an array, or of the element of it at `index`; `None` if it is not stored."""
    lengths = stored.get(length_name(name, len(index) + 1))
    value = None if lengths is None else element_at(lengths, index)
    return value if isinstance(value, int) else None


def element_at(value: Plain, index: Iterable[int]) -> Plain:
    """The element of an array at `index`; if there is none, the innermost value around it."""
    for number in index:
        if not isinstance(value, list) or number >= len(value):
            break
        value = value[number]
    return value


class ArrayReader:
    """Reads the changes of the steps of a trace, in their order.

    Args:
        automata: the automaton of each instance.
        start: the variables of the model before the first step.
    """

    def __init__(self, automata: Sequence[Automaton], start: Mapping[str, Plain]) -> None:
        self._automata = automata
        self._stored: dict[int, dict[str, Plain]] = {-1: dict(start)}

    def read(self, step: TraceStep) -> list[DeclaredChange]:
        """The changes of a step, as the models declare the variables. A change of a length is one of its array."""
        changed = dict.fromkeys(
            RecordedVariable(change.variable.instance, array_of(change.variable.name) or change.variable.name)
            for change in step.changes
        )
        for change in step.changes:
            self._of(change.variable.instance).setdefault(change.variable.name, change.before)
        before = [self._value(variable) for variable in changed]
        for change in step.changes:
            self._of(change.variable.instance)[change.variable.name] = change.after
        changes = (
            DeclaredChange(variable, value, self._value(variable))
            for variable, value in zip(changed, before, strict=True)
        )
        return [change for change in changes if change.before != change.after]

    def _value(self, variable: RecordedVariable) -> DeclaredValue:
        stored = self._of(variable.instance)
        return declared(variable.name, stored.get(variable.name, []), stored)

    def _of(self, instance: int) -> dict[str, Plain]:
        """The stored variables of an instance. At first, these are its arrays and their lengths."""
        if instance not in self._stored:
            initial = _initial(self._automata[instance])
            arrays = {array_of(name) for name in initial} - {""}
            self._stored[instance] = {n: value for n, value in initial.items() if n in arrays or array_of(n)}
        return self._stored[instance]


def initial_values(automaton: Automaton) -> dict[str, DeclaredValue]:
    """The initial values of the variables of an automaton, except those that are not constants."""
    return without_lengths(_initial(automaton))


def _initial(automaton: Automaton) -> dict[str, Plain]:
    return {
        variable.name: value
        for variable in automaton.variables
        if variable.initial_value is not None
        and (value := _constant(variable.initial_value, variable.type)) is not None
    }


def _constant(expression: Expression, type_: Type) -> Plain | None:
    """The value of an expression of type `type_`; `None` if it is not a constant."""
    try:
        return _plain(evaluate(expression, {}), type_)
    except EvaluationError:
        return None


def _plain(value: Value, type_: Type) -> Plain | None:
    match value:
        case bool() | int() | float():
            return value
        case tuple():
            element = element_of(type_)
            elements = [plain for inner in value if (plain := _plain(inner, element)) is not None]
            return StoredText(elements) if is_text(type_) else elements
        case _:
            return None
