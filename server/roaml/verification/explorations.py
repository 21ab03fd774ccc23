# SPDX-License-Identifier: Apache-2.0
"""One exploration for all properties that ask about the same paths or the same reward, such as the minimum and the
maximum of one probability. Properties about different conditions are explored separately: a search that keeps the
answers of all of them leaves out fewer states, often far fewer than the separate searches together."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from roaml.jani.properties import (
    BinaryFormula,
    Expectation,
    ExpectationOperator,
    Filter,
    Formula,
    Probability,
    ProbabilityOperator,
)
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.verification.exhaustive import UndecidedError
from roaml.verification.results import Exact


class Explorations:
    """The exact values that are needed for several properties of a model."""

    def __init__(self) -> None:
        self._known: dict[Hashable, Exact | UndecidedError | FaultError | None] = {}
        self._checker: ModelChecker | None = None

    def checker(self, compile_: Callable[[], ModelChecker]) -> ModelChecker:
        """The model checker for the same properties under another assumption, compiled once."""
        if self._checker is None:
            self._checker = compile_()
        return self._checker

    def exact(
        self, checker: ModelChecker, property_: CompiledProperty, limits: Hashable, compute: Callable[[], Exact | None]
    ) -> Exact | None:
        """The exact values of a property. They are computed once for all properties of `checker` with the same subject.

        Args:
            limits: values with other limits are computed separately.
            compute: computes the values for `property_`; `None` if there are none.

        Raises:
            UndecidedError, FaultError: `compute` raises them.
        """
        subject = subject_of(checker, property_)
        if subject is None or [subject_of(checker, other) for other in checker.compiled_properties].count(subject) < 2:
            return compute()
        key = limits, subject
        if key not in self._known:
            try:
                self._known[key] = compute()
            except (UndecidedError, FaultError) as error:
                self._known[key] = error
        known = self._known[key]
        if isinstance(known, (UndecidedError, FaultError)):
            raise known
        return known if known is None else _about(known, property_)


def subject_of(checker: ModelChecker, property_: CompiledProperty) -> Hashable | None:
    """What a property asks about, without the extreme and the number with which it is compared. Two properties with the
    same subject have the same exact values. `None` for properties with an observer or assumptions."""
    question = property_.question
    if question.is_conditional or question.is_stuck or question.name in checker.outputs:
        return None
    fold = question.fold if question.initial_states > 1 else None
    return _without_extreme(property_.property.expression), fold


def _without_extreme(formula: Formula) -> Formula:
    match formula:
        case Filter():
            return _without_extreme(formula.values)
        case Probability():
            return replace(formula, operator=ProbabilityOperator.PMIN)
        case Expectation():
            return replace(formula, operator=ExpectationOperator.EMIN)
        case BinaryFormula(left=(Filter() | Probability() | Expectation()) as compared):
            return _without_extreme(compared)
        case BinaryFormula(right=(Filter() | Probability() | Expectation()) as compared):
            return _without_extreme(compared)
        case _:
            return formula


def _about(exact: Exact, property_: CompiledProperty) -> Exact:
    """The values, with traces that name another property with the same subject."""
    traces = []
    for trace in exact.traces:
        named = replace(trace.compiled_property, property=property_.property, question=property_.question)
        traces.append(replace(trace, compiled_property=named))
    return replace(exact, fold=property_.question.fold, traces=tuple(traces))
