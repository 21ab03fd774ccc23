# SPDX-License-Identifier: Apache-2.0
"""Traces over states that the kernel has expanded before.

- Plain Python; Cython compiles it with the types in `states.pxd`, like the kernel. The traces are exactly those of the
  kernel: the same random numbers select the same steps, and rewards are added in the same order.
- A *node* is a state that a trace has reached. The kernel takes each step from a node only once; afterwards the node
  contains where the step leads. A step between nodes is a look-up. The kernel is restored to a node (`_go`) only if the
  next step from there is new.
- A node is a part of `cells`: a header, the values of the conditions of the goal, and a *target* for each choice. A
  choice is a vector with one of its combinations of edges, in the order in which the kernel numbers them. A target that
  is not negative is twice the number of the next node, plus 1 if the step changes a location. It is NEW if the step has
  not been taken. Any other target is `-d`, where `d` is the number of the *dice* of the choice: the random numbers that
  select destinations, and a target for each combination of them.
- `packing` packs and numbers the states of the nodes. If the states need a new layout, or the memory is full, all nodes
  are forgotten.
- Nodes cost time until enough steps repeat. If they have cost more than a share of the time so far, the kernel
  generates traces until they may cost more; the nodes are kept. If the memory has become full and its nodes have saved
  no time, it is given back, and the kernel generates all further traces.
- Traces under a sampled scheduler, recorded traces, and states with very many choices are left to the kernel.
"""

from __future__ import annotations

from array import array
from time import process_time
from typing import TYPE_CHECKING, Any

from roaml.smc.memory import flat, grown
from roaml.smc.packing import PackedStates
from roaml.smc.rounds import next_limit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import TypeAlias

    from roaml.smc.program import Program
    from roaml.smc.rounds import Rounds

    Pulse: TypeAlias = Callable[[int, int], None]

UINT64_MASK = 0xFFFFFFFFFFFFFFFF
GOLDEN = 0x9E3779B97F4A7C15
MIX_1 = 0xBF58476D1CE4E5B9
MIX_2 = 0x94D049BB133111EB
MAX_INT64 = 0x7FFFFFFFFFFFFFFF
TO_UNIT = 1.0 / 9007199254740992.0
MAX_DRAWN_COMBINATIONS = 4096
"""As in the kernel."""

FALSE, TRUE, UNKNOWN, FAULTY = 0, 1, 2, 3
DECIDED, CUT = 0, 7
GOES_ON = -1

SIZE, STATE, FLAGS, REWARD = 0, 1, 2, 3
"""The header of a node: the number of its choices, the number of its state, its flags, and the number of the reward for
leaving it."""
HEADER_CELLS = 4
CONDITIONS_A_CELL = 15
"""The number of untils whose conditions are in one cell, with two bits each."""
DECIDES, CAN_LEAVE, CANNOT_LEAVE = 1, 2, 4
"""Flags of a node. DECIDES: the values of the conditions may decide an until. The others: whether a choice changes the
state, if this is known."""
REASON_SHIFT = 3
"""The flags from this bit on are the reason why a trace ends here."""
NEW = -1
BY_KERNEL = -1
"""The size of a node at which the kernel continues."""

MAX_ROOTS = 4096
"""The maximum number of initial states whose nodes are known by the numbers of the states."""
MAX_COMPARED = 4
"""The number of probabilities up to which a random number is compared with each of them."""
MAX_BYTES = 12 << 20
"""The maximum memory for nodes, in bytes."""
MEASURED_STEPS = 4096
"""The number of steps at the beginning from which the speed of the kernel is measured."""
REVIEW_STEPS = 4096
"""The number of new steps after which it is determined whether the nodes save time."""
MAX_LOSS_S, MAX_LOSS_SHARE = 0.015, 0.1
"""The maximum time by which the nodes may increase the time before they are paused: the sum of a time in s and a share
of the time so far."""
NUMBER_BYTES = 100
"""The approximate memory of an entry of a dictionary of numbers, in bytes."""
PULSE_STEPS = 200_000
"""The number of steps after which Python can handle an interrupt: these steps take some hundredths of a second."""
PULSE_TRACES = 64


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class TraceBatch(PackedStates):
    """Generates batches of traces.

    Args:
        kernel: the kernel for the program and a goal. Nothing else uses it during a batch.
        bytes: the maximum memory for nodes, in bytes; 0 if the kernel generates all traces.
        rounds: what examines long traces; `None` if they are not examined.

    Attributes:
        verdicts, ends, steps, activities: the results of the traces of the last batch, for each question of the batch;
            see `batch.Rows`. rewards: the reward of each trace.
        count: the number of nodes.
    """

    def __init__(
        self, kernel: Any, program: Program, bytes: int = MAX_BYTES, rounds: Rounds | None = None  # noqa: A002
    ) -> None:  # fmt: skip
        super().__init__(kernel, program.cell_watch, 0)
        self.rounds = rounds
        self.max_bytes = bytes
        self.is_on = 1 if bytes > 0 else 0
        self.leaves = self.kernel.leaves
        self.condition_cells = (self.leaves + CONDITIONS_A_CELL - 1) // CONDITIONS_A_CELL
        self.head = HEADER_CELLS + self.condition_cells
        self.has_activities = 0
        for code in self.kernel.activity:
            if code >= 0:
                self.has_activities = 1
        self.has_exit = 1 if self.kernel.exit_reward >= 0 else 0
        self.width = 2 if self.kernel.step_reward >= 0 else 1
        self.is_prepared = 0
        self.is_kernel = 0
        self.is_measured = 0
        self.measured_steps = MEASURED_STEPS
        self.kernel_step_s = 0.0
        self.started_s = 0.0
        self.spent_s = 0.0
        self.done_steps = 0
        self.earlier_s = 0.0
        self.earlier_loss_s = 0.0
        self.is_full = 0
        self.first_loss_s = 0.0
        self.new_steps = 0
        self.next_review = REVIEW_STEPS
        self.next_bound = MAX_INT64
        for i in range(self.leaves):
            if self.kernel.upper[i] >= 0 and self.kernel.upper[i] < self.next_bound:
                self.next_bound = self.kernel.upper[i]
        self.node = 0
        self.most_roots = int(min(self.kernel.roots, MAX_ROOTS))
        self.root_node = array("i", [0]) * self.most_roots
        self.here = 0
        self.age = 0
        self.drawn = 0
        self.cell_end = 0
        self.cell_room = 0
        self.real_end = 0
        self.real_room = 0
        self.number_of: dict[float, int] = {}
        self.verdicts = bytearray()
        self.ends = bytearray()
        self.activities = bytearray()
        self.steps = array("q")
        self.rewards = array("d")

    # ------------------------------------------------------------ batches

    def run(
        self, seed: int, first: int, size: int, max_steps: int, questions: Sequence[int], pulse: Pulse | None
    ) -> int:  # fmt: skip
        """Generate `size` traces from the trace `first` on; return the number of traces that have no undefined
        operation. If it is less than `size`, the next trace has one; see `Kernel.problem`.

        Args:
            pulse: see `batch.run`.
        """
        count = len(questions)
        self.is_kernel = 1  # The kernel is at no node: other traces may have used it since the last batch.
        self.kernel.choose(questions)
        self.verdicts = bytearray(size * count)
        self.ends = bytearray(size * count)
        self.activities = bytearray(size * count)
        self.steps = array("q", [0]) * (size * count)
        self.rewards = array("d", [0.0]) * size
        verdicts, ends, activities, steps = self.verdicts, self.ends, self.activities, self.steps
        asked = array("i", questions)
        rewards = self.rewards
        since = 0
        # Numbers of C: to compute with numbers of Python takes as long as some steps.
        key = seed & UINT64_MASK
        start = first & UINT64_MASK
        first_limit = next_limit(0, max_steps)
        self.started_s = process_time()
        for trace in range(size):
            status = self._begin(key, (start + trace) & UINT64_MASK)
            limit = 0
            while status == UNKNOWN and self.kernel.end == DECIDED and limit < max_steps:
                limit = first_limit if limit == 0 else next_limit(limit, max_steps)
                status = self._advance(limit)
                if status == UNKNOWN and self.kernel.end == DECIDED and self.rounds is not None:
                    if self.is_kernel == 0:
                        self._go(self.node)
                    status = self.rounds.check(self.kernel, seed, first + trace)
                if limit > PULSE_STEPS and pulse is not None:
                    pulse(first + trace, limit)
            since += self.kernel.steps
            if pulse is not None and (trace & (PULSE_TRACES - 1) == 0 or since > PULSE_STEPS):
                since = 0
                pulse(first + trace, limit)
            self.done_steps += self.kernel.steps
            if self.is_measured == 0 and self.done_steps >= self.measured_steps:
                self._measure()
            if status == FAULTY:
                return trace
            if status == UNKNOWN and self.has_activities != 0 and self.is_kernel == 0:
                self._go(self.node)
            at = trace
            for i in range(count):
                question = asked[i]
                if self.kernel.known[question] == UNKNOWN:
                    verdicts[at] = UNKNOWN
                    ends[at] = CUT if self.kernel.end == DECIDED else self.kernel.end
                    steps[at] = self.kernel.steps
                    activities[at] = self.kernel._active(self.kernel.activity[question])
                else:
                    verdicts[at] = self.kernel.known[question]
                    ends[at] = self.kernel.known_end[question]
                    steps[at] = self.kernel.known_steps[question]
                    activities[at] = self.kernel.known_activity[question]
                at += size
            rewards[trace] = self.kernel.reward
        self.spent_s += process_time() - self.started_s
        return size

    def use_nodes(self) -> None:
        """Use nodes from the next trace on, even if they save no time."""
        self.is_on = 1
        self.is_measured = 1
        self.next_review = MAX_INT64

    def _begin(self, seed: int, trace: int) -> int:
        """Go to the start of a trace; return the status of the goal there."""
        self.kernel._seed(seed, trace)
        self.kernel.scheduler = 0
        root = self.kernel._root_number()
        if self.is_on == 0 or self.is_measured == 0:
            self.is_kernel = 1
            self.kernel.root(root)
            return self.kernel._finish(self.kernel._look())
        if self.is_prepared == 0:
            self._prepare()
        node = 0
        if root < self.most_roots:
            node = self.root_node[root]
        if node == 0 or self.is_kernel != 0:
            self.kernel.root(root)
            if self.kernel.fault != 0:
                self.is_kernel = 1
                return FAULTY
            self._update()
            node = self._here()
            if root < self.most_roots:
                self.root_node[root] = node
        self.is_kernel = 0
        self.kernel._reset_goal()
        self.node = node
        if self.cells[node] == BY_KERNEL:
            self._leave(node)
            return self.kernel._finish(self.kernel._look())
        return self._judged(node)

    def _advance(self, limit: int) -> int:
        """Continue a trace; return the status of the goal."""
        if self.is_kernel == 0:
            status = self._walk(limit)
            if status != GOES_ON:
                return status
            if self.is_kernel == 0:
                return UNKNOWN
        before = self.kernel.steps
        status = self.kernel._advance(limit)
        self.new_steps += self.kernel.steps - before
        return status

    # ------------------------------------------------------------ steps

    def _walk(self, limit: int) -> int:
        """Continue from node to node. Return GOES_ON if the trace has `limit` steps, or if the kernel continues."""
        node = self.node
        steps = self.kernel.steps
        while steps < limit:
            size = self.cells[node]
            if size == 0:
                self.node = node
                return self._ended(node, 0)
            drawn = self.kernel.drawn
            is_rolled = 0
            at = node + self.head
            if size > 1:
                drawn += 1
                at += self.width * (((self._random(drawn) >> 32) * size) >> 32)
            target = self.cells[at]
            if target < NEW:
                self.drawn = drawn
                at = self._rolled(-target)
                drawn = self.drawn
                target = self.cells[at]
                is_rolled = 1
            if target == NEW:
                status = self._new_step(node, at, is_rolled)
                if status != GOES_ON or self.is_kernel != 0:
                    return status
                steps = self.kernel.steps
                node = self.node
                target = self.kernel.moved
            else:
                self.kernel.drawn = drawn
                if self.has_exit != 0:
                    self.kernel.reward += self.reals[self.cells[node + REWARD]]
                if self.width > 1:
                    self.kernel.reward += self.reals[self.cells[at + 1]]
                node = target >> 1
                steps += 1
                self.kernel.steps = steps
            flags = self.cells[node + FLAGS]
            if flags & DECIDES != 0 or steps >= self.next_bound:
                if self.cells[node] == BY_KERNEL:
                    self._leave(node)
                    self.kernel.moved = target & 1
                    return self._judged_by_kernel()
                status = self._judged(node)
                if status != UNKNOWN:
                    self.node = node
                    if self.kernel.is_bounded == 2 and self.cells[node] == 0:
                        self.kernel.end = flags >> REASON_SHIFT
                        self.kernel.known_end[0] = self.kernel.end
                    return status
            if target & 1 != 0:
                self.kernel.still = 0
            else:
                self.kernel.still += 1
                if self.kernel.still & (self.kernel.still - 1) == 0 and self.kernel.lasts == 0:
                    if flags & (CAN_LEAVE | CANNOT_LEAVE) == 0:
                        self._go(node)
                        flags |= CAN_LEAVE if self.kernel._can_leave() != 0 else CANNOT_LEAVE
                        self.cells[node + FLAGS] = flags
                    if flags & CANNOT_LEAVE != 0:
                        self.node = node
                        return self._ended(node, 0 if self.cells[node] == 0 else 1)
        self.node = node
        return GOES_ON

    def _random(self, number: int) -> int:
        """Random number `number` of the trace, as in the kernel."""
        z = (self.kernel.key + number * GOLDEN) & UINT64_MASK
        z = ((z ^ (z >> 30)) * MIX_1) & UINT64_MASK
        z = ((z ^ (z >> 27)) * MIX_2) & UINT64_MASK
        return z ^ (z >> 31)

    def _rolled(self, dice: int) -> int:
        """The place of the target that random numbers select."""
        count = self.cells[dice]
        at = dice + 1
        index = 0
        for _ in range(count):
            sides = self.cells[at]
            first = self.cells[at + 1]
            self.drawn += 1
            unit = (self._random(self.drawn) >> 11) * TO_UNIT
            low = 0
            high = sides - 1
            while high - low > MAX_COMPARED:
                middle = (low + high) // 2
                if unit < self.reals[first + middle]:
                    high = middle
                else:
                    low = middle + 1
            # Without jumps, which a processor could not predict.
            middle = low
            while middle < high:
                low += unit >= self.reals[first + middle]
                middle += 1
            index = index * sides + low
            at += 2
        return at + self.width * index

    def _judged(self, node: int) -> int:
        """Evaluate the goal at a node; return its status. Does the same as `Kernel._look`."""
        decided = 0
        steps = self.kernel.steps
        for i in range(self.leaves):
            if self.kernel.verdict[i] == UNKNOWN and self.kernel.lower[i] >= 0:
                bits = self.cells[node + HEADER_CELLS + i // CONDITIONS_A_CELL] >> (2 * (i % CONDITIONS_A_CELL))
                if bits & 2 != 0 and steps >= self.kernel.lower[i]:
                    self.kernel.verdict[i] = TRUE
                    decided = 1
                elif bits & 1 == 0 or (self.kernel.upper[i] >= 0 and steps >= self.kernel.upper[i]):
                    self.kernel.verdict[i] = FALSE
                    decided = 1
        if decided == 0:
            return self.kernel.status
        if self.has_activities != 0:
            self._go(node)
        return self.kernel._combined()

    def _ended(self, node: int, repeats: int) -> int:
        """Evaluate the goal at a node that the trace never leaves."""
        if self.has_activities != 0:
            self._go(node)
        for i in range(self.leaves):
            bits = self.cells[node + HEADER_CELLS + i // CONDITIONS_A_CELL] >> (2 * (i % CONDITIONS_A_CELL))
            self.kernel.holds_left[i] = bits & 1
            self.kernel.holds_right[i] = (bits >> 1) & 1
            self.kernel.stale[i] = 1
        reason = self.cells[node + FLAGS] >> REASON_SHIFT
        return self.kernel._finish(self.kernel._ends_for(reason, repeats))

    def _new_step(self, node: int, at: int, is_rolled: int) -> int:
        """Let the kernel take the next step from a node, and store in the target at `at` where it leads. With
        `is_rolled`, the target is part of dice. Set `node` to the next node.

        Returns:
            GOES_ON, or the status of the goal if the kernel has determined that the trace ends.
        """
        self._go(node)
        self.kernel._step()
        if self.kernel.fault != 0:
            self.is_kernel = 1
            return FAULTY
        self.kernel.steps += 1
        self.new_steps += 1
        if self.new_steps >= self.next_review:
            self._review()
            if self.is_on == 0 or self.is_measured == 0:
                self.is_kernel = 1
                return self._judged_by_kernel()
        age = self.age
        self._update()
        following = self._here()
        if self.age == age:
            self._link(node, at, is_rolled, following)
        self.node = following
        return GOES_ON

    def _link(self, node: int, at: int, is_rolled: int, following: int) -> None:
        """Store where the step that the kernel has just taken leads."""
        if is_rolled == 0:
            at = self._dice(node, at)
            if at == 0:
                return
        self.cells[at] = 2 * following + self.kernel.moved
        if self.width > 1:
            self.cells[at + 1] = self._number(self.kernel.added)

    def _dice(self, node: int, at: int) -> int:
        """Create the dice for the choice that the kernel has just taken, if destinations are random. Return the place
        of the target for the destinations that it has taken, or 0 if there are too many combinations."""
        count = 0
        combinations = 1
        is_computed = 0
        for i in range(self.kernel.parts):
            edge = self.edge_of_way[self.kernel.part_way[i]]
            first = self.kernel.way_start[edge]
            ways = self.kernel.way_start[edge + 1] - first
            if ways > 1:
                count += 1
                combinations = min(combinations * ways, MAX_DRAWN_COMBINATIONS + 1)
                if self.kernel.way_chance[first] >= 0:
                    is_computed = 1
        if count == 0:
            return at
        dice = self.cell_end
        end = dice + 1 + 2 * count + self.width * combinations
        if combinations > MAX_DRAWN_COMBINATIONS or self._used() + 4 * (end - dice) > self.max_bytes:
            return 0
        if is_computed != 0:
            self._go(node)
        self._reserve(end - dice)
        self.cells[dice] = count
        self.cell_end = end
        place = dice + 1
        index = 0
        for i in range(self.kernel.parts):
            way = self.kernel.part_way[i]
            edge = self.edge_of_way[way]
            first = self.kernel.way_start[edge]
            ways = self.kernel.way_start[edge + 1] - first
            if ways > 1:
                self.cells[place + 1] = first
                if self.kernel.way_chance[first] >= 0:
                    self.cells[place + 1] = self.real_end
                    ways = self._weigh(edge)
                self.cells[place] = ways
                index = index * ways + way - first
                place += 2
        while place < end:
            self.cells[place] = NEW
            place += 1
        self.cells[at] = -dice
        return dice + 1 + 2 * count + self.width * index

    def _weigh(self, edge: int) -> int:
        """Append the sums of the probabilities of the ways of an edge to `reals`, up to the last way that is possible;
        return their number."""
        total = 0.0
        sides = 0
        first = self.kernel.way_start[edge]
        start = self.real_end
        for way in range(first, self.kernel.way_start[edge + 1]):
            register = self.kernel._execute(self.kernel.way_chance[way])
            total += self.kernel.reals[register]
            if self.kernel.reals[register] > 0.0:
                sides = way - first + 1
            self._append(total)
        self.real_end = start + sides
        return sides

    # ------------------------------------------------------------ whether nodes save time

    def _measure(self) -> None:
        """Determine the time that the kernel needs for a step, from its last traces. The next traces use nodes."""
        now = process_time()
        spent = self.spent_s + now - self.started_s
        self.kernel_step_s = spent / self.done_steps
        self.is_measured = 1
        self._begin_period(now, spent, 0)

    def _review(self) -> None:
        """Pause the nodes if they have cost too much time, or switch them off if they will save none."""
        self.next_review = self.new_steps + REVIEW_STEPS
        now = process_time()
        spent = self.spent_s + now - self.started_s
        total = self.earlier_s + spent
        loss = self.earlier_loss_s + spent - (self.done_steps + self.kernel.steps) * self.kernel_step_s
        if self.is_full != 0 and loss > self.first_loss_s:
            self._switch_off()
        elif loss > MAX_LOSS_S + MAX_LOSS_SHARE * total:
            self.is_measured = 0
            pause = max(loss / MAX_LOSS_SHARE - total, self.kernel_step_s * MEASURED_STEPS)
            self.measured_steps = int(pause / self.kernel_step_s)
            self.earlier_loss_s = loss
            self._begin_period(now, spent, -self.kernel.steps)
        elif self.is_full != 0:
            self.is_full = 0
            self.first_loss_s = loss

    def _begin_period(self, now: float, spent: float, steps: int) -> None:
        """Begin to measure the time from `now` on. `spent`: the time, in s, of the period before it. `steps`: the
        number of steps of the new period."""
        self.earlier_s += spent
        self.spent_s = 0.0
        self.started_s = now
        self.done_steps = steps

    def _switch_off(self) -> None:
        self.is_on = 0
        self._clear()
        self.keys = array("Q", [0])
        self.node_of = array("i", [0])
        self.cells = array("i", [0])
        self.number_of = {}

    # ------------------------------------------------------------ the kernel

    def _leave(self, node: int) -> None:
        """Let the kernel continue from a node."""
        self._go(node)
        self.is_kernel = 1
        self.kernel._forget_conditions()

    def _judged_by_kernel(self) -> int:
        """Let the kernel do what follows a step; return GOES_ON if the trace has not ended."""
        self.kernel._forget_conditions()
        status = self.kernel._after_step()
        return status if status == GOES_ON else self.kernel._finish(status)

    def _go(self, node: int) -> None:
        """Restore the kernel to a node, and update what is enabled."""
        if self.here == node:
            return
        self.here = node
        self._visit(self.cells[node + STATE])

    def _update(self) -> None:
        """Read what the kernel has changed."""
        self.here = 0
        self._list_changed()
        self._pack_changed()
        while self.misfit >= 0:
            if self._widen() != 0:
                # To pack all states again would take as long as to expand them again.
                self._lay_out()
                self._forget()
            self._pack_all()
        self._accept()

    # ------------------------------------------------------------ nodes

    def _prepare(self) -> None:
        """Allocate memory for nodes."""
        self.is_prepared = 1
        kernel = self.kernel
        self.edge_of_way = array("i", [0]) * len(kernel.way_target)
        for edge in range(len(kernel.guard)):
            for way in range(kernel.way_start[edge], kernel.way_start[edge + 1]):
                self.edge_of_way[way] = edge
        self.real_room = len(kernel.way_sum) + 64
        self.reals = array("d", [0.0]) * self.real_room
        for way in range(len(kernel.way_sum)):
            self.reals[way] = kernel.way_sum[way]
        self.cell_room = 1024
        self.cells = array("i", [0]) * self.cell_room
        self.node_of = flat("i", self.state_room)
        kernel._reset()
        self._start()
        self._forget()

    def _forget(self) -> None:
        """Forget all nodes."""
        self.age += 1
        self._clear()
        for i in range(self.most_roots):
            self.root_node[i] = 0
        self.here = 0
        self.cell_end = HEADER_CELLS
        self.real_end = len(self.kernel.way_sum)
        self.number_of = {}

    def _here(self) -> int:
        """The node of the current state of the kernel, which is created if it is new. This may forget all others."""
        at = self._look_up()
        state = self._state_at(at)
        if state >= 0:
            self.here = self.node_of[state]
            return self.here
        size = self._choice_count()
        count = self.head + self.width * max(size, 0)
        if self._used() + 4 * count + 8 * self.words > self.max_bytes and self.count > 0:
            self.is_full = 1
            self._forget()
            at = self._look_up()
        self._reserve(count)
        node = self.cell_end
        self.cell_end = node + count
        self._describe(node, size)
        for i in range(node + self.head, self.cell_end):
            self.cells[i] = NEW
        if self.count == self.state_room:
            self._grow()
            self.node_of = grown(self.node_of, self.state_room)
        state = self._add(at)
        self.node_of[state] = node
        self.cells[node + STATE] = state
        self.here = node
        return node

    def _choice_count(self) -> int:
        """The number of choices in the current state of the kernel; BY_KERNEL if there are too many."""
        total = self.kernel._total()
        return BY_KERNEL if total > MAX_DRAWN_COMBINATIONS else total

    def _describe(self, node: int, size: int) -> None:
        """Write the header and the conditions of the node for the current state of the kernel."""
        flags = 0
        for i in range(HEADER_CELLS, self.head):
            self.cells[node + i] = 0
        for i in range(self.leaves):
            if self.kernel.stale[i] != 0 or self.kernel.is_bounded == 2:
                self.kernel.stale[i] = 0
                self.kernel.holds_left[i] = self.kernel._holds(self.kernel.left[i])
                self.kernel.holds_right[i] = self.kernel._holds(self.kernel.right[i])
            bits = self.kernel.holds_left[i] | (self.kernel.holds_right[i] << 1)
            self.cells[node + HEADER_CELLS + i // CONDITIONS_A_CELL] |= bits << (2 * (i % CONDITIONS_A_CELL))
            if bits != 1 and self.kernel.lower[i] >= 0:
                flags = DECIDES
        self.cells[node + REWARD] = 0
        if self.has_exit != 0:
            register = self.kernel._execute(self.kernel.exit_reward)
            self.cells[node + REWARD] = self._number(self.kernel.reals[register])
        if self.kernel.fault != 0:
            # The kernel finds the undefined operation again, where it is relevant.
            self.kernel.fault = 0
            self.kernel._forget_conditions()
            size = BY_KERNEL
        if size == BY_KERNEL:
            flags = DECIDES
        self.cells[node] = size
        self.cells[node + FLAGS] = flags | (self.kernel._reason(1 if size != 0 else 0) << REASON_SHIFT)

    # ------------------------------------------------------------ memory

    def _used(self) -> int:
        """The bytes in use."""
        return (
            4 * self.cell_end + (8 * self.words + 4) * self.count + 8 * (self.table_mask + 1) + 8 * self.real_end
            + NUMBER_BYTES * len(self.number_of)
        )  # fmt: skip

    def _reserve(self, count: int) -> None:
        """Allocate memory for further cells."""
        if self.cell_end + count > self.cell_room:
            self.cell_room = (self.cell_end + count) * 3 // 2
            self.cells = grown(self.cells, self.cell_room)

    def _append(self, value: float) -> None:
        if self.real_end == self.real_room:
            self.real_room = self.real_room * 3 // 2
            self.reals = grown(self.reals, self.real_room)
        self.reals[self.real_end] = value
        self.real_end += 1

    def _number(self, value: float) -> int:
        """The index of a reward in `reals`; a new one is added."""
        known = self.number_of.get(value)
        if known is not None:
            return known
        index = self.real_end
        self._append(value)
        self.number_of[value] = index
        return index
