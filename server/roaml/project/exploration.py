# SPDX-License-Identifier: Apache-2.0
"""The steps that a whole system can take, from all states that it can reach.

The limits are numbers of states and steps, and not times, so the result does not depend on the speed of the machine.
The search leaves out the order of independent steps: each step of a machine that is possible in the system also occurs
in the reduced search (docs/spec/reductions.md).

Machines that react at once reach a part of the states, so what never happens with the reaction time `any` never happens
then either. This smaller search comes first, and ends most checks: without a finding, or because it reaches a limit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from roaml.interruption import checkpoint
from roaml.jani.expressions import Integer
from roaml.project.analysis import Analysis
from roaml.project.translation import network_of
from roaml.record import Record
from roaml.scxml.names import TreeEventKind, read_tree_event, received_by

if TYPE_CHECKING:
    from roaml.explicit.space import Space
    from roaml.jani.model import Model
    from roaml.project.explored_steps import ClientRequests, ExploredSteps, ExploredWay
    from roaml.smc.model import ModelChecker

MAX_STATES, MAX_STEPS, MAX_BYTES = 10_000, 300_000, 1 << 28
"""The limits of one exploration. A typical one that reaches them takes 0.2 s."""


class ReachedFaultError(Exception):
    """An undefined operation is executed in a reachable state, behind which no states are known. `space` contains the
    states that were reached before."""

    def __init__(self, space: Space) -> None:
        super().__init__()
        self.space = space


class Reached(Record, frozen=True):
    """What the steps in all reachable states are.

    Attributes:
        events: the events that an automaton can receive -> whether it receives them in some state.
        statuses: number of a node of the tree -> the numbers of the statuses that it returns in some state.
        is_instant: whether this is only known if machines react at once.
        model: the model that was explored.
        steps: the steps of all automata.
        ways: the steps of another model, found in the same manner; `None` if they are not known.
        simulated: the number of simulated runs from which this is known; 0 if all reachable states are known.
    """

    events: Mapping[str, bool]
    statuses: Mapping[int, frozenset[int]]
    is_instant: bool
    model: Model
    steps: Callable[[], ExploredSteps]
    ways: Callable[[Model], list[ExploredWay] | None]
    simulated: int = 0

    def while_handled(self, requests: ClientRequests) -> ExploredSteps | None:
        """The steps while a request is handled; `None` if they are not known."""
        from roaml.project.request_context import steps_while_handled  # noqa: PLC0415 - only some findings need it

        return steps_while_handled(self.model, requests, self.ways)

    @property
    def ticks(self) -> Mapping[int, bool]:
        """The numbers of the nodes of the tree -> whether they are ticked."""
        ticks: dict[int, bool] = {}
        for event, is_received in self.events.items():
            tree = read_tree_event(event)
            if tree is not None and tree.kind is TreeEventKind.TICK:
                ticks[tree.number] = ticks.get(tree.number, False) or is_received
        return ticks

    @property
    def no_run(self) -> str:
        """The subject of a statement about all runs."""
        return f"none of {self.simulated} simulated runs of this system" if self.simulated else "no run of this system"


def explored(analysis: Analysis, path: str) -> Iterator[Reached]:
    """What a system reaches: first with machines that react at once, then with its own reaction time. The iterator ends
    before a search that has too many states.

    Raises:
        ReachedFaultError: a state is reached in which an undefined operation is executed.
    """
    from roaml.to_jani import translate  # noqa: PLC0415 - the model checker is imported only if a system is explored

    model = translate(network_of(analysis, path), (), ())
    checkpoint()
    for variant, is_instant in with_reactions(model):
        reached = _reached(variant, is_instant=is_instant)
        if reached is None:
            return
        yield reached


def with_reactions(model: Model) -> Iterator[tuple[Model, bool]]:
    """A model in which machines react at once, unless this assumes more than the model does, and the model itself; each
    with whether it assumes more. The iterator is empty if such a model cannot be made."""
    from roaml.durations import AT_ONCE  # noqa: PLC0415 - see `explored`
    from roaml.jani.reaction import ReactionError, reacting  # noqa: PLC0415

    metadata = model.metadata
    if metadata is not None and metadata.clock is not None and metadata.reaction_time.is_any:
        try:
            yield reacting(model, AT_ONCE), True
        except ReactionError:
            return
    yield model, False


def _reached(model: Model, *, is_instant: bool) -> Reached | None:
    """What a model reaches; `None` if it cannot be explored."""
    searched = _searched(model)
    if searched is None:
        return None
    return reached_by(model, *searched, _ways_of, is_instant=is_instant)


def reached_by(
    model: Model,
    checker: ModelChecker,
    taken: bytes,
    ways: Callable[[Model], list[ExploredWay] | None],
    *,
    is_instant: bool = False,
    simulated: int = 0,
) -> Reached:
    """What a model reaches.

    Args:
        taken: for each way of an edge, in the order of `checker.legend.ways`, whether it is taken.
        ways, is_instant, simulated: see `Reached`.
    """
    events, returned = _events(checker, taken), _statuses(checker, taken)
    return Reached(events, returned, is_instant, model, lambda: _steps(model, checker, taken), ways, simulated)


def _steps(model: Model, checker: ModelChecker, taken: bytes) -> ExploredSteps:
    from roaml.project.explored_steps import ExploredSteps  # noqa: PLC0415 - see `explored`

    return ExploredSteps(model, ways_taken(checker, taken))


def _ways_of(model: Model) -> list[ExploredWay] | None:
    """The steps of a model; `None` if it cannot be explored."""
    try:
        searched = _searched(model)
    except ReachedFaultError:
        return None
    return None if searched is None else list(ways_taken(*searched))


def _searched(model: Model) -> tuple[ModelChecker, bytes] | None:
    """A model checker, and for each way of an edge whether it is taken. `None` if there are too many states.

    Raises:
        ReachedFaultError: see `explored`.
    """
    from roaml.explicit.independence import can_be_reduced  # noqa: PLC0415
    from roaml.explicit.space import LimitError, StateLimits, explore  # noqa: PLC0415
    from roaml.smc.fault import FaultError  # noqa: PLC0415
    from roaml.smc.model import ModelChecker  # noqa: PLC0415
    from roaml.views.ends import marks  # noqa: PLC0415

    limits = StateLimits(states=MAX_STATES, bytes=MAX_BYTES, combinations=4_096, transitions=MAX_STEPS)
    try:
        checker = ModelChecker(model, (), marks(model))
        is_reduced = can_be_reduced(checker.program, checker.stuck.goal)
        space = explore(checker, checker.stuck, limits, lambda _: checkpoint(), is_reduced=is_reduced)
    except (FaultError, LimitError):
        return None
    if space.problem is not None:
        raise ReachedFaultError(space)
    return checker, bytes(memoryview(space.search.taken))


def ways_taken(checker: ModelChecker, taken: bytes) -> Iterator[ExploredWay]:
    """All steps of the automata of a model."""
    from roaml.project.explored_steps import ExploredWay  # noqa: PLC0415 - see `explored`

    legend, automata = checker.legend, checker.automata
    for (edge, destination), (source, _), is_taken in zip(legend.ways, legend.moves, taken, strict=False):
        yield ExploredWay(automata[legend.locations[source][0]], edge, destination, is_taken != 0)


def _events(checker: ModelChecker, taken: bytes) -> Mapping[str, bool]:
    events: dict[str, bool] = {}
    for way, (edge, _) in enumerate(checker.legend.ways):
        event = received_by(edge.action or "")
        if event:
            events[event] = events.get(event, False) or taken[way] != 0
    return events


def _statuses(checker: ModelChecker, taken: bytes) -> Mapping[int, frozenset[int]]:
    """The numbers of the nodes of the tree -> those of the statuses that they return, as far as these are constants."""
    statuses: dict[int, frozenset[int]] = {}
    for way, (_, destination) in enumerate(checker.legend.ways):
        for assignment in destination.assignments if taken[way] else ():
            event, _, parameter = assignment.variable.rpartition("__")
            tree = read_tree_event(event) if parameter == "status" else None
            if tree is not None and isinstance(assignment.value, Integer):
                statuses[tree.number] = statuses.get(tree.number, frozenset()) | {assignment.value.value}
    return statuses
