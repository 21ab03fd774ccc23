# SPDX-License-Identifier: Apache-2.0
"""A run of a model: a sequence of steps, each decided by the seed or by the user, that can be replayed up to any step.

A step that the seed decides is the same as in the trace that `verify` generates for this seed and trace number. Going
back restores the last snapshot before the position and replays the steps from there.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Any, NamedTuple

from roaml.record import Record
from roaml.simulation.intervention import Intervention, intervene, is_free, is_possible
from roaml.smc.batch import TraceProblem
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FAULTY, UNKNOWN
from roaml.smc.record import Plain, RecordedVariable, StepReader, TraceStep
from roaml.smc.rounds import Rounds
from roaml.smc.standstill import Standstill

SNAPSHOT_INTERVAL = 512
"""The number of steps between two snapshots of the kernel."""


class RunError(ValueError):
    """A decision is not possible in the state for which it was given."""


class Decision(Record, frozen=True):
    """A step that the user has chosen.

    Attributes:
        vector: the number of the synchronisation vector in `roaml.smc.compile.Legend`.
        picks: for each participating automaton, the number of its edge among its enabled edges for the action, from 0.
        ways: for each participating automaton, the number of the destination among those of its edge, from 0.
    """

    vector: int
    picks: tuple[int, ...]
    ways: tuple[int, ...]


ByHand = Decision | Intervention


class EnabledEdges(NamedTuple):
    """The enabled edges of an automaton for an action. `edges` contains, for each edge, the number of its first
    destination in the kernel, and the probabilities of its destinations."""

    instance: int
    edges: tuple[tuple[int, tuple[float, ...]], ...]


class Enabled(Record, frozen=True):
    """An enabled synchronisation vector.

    Attributes:
        ties: the number of choices with the same effect, for each combination of edges.
        slots: the enabled edges of each participating automaton.
    """

    vector: int
    ties: int
    slots: tuple[EnabledEdges, ...]


class Run:
    """A run, and a position in it.

    Args:
        decisions: the decisions of the first steps; `None` for a step that the seed decides. The seed decides all later
            steps.

    Attributes:
        start: the variables of the model before the first step.
        first_locations: the location of each instance before the first step.
        steps: all steps taken, including those after the position.
        decisions: the decision of each of these steps.
        position: the number of steps before the current state.
        status: the verdict on the property in the current state (`roaml.smc.program`).
        has_ended: whether no further step changes anything.

    Raises:
        RunError: one of the decisions is not possible.
        FaultError: the model executes an undefined operation, such as a division by zero.
    """

    def __init__(
        self,
        checker: ModelChecker,
        property_: CompiledProperty,
        seed: int,
        trace: int = 0,
        decisions: Iterable[ByHand | None] = (),
    ) -> None:
        self.checker = checker
        self.compiled_property = property_
        self.seed = seed
        self.trace = trace
        compiled = checker.compiled(property_)
        self._program = compiled.program
        self._kernel = Kernel(compiled.program, compiled.goal)
        self.legend = checker.legend
        self._rounds = Rounds(compiled)
        self._reader = StepReader(self._kernel, self.legend)
        self.steps: list[TraceStep] = []
        self.decisions: list[ByHand | None] = []
        self._first_by_hand: int | None = None
        self._interventions: list[int] = []
        self._snapshots: dict[int, tuple[Any, ...]] = {}
        self._begin()
        shared = self.legend.layout.shared
        self.start = dict(zip((storage.name for storage in shared), self._reader.values(shared), strict=True))
        self.first_locations = self.locations()
        for number, decision in enumerate(decisions, 1):
            if self.advance(decision) is None:
                raise RunError(f"step {number} cannot be taken: the run has ended before it")

    def _begin(self) -> None:
        self.position = 0
        self.status = self._kernel.begin(self.seed, self.trace)
        self._check()
        self._check_end()
        self._reader.start()

    def _check_end(self) -> None:
        self.has_ended = self._kernel.ended()
        if self.has_ended:
            self._learn(self._kernel.close())

    def _check(self) -> None:
        if self.status == FAULTY:
            raise self.checker.fault(TraceProblem(self.trace, *self._kernel.problem()))

    # ------------------------------------------------------------ moving

    def advance(self, decision: ByHand | None = None) -> TraceStep | None:
        """Take a step. If its decision differs from that of the step taken here before, the steps after the position
        are discarded.

        Returns:
            The step; `None` if no step is possible, or no step changes anything.

        Raises:
            RunError: the decision is not possible here.
            FaultError: the model executes an undefined operation in the step, such as a division by zero; the run stays
                in the state before it.
        """
        if self.has_ended:
            return None
        if decision is not None:
            self._check_possible(decision)
        try:
            self._take(decision)
        except FaultError:
            self._return()
            raise
        if self.position <= len(self.steps) and self.decisions[self.position - 1] == decision:
            self._reader.start()
            return self.steps[self.position - 1]
        if self.position <= len(self.steps):
            self._discard(self.position - 1)
        if isinstance(decision, Intervention):
            action = f"{decision.event}_on_send" if decision.event else None
            self.steps.append(self._reader.change(self.position, action))
        else:
            self.steps.append(self._reader.read(self.position))
        self.decisions.append(decision)
        if decision is not None and self._first_by_hand is None:
            self._first_by_hand = self.position
        return self.steps[-1]

    def _discard(self, position: int) -> None:
        """Discard the steps after `position`."""
        del self.steps[position:], self.decisions[position:]
        self._interventions = [number for number in self._interventions if number <= position]
        if self._first_by_hand is not None and self._first_by_hand > position:
            self._first_by_hand = None
        self._snapshots = {at: saved for at, saved in self._snapshots.items() if at <= position}

    def _return(self) -> None:
        """Restore the state at the position, after a step that failed."""
        position = self.position
        self._begin()
        self.go_to(position)

    def go_to(self, position: int) -> None:
        """Go to the state after the first `position` steps, which have been taken before."""
        nearest = max((at for at in self._snapshots if at <= position), default=0)
        if position < self.position or nearest > self.position:
            self._restore(nearest)
        while self.position < position:
            decision = self.decisions[self.position]
            until = self.position + 1
            while decision is None and until < position and self.decisions[until] is None:
                until += 1
            self._take(decision, until)
        self._reader.start()

    def _restore(self, position: int) -> None:
        """Go to a position with a snapshot, or to the start."""
        if position not in self._snapshots:
            self._begin()
            return
        self.status, self.has_ended, saved = self._snapshots[position]
        self._kernel.load(saved)
        self.position = position

    def _take(self, decision: ByHand | None, until: int = 0) -> None:
        """Take the step of `decision`. Without a decision, take the steps that the seed decides up to position `until`;
        0 means only the next step."""
        if decision is None:
            until = until or self.position + 1
            while self._kernel.outcome()[0] < until:
                self._learn(self._kernel.advance(until))
            self.position = until
        elif isinstance(decision, Intervention):
            intervene(self._kernel, self.legend, self._reader.variables, decision)
            if self._kernel.problem()[0]:
                self._learn(FAULTY)
            self.position += 1
            self._interventions = sorted({*self._interventions, self.position})
        else:
            self._learn(self._kernel.go(decision.vector, list(decision.picks), list(decision.ways)))
            self._learn(self._kernel.look())
            self.position += 1
        self._check_end()
        if self.position % SNAPSHOT_INTERVAL == 0 and self.position not in self._snapshots:
            self._snapshots[self.position] = self.status, self.has_ended, self._kernel.save()

    @property
    def is_by_hand(self) -> bool:
        """Whether the user has decided a step up to the position."""
        return self._first_by_hand is not None and self._first_by_hand <= self.position

    @property
    def is_changed(self) -> bool:
        """Whether the user has changed the state up to the position, so that the run does not show the behaviour of the
        model."""
        return bool(self._interventions) and self._interventions[0] <= self.position

    def is_free(self, event: str) -> bool:
        """Whether the user can send an event: the previous event with its name has been received."""
        return is_free(self._kernel, self.legend, event)

    def _check_possible(self, decision: ByHand) -> None:
        if isinstance(decision, Intervention):
            if not is_possible(self.legend, self._reader.variables, decision):
                raise RunError(
                    "the model has no such event or variable, or a value does not match the type of its variable"
                )
            if decision.event and not self.is_free(decision.event):
                event = decision.event
                raise RunError(f"the previous event `{event}` has not been received yet; continue until it is received")
            return
        for enabled in self.enabled():
            if enabled.vector == decision.vector:
                fits = len(decision.picks) == len(decision.ways) == len(enabled.slots) and all(
                    0 <= pick < len(slot.edges) and 0 <= way < len(slot.edges[pick][1]) and slot.edges[pick][1][way] > 0
                    for pick, way, slot in zip(decision.picks, decision.ways, enabled.slots, strict=True)
                )
                if fits:
                    return
        raise RunError(f"the decision for step {self.position + 1} is not possible in this state")

    def _learn(self, status: int) -> None:
        """Store the verdict on the property after a step. A decided property stays decided. After a change by the
        user, no property is decided any more."""
        if status == FAULTY or (self.status == UNKNOWN and not self.is_changed):
            self.status = status
            self._check()

    # ------------------------------------------------------------ the state

    @property
    def end(self) -> End | None:
        """The reason why no further step changes the state; `None` if a step changes it."""
        return End(self._kernel.standstill()) if self.has_ended else None

    def causes_of(self, end: End) -> list[int]:
        """The instances whose current locations are the reason for an end."""
        marks = self._program.location_mark
        return [i for i in range(len(self.legend.layout.instances)) if marks[self._kernel.location(i)] == end]

    def repeats(self) -> bool:
        """Whether the seed leads to some states again and again, which do not decide the property. It is found after
        many steps (`rounds.FIRST_CHECK`)."""
        if self.has_ended or self.is_by_hand or self.status != UNKNOWN:
            return False
        saved = self._kernel.save()
        status = self._rounds.check(self._kernel, self.seed, self.trace)
        self._kernel.load(saved)
        return status not in (UNKNOWN, FAULTY)

    def standstill(self) -> Standstill:
        """The current state, as input for the analysis of the automata that wait for one another."""
        return self._reader.standstill(self.checker.model.system)

    def enabled(self) -> list[Enabled]:
        """The enabled synchronisation vectors."""
        return [Enabled(vector, ties, self._edges(vector, slots)) for vector, ties, slots in self._kernel.choices()]

    def values_after(
        self, decision: Decision, variables: Collection[RecordedVariable]
    ) -> dict[RecordedVariable, Plain]:
        """The values of variables after a possible next step, which is not taken.

        Raises:
            FaultError: the model executes an undefined operation in the step.
        """
        storages = {variable: storage for variable, storage in self._reader.variables if variable in variables}
        saved = self._kernel.save()
        try:
            if self._kernel.go(decision.vector, list(decision.picks), list(decision.ways)) == FAULTY:
                raise self.checker.fault(TraceProblem(self.trace, *self._kernel.problem()))
            return dict(zip(storages, self._reader.values(list(storages.values())), strict=True))
        finally:
            self._kernel.load(saved)

    def _edges(self, vector: int, slots: Sequence[Sequence[Sequence[float]]]) -> tuple[EnabledEdges, ...]:
        program = self._program
        active = program.active_slot[program.active_start[vector] : program.active_start[vector + 1]]
        return tuple(
            EnabledEdges(
                program.slot_instance[slot], tuple(zip(self._first_ways(slot), map(tuple, edges), strict=True))
            )
            for slot, edges in zip(active, slots, strict=True)
        )

    def _first_ways(self, slot: int) -> list[int]:
        """The number of the first destination of each enabled edge of a slot, in the order of the kernel."""
        program = self._program
        instance = program.slot_instance[slot]
        location = self._kernel.location(instance)
        group = next(
            g
            for g in range(program.group_start[location], program.group_start[location + 1])
            if program.group_slot[g] == slot
        )
        own = range(program.way_start[program.edge_start[group]], program.way_start[program.edge_start[group + 1]])
        return [way for way in self._kernel.open_ways(instance) if way in own]

    def locations(self) -> tuple[str, ...]:
        """The name of the current location of each instance."""
        return tuple(
            self.legend.locations[self._kernel.location(number)][1]
            for number in range(len(self.legend.layout.instances))
        )

    def values(self) -> list[tuple[RecordedVariable, Plain]]:
        """The values of all variables: those of the model first, then those of each instance."""
        storages = [storage for _, storage in self._reader.variables]
        return list(zip((v for v, _ in self._reader.variables), self._reader.values(storages), strict=True))
