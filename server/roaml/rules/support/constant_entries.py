# SPDX-License-Identifier: Apache-2.0
"""Entries of the blackboard that always have the same value, because only one script sets them, to a constant."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from roaml.forest.entries import BoundUse, Use
from roaml.forest.forest import Forest
from roaml.forest.scripts import grammar_of, parsed, scripts_of
from roaml.record import Record
from roaml.rules.support.entries import entries_of
from roaml.script.tree import Assignment, Number, walk
from roaml.text import Decoded


class ConstantEntry(Record, frozen=True, eq=False):
    """An entry with only one value.

    Attributes:
        value: the number that a script assigns.
        writer: the script that assigns it.
        names: the other entries to which the same script assigns a number.
    """

    value: float
    writer: BoundUse
    names: tuple[str, ...]


@functools.lru_cache(maxsize=1)
def constant_entries(forest: Forest) -> Mapping[str, ConstantEntry]:
    """Key of an entry -> the number that it always has, once it is set. The result for the last forest is cached,
    because several rules need it."""
    entries = entries_of(forest)
    if not any(use.script and use.writes for use in entries.uses):
        return {}
    from roaml.forest.script_values import scripted_entries  # noqa: PLC0415 - few trees contain scripts

    constant: dict[str, ConstantEntry] = {}
    for key in scripted_entries(forest, entries):
        writers = {bound.use: bound for bound in entries.by_entry[key] if bound.use.writes}
        if len(writers) == 1:
            ((use, bound),) = writers.items()
            numbers = _numbers(forest, use)
            if bound.executed and use.name in numbers and not use.reads:
                others = tuple(name for name in numbers if name != use.name)
                constant[key] = ConstantEntry(numbers[use.name], bound, others)
    return constant


def _numbers(forest: Forest, use: Use) -> Mapping[str, float]:
    """The numbers that a script assigns, by the names of the entries, if it always does, and only once."""
    assigned: dict[str, float] = {}
    for script in scripts_of(forest, use.node):
        if script.attribute.value_span != use.span:
            continue
        tree, _ = parsed(Decoded(script.attribute.value, 0), grammar_of(forest.settings.version))
        targets = [expr.target.name for expr in walk(tree) if isinstance(expr, Assignment)]
        for statement in tree.statements:
            if isinstance(statement, Assignment) and isinstance(statement.value, Number):
                name = statement.target.name
                if statement.operator in (":=", "=") and targets.count(name) == 1:
                    assigned[name] = statement.value.value
    return assigned
