# SPDX-License-Identifier: Apache-2.0
"""The plots of `verify --plot`: curves from traces with uniform choices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.experiments.bands import BandKind
from roaml.experiments.curves import Curve, curve_plot, median_curves, verdict_curves
from roaml.figures.plot import LinePlot
from roaml.verification.verifier import Verifier

BY_TIME = "Probability that the property is decided by this time"
"""The title of the plot of probabilities. A curve that rises late does not mean that the property fails before."""


def curve_plots(verifier: Verifier, variables: Sequence[str], band: BandKind) -> Iterator[LinePlot]:
    """A plot for all probabilities, one for each reward, and one for each variable.

    Raises:
        ValueError: there is no variable with one of the names.
        FaultError: a trace executes an undefined operation.
    """
    checker, options, clock = verifier.checker, verifier.options, verifier.target.clock
    probabilities: list[Curve] = []
    for property_ in checker.compiled_properties:
        curves = verdict_curves(checker, property_, options, clock, band)
        if property_.question.is_reward:
            yield curve_plot(f"Distribution of {property_.question.name}", curves)
        elif not property_.question.is_conditional:
            probabilities += curves
    if probabilities:
        yield curve_plot(BY_TIME, probabilities)
    for variable in variables:
        yield curve_plot(f"{variable} over time", median_curves(checker, variable, options, clock, band), variable)
