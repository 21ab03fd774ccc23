# SPDX-License-Identifier: Apache-2.0
"""The simulator of compiled models: it generates random traces and evaluates the goal on them.

- Plain Python; Cython compiles it to an extension with the types in `kernel.pxd`. Both compute exactly the same traces.
- A trace depends on its seed and its number only: the random number n of a trace is a hash of both and of n.
- The set of enabled synchronisation vectors is updated incrementally. A *slot* is an automaton and one of its actions;
  it is ready if an edge of the automaton for this action is enabled. A vector counts its slots that are not ready.
  Slots that take part in the same vectors, if these are several, share a *gate*, which counts the slots that are not
  ready; it is open if all of them are ready, and a vector counts its gates that are not open. A step updates only the
  slots of the locations that it leaves and enters, and the guards that read a variable that has changed. The compiler
  prepares the changes of slots for each pair of locations, and for whole steps if the vector determines all ways, or
  if these depend on a single location (`updates`). The enabled vectors are sorted by their numbers, so that what a
  random number selects depends on the state only, not on the trace before it. Few of them are enabled at the same time.
- A model with several initial states starts in one of them, which random number 0 of the trace selects.
- A *way* is a destination of an edge. A *part* of a step is a slot with the way that it takes.
- If a vector has too many combinations of edges to number them all, the edge of each automaton is drawn separately. The
  weight of the vector is the number of its combinations in both cases.
- Errors of the model raise no exception: `fault` contains the code of the error, `fault_at` the place in the bytecode.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

from roaml.smc.opcodes import *

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roaml.smc.program import Goal, Program

UINT64_MASK = 0xFFFFFFFFFFFFFFFF
GOLDEN = 0x9E3779B97F4A7C15
MIX_1 = 0xBF58476D1CE4E5B9
MIX_2 = 0x94D049BB133111EB
MAX_INT64 = 0x7FFFFFFFFFFFFFFF
MIN_INT64 = -MAX_INT64 - 1
TO_UNIT = 1.0 / 9007199254740992.0
MAX_DRAWN_COMBINATIONS = 4096
"""The maximum number of combinations from which one random number of 32 bits selects: the relative error of each
probability is then at most one in a million."""
MASS_UNIT = 2.0**512
MASS_UNIT_INVERSE = 2.0**-512

FALSE, TRUE, UNKNOWN, FAULTY = 0, 1, 2, 3
"""The status of the goal. UNKNOWN: the trace can go on; FAULTY: the model has executed an undefined operation."""
DECIDED, TIME, FINISHED, STUCK, QUIET, DEADLOCK, IDLE, ROUND = 0, 1, 2, 3, 4, 5, 6, 8
"""The reason why a trace has ended, see `end.End`."""
GOES_ON = -1
"""The status of a trace that has not ended."""
ASKED = 2
"""The activity of a question without code for its activity, see `goal.Activity`."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class KernelTables:
    """The tables of a model and a goal. Their C types follow from `roaml.smc.program`, see `setup.py`."""

    def __init__(self, program: Program, goal: Goal) -> None:
        self.code = program.code
        self.int_count = program.int_count
        self.real_count = program.real_count
        self.instances = program.instances
        self.root_start = program.root_start
        self.root_cell = program.root_cell
        self.root_count = program.root_count
        self.root_first = program.root_first
        self.root_int = program.root_int
        self.root_real = program.root_real
        self.first_location = program.first_location
        self.group_start = program.group_start
        self.group_slot = program.group_slot
        self.group_way = program.group_way
        self.edge_start = program.edge_start
        self.guard = program.guard
        self.way_start = program.way_start
        self.way_target = program.way_target
        self.way_code = program.way_code
        self.way_sum = program.way_sum
        self.way_chance = program.way_chance
        self.way_move = program.way_move
        self.way_update = program.way_update
        self.vector_update = program.vector_update
        self.group_update = program.group_update
        self.updates = program.updates
        self.slot_instance = program.slot_instance
        self.slot_vector = program.slot_vector
        self.gate_start = program.gate_start
        self.gate_vector = program.gate_vector
        self.first_held = program.first_held
        self.active_start = program.active_start
        self.active_slot = program.active_slot
        self.all_start = program.all_start
        self.all_slot = program.all_slot
        self.entangled = program.entangled
        self.phase_start = program.phase_start
        self.phase_index = program.phase_index
        self.phase_read = program.phase_read
        self.phase_write = program.phase_write
        self.watch_start = program.watch_start
        self.watch_instance = program.watch_instance
        self.watch_table = program.watch_table
        self.watched_start = program.watched_start
        self.watched_group = program.watched_group
        self.watched_index = program.watched_index
        self.indexed_start = program.indexed_start
        self.indexed_register = program.indexed_register
        self.group_index = program.group_index
        self.dimension_start = program.dimension_start
        self.dimension_register = program.dimension_register
        self.dimension_low = program.dimension_low
        self.dimension_size = program.dimension_size
        self.first_list = program.first_list
        self.list_start = program.list_start
        self.list_item = program.list_item
        self.settle = program.settle
        self.location_code = program.location_code
        self.location_mark = program.location_mark
        self.seen_start = goal.seen_start
        self.seen_leaf = goal.seen_leaf
        self.left = goal.left
        self.right = goal.right
        self.lower = goal.lower
        self.upper = goal.upper
        self.formula = goal.formula
        self.formula_start = goal.formula_start
        self.leaf_start = goal.leaf_start
        self.activity = goal.activity
        self.is_bounded = goal.is_bounded
        self.step_reward = goal.step_reward
        self.exit_reward = goal.exit_reward
        self.sum_register = goal.sum_register
        self.sum_watch = goal.sum_watch
        self.sum_step = goal.sum_step
        self.sum_exit = goal.sum_exit
        self.sum_limit = goal.sum_limit


class Kernel(KernelTables):
    """A compiled model and a goal, and the state of one trace."""

    def __init__(self, program: Program, goal: Goal) -> None:
        super().__init__(program, goal)
        self.functions = [operator.function for operator in program.functions]
        self.ints_0 = program.ints[:]
        self.reals_0 = program.reals[:]
        self.ints = program.ints[:]
        self.reals = program.reals[:]
        self.place_mark = program.initial[:]
        self.ints_mark = program.ints[:]
        self.reals_mark = program.reals[:]
        self.ints_before = program.ints[:]
        self.reals_before = program.reals[:]
        self.place_0 = program.initial
        self.place = program.initial[:]
        self.roots = 1
        for i in range(len(program.root_count)):
            self.roots *= program.root_count[i]
        self.value_before = program.ints[: program.int_count]
        self.visited = program.first_list[:]
        self.visits = program.first_list[:]
        for i in range(len(self.visited)):
            self.visited[i] = 0
        self.visit_count = 0

        self.questions = len(goal.activity)
        self.leaves = len(goal.left)
        self.sums = len(goal.sum_register)
        self.is_plain = 1 if self.sums == 0 and self.settle < 0 and self.step_reward < 0 else 0
        self.lasts = 1 if goal.upper[0] >= 0 and (goal.step_reward >= 0 or goal.exit_reward >= 0) else 0
        self.verdict = goal.left[:]
        self.holds_left = goal.left[:]
        self.holds_right = goal.left[:]
        self.stale = goal.left[:]
        self.stack = goal.formula[:]
        self.asked = goal.activity[:]
        self.known = goal.activity[:]
        self.known_end = goal.activity[:]
        self.known_activity = goal.activity[:]
        self.known_steps = array("q", [0]) * len(goal.activity)
        for i in range(self.questions):
            self.asked[i] = 1

        self.ready = array("i", [0]) * len(program.slot_instance)
        self.ready_0 = array("i", [0]) * len(program.slot_instance)
        self.slot_group = array("i", [0]) * len(program.slot_instance)
        self.slot_group_0 = array("i", [0]) * len(program.slot_instance)
        self.gate_missing = program.gate_missing[:]
        self.gate_missing_0 = program.gate_missing[:]
        self.vector_missing = program.vector_missing[:]
        self.vector_missing_0 = program.vector_missing[:]
        self.enabled = array("i", [0]) * len(program.vector_missing)
        self.enabled_0 = array("i", [0]) * len(program.vector_missing)
        self.enabled_count = 0
        self.plural = 0
        self.noted = array("i", [0]) * (len(goal.seen_start) - 1)
        self.notes = array("i", [0]) * (len(goal.seen_start) - 1)
        self.note_count = 0
        self.part_slot = array("i", [0]) * program.instances
        self.part_way = array("i", [0]) * program.instances
        self.kept_slot = array("i", [0]) * program.instances
        self.kept_way = array("i", [0]) * program.instances
        self.tried = 0
        self.parts = 0
        self.vector = -1
        self.update = -1
        self.moved = 0
        self.must_look = 0
        self.fault = 0
        self.fault_at = -1
        self.fault_value = 0
        self.fault_size = 0
        self.fault_real = 0.0
        self.arguments: list[Any] = []
        self.key = 0
        self.drawn = 0
        self.scheduler = 0
        self.choice = 0
        self.tossed = 0
        self.looped = 0
        self.loop_state = 0
        self.loop_drawn = UINT64_MASK
        self.loop_span = 1
        self.loop_left = 1
        self.mass = 1.0
        self.rank = 0
        self.end = DECIDED
        self.status = UNKNOWN
        self.steps = 0
        self.still = 0
        self.reward = 0.0
        self.added = 0.0
        self._prepare()

    # ------------------------------------------------------------ public

    def choose(self, questions: Sequence[int]) -> None:
        """Let the traces that begin from now on answer only these questions, given by their numbers."""
        for i in range(self.questions):
            self.asked[i] = 0
        for i in questions:
            self.asked[i] = 1

    def begin(self, seed: int, trace: int, scheduler: int = 0) -> int:
        """Go to the start of a trace; `advance` continues it.

        Args:
            scheduler: 0 draws uniformly among the choices; any other number identifies a scheduler, see `lss`.

        Returns:
            The status of the goal in the initial state: UNKNOWN if one of the questions is undecided.
        """
        self._seed(seed & UINT64_MASK, trace & UINT64_MASK)
        self.scheduler = scheduler & UINT64_MASK
        self.root(self._root_number())
        return self._finish(self._look())

    def root(self, number: int) -> None:
        """Go to the initial state with this number, from 0 to `roots` - 1, without evaluating the goal."""
        self._reset()
        if self.roots > 1:
            self._enter(number)

    def advance(self, limit: int) -> int:
        """Continue until the goal is decided or the trace has `limit` steps; return the status of the goal then."""
        return self._advance(limit)

    def step(self) -> int:
        """Take one step without evaluating the goal. `vector` and the parts describe the step.

        Returns:
            FALSE if no step is possible, FAULTY if the step has an error, else UNKNOWN.
        """
        if self.enabled_count == 0:
            return FALSE
        self._step()
        if self.fault != 0:
            return FAULTY
        self.steps += 1
        return UNKNOWN

    def look(self) -> int:
        """The status of the goal in the current state."""
        return self._look()

    def ended(self) -> bool:
        """Whether no step changes the state any more."""
        return self.enabled_count == 0 or self._can_leave() == 0

    def taken(self) -> list[tuple[int, int]]:
        """The instance and the way of each part of the last step that has an effect."""
        if self.update >= 0:
            self._list_parts(self.update)
        return [(self.slot_instance[self.part_slot[i]], self.part_way[i]) for i in range(self.parts)]

    def outcome(self) -> tuple[int, int, float]:
        """The number of steps of the trace, its number of random draws, and its reward."""
        return self.steps, self.drawn, self.reward

    def result(self, question: int) -> tuple[int, int, int, int]:
        """The result of the trace for a question: the verdict; why the trace has ended for it (`end.End`), DECIDED
        while it can go on; the number of steps until then; and its `goal.Activity`."""
        if self.known[question] == UNKNOWN:
            return UNKNOWN, self.end, self.steps, self._active(self.activity[question])
        return (
            self.known[question],
            self.known_end[question],
            self.known_steps[question],
            self.known_activity[question],
        )

    def ending(self) -> int:
        """Why the trace has ended (`end.End`); also DECIDED while it can go on."""
        return self.end

    def standstill(self) -> int:
        """Why the trace would end here if nothing changed any more; does not depend on the goal."""
        return self._reason(0 if self.enabled_count == 0 else 1)

    def close(self) -> int:
        """The status of the goal if the trace ends in this state, in which no step changes anything."""
        return self._finish(self._ends(0 if self.enabled_count == 0 else 1))

    def open_ways(self, instance: int) -> list[int]:
        """The first way of each edge of `instance` whose guard is true."""
        location = self.place[instance]
        ways = []
        for group in range(self.group_start[location], self.group_start[location + 1]):
            for edge in range(self.edge_start[group], self.edge_start[group + 1]):
                if self.guard[edge] < 0 or self._is_true(self.guard[edge]) != 0:
                    ways.append(self.way_start[edge])
        return ways

    def problem(self) -> tuple[int, int, int, int, float]:
        """The error: its code, the place in the bytecode, and the values that its message shows."""
        return self.fault, self.fault_at, self.fault_value, self.fault_size, self.fault_real

    def integer(self, register: int) -> int:
        """The value of an integer or boolean register."""
        return self.ints[register]

    def real(self, register: int) -> float:
        """The value of a real register."""
        return self.reals[register]

    def snapshot(self) -> tuple[list[int], list[float]]:
        """The values of all variables."""
        return [self.ints[i] for i in range(self.int_count)], [self.reals[i] for i in range(self.real_count)]

    def changed(self, ints: array[int], reals: array[float]) -> tuple[list[int], list[int]]:
        """The registers of integers and of reals whose values differ from those of an earlier `snapshot`."""
        changed_ints = [i for i in range(self.int_count) if self.ints[i] != ints[i]]
        return changed_ints, [i for i in range(self.real_count) if self.reals[i] != reals[i]]

    def location(self, instance: int) -> int:
        """The current location of `instance`, numbered through all instances."""
        return self.place[instance]

    def restore(self, place: Sequence[int], ints: Sequence[int], reals: Sequence[float]) -> None:
        """Go to a state that `snapshot` and `location` have returned."""
        self._reset()
        for i in range(self.instances):
            self.place[i] = place[i]
        for i in range(self.int_count):
            self.ints[i] = ints[i]
        for i in range(self.real_count):
            self.reals[i] = reals[i]
        self._keep_values()
        for slot in range(len(self.ready)):
            self._set_ready(slot, 0)
        for i in range(self.instances):
            self._arrive(self.place[i])

    def returns(self, most: int) -> bool:
        """Whether the trace comes back to the current state within a number of steps."""
        return self._returns(most) != 0

    def conditions(self) -> list[tuple[bool, bool]]:
        """Whether the left and the right side of each until hold in the current state."""
        return [(self._holds(self.left[i]) != 0, self._holds(self.right[i]) != 0) for i in range(self.leaves)]

    def repeat(self, decidable: Sequence[bool], lasting: Sequence[bool]) -> int:
        """Evaluate the goal if the trace visits each of some states again and again, and no others.

        Args:
            decidable: for each until, whether it is decided in one of these states.
            lasting: for each until, whether its right side holds in all of them.

        Returns:
            The status of the goal: UNKNOWN if a question can still be decided in another way.
        """
        self.end = ROUND
        for question in range(self.questions):
            leaves = range(self.leaf_start[question], self.leaf_start[question + 1])
            leaves_open = [i for i in leaves if self.verdict[i] == UNKNOWN]
            if self.known[question] != UNKNOWN or any(self._can_decide(i, decidable[i]) for i in leaves_open):
                continue
            for i in leaves_open:
                self.verdict[i] = TRUE if self.lower[i] < 0 and lasting[i] else FALSE
        status = self._combined()
        if status == UNKNOWN:
            self.end = DECIDED
        return self._finish(status)

    def _can_decide(self, leaf: int, decidable: bool) -> bool:
        """Whether an until without verdict can be decided in the states that the trace visits."""
        if self.lower[leaf] < 0:
            return False
        return decidable or self.upper[leaf] >= 0 or self.lower[leaf] > self.steps

    def save(self) -> tuple[Any, ...]:
        """All data that determine how the trace continues; `load` restores them."""
        arrays = [list(table) for table in self._changing()]
        counts = (self.enabled_count, self.plural, self.fault, self.end, self.vector, self.looped, self.moved)
        goal = (self.status, self.must_look, self.steps, self.still, self.reward)
        draws = (self.key, self.drawn, self.scheduler)
        loop = (self.loop_state, self.loop_drawn, self.loop_span, self.loop_left)
        return arrays, counts, goal, draws, loop

    def load(self, saved: tuple[Any, ...]) -> None:
        """Go back to a state of the same model and goal that `save` has returned."""
        arrays, counts, goal, draws, loop = saved
        self._reset()
        for table, values in zip(self._changing(), arrays, strict=True):
            for i, value in enumerate(values):
                table[i] = value
        self._keep_values()
        self.enabled_count, self.plural, self.fault, self.end, self.vector, self.looped, self.moved = counts
        self.status, self.must_look, self.steps, self.still, self.reward = goal
        self.key, self.drawn, self.scheduler = draws
        self.loop_state, self.loop_drawn, self.loop_span, self.loop_left = loop

    def _changing(self) -> list[Any]:
        """The arrays that steps change, except for those whose contents are used only within a step."""
        state: list[Any] = [self.ints, self.reals, self.place, self.verdict, self.holds_left, self.holds_right]
        goal: list[Any] = [self.stale, self.known, self.known_end, self.known_activity, self.known_steps]
        enabled: list[Any] = [self.ready, self.slot_group, self.gate_missing, self.vector_missing]
        return [*state, *goal, *enabled, self.enabled]

    def choices(self) -> list[tuple[int, int, list[list[list[float]]]]]:
        """All enabled vectors. Each is described by its number, the number of choices that differ only in slots without
        effect, and, for each slot that has an effect, the probabilities of the ways of each enabled edge."""
        vectors = []
        for i in range(self.enabled_count):
            vector = self.enabled[i]
            slots = []
            combinations: Any = 1
            weight: Any = 1
            for k in range(self.all_start[vector], self.all_start[vector + 1]):
                weight *= self.ready[self.all_slot[k]]
            for k in range(self.active_start[vector], self.active_start[vector + 1]):
                slot = self.active_slot[k]
                combinations *= self.ready[slot]
                edges = [self._chances(self._edge(slot, pick)) for pick in range(self.ready[slot])]
                slots.append(edges)
            vectors.append((vector, weight // combinations, slots))
        return vectors

    def go(self, vector: int, picks: list[int], ways: list[int]) -> int:
        """Take a given choice; return the same as `step`.

        Args:
            picks: for each slot of the vector that has an effect, the number of its edge among the enabled ones.
            ways: for each of these slots, the number of the way among those of its edge.
        """
        self._take_given(vector, picks, ways)
        if self.fault != 0:
            return FAULTY
        self.steps += 1
        return UNKNOWN

    # ------------------------------------------------------------ state

    def _prepare(self) -> None:
        """Compute what is enabled in the initial state; every trace starts with a copy of it."""
        for a in range(self.instances):
            self._settle_location(a)
            self._arrive(self.place[a])
        self.note_count = 0
        for i in range(len(self.noted)):
            self.noted[i] = 0
        self.ints_0[:] = self.ints
        self.reals_0[:] = self.reals
        self.ready_0[:] = self.ready
        self.slot_group_0[:] = self.slot_group
        self.gate_missing_0[:] = self.gate_missing
        self.vector_missing_0[:] = self.vector_missing
        self.enabled_0[:] = self.enabled
        self.enabled_count_0 = self.enabled_count
        self.plural_0 = self.plural
        self.fault_0 = self.fault

    def _reset(self) -> None:
        for i in range(self.int_count):
            self.ints[i] = self.ints_0[i]
        for i in range(self.real_count):
            self.reals[i] = self.reals_0[i]
        self._keep_values()
        self.place[:] = self.place_0
        self.ready[:] = self.ready_0
        self.slot_group[:] = self.slot_group_0
        self.gate_missing[:] = self.gate_missing_0
        self.vector_missing[:] = self.vector_missing_0
        self.enabled[:] = self.enabled_0
        self.enabled_count = self.enabled_count_0
        self.plural = self.plural_0
        for i in range(self.note_count):
            self.noted[self.notes[i]] = 0
        self.note_count = 0
        self.fault = self.fault_0
        self.vector = -1
        self.update = -1
        self.looped = 0
        self.loop_drawn = UINT64_MASK
        self.parts = 0
        self._forget_conditions()
        self._reset_goal()

    def _forget_conditions(self) -> None:
        """Let the goal be evaluated again, with all of its conditions."""
        self.must_look = 1
        for i in range(self.leaves):
            self.stale[i] = 1

    def _reset_goal(self) -> None:
        """Set what is known about the trace to its start. The state is not changed."""
        self.end = DECIDED
        self.steps = 0
        self.still = 0
        self.reward = 0.0
        for i in range(self.leaves):
            self.verdict[i] = UNKNOWN
        self.status = UNKNOWN
        for i in range(self.questions):
            self.known[i] = UNKNOWN
            if self.asked[i] == 0:
                self.known[i] = FALSE
                self._drop(i)

    def _enter(self, number: int) -> None:
        """Replace the first initial state by the one with this number."""
        rest = number
        for choice in range(len(self.root_count)):
            first = self.root_start[choice]
            end = self.root_start[choice + 1]
            at = self.root_first[choice] + (rest % self.root_count[choice]) * (end - first)
            rest //= self.root_count[choice]
            for k in range(first, end):
                cell = self.root_cell[k]
                if cell < self.instances:
                    self.place[cell] = self.root_int[at]
                elif cell < self.instances + self.int_count:
                    self.ints[cell - self.instances] = self.root_int[at]
                else:
                    self.reals[cell - self.instances - self.int_count] = self.root_real[at]
                at += 1
        self.fault = 0
        if self.settle >= 0:
            self._execute(self.settle)
        for slot in range(len(self.ready)):
            self._set_ready(slot, 0)
        for a in range(self.instances):
            self._settle_location(a)
        self._keep_values()
        for a in range(self.instances):
            self._arrive(self.place[a])
        for i in range(self.note_count):
            self.noted[self.notes[i]] = 0
        self.note_count = 0

    # ------------------------------------------------------------ random numbers

    def _seed(self, seed: int, trace: int) -> None:
        """Set the random numbers to the first one of a trace."""
        self.key = self._mixed((self._mixed(seed) + trace * GOLDEN) & UINT64_MASK)
        self.drawn = 0

    def _root_number(self) -> int:
        """The number of the initial state of the trace."""
        return self._mixed(self.key) % self.roots if self.roots > 1 else 0

    def _mixed(self, value: int) -> int:
        """The finalizer of SplitMix64 (Steele, Lea and Flood 2014)."""
        z = value
        z = ((z ^ (z >> 30)) * MIX_1) & UINT64_MASK
        z = ((z ^ (z >> 27)) * MIX_2) & UINT64_MASK
        return z ^ (z >> 31)

    def _draw(self) -> int:
        self.drawn += 1
        return self._mixed((self.key + self.drawn * GOLDEN) & UINT64_MASK)

    # ------------------------------------------------------------ what is enabled

    def _set_ready(self, slot: int, count: int) -> None:
        """Set the number of enabled edges of a slot, and update its gate and vectors."""
        old = self.ready[slot]
        if old == count:
            return
        self.ready[slot] = count
        if (old | count) > 1:
            self.plural += (count > 1) - (old > 1)
        vector = self.slot_vector[slot]
        if old == 0:
            if vector < 0:
                self._add_to_gate(vector)
            else:
                self.vector_missing[vector] -= 1
                if self.vector_missing[vector] == 0:
                    self._enable(vector)
        elif count == 0:
            if vector < 0:
                self._remove_from_gate(vector)
            else:
                self.vector_missing[vector] += 1
                if self.vector_missing[vector] == 1:
                    self._disable(vector)

    def _add_to_gate(self, number: int) -> None:
        """A slot has become ready that takes part in several vectors, or in none. `number`: see `slot_vector`."""
        gate = -2 - number
        if gate < 0:
            return
        self.gate_missing[gate] -= 1
        if self.gate_missing[gate] == 0:
            for i in range(self.gate_start[gate], self.gate_start[gate + 1]):
                vector = self.gate_vector[i]
                self.vector_missing[vector] -= 1
                if self.vector_missing[vector] == 0:
                    self._enable(vector)

    def _remove_from_gate(self, number: int) -> None:
        """Such a slot is no longer ready."""
        gate = -2 - number
        if gate < 0:
            return
        self.gate_missing[gate] += 1
        if self.gate_missing[gate] == 1:
            for i in range(self.gate_start[gate], self.gate_start[gate + 1]):
                vector = self.gate_vector[i]
                self.vector_missing[vector] += 1
                if self.vector_missing[vector] == 1:
                    self._disable(vector)

    def _enable(self, vector: int) -> None:
        """Insert a vector into `enabled`, unless it is held."""
        at = self.enabled_count
        if at > 0 and (self.enabled[at - 1] >= self.first_held) != (vector >= self.first_held):
            if vector >= self.first_held:
                return
            at = 0
            self.enabled_count = 0
        while at > 0 and self.enabled[at - 1] > vector:
            self.enabled[at] = self.enabled[at - 1]
            at -= 1
        self.enabled[at] = vector
        self.enabled_count += 1

    def _disable(self, vector: int) -> None:
        """Remove a vector from `enabled`. If it was the last one, the clock is no longer held."""
        if vector >= self.first_held and (self.enabled_count == 0 or self.enabled[0] < self.first_held):
            return
        self.enabled_count -= 1
        at = self.enabled_count
        following = self.enabled[at]
        while following != vector:
            at -= 1
            moved = self.enabled[at]
            self.enabled[at] = following
            following = moved
        if self.enabled_count == 0 and vector < self.first_held:
            for held in range(self.first_held, len(self.vector_missing)):
                if self.vector_missing[held] == 0:
                    self.enabled[self.enabled_count] = held
                    self.enabled_count += 1

    def _arrive(self, location: int) -> None:
        """Compute what the edges of a location enable."""
        for group in range(self.group_start[location], self.group_start[location + 1]):
            self.slot_group[self.group_slot[group]] = group
            self._set_ready(self.group_slot[group], self._count(group))

    def _count(self, group: int) -> int:
        """The number of enabled edges of a group."""
        count = 0
        if self.group_index[group] >= 0:
            at = self._list(self.group_index[group])
            for i in range(self.list_start[at], self.list_start[at + 1]):
                edge = self.list_item[i]
                if edge < 0 or self.guard[edge] < 0 or self._is_true(self.guard[edge]) != 0:
                    count += 1
            return count
        for edge in range(self.edge_start[group], self.edge_start[group + 1]):
            if self.guard[edge] < 0 or self._is_true(self.guard[edge]) != 0:
                count += 1
        return count

    def _is_true(self, pc: int) -> int:
        """Whether the guard at `pc` is true. Most guards consist of comparisons, which their operand c distinguishes
        without jumps."""
        op = self.code[pc]
        while op >= 51 or 2 <= op <= 7:  # the comparisons: FAIL_..., IS_..., JUMP_...
            x = self.ints[self.code[pc + 2]]
            y = self.ints[self.code[pc + 3]]
            result = (self.code[pc + 4] >> ((x > y) + (x >= y))) & 1
            if op >= 57:
                return result
            if result == 0:
                pc += WIDTH
            elif op >= 51:
                return 0
            else:
                pc = self.code[pc + 1]
            op = self.code[pc]
        return 1 if self._execute(pc) != 0 else 0

    def _list(self, index: int) -> int:
        """The list of an index for the current values."""
        at = 0
        for i in range(self.dimension_start[index], self.dimension_start[index + 1]):
            value = self.ints[self.dimension_register[i]] - self.dimension_low[i]
            if value < 0 or value >= self.dimension_size[i]:
                return self.first_list[index + 1] - 1
            at = at * self.dimension_size[i] + value
        return self.first_list[index] + at

    def _list_before(self, index: int) -> int:
        """The list of an index for the values before this step."""
        at = 0
        for i in range(self.dimension_start[index], self.dimension_start[index + 1]):
            value = self.value_before[self.dimension_register[i]] - self.dimension_low[i]
            if value < 0 or value >= self.dimension_size[i]:
                return self.first_list[index + 1] - 1
            at = at * self.dimension_size[i] + value
        return self.first_list[index] + at

    def _keep_values(self) -> None:
        """Store the values of the registers in indexes, which `_list_before` reads."""
        for i in range(len(self.indexed_register)):
            self.value_before[self.indexed_register[i]] = self.ints[self.indexed_register[i]]

    def _total(self) -> int:
        """The number of choices if it is at most MAX_DRAWN_COMBINATIONS, else any greater number."""
        if self.plural == 0:
            return self.enabled_count
        total = 0
        for i in range(self.enabled_count):
            total += self._weight(self.enabled[i])
        return total

    def _weight(self, vector: int) -> int:
        """The number of combinations of edges with which a vector can be taken, at most MAX_DRAWN_COMBINATIONS + 1."""
        weight = 1
        for i in range(self.all_start[vector], self.all_start[vector + 1]):
            count = self.ready[self.all_slot[i]]
            if count > 1:
                weight *= count
                if weight > MAX_DRAWN_COMBINATIONS:
                    return MAX_DRAWN_COMBINATIONS + 1
        return weight

    def _weigh(self, vector: int) -> None:
        """Compute the number of combinations without a limit, as `mass` times MASS_UNIT to the power of `rank`. `mass`
        is at most MASS_UNIT, and at least 1 if `rank` is above 0."""
        self.mass = 1.0
        self.rank = 0
        for i in range(self.all_start[vector], self.all_start[vector + 1]):
            self.mass *= self.ready[self.all_slot[i]]
            if self.mass > MASS_UNIT:
                self.mass *= MASS_UNIT_INVERSE
                self.rank += 1

    def _share(self, vector: int, top: int) -> float:
        """The weight of a vector in units of MASS_UNIT to the power of `top`, the greatest rank."""
        self._weigh(vector)
        if self.rank == top:
            return self.mass
        return self.mass * MASS_UNIT_INVERSE if self.rank == top - 1 else 0.0

    # ------------------------------------------------------------ a step

    def _step(self) -> None:
        """Choose a vector and its edges, take the step, and update what is enabled."""
        rest = 0
        apart = 0
        if self.scheduler != 0 and (self.enabled_count > 1 or self.plural != 0):
            apart = 1
            vector = self._scheduled()
        elif self.plural == 0:
            if self.enabled_count == 1:
                vector = self.enabled[0]
            else:
                vector = self.enabled[((self._toss() >> 32) * self.enabled_count) >> 32]
        else:
            total = self._total()
            if total > MAX_DRAWN_COMBINATIONS:
                apart = 1
                vector = self._heavy()
            else:
                if total > 1:
                    rest = ((self._toss() >> 32) * total) >> 32
                i = 0
                vector = self.enabled[0]
                weight = self._weight(vector)
                while rest >= weight:
                    rest -= weight
                    i += 1
                    vector = self.enabled[i]
                    weight = self._weight(vector)
        if self.exit_reward >= 0:
            self._add_reward(self.exit_reward)
        update = self._fixed(vector)
        if update >= 0:
            self._take_fixed(vector, update)
        else:
            self._take(vector, rest, apart)

    def _heavy(self) -> int:
        """A vector drawn by weights that need not fit into an integer."""
        top = 0
        for i in range(self.enabled_count):
            self._weigh(self.enabled[i])
            top = max(top, self.rank)
        total = 0.0
        for i in range(self.enabled_count):
            total += self._share(self.enabled[i], top)
        aim = (self._toss() >> 11) * TO_UNIT * total
        chosen = self.enabled[0]
        for i in range(self.enabled_count):
            share = self._share(self.enabled[i], top)
            if share > 0.0:
                chosen = self.enabled[i]
                if aim < share:
                    return chosen
                aim -= share
        return chosen

    def _toss(self) -> int:
        """The next number that decides between choices: a random one, or a hash of the scheduler and the state."""
        if self.scheduler == 0:
            return self._draw()
        self.tossed += 1
        return self._mixed((self.choice + self.tossed * GOLDEN) & UINT64_MASK)

    def _scheduled(self) -> int:
        """The vector that the scheduler chooses in this state: among those that it prefers, the one with the greatest
        hash of scheduler, state and vector."""
        self.choice = self._state_hash()
        self.tossed = 0
        self._notice(self.choice)
        bias = (self.scheduler >> 57) & 3
        chosen = -1
        chosen_rank = 0
        greatest = 0
        for i in range(self.enabled_count):
            vector = self.enabled[i]
            rank = 0
            if bias != 0:
                rank = self._takes_part(vector, (self.scheduler >> 32) & 0xFFFFFF)
                if bias == 1:
                    rank = 1 - rank
            value = self._mixed((self.choice ^ self._mixed(vector + 1)) & UINT64_MASK)
            if chosen < 0 or rank > chosen_rank or (rank == chosen_rank and value > greatest):
                chosen = vector
                chosen_rank = rank
                greatest = value
        return chosen

    def _takes_part(self, vector: int, instance: int) -> int:
        """Whether `instance` has a slot in `vector` that has an effect."""
        for i in range(self.active_start[vector], self.active_start[vector + 1]):
            if self.slot_instance[self.active_slot[i]] == instance:
                return 1
        return 0

    def _notice(self, state: int) -> None:
        """Detect that the scheduler has returned to a state without a random draw in between. The scheduler chooses
        only by the hash of the state, so the trace then repeats for ever. Each remembered state is kept for twice as
        many choices as the previous one (Brent 1980)."""
        if self.drawn != self.loop_drawn:
            self.loop_drawn = self.drawn
            self.loop_state = state
            self.loop_span = 1
            self.loop_left = 1
        elif state == self.loop_state:
            self.looped = 1
        else:
            self.loop_left -= 1
            if self.loop_left == 0:
                self.loop_state = state
                self.loop_span *= 2
                self.loop_left = self.loop_span

    def _state_hash(self) -> int:
        """A hash of the scheduler and of all values that its choice depends on."""
        state = self.scheduler
        if (self.scheduler >> 56) & 1 != 0:
            state = self._mixed((state + self.vector + 2) & UINT64_MASK)
        # Each of hundreds of values needs only one multiplication and no function call, which would be slow in plain
        # Python. A multiplication waits for the one before it; those of the three other sums are independent of it.
        second = third = fourth = GOLDEN
        i = 3
        while i < self.instances:
            state = ((state ^ (state >> 32)) + self.place[i - 3] + 1) * MIX_1 & UINT64_MASK
            second = ((second ^ (second >> 32)) + self.place[i - 2] + 1) * MIX_1 & UINT64_MASK
            third = ((third ^ (third >> 32)) + self.place[i - 1] + 1) * MIX_1 & UINT64_MASK
            fourth = ((fourth ^ (fourth >> 32)) + self.place[i] + 1) * MIX_1 & UINT64_MASK
            i += 4
        for j in range(i - 3, self.instances):
            state = ((state ^ (state >> 32)) + self.place[j] + 1) * MIX_1 & UINT64_MASK
        i = 3
        while i < self.int_count:
            state = ((state ^ (state >> 32)) + (self.ints[i - 3] & UINT64_MASK)) * MIX_1 & UINT64_MASK
            second = ((second ^ (second >> 32)) + (self.ints[i - 2] & UINT64_MASK)) * MIX_1 & UINT64_MASK
            third = ((third ^ (third >> 32)) + (self.ints[i - 1] & UINT64_MASK)) * MIX_1 & UINT64_MASK
            fourth = ((fourth ^ (fourth >> 32)) + (self.ints[i] & UINT64_MASK)) * MIX_1 & UINT64_MASK
            i += 4
        for j in range(i - 3, self.int_count):
            state = ((state ^ (state >> 32)) + (self.ints[j] & UINT64_MASK)) * MIX_1 & UINT64_MASK
        for i in range(self.real_count):
            real = self.reals[i]
            # `hash` creates an object, and most of the hundreds of reals in messages with poses are 0, whose hash is 0.
            part = 0 if real == 0.0 else hash(real) & UINT64_MASK
            state = ((state ^ (state >> 32)) + part) * MIX_1 & UINT64_MASK
        state = ((state ^ (state >> 32)) + second) * MIX_1 & UINT64_MASK
        state = ((state ^ (state >> 32)) + third) * MIX_1 & UINT64_MASK
        state = ((state ^ (state >> 32)) + fourth) * MIX_1 & UINT64_MASK
        return self._mixed(state)

    def _take(self, vector: int, rest: int, apart: int) -> None:
        """Take combination number `rest` of `vector`; with `apart`, draw the edge of each slot separately."""
        self.vector = vector
        self.update = -1
        self.moved = 0
        parts = 0
        for i in range(self.active_start[vector], self.active_start[vector + 1]):
            slot = self.active_slot[i]
            count = self.ready[slot]
            pick = 0
            if count > 1:
                if apart != 0:
                    pick = ((self._toss() >> 32) * count) >> 32
                else:
                    pick = rest % count
                    rest //= count
            way = self.group_way[self.slot_group[slot]]
            if way < 0:
                edge = self._edge(slot, pick)
                way = self.way_start[edge]
                if self.way_start[edge + 1] - way > 1:
                    way = self._way(edge)
                    if way < 0:
                        self.parts = parts
                        return
            self.part_slot[parts] = slot
            self.part_way[parts] = way
            parts += 1
        self.parts = parts
        self._apply(vector)

    def _fixed(self, vector: int) -> int:
        """The index in `Program.updates` of the step that takes a vector, -1 if its ways are to be chosen."""
        update = self.vector_update[vector]
        return update if update >= -1 else self.group_update[self.slot_group[-2 - update]]

    def _take_fixed(self, vector: int, update: int) -> None:
        """Take a vector whose ways need not be chosen. `update`: the result of `_fixed`, which is not negative."""
        self.vector = vector
        self.update = update
        self.parts = 0
        self.moved = 0
        at = update + 2
        end = self.updates[update]
        if self.is_plain == 0:
            self._list_parts(update)
            self._execute_ways(vector)
            at = end
        while at < end:
            self._execute(self.updates[at])
            at += 1
        if self.fault != 0:
            return
        end = self.updates[update + 1]
        if at < end:
            self.vector_missing[vector] = end - at
            self._disable(vector)
            while at < end:
                self.ready[self.updates[at]] = 0
                at += 1
        self._move(at)
        if self.note_count != 0:
            self._look_around()

    def _list_parts(self, update: int) -> None:
        """Store the parts of a step in `Program.updates`."""
        at = self.updates[self.updates[update + 1] + 3]
        self.parts = self.updates[at]
        for i in range(self.parts):
            self.part_slot[i] = self.updates[at + 1 + 2 * i]
            self.part_way[i] = self.updates[at + 2 + 2 * i]

    def _take_given(self, vector: int, picks: list[int], ways: list[int]) -> None:
        update = self._fixed(vector)
        if update >= 0:
            self._take_fixed(vector, update)
            return
        self.vector = vector
        self.update = -1
        self.parts = 0
        self.moved = 0
        for i in range(self.active_start[vector], self.active_start[vector + 1]):
            slot = self.active_slot[i]
            edge = self._edge(slot, picks[self.parts])
            self.part_slot[self.parts] = slot
            self.part_way[self.parts] = self.way_start[edge] + ways[self.parts]
            self.parts += 1
        self._apply(vector)

    def _apply(self, vector: int) -> None:
        """Take the chosen ways, and update what is enabled."""
        if self.is_plain == 0 or self.entangled[vector] != 0:
            self._execute_ways(vector)
        else:
            for i in range(self.parts):
                code = self.way_code[self.part_way[i]]
                if code >= 0:
                    self._execute(code)
        if self.fault != 0:
            return
        for i in range(self.parts):
            update = self.way_update[self.part_way[i]]
            if update >= 0:
                self._move(update)
        if self.note_count != 0:
            self._look_around()

    def _move(self, update: int) -> None:
        """Let instances go from one location to another. `update`: the index of a move in `Program.updates`."""
        at = update + 4
        end = self.updates[update]
        while at < end:
            self.place[self.updates[at]] = self.updates[at + 1]
            self.moved = 1
            at += 2
        end = self.updates[update + 1]
        while at < end:
            slot = self.updates[at]
            if self.ready[slot] != 0:
                self.ready[slot] = 0
                vector = self.updates[at + 1]
                if vector < 0:
                    self._remove_from_gate(vector)
                else:
                    missing = self.vector_missing[vector]
                    self.vector_missing[vector] = missing + 1
                    if missing == 0:
                        self._disable(vector)
            at += 2
        end = self.updates[update + 2]
        while at < end:
            slot = self.updates[at]
            self.ready[slot] = 1
            self.slot_group[slot] = self.updates[at + 2]
            vector = self.updates[at + 1]
            if vector < 0:
                self._add_to_gate(vector)
            else:
                missing = self.vector_missing[vector] - 1
                self.vector_missing[vector] = missing
                if missing == 0:
                    self._enable(vector)
            at += 3
        end = self.updates[update + 3]
        while at < end:
            slot = self.updates[at]
            group = self.updates[at + 1]
            count = self.updates[at + 2]
            if count < 0:
                count = self._count(group) if count == -1 else self._is_true(-2 - count)
            self.slot_group[slot] = group
            if self.ready[slot] != count:
                self._set_ready(slot, count)
            at += 3

    def _execute_ways(self, vector: int) -> None:
        """Execute the assignments of the chosen ways, and change the locations."""
        if self.sums != 0:
            self._accumulate(self.sum_exit)
        if self.settle >= 0:
            self._execute(self.settle)
        if self.entangled[vector] == 0:
            for i in range(self.parts):
                if self.way_code[self.part_way[i]] >= 0:
                    self._execute(self.way_code[self.part_way[i]])
        else:
            self._execute_phases()
        if self.fault != 0:
            return
        if self.step_reward >= 0:
            self._add_reward(self.step_reward)
        if self.sums != 0:
            self._accumulate(self.sum_step)
        for i in range(self.parts):
            self.place[self.slot_instance[self.part_slot[i]]] = self.way_target[self.part_way[i]]
        if self.settle >= 0:
            self._execute(self.settle)
            for i in range(self.instances):
                self._settle_location(i)

    def _edge(self, slot: int, pick: int) -> int:
        """Enabled edge number `pick` of a slot."""
        group = self.slot_group[slot]
        edge = self.edge_start[group]
        if self.edge_start[group + 1] - edge == 1:
            return edge
        if self.group_index[group] >= 0:
            i = self.list_start[self._list(self.group_index[group])]
            while True:
                edge = self.list_item[i]
                if edge < 0 or self.guard[edge] < 0 or self._is_true(self.guard[edge]) != 0:
                    if pick == 0:
                        return edge if edge >= 0 else -1 - edge
                    pick -= 1
                i += 1
        while True:
            if self.guard[edge] < 0 or self._is_true(self.guard[edge]) != 0:
                if pick == 0:
                    return edge
                pick -= 1
            edge += 1

    def _way(self, edge: int) -> int:
        """A way of `edge`, drawn by the probabilities; -1 if one of these is negative or they do not add up to 1."""
        first = self.way_start[edge]
        end = self.way_start[edge + 1]
        if self.way_chance[first] >= 0:
            return self._way_computed(edge)
        unit = (self._draw() >> 11) * TO_UNIT
        low = first
        high = end - 1
        while low < high:
            middle = (low + high) // 2
            if unit < self.way_sum[middle]:
                high = middle
            else:
                low = middle + 1
        return low

    def _way_computed(self, edge: int) -> int:
        """Like `_way`, for probabilities that depend on the state."""
        first = self.way_start[edge]
        end = self.way_start[edge + 1]
        unit = (self._draw() >> 11) * TO_UNIT
        total = 0.0
        drawn = -1
        last = -1
        for way in range(first, end):
            register = self._execute(self.way_chance[way])
            if self.fault != 0:
                return -1
            chance = self.reals[register]
            if chance < 0.0:
                self._fail(6, self.way_chance[way])
                return -1
            total += chance
            if chance > 0.0:
                last = way
            if drawn < 0 and unit < total:
                drawn = way
        if total < 0.999999 or total > 1.000001:
            self._fail(6, self.way_chance[first])
            return -1
        return last if drawn < 0 else drawn

    def _chances(self, edge: int) -> list[float]:
        """The probability of each way of `edge`."""
        chances = []
        before = 0.0
        for way in range(self.way_start[edge], self.way_start[edge + 1]):
            if self.way_chance[way] >= 0:
                chances.append(self.reals[self._execute(self.way_chance[way])])
            else:
                chances.append(self.way_sum[way] - before)
                before = self.way_sum[way]
        return chances

    def _execute_phases(self) -> None:
        """Execute the assignments of ways that depend on each other: for each index, first compute all values, then
        assign them."""
        index = MIN_INT64
        while True:
            following = MAX_INT64
            for i in range(self.parts):
                way = self.part_way[i]
                for k in range(self.phase_start[way], self.phase_start[way + 1]):
                    if self.phase_index[k] > index and self.phase_index[k] < following:
                        following = self.phase_index[k]
            if following == MAX_INT64:
                return
            index = following
            for i in range(self.parts):
                way = self.part_way[i]
                for k in range(self.phase_start[way], self.phase_start[way + 1]):
                    if self.phase_index[k] == index:
                        self._execute(self.phase_read[k])
                        if self.fault != 0:
                            return
            for i in range(self.parts):
                way = self.part_way[i]
                for k in range(self.phase_start[way], self.phase_start[way + 1]):
                    if self.phase_index[k] == index:
                        self._execute(self.phase_write[k])
                        if self.fault != 0:
                            return

    def _look_around(self) -> None:
        """Evaluate guards in the current locations again if they read a changed variable, and mark the conditions of
        the goal that read one."""
        for i in range(self.note_count):
            variable = self.notes[i]
            self.noted[variable] = 0
            for k in range(self.seen_start[variable], self.seen_start[variable + 1]):
                self.stale[self.seen_leaf[k]] = 1
                self.must_look = 1
            for k in range(self.watch_start[variable], self.watch_start[variable + 1]):
                instance = self.watch_instance[k]
                at = self.watch_table[k] + self.place[instance] - self.first_location[instance]
                index = self.watched_index[at]
                if index >= 0 and self.visited[index] == 0:
                    self._look_up(index)
                for m in range(self.watched_start[at], self.watched_start[at + 1]):
                    group = self.watched_group[m]
                    self._set_ready(self.group_slot[group], self._count(group))
        for i in range(self.note_count):
            variable = self.notes[i]
            for k in range(self.indexed_start[variable], self.indexed_start[variable + 1]):
                self.value_before[self.indexed_register[k]] = self.ints[self.indexed_register[k]]
        self.note_count = 0
        for i in range(self.visit_count):
            self.visited[self.visits[i]] = 0
        self.visit_count = 0

    def _look_up(self, index: int) -> None:
        """Evaluate the guards of a location that are in an index, once in a step. Guards that are neither in the list
        for the previous values nor in that for the current ones were false and stay false. The last vectors leave
        `enabled` first, so that it is not moved."""
        self.visited[index] = 1
        self.visits[self.visit_count] = index
        self.visit_count += 1
        before = self._list_before(index)
        now = self._list(index)
        if before != now:
            i = self.list_start[before + 1]
            while i > self.list_start[before]:
                i -= 1
                group = self.list_item[i]
                self._set_ready(self.group_slot[group if group >= 0 else -1 - group], 0)
        for i in range(self.list_start[now], self.list_start[now + 1]):
            group = self.list_item[i]
            if group >= 0:
                self._set_ready(self.group_slot[group], self._count(group))
            elif before != now:
                self._set_ready(self.group_slot[-1 - group], 1)

    def _settle_location(self, instance: int) -> None:
        """Give transient variables the values that they have in the current location of `instance`."""
        code = self.location_code[self.place[instance]]
        if code >= 0:
            self._execute(code)

    def _can_leave(self) -> int:
        """Whether any choice changes the state."""
        for i in range(self.enabled_count):
            vector = self.enabled[i]
            for k in range(self.active_start[vector], self.active_start[vector + 1]):
                slot = self.active_slot[k]
                for pick in range(self.ready[slot]):
                    edge = self._edge(slot, pick)
                    for way in range(self.way_start[edge], self.way_start[edge + 1]):
                        if self._is_possible(way) != 0 and self._changes(slot, way) != 0:
                            return 1
        return self._can_change()

    def _can_change(self) -> int:
        """Whether a combination of ways changes the state, although none of them does so alone: because they depend on
        one another, or because the step has a reward that is accumulated."""
        is_open = 0
        for i in range(self.sums):
            if self.reals[self.sum_register[i]] < self.sum_limit[i]:
                is_open = 1
        parts = self.parts
        for i in range(parts):
            self.kept_slot[i] = self.part_slot[i]
            self.kept_way[i] = self.part_way[i]
        changes = 0
        self.tried = 0
        for i in range(self.enabled_count):
            vector = self.enabled[i]
            if changes == 0 and (is_open != 0 or self.entangled[vector] != 0):
                self.parts = 0
                changes = self._changes_from(vector, self.active_start[vector])
        self.parts = parts
        for i in range(parts):
            self.part_slot[i] = self.kept_slot[i]
            self.part_way[i] = self.kept_way[i]
        return changes

    def _changes_from(self, vector: int, at: int) -> int:
        """Whether a combination of edges and ways of `vector` changes the state. The parts of the slots before the
        index `at` are chosen already."""
        if at == self.active_start[vector + 1]:
            self.tried += 1
            # The answer 1 is always safe, because the trace then goes on.
            return 1 if self.tried > MAX_DRAWN_COMBINATIONS else self._changes_variables(vector)
        slot = self.active_slot[at]
        for pick in range(self.ready[slot]):
            edge = self._edge(slot, pick)
            for way in range(self.way_start[edge], self.way_start[edge + 1]):
                if self._is_possible(way) != 0:
                    self.part_slot[self.parts] = slot
                    self.part_way[self.parts] = way
                    self.parts += 1
                    changes = self._changes_from(vector, at + 1)
                    self.parts -= 1
                    if changes != 0:
                        return 1
        return 0

    def _changes_variables(self, vector: int) -> int:
        """Whether the step that the parts describe, which changes no location, changes a variable."""
        self._store()
        self._execute_ways(vector)
        return self._restored()

    def _store(self) -> None:
        """Store the variables, for `_restored`."""
        for i in range(self.int_count):
            self.ints_before[i] = self.ints[i]
        for i in range(self.real_count):
            self.reals_before[i] = self.reals[i]

    def _restored(self) -> int:
        """Restore the variables; return whether one of them had changed, or an operation was undefined."""
        changed = 0
        for i in range(self.int_count):
            if self.ints_before[i] != self.ints[i]:
                changed = 1
            self.ints[i] = self.ints_before[i]
        for i in range(self.real_count):
            if self.reals_before[i] != self.reals[i]:
                changed = 1
            self.reals[i] = self.reals_before[i]
        for i in range(self.note_count):
            self.noted[self.notes[i]] = 0
        self.note_count = 0
        if self.fault != 0:
            self.fault = 0
            changed = 1
        return changed

    def _is_possible(self, way: int) -> int:
        """Whether a way has a positive probability."""
        if self.way_chance[way] >= 0:
            register = self._execute(self.way_chance[way])
            return 1 if self.fault != 0 or self.reals[register] > 0.0 else 0
        return 1 if self.way_sum[way] > 0.0 else 0

    def _changes(self, slot: int, way: int) -> int:
        if self.way_move[way] >= 0:
            return 1
        if self.way_code[way] < 0:
            return 0
        self._store()
        self._execute(self.way_code[way])
        if self.settle >= 0:
            self._execute(self.settle)
            for i in range(self.instances):
                self._settle_location(i)
        return self._restored()

    # ------------------------------------------------------------ the goal

    def _advance(self, limit: int) -> int:
        if self.fault != 0:
            return FAULTY
        while self.steps < limit:
            if self.enabled_count == 0:
                return self._finish(self._ends(0))
            self._step()
            if self.fault != 0:
                return FAULTY
            self.steps += 1
            status = self._after_step()
            if status != GOES_ON:
                return self._finish(status)
        return UNKNOWN

    def _after_step(self) -> int:
        """Evaluate the goal after a step; return GOES_ON if the trace has not ended."""
        if self.looped != 0 and self.is_bounded == 0:
            return self._goes_round()
        if self.is_bounded == 2:
            self._forget_conditions()
        if self.must_look != 0 or self.is_bounded != 0:
            status = self._look()
            if status != UNKNOWN:
                if self.is_bounded == 2 and self.enabled_count == 0:
                    self.end = self._reason(0)
                    self.known_end[0] = self.end
                return status
        if self.moved != 0:
            self.still = 0
        else:
            self.still += 1
            if self.still & (self.still - 1) == 0 and self.lasts == 0 and self._can_leave() == 0:
                return self._ends(0 if self.enabled_count == 0 else 1)
        return GOES_ON

    def _finish(self, status: int) -> int:
        return FAULTY if self.fault != 0 else status

    def _look(self) -> int:
        """Evaluate the goal in the current state; return its status."""
        decided = 0
        for i in range(self.leaves):
            if self.verdict[i] == UNKNOWN:
                if self.stale[i] != 0:
                    self.stale[i] = 0
                    self.holds_left[i] = self._holds(self.left[i])
                    self.holds_right[i] = self._holds(self.right[i])
                    if self.fault != 0:
                        return FAULTY
                if self.lower[i] < 0:
                    continue
                if self.holds_right[i] != 0 and self.steps >= self.lower[i]:
                    self.verdict[i] = TRUE
                    decided = 1
                elif self.holds_left[i] == 0 or (self.upper[i] >= 0 and self.steps >= self.upper[i]):
                    self.verdict[i] = FALSE
                    decided = 1
        self.must_look = 0
        return self.status if decided == 0 else self._combined()

    def _holds(self, code: int) -> int:
        """The value of a condition: the address of its bytecode, or a negative number that `program.Goal` defines."""
        if code == -1:
            return 1
        if code == -2:
            return 0
        if code == -3:
            return self._is_deadlock()
        if code == -4:
            return 1 - self._is_deadlock()
        if code == -5:
            return 0
        return 1 if self._execute(code) != 0 else 0

    def _is_deadlock(self) -> int:
        """Whether no step is possible. The end of the model's time and a finished tree are not deadlocks."""
        if self.enabled_count != 0:
            return 0
        reason = self._reason(0)
        return 0 if reason in (TIME, FINISHED) else 1

    def _ends(self, repeats: int) -> int:
        """Evaluate the goal if the state never changes again; with `repeats`, steps that change nothing go on for
        ever."""
        return self._ends_for(self._reason(repeats), repeats)

    def _ends_for(self, reason: int, repeats: int) -> int:
        self.end = reason
        for i in range(self.leaves):
            if self.verdict[i] == UNKNOWN:
                if self.right[i] == -5:
                    self.verdict[i] = TRUE if self.end == STUCK else FALSE
                elif self.lower[i] < 0:
                    if self.end != TIME or self.holds_left[i] == 0:
                        self.verdict[i] = TRUE if self.holds_right[i] != 0 else FALSE
                else:
                    self.verdict[i] = TRUE if repeats != 0 and self.holds_right[i] != 0 else FALSE
        return self._combined()

    def _returns(self, most: int) -> int:
        self.place_mark[:] = self.place
        self.ints_mark[:] = self.ints
        self.reals_mark[:] = self.reals
        for _ in range(most):
            if self.enabled_count == 0:
                return 0
            self._step()
            if self.fault != 0:
                return 0
            if self._is_marked() != 0:
                return 1
        return 0

    def _is_marked(self) -> int:
        """Whether the state is the one in which `_returns` began."""
        for i in range(self.instances):
            if self.place[i] != self.place_mark[i]:
                return 0
        for i in range(self.int_count):
            if self.ints[i] != self.ints_mark[i]:
                return 0
        for i in range(self.real_count):
            if self.reals[i] != self.reals_mark[i]:
                return 0
        return 1

    def _goes_round(self) -> int:
        """Evaluate the goal if the trace repeats a cycle for ever. A condition that has not been true will then never
        be true. Whether a condition is true at every step of the cycle is not known."""
        self.end = IDLE
        for i in range(self.leaves):
            if self.verdict[i] == UNKNOWN and self.lower[i] >= 0:
                self.verdict[i] = FALSE
        return self._combined()

    def _reason(self, repeats: int) -> int:
        """Why the state does not change any more: the smallest mark of the current locations; ROUND if steps that
        change nothing hold the clock."""
        for vector in range(self.first_held, len(self.vector_missing)):
            if repeats != 0 and self.vector_missing[vector] == 0 and self.enabled[0] < self.first_held:
                return ROUND
        reason = 0
        for i in range(self.instances):
            mark = self.location_mark[self.place[i]]
            if mark != 0 and (reason == 0 or mark < reason):
                reason = mark
        if reason != 0:
            return reason
        return DEADLOCK if repeats == 0 else IDLE

    def _combined(self) -> int:
        """Evaluate the formulas of the open questions. Return UNKNOWN if one of them stays open, otherwise the last
        verdict."""
        status = self.status
        is_open = 0
        for i in range(self.questions):
            if self.known[i] == UNKNOWN:
                status = self._value(self.formula_start[i], self.formula_start[i + 1])
                if status == UNKNOWN:
                    is_open = 1
                else:
                    self.known[i] = status
                    self.known_end[i] = self.end
                    self.known_steps[i] = self.steps
                    self.known_activity[i] = self._active(self.activity[i])
                    self._drop(i)
        self.status = UNKNOWN if is_open != 0 else status
        return self.status

    def _active(self, code: int) -> int:
        """The `goal.Activity` that `code` computes."""
        return ASKED if code < 0 else self._execute(code)

    def _drop(self, question: int) -> None:
        """Stop the evaluation of the untils of a question."""
        for i in range(self.leaf_start[question], self.leaf_start[question + 1]):
            self.verdict[i] = FALSE

    def _value(self, start: int, end: int) -> int:
        """The value of a formula over the untils. The formula is in reverse Polish notation: -1 is not, -2 is and, -3
        is or."""
        top = 0
        for i in range(start, end):
            item = self.formula[i]
            if item >= 0:
                self.stack[top] = self.verdict[item]
                top += 1
            elif item == -1:
                if self.stack[top - 1] != UNKNOWN:
                    self.stack[top - 1] = 1 - self.stack[top - 1]
            else:
                top -= 1
                a = self.stack[top - 1]
                b = self.stack[top]
                decisive = FALSE if item == -2 else TRUE
                if a == decisive or b == decisive:
                    self.stack[top - 1] = decisive
                elif a == UNKNOWN or b == UNKNOWN:
                    self.stack[top - 1] = UNKNOWN
                else:
                    self.stack[top - 1] = a
        return self.stack[0]

    def _add_reward(self, code: int) -> None:
        register = self._execute(code)
        self.added = self.reals[register]
        self.reward += self.added

    def _accumulate(self, codes: Any) -> None:
        """Add the rewards of a step, which `codes` compute, to the variables that contain accumulated rewards."""
        for i in range(self.sums):
            if codes[i] < 0:
                continue
            register = self._execute(codes[i])
            if self.fault != 0:
                return
            reward = self.reals[register]
            if reward < 0.0:
                self._fail(9, codes[i])
                return
            register = self.sum_register[i]
            total = min(self.reals[register] + reward, self.sum_limit[i])
            if total != self.reals[register]:
                self.reals[register] = total
                self._note(self.sum_watch[i])

    # ------------------------------------------------------------ the bytecode

    def _fail(self, fault: int, at: int) -> None:
        self._fail_with(fault, at, 0, 0, 0.0)

    def _fail_with(self, fault: int, at: int, value: int, size: int, real: float) -> None:
        """Keep the first fault of a step, with its values; later ones may follow from it."""
        if self.fault == 0:
            self.fault = fault
            self.fault_at = at
            self.fault_value = value
            self.fault_size = size
            self.fault_real = real

    def _note(self, variable: int) -> None:
        if self.noted[variable] == 0:
            self.noted[variable] = 1
            self.notes[self.note_count] = variable
            self.note_count += 1

    def _call(self, function: int, real: int, target: int, at: int) -> int:
        """Call a Python function with the collected arguments; return whether it has a value for them."""
        arguments = self.arguments
        self.arguments = []
        try:
            value = self.functions[function](*arguments)
            if real != 0:
                self.reals[target] = value
            else:
                if value > MAX_INT64 or value < MIN_INT64:
                    self._fail(1, at)
                    return 0
                self.ints[target] = value
        except ZeroDivisionError:
            self._fail(2, at)
            return 0
        except OverflowError:
            self._fail(8, at)
            return 0
        except Exception:
            self._fail_with(5, at, 0, 0, arguments[0])
            return 0
        return 1

    def _execute(self, pc: int) -> int:
        """Execute the bytecode from `pc` on; return the operand of its RETURN. The codes are those of `opcodes`."""
        while True:
            op = self.code[pc]
            d = self.code[pc + 1]
            a = self.code[pc + 2]
            b = self.code[pc + 3]
            c = self.code[pc + 4]
            if op == RETURN:
                return self.ints[a]
            if op == JUMP:
                pc = d
                continue
            if op == JUMP_TRUE:
                if self.ints[a] != 0:
                    pc = d
                    continue
            elif op == JUMP_FALSE:
                if self.ints[a] == 0:
                    pc = d
                    continue
            elif op == JUMP_EQ:
                if self.ints[a] == self.ints[b]:
                    pc = d
                    continue
            elif op == JUMP_NE:
                if self.ints[a] != self.ints[b]:
                    pc = d
                    continue
            elif op == JUMP_LT:
                if self.ints[a] < self.ints[b]:
                    pc = d
                    continue
            elif op == JUMP_LE:
                if self.ints[a] <= self.ints[b]:
                    pc = d
                    continue
            elif op == MOVE:
                self.ints[d] = self.ints[a]
            elif op == SET:
                if self.ints[d] != self.ints[a]:
                    self.ints[d] = self.ints[a]
                    self._note(b)
            elif op == ADD:
                x = self.ints[a]
                y = self.ints[b]
                z = x + y
                if z > MAX_INT64 or z < MIN_INT64 or (y >= 0) != (z >= x):
                    self._fail(1, pc)
                    return 0
                self.ints[d] = z
            elif op == SUB:
                x = self.ints[a]
                y = self.ints[b]
                z = x - y
                if z > MAX_INT64 or z < MIN_INT64 or (y >= 0) != (z <= x):
                    self._fail(1, pc)
                    return 0
                self.ints[d] = z
            elif op == MUL:
                x = self.ints[a]
                y = self.ints[b]
                if x == 0 or y == 0:
                    z = 0
                elif (x == -1 and y == MIN_INT64) or (y == -1 and x == MIN_INT64):
                    self._fail(1, pc)
                    return 0
                else:
                    z = x * y
                    if z > MAX_INT64 or z < MIN_INT64 or z // y != x:
                        self._fail(1, pc)
                        return 0
                self.ints[d] = z
            elif op == MIN:
                self.ints[d] = self.ints[a] if self.ints[a] <= self.ints[b] else self.ints[b]
            elif op == MAX:
                self.ints[d] = self.ints[a] if self.ints[a] >= self.ints[b] else self.ints[b]
            elif op == ABS:
                x = self.ints[a]
                if x == MIN_INT64:
                    self._fail(1, pc)
                    return 0
                self.ints[d] = x if x >= 0 else -x
            elif op == REM:
                x = self.ints[a]
                y = self.ints[b]
                if y == 0:
                    self._fail(2, pc)
                    return 0
                if y == MIN_INT64:
                    z = x if x >= 0 else (0 if x == MIN_INT64 else x - MIN_INT64)
                else:
                    y = y if y > 0 else -y
                    z = x - (x // y) * y  # 0 ≤ z < y in Python, -y < z < y in C
                    if z < 0:
                        z += y
                self.ints[d] = z
            elif op == REAL:
                self.reals[d] = self.ints[a]
            elif op == INDEX:
                x = self.ints[a]
                if x < 0 or x >= b:
                    self._fail_with(3, pc, x, b, 0.0)
                    return 0
            elif op == OFFSET:
                self.ints[d] = self.ints[d] * b + self.ints[a]
            elif op == LOAD:
                self.ints[d] = self.ints[a + self.ints[b]]
            elif op == STORE:
                at = d + self.ints[a]
                if self.ints[at] != self.ints[b]:
                    self.ints[at] = self.ints[b]
                    if c >= 0:
                        self._note(c)
            elif op == COPY:
                changed = 0
                for i in range(c):
                    if self.ints[d + i] != self.ints[a + i]:
                        self.ints[d + i] = self.ints[a + i]
                        changed = 1
                if changed != 0 and b >= 0:
                    self._note(b)
            elif op == COPY_INDEXED:
                at = a + self.ints[b]
                for i in range(c):
                    self.ints[d + i] = self.ints[at + i]
            elif op == STORE_MANY:
                at = d + self.ints[a]
                for i in range(c):
                    self.ints[at + i] = self.ints[b + i]
            elif op == NOTE:
                self._note(d)
            elif op == RANGE:
                if self.ints[a] < self.ints[b] or self.ints[a] > self.ints[c]:
                    self._fail_with(4, pc, self.ints[a], 0, 0.0)
                    return 0
            elif op == FAULT:
                self._fail_with(d, pc, a, b, 0.0)
                return 0
            elif op == JUMP_EQ_REAL:
                if self.reals[a] == self.reals[b]:
                    pc = d
                    continue
            elif op == JUMP_NE_REAL:
                if self.reals[a] != self.reals[b]:
                    pc = d
                    continue
            elif op == JUMP_LT_REAL:
                if self.reals[a] < self.reals[b]:
                    pc = d
                    continue
            elif op == JUMP_LE_REAL:
                if self.reals[a] <= self.reals[b]:
                    pc = d
                    continue
            elif op == MOVE_REAL:
                self.reals[d] = self.reals[a]
            elif op == SET_REAL:
                if self.reals[d] != self.reals[a]:
                    self.reals[d] = self.reals[a]
                    self._note(b)
            elif op == ADD_REAL:
                self.reals[d] = self.reals[a] + self.reals[b]
            elif op == SUB_REAL:
                self.reals[d] = self.reals[a] - self.reals[b]
            elif op == MUL_REAL:
                self.reals[d] = self.reals[a] * self.reals[b]
            elif op == MIN_REAL:
                self.reals[d] = self.reals[b] if self.reals[b] < self.reals[a] else self.reals[a]
            elif op == MAX_REAL:
                self.reals[d] = self.reals[b] if self.reals[b] > self.reals[a] else self.reals[a]
            elif op == ABS_REAL:
                self.reals[d] = -self.reals[a] if self.reals[a] < 0.0 else self.reals[a]
            elif op == DIVIDE:
                if self.reals[b] == 0.0:
                    self._fail(2, pc)
                    return 0
                self.reals[d] = self.reals[a] / self.reals[b]
            elif op == LOAD_REAL:
                self.reals[d] = self.reals[a + self.ints[b]]
            elif op == STORE_REAL:
                at = d + self.ints[a]
                if self.reals[at] != self.reals[b]:
                    self.reals[at] = self.reals[b]
                    if c >= 0:
                        self._note(c)
            elif op == COPY_REAL:
                changed = 0
                for i in range(c):
                    if self.reals[d + i] != self.reals[a + i]:
                        self.reals[d + i] = self.reals[a + i]
                        changed = 1
                if changed != 0 and b >= 0:
                    self._note(b)
            elif op == COPY_INDEXED_REAL:
                at = a + self.ints[b]
                for i in range(c):
                    self.reals[d + i] = self.reals[at + i]
            elif op == STORE_MANY_REAL:
                at = d + self.ints[a]
                for i in range(c):
                    self.reals[at + i] = self.reals[b + i]
            elif op == RANGE_REAL:
                if self.reals[a] < self.reals[b] or self.reals[a] > self.reals[c]:
                    self._fail_with(4, pc, 0, 0, self.reals[a])
                    return 0
            elif op == CALL_INT:
                if self._call(c, 0, d, pc) == 0:
                    return 0
            elif op == CALL_REAL:
                if self._call(c, 1, d, pc) == 0:
                    return 0
            elif op == ARGUMENT:
                self.arguments.append(self.ints[a])
            elif op == ARGUMENT_REAL:
                self.arguments.append(self.reals[a])
            elif op == FAIL_TRUE:
                if self.ints[a] != 0:
                    return 0
            elif op == FAIL_FALSE:
                if self.ints[a] == 0:
                    return 0
            elif op == FAIL_EQ:
                if self.ints[a] == self.ints[b]:
                    return 0
            elif op == FAIL_NE:
                if self.ints[a] != self.ints[b]:
                    return 0
            elif op == FAIL_LT:
                if self.ints[a] < self.ints[b]:
                    return 0
            elif op == FAIL_LE:
                if self.ints[a] <= self.ints[b]:
                    return 0
            elif op == IS_EQ:
                return 1 if self.ints[a] == self.ints[b] else 0
            elif op == IS_NE:
                return 1 if self.ints[a] != self.ints[b] else 0
            elif op == IS_LT:
                return 1 if self.ints[a] < self.ints[b] else 0
            elif op == IS_LE:
                return 1 if self.ints[a] <= self.ints[b] else 0
            pc += WIDTH
