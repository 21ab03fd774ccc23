# SPDX-License-Identifier: Apache-2.0
"""The parameters of a system (docs/spec/systems.md#parameters)."""

from __future__ import annotations

import enum

from roaml.durations import ANY_TIME, ReactionTime
from roaml.record import Record, replace

DEFAULT_MAX_ARRAY_SIZE = 100
DEFAULT_TICK_RATE = 1.0
DEFAULT_RANDOM_VALUES = 100
MAX_RANDOM_VALUES = 10_000
"""The maximum of `random_values`. It is limited because each value is a destination of an edge in JANI."""


class TreeSemantics(enum.Enum):
    """Whose meaning the nodes of BehaviorTree.CPP have (docs/spec/nodes.md#semantics). The values are the names in
    settings, system files and on the command line."""

    LIBRARY = "behaviortree-cpp"
    AS2FM = "as2fm"


SEMANTICS = {semantics.value: semantics for semantics in TreeSemantics}
"""Name -> semantics."""


class Parameters(Record, frozen=True):
    """The parameters with which a system is translated.

    Attributes:
        max_time: the bound of the clock in ns; `None` if it is not given or invalid.
        tick_rate: the rate of ticks of the behavior tree, in Hz.
        reaction_time: how long machines may wait before they take a possible step; `None` if the file states nothing.
        random_values: the number n of the values of `Math.random()`: 0, 1/n, 2/n, … (docs/spec/expressions.md#random).
        semantics: whose meaning the nodes of the tree have; `None` if the system file does not state it.
    """

    max_time: int | None = None
    max_array_size: int = DEFAULT_MAX_ARRAY_SIZE
    tick_rate: float = DEFAULT_TICK_RATE
    tick_if_not_running: bool = False
    random_values: int = DEFAULT_RANDOM_VALUES
    reaction_time: ReactionTime | None = None
    semantics: TreeSemantics | None = None


class Overrides(Record, frozen=True):
    """Parameters that replace those of a system file. A parameter that is `None` replaces nothing; see `Parameters`.

    Attributes:
        default_reaction_time: the reaction time of systems that state none.
        default_semantics: the semantics of systems that state none.
        values: names and texts of values for parameters that the models declare (docs/spec/parameters.md#values); of
            equal names, the last one is used.
    """

    max_time: int | None = None
    max_array_size: int | None = None
    reaction_time: ReactionTime | None = None
    default_reaction_time: ReactionTime = ANY_TIME
    semantics: TreeSemantics | None = None
    default_semantics: TreeSemantics | None = None
    values: tuple[tuple[str, str], ...] = ()

    def applied(self, parameters: Parameters) -> Parameters:
        max_time = parameters.max_time if self.max_time is None else self.max_time
        size = parameters.max_array_size if self.max_array_size is None else self.max_array_size
        reaction = self.reaction_time or parameters.reaction_time or self.default_reaction_time
        semantics = self.semantics or parameters.semantics or self.default_semantics
        return replace(parameters, max_time=max_time, max_array_size=size, reaction_time=reaction, semantics=semantics)


NO_OVERRIDES = Overrides()
