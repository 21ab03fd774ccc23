# SPDX-License-Identifier: Apache-2.0
"""Explores the states of a model for a property, within limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from roaml.durations import AT_ONCE
from roaml.explicit import ample, codes
from roaml.explicit import search as engine
from roaml.explicit.preparation import preparation_of
from roaml.explicit.tables import Tables
from roaml.record import Record
from roaml.smc import kernel
from roaml.smc.batch import TraceProblem
from roaml.smc.goal import CompiledProperty
from roaml.smc.memory import available
from roaml.smc.model import ModelChecker
from roaml.smc.program import AT_END, Goal


class ExplorationProgress(Record, frozen=True):
    """The progress of a search: the number of states, the number of those that have been expanded, and the memory in
    use, in bytes."""

    states: int
    expanded: int
    bytes: int


MAX_STATES_LIMIT, MAX_TRANSITIONS_LIMIT, MAX_MEMORY_LIMIT = "max-states", "max-transitions", "max-memory"
"""The names of the limits that users can raise."""
ExplorationWatch: TypeAlias = Callable[[ExplorationProgress], None]
"""Called during a search."""

STRIDE = 16_384
"""The number of states that are expanded between two calls of a watch."""
SHORT_STRIDE = 16
"""The number of states that are expanded between two calls of a watch if the number of transitions is limited."""
MAX_STATES = 0x7FFFFFF0
"""The maximum number of states that a search can number."""
MAX_COMBINATIONS = 1 << 20
"""The maximum number of combinations of edges and destinations in one state. Exploring this many takes some seconds."""


class StateLimits(Record, frozen=True):
    """The limits of a search.

    Attributes:
        states: the maximum number of states.
        bytes: the maximum memory in bytes; `None` for half of the free memory.
        combinations: the maximum number of combinations of edges and destinations in one state. With n automata of k
            edges on one action there are kⁿ.
        transitions: the number of transitions, including those from states that are not stored; if it is exceeded, the
            search ends at its next check. `None` if there is no limit.
        work: the maximum number of additions for each value that a property asks for; `None` for the limit of the
            solver.
        reduces: whether dead variables are reset, and whether choices may be left out where that keeps the minimum and
            the maximum.
    """

    states: int = MAX_STATES
    bytes: int | None = None
    combinations: int = MAX_COMBINATIONS
    transitions: int | None = None
    work: int | None = None
    reduces: bool = True


class LimitError(Exception):
    """A search has ended before all states were known. The message is a phrase for users.

    Attributes:
        states: the number of states that were reached.
        search: the search; `None` if it has not begun.
        limit: the name of the limit for users; "" if it cannot be raised.
    """

    def __init__(self, message: str, states: int, search: Any = None, *, limit: str = "") -> None:
        super().__init__(message)
        self.states = states
        self.search = search
        self.limit = limit


class SearchInterruptedError(KeyboardInterrupt):
    """A search was interrupted. `search` is the search, which cannot be continued."""

    def __init__(self, search: Any) -> None:
        super().__init__()
        self.search = search


class Space(Record, frozen=True):
    """All states of a model that are reached before a goal is decided.

    Attributes:
        search: the states and their choices.
        fault_at: the state in which an undefined operation was executed, which ended the search early; -1 if there was
            none.
        problem: the undefined operation.
        is_reduced: whether choices and states were left out. The minimum and the maximum are those of all states; the
            value under uniform choices is not.
    """

    checker: ModelChecker
    compiled_property: CompiledProperty
    search: Any
    fault_at: int = -1
    problem: TraceProblem | None = None
    is_reduced: bool = False

    @property
    def states(self) -> int:
        return int(self.search.count)

    @property
    def roots(self) -> list[int]:
        """The initial states, in their order."""
        return list(memoryview(self.search.roots)[: self.search.entered])

    @property
    def can_get_stuck(self) -> bool:
        """Whether a trace can get stuck before the goal is decided."""
        labels = set(bytes(memoryview(self.search.label)[: self.search.expanded]))
        return any(label & codes.GETS_STUCK for label in labels)


def explore(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    watch: ExplorationWatch | None = None,
    modules: Any = None,
    *,
    is_reduced: bool = False,
    tables: Tables | None = None,
) -> Space:
    """All states that can be reached before the goal is decided.

    Args:
        tables: the result of `search_tables`, if it has been computed before.
        is_reduced: whether choices and states are left out (`independence.can_be_reduced` must be true for the goal).
        modules: the modules of the kernel and of the search, for tests.

    Raises:
        LimitError: a limit was exceeded.
        SearchInterruptedError: Ctrl-C was pressed.
    """
    if checker.initial_states > limits.states:
        many = f"there are {checker.initial_states:,} initial states, more than {limits.states:,} ({MAX_STATES_LIMIT})"
        raise LimitError(many, checker.initial_states, limit=MAX_STATES_LIMIT)
    tables = tables or search_tables(checker, property_, limits)
    search = _search(
        checker, property_, limits, tables, modules or _modules(), leaves_out=is_reduced, avoids_cycles=False
    )
    try:
        space = _searched(checker, property_, limits, watch, search, is_reduced=is_reduced)
        if is_reduced and search.has_partial_cycle():
            search = _search(
                checker, property_, limits, tables, modules or _modules(), leaves_out=True, avoids_cycles=True
            )
            space = _searched(checker, property_, limits, watch, search, is_reduced=True)
    except KeyboardInterrupt:
        raise SearchInterruptedError(search) from None
    return space


def _search(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    tables: Tables,
    modules: Any,
    *,
    leaves_out: bool,
    avoids_cycles: bool,
) -> Any:
    """A search that has not begun.

    Args:
        leaves_out: whether choices are left out.
        avoids_cycles: see `StateSearch.leave_out`.
    """
    kernel_module, search_module = modules
    compiled = checker.compiled(property_)
    steps, lower, depth = _bounds(compiled.goal)
    simulator = kernel_module.Kernel(compiled.program, compiled.goal)
    search = search_module.StateSearch(
        simulator,
        tables,
        steps,
        lower,
        depth,
        limits.states,
        available() // 2 if limits.bytes is None else limits.bytes,
        limits.combinations,
    )
    if leaves_out:
        independence = preparation_of(checker).independence.tables(compiled.goal)
        ample_sets = _ample_module(search_module).AmpleSets(simulator, independence, _looks_ahead(checker))
        search.leave_out(ample_sets, int(avoids_cycles))
    return search


def _looks_ahead(checker: ModelChecker) -> bool:
    """Whether steps are also left out if a dependent step cannot be reached before them. If machines may delay their
    steps, the clock often may advance alone in this way. The traces that are left are then those in which machines
    react late, and a counterexample would show delays that are not its cause."""
    metadata = checker.model.metadata
    return metadata is None or metadata.clock is None or metadata.reaction_time == AT_ONCE


def _searched(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    watch: ExplorationWatch | None,
    search: Any,
    *,
    is_reduced: bool,
) -> Space:
    """All states that a search reaches; see `explore`."""
    stride = STRIDE if limits.transitions is None else SHORT_STRIDE
    while True:
        status = search.run(stride)
        transitions = search.transitions + search.passed
        if watch is not None:
            watch(ExplorationProgress(search.count, search.expanded, search.memory_used()))
        match status:
            case codes.PART if limits.transitions is not None and transitions > limits.transitions:
                why = f", with more than {limits.transitions:,} transitions ({MAX_TRANSITIONS_LIMIT})"
                raise _stopped(search, why, MAX_TRANSITIONS_LIMIT)
            case codes.PART:
                continue
            case codes.COMPLETE:
                return Space(checker, property_, search, is_reduced=is_reduced)
            case codes.FAULT:
                problem = TraceProblem(0, *search.fault())
                return Space(checker, property_, search, search.problem, problem, is_reduced)
            case codes.STATES:
                raise _stopped(search, f" ({MAX_STATES_LIMIT})", MAX_STATES_LIMIT)
            case codes.MEMORY:
                size = _size(search.memory_used())
                why = f", which occupy {size} ({MAX_MEMORY_LIMIT}; half of the free memory by default)"
                raise _stopped(search, why, MAX_MEMORY_LIMIT)
            case _:
                raise _stopped(search, f": one of them has more than {limits.combinations:,} combinations of edges")


def _size(many: int) -> str:
    """A number of bytes for users."""
    return f"{many / (1 << 30):.1f} GiB" if many >= 1 << 30 else f"{-(-many // (1 << 20)):,} MiB"


def _stopped(search: Any, why: str, limit: str = "") -> LimitError:
    many = f"{search.count:,} {'state' if search.count == 1 else 'states'}"
    return LimitError(f"stopped at {many}{why}", search.count, search, limit=limit)


def search_tables(checker: ModelChecker, property_: CompiledProperty, limits: StateLimits) -> Tables:
    """The tables that a search needs. They are the same with and without choices that are left out."""
    return preparation_of(checker).tables(property_, checker.observed(property_), reduces=limits.reduces)


def _bounds(goal: Goal) -> tuple[int, int, int]:
    """How a search treats the step bounds of a goal. Return three numbers: the number of steps that states
    distinguish; the lower bound of a single until, which the solver needs; and the number of steps after which the goal
    is decided, or -1."""
    lower = [bound for bound in goal.lower if bound != AT_END]
    if not any(bound > 0 for bound in lower) and all(bound < 0 for bound in goal.upper):
        return 0, 0, -1
    if len(goal.left) == 1:
        return 0, lower[0], goal.upper[0]
    return max(*lower, *goal.upper) + 1, 0, -1


def _modules() -> tuple[Any, Any]:
    """The modules of the kernel and of the search. A search that is not compiled gets a kernel that is not compiled,
    because Python cannot read the data of a compiled kernel."""
    if kernel.compiled() and not engine.compiled():
        from roaml.explicit.plain import plain_kernel, plain_search  # noqa: PLC0415

        return plain_kernel(), plain_search()
    return kernel, engine


def _ample_module(search_module: Any) -> Any:
    """The module of ample sets that fits a module of the search."""
    if search_module.compiled():
        return ample

    from roaml.explicit.plain import plain_ample  # noqa: PLC0415

    return plain_ample()
