# SPDX-License-Identifier: Apache-2.0
"""A probability that is almost 1 is not shown as 1."""

from __future__ import annotations

import pytest
from smc_models import automaton, document, edge, model, op, probability, variable, way

from as2fm_lsp.verification import exact_report
from roaml import api


@pytest.mark.parametrize(
    ("tosses", "shown"),
    [
        (0, "p: = 1 for all"),
        (1, "p: less than 1 by at most 1e-10 for all"),
        (3, "p: less than 1 by at most 2e-16 for all"),
    ],
)
def test_a_failing_trace_excludes_1(tosses: int, shown: str) -> None:
    """A trace fails if each of the tosses fails."""
    edges = [edge(f"l{n}", way("m", 1 - 1e-10, x=1), way(f"l{n + 1}", 1e-10)) for n in range(tosses)]
    edges += [] if tosses else [edge("l0", way("m", x=1))]
    goal = {"p": probability(op("F", op("=", "x", 1)))}
    written = document(automaton("a", "l0 l1 l2 l3 m", edges), variables=[variable("x")], properties=goal)
    (result,) = api.verify(model(written), exact_if_small=True)
    assert result.exact is not None
    (first, *_) = exact_report.lines("p", result.exact, 0.0)
    assert first.startswith(shown)
