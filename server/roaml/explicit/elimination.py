# SPDX-License-Identifier: Apache-2.0
"""Values of a small Markov decision process by policy iteration, for components in which value iteration is slow.

- Plain Python; Cython compiles it with the types in `elimination.pxd`.
- The equations of one policy are solved by state elimination. Grassmann, Taksar and Heyman (1985) compute the sum of a
  row without subtraction, so no digit is lost, however improbable the end of the process is.
- The bounds are proved; they do not rely on the accuracy of the elimination. Let `g` be at least one more than its
  mean after any choice (an upper bound of the number of steps). If one step changes the values `x` by at most `r`,
  then `x - r g` does not decrease and `x + r g` does not increase; hence they enclose the solution.
- If each state has one choice, and for policies of many states, the equations are solved by `chain`, which bounds the
  error also where `g` is great.
"""

from __future__ import annotations

from typing import Any

from roaml.explicit.chain import Chain
from roaml.smc.memory import flat

MAXIMUM, MINIMUM = 0, 1
INFINITE = float("inf")
MAX_ROUNDS = 200
"""The maximum number of policies; in most cases there are fewer than ten."""
MAX_SPARSE_ROUNDS = 12
"""The maximum number of policies of a process with more than `MAX_DENSE_STATES` states."""
MAX_DENSE_STATES = 2_500
"""The maximum number of states whose equations are a dense matrix, which then occupies 50 MB."""
MAX_STEPS = 1e12
"""The maximum mean number of steps until the end; beyond it, rounding errors would invalidate the proof."""
IMPROVEMENT = 1e-12
"""The relative improvement that a choice must bring to replace another one. Smaller improvements are due to
rounding."""
ROUNDING = 4e-16
"""Twice the relative rounding error of an addition and a multiplication."""


class SmallProcess:
    """States with choices, each of which has an immediate value and leads to states or to the end.

    A choice is built by setting `leaves` and `gain` at the index `choices`, and by calls of `add_entry` and
    `end_choice`. `end_state` follows the last choice of a state.

    Args:
        size: the number of states.
        choices: the maximum number of choices.
        entries: the maximum number of pairs of a choice and a state.

    Attributes:
        choices: the number of choices that are complete.
        leaves: the probability of the end, for each choice.
        gain: the immediate value of each choice.
        values: the solution, after `solve`.
        relative_error: the greatest possible relative error of a value, in addition to the distance that `solve`
            returns.
    """

    def __init__(self, size: int, choices: int, entries: int) -> None:
        self.states = 0
        self.choices = 0
        self.entries = 0
        states = size
        # The index of the first choice of each state, and of the first entry of each choice; one more element marks the
        # end.
        self.first_choice = flat("i", states + 1)
        self.first_entry = flat("i", choices + 1)
        self.target = flat("i", entries + 1)
        self.chance = flat("d", entries + 1)
        self.leaves = flat("d", choices + 1)
        self.gain = flat("d", choices + 1)
        self.values = flat("d", states + 1)
        self.steps = flat("d", states + 1)
        self.sums = flat("d", states + 1)
        self.policy = flat("i", states + 1)
        self.matrix = flat("d", 1)
        self.has_matrix = 0
        self.relative_error = 0.0
        self.counts_steps = 0

    def add_entry(self, target: int, chance: float) -> None:
        """Add a successor state and its probability to the choice that is being built."""
        self.target[self.entries] = target
        self.chance[self.entries] = chance
        self.entries += 1

    def end_choice(self) -> None:
        """Complete the choice that is being built."""
        self.choices += 1
        self.first_entry[self.choices] = self.entries

    def end_state(self) -> None:
        """Complete a state. Its choices are those that were added after the previous state."""
        self.states += 1
        self.first_choice[self.states] = self.choices

    def solve(self, mode: int) -> float:
        """Compute `values`.

        Args:
            mode: MAXIMUM or MINIMUM.

        Returns:
            The greatest possible distance of a value from the solution; infinite if no bound was found, for example
            because the process need not end.
        """
        if self.choices == self.states and self._solve_chain() != 0:
            return 0.0
        self.counts_steps = 1
        if self._iterate(self.steps, MAXIMUM) == 0:
            return INFINITE
        # Rounding errors must not invalidate the proof, so `g` is twice the number of steps.
        for state in range(self.states):
            steps = self.steps[state]
            if steps > MAX_STEPS or steps < self._best(state, self.steps, MAXIMUM) - 0.5:
                return INFINITE
        self.counts_steps = 0
        if self._iterate(self.values, mode) == 0:
            return INFINITE
        residual = 0.0
        size = 0.0
        longest = 0.0
        for state in range(self.states):
            value = self.values[state]
            distance = self._best(state, self.values, mode) - value
            residual = max(residual, distance if distance > 0.0 else -distance)
            size = max(size, value if value > 0.0 else -value)
            longest = max(longest, self.steps[state])
        for choice in range(self.first_choice[self.states]):
            gain = self.gain[choice]
            size = max(size, gain if gain > 0.0 else -gain)
        entries = 2
        for choice in range(self.first_choice[self.states]):
            entries = max(entries, 2 + self.first_entry[choice + 1] - self.first_entry[choice])
        return 2.0 * longest * (residual + ROUNDING * entries * size)

    def _solve_chain(self) -> int:
        """Compute the values of a process in which each state has one choice; return 0 if that is not possible."""
        for choice in range(self.choices):
            self.policy[choice] = choice
            if self.gain[choice] < 0.0:
                return 0
        self.counts_steps = 0
        error = self._evaluate_sparsely(self.values)
        if error < 0.0:
            return 0
        self.relative_error = error
        return 1

    def _evaluate_sparsely(self, values: Any) -> float:
        """Compute the values of the policy as those of a chain; return their relative error, negative if that is not
        possible."""
        chain = Chain(self.states)
        for state in range(self.states):
            choice = self.policy[state]
            chain.leaves[state] = self.leaves[choice]
            chain.gain[state] = 1.0 if self.counts_steps != 0 else self.gain[choice]
            if chain.gain[state] < 0.0:
                return -1.0
            for at in range(self.first_entry[choice], self.first_entry[choice + 1]):
                chain.add(state, self.target[at], self.chance[at])
        error = chain.solve()
        for state in range(self.states):
            values[state] = chain.values[state]
        return error

    def _iterate(self, values: Any, mode: int) -> int:
        """Policy iteration; returns 0 if a policy does not end, or if there are too many."""
        for state in range(self.states):
            self.policy[state] = self.first_choice[state]
        for _ in range(MAX_ROUNDS if self.states <= MAX_DENSE_STATES else MAX_SPARSE_ROUNDS):
            if self._evaluate(values) == 0:
                return 0
            if self._improve(values, mode) == 0:
                return 1
        return 0

    def _improve(self, values: Any, mode: int) -> int:
        """Replace choices of the policy by better ones; return whether there were any."""
        improved = 0
        for state in range(self.states):
            best = self._value(self.policy[state], values)
            for choice in range(self.first_choice[state], self.first_choice[state + 1]):
                value = self._value(choice, values)
                gain = best - value if mode == MINIMUM else value - best
                if gain > IMPROVEMENT * (value if value > 0.0 else -value):
                    self.policy[state] = choice
                    best = value
                    improved = 1
        return improved

    def _value(self, choice: int, values: Any) -> float:
        value = 1.0 if self.counts_steps != 0 else self.gain[choice]
        for at in range(self.first_entry[choice], self.first_entry[choice + 1]):
            value += self.chance[at] * values[self.target[at]]
        return value

    def _best(self, state: int, values: Any, mode: int) -> float:
        best = INFINITE if mode == MINIMUM else -INFINITE
        for choice in range(self.first_choice[state], self.first_choice[state + 1]):
            value = self._value(choice, values)
            if (value < best) if mode == MINIMUM else (value > best):
                best = value
        return best

    def _evaluate(self, values: Any) -> int:
        """Compute the values of the policy; return 0 if the process may continue for ever under it."""
        count = self.states
        if count > MAX_DENSE_STATES:
            return 1 if self._evaluate_sparsely(values) >= 0.0 else 0
        if self.has_matrix == 0:
            self.has_matrix = 1
            self.matrix = flat("d", count * count + 1)
        for at in range(count * count):
            self.matrix[at] = 0.0
        for state in range(count):
            choice = self.policy[state]
            self.sums[state] = self.leaves[choice]
            values[state] = 1.0 if self.counts_steps != 0 else self.gain[choice]
            for at in range(self.first_entry[choice], self.first_entry[choice + 1]):
                self.matrix[state * count + self.target[at]] += self.chance[at]
        # `sums` contains the probability of the end while a state is not eliminated, and then that of leaving the
        # state.
        for last in range(count - 1, -1, -1):
            row = last * count
            total = self.sums[last]
            for to in range(last):
                total += self.matrix[row + to]
            if total <= 0.0:
                return 0
            for state in range(last):
                at = state * count
                share = self.matrix[at + last]
                if share == 0.0:
                    continue
                share /= total
                for to in range(last):
                    self.matrix[at + to] += share * self.matrix[row + to]
                self.sums[state] += share * self.sums[last]
                values[state] += share * values[last]
            self.sums[last] = total
        for state in range(count):
            value = values[state]
            for to in range(state):
                value += self.matrix[state * count + to] * values[to]
            values[state] = value / self.sums[state]
        return 1
