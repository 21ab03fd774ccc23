# SPDX-License-Identifier: Apache-2.0
"""The rule `ignored-bounds`, which ignored_bounds.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.jani.properties import BinaryPath, UnaryPath, walk
from roaml.model.property_links import clock_step
from roaml.rules.rule import PropertiesContext, Rule
from roaml.smc.forms import BOUNDS, faults_in

TIME = (
    "`verify` cannot decide this: bounds on time are not supported here; compare `topic_clock_msg__ros_fields__sec`, "
    "the time in seconds, in the formula instead"
)


def check(context: PropertiesContext) -> Iterator[Finding]:
    if context.system is None:
        return
    step = clock_step(context.system)
    for property_ in context.properties:
        if not any(faults_in(property_, step)):
            continue  # an observer measures these times
        for formula in walk(property_.expression):
            if isinstance(formula, (UnaryPath, BinaryPath)):
                bound = formula.time_bounds
                if bound is not None and bound.origin is not None:
                    yield RULE.at(bound.origin.span, TIME)


RULE = Rule(
    BOUNDS,
    Severity.WARNING,
    "A property has bounds on time, which `verify` and `translate` do not support.",
    properties=check,
)
