# SPDX-License-Identifier: Apache-2.0
"""The extensions of JANI that a file declares in its `features`."""

from __future__ import annotations

import enum


class Feature(enum.Enum):
    """An extension that JANI defines. Names that begin with `x-` are reserved for tools and are not listed."""

    ARRAYS = "arrays"
    DATATYPES = "datatypes"
    DERIVED_OPERATORS = "derived-operators"
    EDGE_PRIORITIES = "edge-priorities"
    FUNCTIONS = "functions"
    HYPERBOLIC_FUNCTIONS = "hyperbolic-functions"
    MULTI_OBJECTIVE_PROPERTIES = "multi-objective-properties"
    NAMED_EXPRESSIONS = "named-expressions"
    NONDET_SELECTION = "nondet-selection"
    STATE_EXIT_REWARDS = "state-exit-rewards"
    TRADEOFF_PROPERTIES = "tradeoff-properties"
    TRIGONOMETRIC_FUNCTIONS = "trigonometric-functions"


SUPPORTED = frozenset(Feature) - {
    Feature.EDGE_PRIORITIES,
    Feature.MULTI_OBJECTIVE_PROPERTIES,
    Feature.NAMED_EXPRESSIONS,
    Feature.TRADEOFF_PROPERTIES,
}
"""The extensions whose syntax `roaml.jani` reads and writes. A file may declare other extensions, but not use them."""
