# SPDX-License-Identifier: Apache-2.0
"""Machines of a system that are copies of each other with numbers in their names, and constants with the number of
another copy."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.tree import Expr
from roaml.model.message_constants import NumberedConstant, numbered_constants
from roaml.rules.rule import MachineContext
from roaml.rules.support.words import words_of

_MIN_NUMBERED = 3
"""How many machines of a system must have names that differ only in a number before their constants are compared with
it."""


def numbers_of_others(context: MachineContext) -> Iterator[tuple[Expr, str]]:
    """Constants with another number than the name of the machine, one of several that are copies of each other, each
    with the text that is meant: the text `'door_3'`, or 3 in the field `door`, in the machine `CloseDoor2`. All copies
    that have the same constant, with another number, must have their own one: machines that name their neighbours, or
    count from 0, are right."""
    if context.system is None or context.machine.name is None:
        return
    name = context.machine.name
    words = words_of(name.value)
    numbers = [place for place, word in enumerate(words) if word.isdigit()]
    if len(numbers) != 1 or numbers[0] == 0:
        return
    (at,) = numbers
    kind, own = words[at - 1], words[at]
    numbered: dict[str, frozenset[NumberedConstant]] = {}
    for _, outline in context.system.nodes:
        other = words_of(outline.name)
        if len(other) != len(words) or other[at] == own or not other[at].isdigit():
            continue
        if [*other[:at], own, *other[at + 1 :]] == words:
            numbered.setdefault(other[at], outline.numbered)
    if len(numbered) < _MIN_NUMBERED - 1:
        return
    for known, tree in numbered_constants(context.machine, context.typed):
        # A number in a field may have another meaning. A text may name a machine that this system does not use.
        if known.number == own or (known.field and known.number not in numbered):
            continue
        if kind not in words_of(known.field or known.text):
            continue
        in_copies = [(n, c.number) for n, constants in numbered.items() for c in constants if _is_copy(c, known)]
        if len(in_copies) < _MIN_NUMBERED - 1 or any(number != of_copy for of_copy, number in in_copies):
            continue
        quote = context.source.text[tree.span.start] if known.text else ""
        yield tree, f"{quote}{known.text.replace('#', own)}{quote}" if known.text else own


def _is_copy(constant_: NumberedConstant, other: NumberedConstant) -> bool:
    return constant_.field == other.field and constant_.text == other.text
