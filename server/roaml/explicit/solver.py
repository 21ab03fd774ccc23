# SPDX-License-Identifier: Apache-2.0
"""Probabilities and expected rewards in a `StateSearch`, enclosed from below and above.

- Plain Python; Cython compiles it with the types in `solver.pxd`.
- Strongly connected components are solved in reverse topological order (Tarjan 1972, without recursion).
- End components are the parts in which a scheduler can stay for ever (de Alfaro 1997). Each is merged into one state;
  after that, the equations have one solution.
- A component whose values converge slowly is solved by policy iteration and elimination (`elimination`, `chain`).
- Lower bounds are computed by value iteration, upper bounds by Park induction, as in optimistic value iteration
  (Hartmanns and Kaminski 2020): values that no step increases are upper bounds.
"""

from __future__ import annotations

from typing import Any

from roaml.explicit.elimination import MAX_DENSE_STATES, SmallProcess
from roaml.smc.memory import flat

MAXIMUM, MINIMUM, MEAN = 0, 1, 2
"""How choices are resolved: for the greatest value, for the smallest value, or at random by their weights."""
NOTHING, AS_JUDGED, NEGATED = 0, 1, 2
"""Which paths that stay in an end component are accepted: none, those for which the goal is true, or those for which it
is false."""
FALSE, TRUE, UNKNOWN = 0, 1, 2
STATUS, LASTS, FAILS, HOLDS = 3, 4, 8, 16
INFINITE = float("inf")
RELATIVE_TOLERANCE = 1e-8
"""The relative distance of the bounds at which a component is solved."""
MIN_TOLERANCE = 1e-16
"""The relative change of values below which further steps are useless. If bounds are not proved then, they stay
wide."""
ROUNDING = 1e-15
"""The relative difference up to which two values are regarded as equal."""
MAX_ROUNDED = 1e-6
"""The distance from 1 at which an upper bound of a probability does not exclude 1, with a margin for rounding."""
MAX_PROOF_STEPS = 100
"""The number of steps after which the attempt to prove upper bounds is given up."""
MAX_DIRECT_STATES = 2_000_000
"""The maximum number of states of a component that is solved directly if value iteration is slow."""
MAX_RELATIVE_ERROR = 1e-3
"""The maximum relative error of a direct solution. Beyond `RELATIVE_TOLERANCE`, the bounds are wider than intended."""
MAX_WORK = 20_000_000_000
"""The maximum number of additions, unless `Solver.most_work` is changed."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class Solver:
    """Computes bounds of values for all states of a search.

    Args:
        search: a complete search.
        mode: MAXIMUM, MINIMUM or MEAN.

    Attributes:
        most_work: the maximum number of additions for all components. After that, bounds are not narrowed further.
        has_ended_early: whether some bounds are wider than intended.
        is_unclear: whether the minimum is unknown because of negative rewards in an end component.
    """

    def __init__(self, search: Any, mode: int) -> None:
        self.mode = mode
        self.states = search.count
        self.start = search.start
        self.code = search.code
        self.reals = search.reals
        self.label = search.label
        count = self.states + 1
        self.low = flat("d", count)
        self.high = flat("d", count)
        self.fixed = flat("B", count)
        self.group = flat("i", count)
        self.order = flat("i", count)
        self.spare = flat("i", count)
        self.set_of = flat("i", count)
        self.index = flat("i", count)
        self.lowest = flat("i", count)
        self.opened = flat("B", count)
        self.path = flat("i", count)
        self.work_state = flat("i", count)
        self.work_at = flat("q", count)
        self.work_left = flat("i", count)
        self.bound = flat("i", 2 * count + 2)
        self.bounds = 0
        self.range_first = flat("i", count)
        self.range_last = flat("i", count)
        self.end_first = flat("i", count)
        self.end_last = flat("i", count)
        self.ends = 0
        self.sets = 0
        self.is_reward = 0
        self.accepts = NOTHING
        self.work = 0
        self.most_work = MAX_WORK
        self.has_ended_early = 0
        self.is_unclear = 0
        self.is_signed = 0
        self.rises = 0
        self.falls = 0
        self.size = 0
        self.before = self.low
        self.has_before = 0

    # ------------------------------------------------------------ public

    def probability(self, target: int, bits: int, accepts: int) -> tuple[float, float]:
        """Bounds of the probability that a path from the initial state reaches a target state.

        Args:
            target: the STATUS of target states; UNKNOWN for none.
            bits: states with one of these bits in their label are target states, too.
            accepts: the paths that stay in an end component and are added to the probability; NOTHING for a minimum.
        """
        self.accepts = accepts
        for state in range(self.states):
            self.group[state] = state
            status = self.label[state] & STATUS
            if (status == target and target != UNKNOWN) or self.label[state] & bits != 0:
                self._fix(state, 1.0)
            elif status != UNKNOWN:
                self._fix(state, 0.0)
        self._solve()
        return self.low[0], self.high[0]

    def certain(self, roots: list[int]) -> list[bool]:
        """Whether the probability of each of some states is exactly 1, after `probability`, whose bounds this replaces.

        Bounds cannot decide this because of rounding; the graph does (Baier and Katoen 2008, 10.6.1). Where it is less
        than 1, the value in `low` becomes infinite, as that of an expected reward until a state with the value 1. For a
        maximum, these are the states in which no scheduler reaches such a state almost surely. For the others, as all
        end components have a value, they are the states from which one with the value 0 can be reached.
        """
        certain = [self.high[root] > 1.0 - MAX_ROUNDED for root in roots]
        if not any(certain):
            return certain
        for state in range(self.states):
            is_zero = self.fixed[state] != 0 and self.low[state] != 1.0
            self.low[state] = INFINITE if is_zero else 0.0
        first = 0
        for k in range(self._sort_components()):
            last = self.bound[k]
            if self.mode == MAXIMUM:
                self._keep_finite(first, last)
            elif self._meets_infinite(first, last) != 0:
                self._fix_all(first, last, INFINITE)
            first = last
        return [self.low[root] != INFINITE for root in roots]

    def expected(self) -> tuple[float, float]:
        """Bounds of the expected reward until states with the status TRUE are reached."""
        self.is_reward = 1
        for state in range(self.states):
            self.group[state] = state
            if self.label[state] & STATUS == TRUE:
                self._fix(state, 0.0)
            at = self.start[state]
            while at < self.start[state + 1]:
                size = self.code[at]
                if size >= 0:
                    at += 1
                    continue
                if self.reals[self.code[at + 2]] < 0.0:
                    self.is_signed = 1
                at += 3 - 2 * size
        self._solve()
        return self.low[0], self.high[0]

    def accumulated(self, steps: int) -> tuple[float, float]:
        """Bounds of the expected reward of a number of steps. Where no step is possible, no more reward is earned."""
        self.is_reward = 1
        for state in range(self.states):
            self.group[state] = state
        for _ in range(steps):
            self._sweep(0)
        return self.low[0], self.low[0]

    def bounded(self, target: int, lower: int, upper: int) -> tuple[float, float]:
        """Bounds of the probability of an until with step bounds.

        Args:
            target: the status with which an until without lower bound is true.
            lower, upper: the bounds, both inclusive; `upper` is negative if there is none.
        """
        for state in range(self.states):
            self.group[state] = state
            label = self.label[state]
            if label & HOLDS != 0 if lower > 0 else label & STATUS == target:
                self._fix(state, 1.0)
            elif label & STATUS != UNKNOWN:
                self._fix(state, 0.0)
        if upper < 0:
            self._solve()
        else:
            for _ in range(upper - lower):
                if self._sweep(0) == 0:
                    break
            self.high[: self.states] = self.low[: self.states]
        for _ in range(lower):
            self._sweep(1)
            if upper < 0:
                self._swap()
                self._sweep(1)
                self._swap()
            else:
                self.high[: self.states] = self.low[: self.states]
        return self.low[0], self.high[0]

    # ------------------------------------------------------------ bounded

    def _swap(self) -> None:
        self.low, self.high = self.high, self.low

    def _sweep(self, everywhere: int) -> int:
        """One step backwards for the values in `low`; returns whether a value has changed.

        Args:
            everywhere: whether to compute the values of states in which the right side holds, too, because steps before
                the lower bound remain.
        """
        if self.has_before == 0:
            self.before = flat("d", self.states)
            self.has_before = 1
        for state in range(self.states):
            self.before[state] = self.low[state]
        changed = 0
        for state in range(self.states):
            if everywhere == 0 and self.fixed[state] != 0:
                continue
            value = 0.0
            if self.label[state] & STATUS == UNKNOWN and self.start[state] < self.start[state + 1]:
                value = self._best(state, self.before, -1)
            if value != self.low[state]:
                self.low[state] = value
                changed = 1
        return changed

    # ------------------------------------------------------------ components

    def _fix(self, state: int, value: float) -> None:
        self.fixed[state] = 1
        self.low[state] = value
        self.high[state] = value

    def _sort_components(self) -> int:
        """Sort the states without a fixed value into `order` and `bound`; return the number of components."""
        count = 0
        for state in range(self.states):
            self.set_of[state] = -1
            if self.fixed[state] == 0:
                self.order[count] = state
                self.set_of[state] = 0
                count += 1
        self.sets = 1
        self.bounds = 0
        self._components(0, count, 0, 0, 0)
        return self.bounds

    def _solve(self) -> None:
        first = 0
        for k in range(self._sort_components()):
            last = self.bound[k]
            self._component(first, last)
            if self.is_unclear != 0:
                return  # there is no result
            first = last

    def _components(self, first: int, last: int, own: int, inner: int, free: int) -> None:
        """Find the strongly connected components of the states `order[first:last]`, which form the set `own`.
        Afterwards `order` contains them in reverse topological order, and `bound` contains their ends.

        Args:
            inner: whether to use only choices that do not leave the set.
            free: whether to use only choices without reward.
        """
        for i in range(first, last):
            self.index[self.order[i]] = 0
        counted = 0
        emitted = first
        held = 0
        for i in range(first, last):
            root = self.order[i]
            if self.index[root] != 0:
                continue
            top = 0
            counted += 1
            self.index[root] = counted
            self.lowest[root] = counted
            self.path[held] = root
            held += 1
            self.opened[root] = 1
            self.work_state[0] = root
            self.work_at[0] = self.start[root]
            self.work_left[0] = 0
            while top >= 0:
                state = self.work_state[top]
                at = self.work_at[top]
                left = self.work_left[top]
                end = self.start[state + 1]
                pushed = 0
                while left > 0 or at < end:
                    if left == 0:
                        size = self.code[at]
                        if inner != 0 and self._stays(at, own, free) == 0:
                            at += 1 if size >= 0 else 3 - 2 * size
                            continue
                        if size >= 0:
                            to = size
                            at += 1
                        else:
                            left = -size
                            at += 3
                            continue
                    else:
                        to = self.code[at]
                        at += 2
                        left -= 1
                    if self.set_of[to] != own:
                        continue
                    if self.index[to] == 0:
                        self.work_at[top] = at
                        self.work_left[top] = left
                        top += 1
                        counted += 1
                        self.index[to] = counted
                        self.lowest[to] = counted
                        self.path[held] = to
                        held += 1
                        self.opened[to] = 1
                        self.work_state[top] = to
                        self.work_at[top] = self.start[to]
                        self.work_left[top] = 0
                        pushed = 1
                        break
                    if self.opened[to] != 0 and self.index[to] < self.lowest[state]:
                        self.lowest[state] = self.index[to]
                if pushed != 0:
                    continue
                top -= 1
                if top >= 0 and self.lowest[state] < self.lowest[self.work_state[top]]:
                    self.lowest[self.work_state[top]] = self.lowest[state]
                if self.lowest[state] == self.index[state]:
                    while True:
                        held -= 1
                        to = self.path[held]
                        self.opened[to] = 0
                        self.spare[emitted] = to
                        emitted += 1
                        if to == state:
                            break
                    self.bound[self.bounds] = emitted
                    self.bounds += 1
        for i in range(first, last):
            self.order[i] = self.spare[i]

    def _stays(self, at: int, own: int, free: int) -> int:
        """Whether the choice at the index `at` of the code does not leave the set `own` and, with `free`, has no
        reward."""
        size = self.code[at]
        if size >= 0:
            return 1 if self.set_of[size] == own else 0
        if free != 0 and self.reals[self.code[at + 2]] != 0.0:
            return 0
        for k in range(-size):
            if self.set_of[self.code[at + 3 + 2 * k]] != own:
                return 0
        return 1

    def _can_stay(self, state: int, own: int, free: int) -> int:
        at = self.start[state]
        while at < self.start[state + 1]:
            if self._stays(at, own, free) != 0:
                return 1
            size = self.code[at]
            at += 1 if size >= 0 else 3 - 2 * size
        return 0

    def _find_ends(self, first: int, last: int, free: int) -> None:
        """Find the maximal end components among the states `order[first:last]`. Afterwards each is a range of `order`,
        and its states form a set. All other states belong to no set."""
        base = self.bounds
        waiting = 1
        self.ends = 0
        self.range_first[0] = first
        self.range_last[0] = last
        while waiting > 0:
            waiting -= 1
            begin = self.range_first[waiting]
            end = self.range_last[waiting]
            own = self.sets
            self.sets += 1
            for i in range(begin, end):
                self.set_of[self.order[i]] = own
            self.bounds = base
            self._components(begin, end, own, 1, free)
            if self.bounds == base + 1:
                state = self.order[begin]
                if end - begin > 1 or self._can_stay(state, own, free) != 0:
                    self.end_first[self.ends] = begin
                    self.end_last[self.ends] = end
                    self.ends += 1
                else:
                    self.set_of[state] = -1
                continue
            at = begin
            for k in range(base, self.bounds):
                self.range_first[waiting] = at
                self.range_last[waiting] = self.bound[k]
                at = self.bound[k]
                waiting += 1
        self.bounds = base

    def _has_loop(self, state: int) -> int:
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            if size >= 0:
                if size == state:
                    return 1
                at += 1
                continue
            for k in range(-size):
                if self.code[at + 3 + 2 * k] == state:
                    return 1
            at += 3 - 2 * size
        return 0

    # ------------------------------------------------------------ a component

    def _component(self, first: int, last: int) -> None:
        state = self.order[first]
        if last - first == 1 and self.start[state] == self.start[state + 1]:
            self._stay(first, last)
            return
        leads_to_one = self._leads_to_one(first, last) if self.is_reward == 0 else 0
        if last - first == 1 and self._has_loop(state) == 0:
            if leads_to_one != 0:
                self._fix(state, 1.0)
                return
            self.set_of[state] = -1
            self.low[state] = self._best(state, self.low, state)
            self.high[state] = self._best(state, self.high, state)
            return
        if self._is_chain(first, last) != 0:
            own = self.sets
            self.sets += 1
            for i in range(first, last):
                self.set_of[self.order[i]] = own
            if self._is_closed(first, last, own) != 0:
                self._stay(first, last)
                return
            for i in range(first, last):
                self.set_of[self.order[i]] = -1
            if self.is_reward != 0 and self._meets_infinite(first, last) != 0:
                self._fix_all(first, last, INFINITE)
                return
            if leads_to_one != 0:
                self._fix_all(first, last, 1.0)
                return
        elif self.is_reward == 0:
            self._find_ends(first, last, 0)
            if leads_to_one != 0 and (self.mode == MAXIMUM or self.ends == 0):
                self._fix_all(first, last, 1.0)
                return
            for k in range(self.ends):
                if self.mode == MINIMUM:
                    self._fix_all(self.end_first[k], self.end_last[k], 0.0)
                else:
                    self._merge(self.end_first[k], self.end_last[k])
            if self.mode == MAXIMUM:
                self._accept_ends()
        elif self.mode == MAXIMUM:
            self._find_ends(first, last, 0)
            if self.ends > 0 or self._meets_infinite(first, last) != 0:
                self._fix_all(first, last, INFINITE)
                return
        else:
            self._keep_finite(first, last)
            self._merge_free(first, last)
        self._iterate(first, last)

    def _leads_to_one(self, first: int, last: int) -> int:
        """Whether paths leave a component, and only to states with a probability of exactly 1. Then the states of the
        component have it, too, unless a path can stay in it for ever."""
        own = self.sets
        self.sets += 1
        leaves = 0
        for i in range(first, last):
            self.set_of[self.order[i]] = own
        for i in range(first, last):
            state = self.order[i]
            at = self.start[state]
            while at < self.start[state + 1]:
                size = self.code[at]
                count = 1 if size >= 0 else -size
                for k in range(count):
                    to = size if size >= 0 else self.code[at + 3 + 2 * k]
                    if self.set_of[to] == own:
                        continue
                    if self.fixed[to] == 0 or self.low[to] != 1.0:
                        return 0
                    leaves = 1
                at += 1 if size >= 0 else 3 - 2 * size
        return leaves

    def _is_closed(self, first: int, last: int, own: int) -> int:
        """Whether no choice leaves the component."""
        for i in range(first, last):
            state = self.order[i]
            at = self.start[state]
            while at < self.start[state + 1]:
                if self._stays(at, own, 0) == 0:
                    return 0
                size = self.code[at]
                at += 1 if size >= 0 else 3 - 2 * size
        return 1

    def _stay(self, first: int, last: int) -> None:
        """Give the states of a range the value of paths that stay in it for ever."""
        if self.is_reward != 0:
            self._fix_all(first, last, INFINITE)
        else:
            self._fix_all(first, last, 1.0 if self._accepted(first, last) != 0 else 0.0)

    def _accepted(self, first: int, last: int) -> int:
        """Whether paths that visit all states of a range infinitely often are accepted."""
        if self.accepts == NOTHING:
            return 0
        label = self.label[self.order[first]]
        lasts = 1 if label & LASTS != 0 else 0
        fails = 1 if label & FAILS != 0 else 0
        if self.accepts == NEGATED:
            lasts = 1 - lasts
            fails = 1 - fails
        if lasts == fails:
            return lasts
        holds = 1
        for i in range(first, last):
            if self.label[self.order[i]] & HOLDS == 0:
                holds = 0
        return lasts if holds != 0 else fails

    def _needs_lasting(self, state: int) -> int:
        """Whether paths are accepted only if the lasting condition holds for ever."""
        label = self.label[state]
        accepting = LASTS if self.accepts == AS_JUDGED else FAILS
        return 1 if self.accepts != NOTHING and label & (LASTS | FAILS) == accepting else 0

    def _accept_ends(self) -> None:
        """Give accepted end components the value 1. An end component is accepted if a scheduler can stay in an accepted
        part."""
        count = self.ends
        for k in range(count):
            first = self.end_first[k]
            last = self.end_last[k]
            accepted = self._accepted(first, last)
            if accepted == 0 and self._needs_lasting(self.order[first]) != 0:
                accepted = self._can_last(first, last)
            if accepted != 0:
                self._fix_all(first, last, 1.0)

    def _can_last(self, first: int, last: int) -> int:
        """Whether a scheduler can stay among the states of a range in which the lasting condition holds."""
        own = self.set_of[self.order[first]]
        middle = first
        for i in range(first, last):
            state = self.order[i]
            if self.label[state] & HOLDS != 0:
                self.order[i] = self.order[middle]
                self.order[middle] = state
                middle += 1
        if middle == first:
            return 0
        kept = self.ends
        others_first = [self.end_first[k] for k in range(kept)]
        others_last = [self.end_last[k] for k in range(kept)]
        self._find_ends(first, middle, 0)
        lasting = 1 if self.ends > 0 else 0
        for i in range(first, last):
            self.set_of[self.order[i]] = own
        self.ends = kept
        for k in range(kept):
            self.end_first[k] = others_first[k]
            self.end_last[k] = others_last[k]
        return lasting

    def _fix_all(self, first: int, last: int, value: float) -> None:
        for i in range(first, last):
            self._fix(self.order[i], value)
            self.set_of[self.order[i]] = -1

    def _merge(self, first: int, last: int) -> None:
        """Merge the states of a range into one."""
        for i in range(first, last):
            self.group[self.order[i]] = self.order[first]

    def _meets_infinite(self, first: int, last: int) -> int:
        """Whether some choice leads to a state with an infinite value."""
        for i in range(first, last):
            state = self.order[i]
            at = self.start[state]
            while at < self.start[state + 1]:
                size = self.code[at]
                if size >= 0:
                    if self.low[size] == INFINITE:
                        return 1
                    at += 1
                    continue
                for k in range(-size):
                    if self.low[self.code[at + 3 + 2 * k]] == INFINITE:
                        return 1
                at += 3 - 2 * size
        return 0

    def _keep_finite(self, first: int, last: int) -> None:
        """Fix the values of the states from which no scheduler reaches the goal almost surely: they are infinite. The
        other states stay in one set."""
        own = self.sets
        self.sets += 1
        for i in range(first, last):
            self.set_of[self.order[i]] = own
        while True:
            # Find the states from which the goal, or a state outside the set, can be reached through finite states
            # only.
            reaching = self.sets
            self.sets += 1
            grows = 1
            while grows != 0:
                grows = 0
                for i in range(first, last):
                    state = self.order[i]
                    if self.set_of[state] == own and self._advances(state, own, reaching) != 0:
                        self.set_of[state] = reaching
                        grows = 1
            removed = 0
            for i in range(first, last):
                state = self.order[i]
                if self.set_of[state] == own:
                    self._fix(state, INFINITE)
                    self.set_of[state] = -1
                    removed = 1
            own = reaching
            if removed == 0:
                return

    def _advances(self, state: int, own: int, reaching: int) -> int:
        """Whether a choice leads only to finite states, and with a positive probability to the set `reaching` or out of
        the component."""
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            count = 1 if size >= 0 else -size
            is_safe = 1
            is_progress = 0
            for k in range(count):
                to = size if size >= 0 else self.code[at + 3 + 2 * k]
                if self.set_of[to] == own:
                    continue
                if self.set_of[to] == reaching:
                    is_progress = 1
                elif self.low[to] == INFINITE:
                    is_safe = 0
                else:
                    is_progress = 1
            if is_safe != 0 and is_progress != 0:
                return 1
            at += 1 if size >= 0 else 3 - 2 * size
        return 0

    def _merge_free(self, first: int, last: int) -> None:
        """Merge the end components in which no reward is collected."""
        # The states with a value come last; they belong to no set.
        middle = first
        for i in range(first, last):
            state = self.order[i]
            if self.fixed[state] == 0:
                self.order[i] = self.order[middle]
                self.order[middle] = state
                middle += 1
        if middle == first:
            return
        if self.is_signed != 0:
            self._find_ends(first, middle, 0)
            if self.ends > 0:
                self.is_unclear = 1
        self._find_ends(first, middle, 1)
        for k in range(self.ends):
            self._merge(self.end_first[k], self.end_last[k])

    # ------------------------------------------------------------ values

    def _best(self, state: int, values: Any, own: int) -> float:
        """The value of the best choice of a state. Choices that do not leave the merged state `own` are ignored. If no
        choice is left, the value is `-INFINITE` (MAXIMUM), `INFINITE` (MINIMUM) or 0 (MEAN)."""
        best = INFINITE if self.mode == MINIMUM else -INFINITE
        total = 0.0
        weights = 0.0
        inside = 0.0
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            if size >= 0:
                weight = 1.0
                if self.group[size] == own:
                    value = 0.0
                    stays = 1.0
                else:
                    value = values[self.group[size]]
                    stays = 0.0
                at += 1
            else:
                weight = self.reals[self.code[at + 1]]
                value = self.reals[self.code[at + 2]] if self.is_reward != 0 else 0.0
                stays = 0.0
                outside = 0
                for k in range(-size):
                    to = self.group[self.code[at + 3 + 2 * k]]
                    chance = self.reals[self.code[at + 4 + 2 * k]]
                    if to == own:
                        stays += chance
                    else:
                        outside = 1
                        value += chance * values[to]
                if outside == 0:
                    stays = 1.0
                at += 3 - 2 * size
            if self.mode == MEAN:
                total += weight * value
                weights += weight
                inside += weight * stays
            elif stays < 1.0:
                if stays > 0.0:
                    value /= 1.0 - stays
                best = max(best, value) if self.mode == MAXIMUM else min(best, value)
        if self.mode == MEAN:
            return total / (weights - inside) if weights > inside else 0.0
        return best

    def _step(self, first: int, last: int, values: Any) -> float:
        """Compute all values of a component once; return the greatest relative change. Afterwards `rises` states
        whether a value has become greater, and `falls` whether a value has become smaller."""
        self.rises = 0
        self.falls = 0
        change = 0.0
        i = first
        while i < last:
            own = self.group[self.order[i]]
            if self.fixed[own] != 0:
                i += 1
                continue
            best = INFINITE if self.mode == MINIMUM else -INFINITE
            while i < last and self.group[self.order[i]] == own:
                value = self._best(self.order[i], values, own)
                if (value < best) if self.mode == MINIMUM else (value > best):
                    best = value
                i += 1
            if best == -INFINITE:
                best = 0.0
            before = values[own]
            slack = ROUNDING * (best if best > 0.0 else -best)
            if best > before + slack:
                self.rises = 1
            elif best < before - slack:
                self.falls = 1
            distance = best - before if best > before else before - best
            size = best if best > 0.0 else -best
            if distance > 0.0:
                relative = distance / size if size > 0.0 else INFINITE
                change = max(change, relative)
            values[own] = best
        self.work += self.size
        return change

    def _iterate(self, first: int, last: int) -> None:
        """Compute bounds for the states of a component, from the bounds of the components after it."""
        if self.is_unclear != 0:
            return
        self._gather(first, last)
        self.size = 0
        gap = 0.0
        for i in range(first, last):
            state = self.order[i]
            self.size += self.start[state + 1] - self.start[state]
            if self.fixed[state] == 0:
                self.low[self.group[state]] = 0.0
                gap = max(gap, self._gap(state))
        tolerance = RELATIVE_TOLERANCE / 10
        change = INFINITE
        is_proven = 0
        limit = self.most_work
        may_solve = 0
        if last - first <= MAX_DIRECT_STATES:
            may_solve = 1
            limit = min(limit, self.work + self.size + self._direct_work(first, last))
        while is_proven == 0:
            while change > tolerance and self.work < limit:
                change = self._step(first, last, self.low)
            if change > tolerance and may_solve != 0:
                if self._solve_directly(first, last, gap) != 0:
                    return
                may_solve = 0
                limit = self.most_work
                continue
            for i in range(first, last):
                own = self.group[self.order[i]]
                if own == self.order[i] and self.fixed[own] == 0:
                    value = self.low[own]
                    self.high[own] = value + RELATIVE_TOLERANCE * (value if value > 0.0 else -value) + gap
            for _ in range(MAX_PROOF_STEPS):
                self._step(first, last, self.high)
                if self.rises == 0:
                    is_proven = 1
                    break
                if self.falls == 0:
                    break
            if is_proven != 0:
                break
            if tolerance < MIN_TOLERANCE or self.work >= self.most_work:
                break
            tolerance /= 10
        if is_proven != 0 and self.is_signed != 0:
            is_proven = self._lower_is_proven(first, last)
        if is_proven == 0:
            self.has_ended_early = 1
        for i in range(first, last):
            state = self.order[i]
            own = self.group[state]
            if self.fixed[state] != 0:
                continue
            if is_proven == 0:
                self.high[own] = INFINITE if self.is_reward != 0 else 1.0
                if self.is_signed != 0:
                    self.low[own] = -INFINITE
            elif self.is_reward == 0 and self.high[own] > 1.0:
                self.high[own] = 1.0
        for i in range(first, last):
            state = self.order[i]
            if self.fixed[state] == 0:
                self.low[state] = self.low[self.group[state]]
                self.high[state] = self.high[self.group[state]]

    def _direct_work(self, first: int, last: int) -> int:
        """The number of additions of value iteration after which a component is solved directly; the direct solution
        takes about as long."""
        count = last - first
        if count > MAX_DENSE_STATES or self._is_chain(first, last) != 0:
            return 1000 * count
        return count * count * count // 16 + 1000 * count

    def _is_chain(self, first: int, last: int) -> int:
        """Whether nothing is to be chosen in the states of a component."""
        if self.mode == MEAN:
            return 1
        for i in range(first, last):
            state = self.order[i]
            if self.group[state] != state:
                return 0
            if self.fixed[state] == 0:
                size = self.code[self.start[state]]
                if self.start[state] + (1 if size >= 0 else 3 - 2 * size) != self.start[state + 1]:
                    return 0
        return 1

    def _solve_directly(self, first: int, last: int, gap: float) -> int:
        """Compute bounds for the states of a component by policy iteration; return 0 if that is not possible."""
        process = self._small_process(first, last)
        if process is None:
            return 0
        error = process.solve(MINIMUM if self.mode == MINIMUM else MAXIMUM)
        largest = 1.0
        if self.is_reward != 0:
            largest = max((abs(value) for value in process.values), default=0.0)
        if error > RELATIVE_TOLERANCE * largest or process.relative_error > MAX_RELATIVE_ERROR:
            return 0
        if process.relative_error > RELATIVE_TOLERANCE:
            self.has_ended_early = 1
        for i in range(first, last):
            state = self.order[i]
            if self.fixed[state] != 0:
                continue
            value = process.values[self.index[self.group[state]]]
            size = value if value > 0.0 else -value
            self.low[state] = value - error - process.relative_error * size
            self.high[state] = value + error + process.relative_error * size + gap
            if self.is_signed == 0 and self.low[state] < 0.0:
                self.low[state] = 0.0
            if self.is_reward == 0 and self.high[state] > 1.0:
                self.high[state] = 1.0
        return 1

    def _small_process(self, first: int, last: int) -> Any:
        """The states of a component as a process, in which successors outside of the component are immediate values;
        `None` if a state has no choice. Afterwards `index` contains the number of each merged state."""
        own = self.sets
        self.sets += 1
        states = 0
        choices = 0
        for i in range(first, last):
            state = self.order[i]
            if self.fixed[state] != 0:
                continue
            self.set_of[state] = own
            if self.group[state] == state:
                # The states of one merged state follow each other, so these numbers have the order in which they are
                # added below.
                self.index[state] = states
                states += 1
            choices += self.start[state + 1] - self.start[state]
        process = SmallProcess(states, choices, choices)
        i = first
        while i < last:
            group = self.group[self.order[i]]
            if self.fixed[group] != 0:
                i += 1
                continue
            before = process.choices
            while i < last and self.group[self.order[i]] == group:
                self._add_choices(process, self.order[i], group, own)
                i += 1
            if process.choices == before:
                return None
            process.end_state()
        return process

    def _add_choices(self, process: Any, state: int, group: int, own: int) -> None:
        """Add the choices of `state` to `process`. With the uniform scheduler (`MEAN`), they become one choice, their
        mean. Otherwise, choices that stay in the merged state `group` or lead to an infinite value are omitted."""
        share = 1.0
        if self.mode == MEAN:
            share = 1.0 / self._weight(state)
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            if size >= 0:
                if self.mode == MEAN or (self.group[size] != group and self.low[self.group[size]] != INFINITE):
                    self._add_entry(process, size, share, own)
                    if self.mode != MEAN:
                        process.end_choice()
                at += 1
                continue
            if self.mode == MEAN or self._is_useful(at, group) != 0:
                weight = share * self.reals[self.code[at + 1]] if self.mode == MEAN else 1.0
                if self.is_reward != 0:
                    process.gain[process.choices] += weight * self.reals[self.code[at + 2]]
                for k in range(-size):
                    self._add_entry(
                        process, self.code[at + 3 + 2 * k], weight * self.reals[self.code[at + 4 + 2 * k]], own
                    )
                if self.mode != MEAN:
                    process.end_choice()
            at += 3 - 2 * size
        if self.mode == MEAN:
            process.end_choice()

    def _add_entry(self, process: Any, to: int, chance: float, own: int) -> None:
        if self.set_of[to] == own:
            process.add_entry(self.index[self.group[to]], chance)
        else:
            process.leaves[process.choices] += chance
            process.gain[process.choices] += chance * self.low[self.group[to]]

    def _weight(self, state: int) -> float:
        """The sum of the weights of the choices of a state."""
        weights = 0.0
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            weights += 1.0 if size >= 0 else self.reals[self.code[at + 1]]
            at += 1 if size >= 0 else 3 - 2 * size
        return weights

    def _is_useful(self, at: int, group: int) -> int:
        """Whether a choice with several destinations leaves a merged state and leads only to finite values."""
        leaves = 0
        for k in range(-self.code[at]):
            to = self.group[self.code[at + 3 + 2 * k]]
            if self.low[to] == INFINITE:
                return 0
            if to != group:
                leaves = 1
        return leaves

    def _lower_is_proven(self, first: int, last: int) -> int:
        """Whether the values are proved to be lower bounds although rewards may be negative: a step decreases none of
        them."""
        for i in range(first, last):
            own = self.group[self.order[i]]
            if own == self.order[i] and self.fixed[own] == 0:
                value = self.low[own]
                self.low[own] = value - RELATIVE_TOLERANCE * (value if value > 0.0 else -value)
        for _ in range(MAX_PROOF_STEPS):
            self._step(first, last, self.low)
            if self.falls == 0:
                return 1
        return 0

    def _gather(self, first: int, last: int) -> None:
        """Sort the states of a component so that the states of each merged state are adjacent."""
        merged = 0
        for i in range(first, last):
            if self.group[self.order[i]] != self.order[i]:
                merged = 1
        if merged == 0:
            return
        states = sorted(self.order[first:last], key=self.group.__getitem__)
        for i in range(first, last):
            self.order[i] = states[i - first]

    def _gap(self, state: int) -> float:
        """The greatest distance between the bounds of a fixed successor outside of the component."""
        gap = 0.0
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            count = 1 if size >= 0 else -size
            for k in range(count):
                to = self.group[size if size >= 0 else self.code[at + 3 + 2 * k]]
                distance = self.high[to] - self.low[to]
                if self.low[to] != INFINITE and distance > gap:
                    gap = distance
            at += 1 if size >= 0 else 3 - 2 * size
        return gap
