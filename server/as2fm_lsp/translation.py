# SPDX-License-Identifier: Apache-2.0
"""Functions for translations that the command line and the server share."""

from __future__ import annotations

import os

from roaml.diagnostics import Diagnostic, Severity
from roaml.jani.model import Model
from roaml.jani.properties import Property
from roaml.record import replace
from roaml.smc.forms import BOUNDS, TIME_BOUNDS, time_bounds_in


def jani_path(system: str) -> str:
    """The default path of the JANI file of a system: beside the system file."""
    return os.path.splitext(system)[0] + ".jani"


def without_bounded(model: Model) -> tuple[Model, tuple[Diagnostic, ...]]:
    """A model without the properties that have bounds on time, and a warning for each of these bounds.

    JANI defines these bounds for timed models. In a model that counts steps, Storm reads a bound of 5 (seconds) as 5
    steps.
    """
    warnings: list[Diagnostic] = []
    kept: list[Property] = []
    for property_ in model.properties:
        bounds = list(time_bounds_in(property_))
        for bound in bounds:
            assert bound.origin is not None  # The property was read from a file of the system.
            message = f"the property `{property_.name}` is left out of the JANI file: {TIME_BOUNDS}"
            warnings.append(Diagnostic(bound.origin.path, BOUNDS, Severity.WARNING, bound.origin.span, message))
        if not bounds:
            kept.append(property_)
    return replace(model, properties=tuple(kept)), tuple(warnings)


def summary(model: Model) -> str:
    """The size of a model, as a phrase."""
    edges = sum(len(automaton.edges) for automaton in model.automata)
    counts = (
        (len(model.automata), "automaton", "automata"),
        (edges, "edge", "edges"),
        (len(model.variables), "global variable", "global variables"),
        (len(model.properties), "property", "properties"),
    )
    return ", ".join(f"{count} {singular if count == 1 else many}" for count, singular, many in counts)
