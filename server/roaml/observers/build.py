# SPDX-License-Identifier: Apache-2.0
"""Translates a property to its observer."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.observers.formulas import observe_formula
from roaml.observers.patterns import observe_pattern
from roaml.observers.program import Observer, State, step
from roaml.observers.properties import PatternProperty, Property


def observer_of(property_: Property) -> Observer:
    """The observer of a property; its registers have their values before the first letter."""
    if isinstance(property_, PatternProperty):
        return observe_pattern(property_)
    return observe_formula(property_)


def begin(observer: Observer, inputs: Mapping[str, bool]) -> State:
    """The state of an observer after the first letter, which is the start of the trace."""
    return step(observer, observer.initial(), inputs, tick=False)
