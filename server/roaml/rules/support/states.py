# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about states."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.machine import Chart
from roaml.model.syntax import Name


def references(chart: Chart) -> Iterator[Name]:
    """The names of states in `initial` and in the targets of a chart, in document order."""
    if chart.initial is not None:
        yield chart.initial
    for state in chart.states:
        for handler in state.handlers:
            for target in handler.targets:
                if target.state is not None:
                    yield target.state
