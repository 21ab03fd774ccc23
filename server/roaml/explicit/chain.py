# SPDX-License-Identifier: Apache-2.0
"""Values of a large Markov chain by state elimination, for components in which value iteration is slow.

- Plain Python; Cython compiles it with the types in `chain.pxd`.
- Rows are sparse. The state whose elimination adds fewest entries, as far as its numbers of predecessors and successors
  show, is eliminated first.
- Numbers are unevaluated sums of two floating-point numbers (Dekker 1971), so they have about 31 digits.
- No number is subtracted (Grassmann, Taksar and Heyman 1985): the probability of leaving a state is the sum of its row.
  Hence the relative error has a bound that depends neither on the values nor on the number of steps until the end
  (O'Cinneide 1993). Proof: a value is a quotient of polynomials without negative terms, in which each product contains
  at most one number of each row (Markov chain tree theorem). If the numbers of `m` rows have relative errors of at most
  `e`, a value has one of at most about `(2m + 1) e`. Elimination computes the numbers of the remaining rows from those
  before with errors of some roundings, so the errors of all eliminations add up.
"""

from __future__ import annotations

from roaml.smc.memory import flat, grown

ROUNDING = 2.0**-98
"""A bound of the relative error of an addition, a multiplication or a division, with a margin."""
INPUT_ROUNDING = 2.0**-51
"""A bound of the relative error of the numbers given to a chain that are products of two rounded numbers."""
SMALLEST = 1e-270
"""The smallest positive number; below it, the second part of a number loses digits."""
SPLITTER = 134217729.0
"""2^27 + 1: splits a floating-point number into two halves."""
MAX_ENTRIES_PER_STATE = 24
"""The maximum number of entries, as a multiple of the number of states, after which the elimination is given up."""
LARGEST = 1e290
"""The greatest value."""
BUCKETS = 1024
"""The number of different costs of an elimination that are distinguished."""
FAILED = -1.0


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class Chain:
    """A Markov chain in which each state has an immediate value that is not negative, and leads to states or to the
    end. The value of a state is the expected sum of the immediate values until the end, where a state that leads to
    itself is left with the probabilities of its other destinations, divided by their sum.

    A chain is built by calls of `add`, for one state after the other, and by setting `leaves` and `gain`.

    Args:
        size: the number of states.

    Attributes:
        leaves: the probability of the end, for each state.
        gain: the immediate value of each state.
        values: the solution, after `solve`.
        operations: the number of operations of `solve`.
    """

    def __init__(self, size: int) -> None:
        self.states = size
        self.leaves = flat("d", size + 1)
        self.gain = flat("d", size + 1)
        self.values = flat("d", size + 1)
        self.leaves_low = flat("d", size + 1)
        self.gain_low = flat("d", size + 1)
        self.values_low = flat("d", size + 1)
        self.sum_high = flat("d", size + 1)
        self.sum_low = flat("d", size + 1)
        # The entries of a row, and of a column, are lists. -1 ends a list; numbers of entries are stored plus one.
        self.row = flat("i", size + 1)
        self.column = flat("i", size + 1)
        self.row_length = flat("i", size + 1)
        self.column_length = flat("i", size + 1)
        self.is_gone = flat("B", size + 1)
        self.place = flat("i", size + 1)
        self.order = flat("i", size + 1)
        self.bucket = flat("i", BUCKETS)
        self.after = flat("i", size + 1)
        self.before = flat("i", size + 1)
        self.cost = flat("i", size + 1)
        self.room = 1024
        self.source = flat("i", self.room)
        self.target = flat("i", self.room)
        self.in_row = flat("i", self.room)
        self.in_column = flat("i", self.room)
        self.chance = flat("d", self.room)
        self.chance_low = flat("d", self.room)
        self.entries = 0
        self.current = 0
        self.operations = 0
        self.high = 0.0
        self.low = 0.0

    def add(self, state: int, target: int, chance: float) -> int:
        """Add a destination of a state; probabilities of the same destination are added. The state itself is no
        destination."""
        if state == target or chance <= 0.0:
            return 0
        if state != self.current:
            self._leave_row(self.current)
            self.current = state
        known = self.place[target] - 1
        if known >= 0:
            self._add(self.chance[known], self.chance_low[known], chance, 0.0)
            self.chance[known] = self.high
            self.chance_low[known] = self.low
            return 0
        self._link(state, target, chance, 0.0)
        self.place[target] = self.entries
        return 0

    def solve(self) -> float:
        """Compute `values`.

        Returns:
            The greatest possible relative error of a value; negative if the chain need not end, if numbers become too
            small, or if there are too many entries.
        """
        self._leave_row(self.current)
        error = (2.0 * self.states + 1.0) * INPUT_ROUNDING
        for state in range(self.states):
            self._insert(state)
        cheapest = 0
        for step in range(self.states):
            while self.bucket[cheapest] == 0:
                cheapest += 1
            last = self.bucket[cheapest] - 1
            self._remove(last)
            self.order[step] = last
            roundings = self._eliminate(last)
            if roundings < 0:
                return FAILED
            left = self.states - step
            error += (2.0 * left + 1.0) * roundings * ROUNDING
            at = self.row[last]
            while at > 0:
                to = self.target[at - 1]
                self._remove(to)
                self._insert(to)
                cheapest = min(cheapest, self.cost[to])
                at = self.in_row[at - 1]
            at = self.column[last]
            while at > 0:
                state = self.source[at - 1]
                if self.is_gone[state] == 0:
                    self._remove(state)
                    self._insert(state)
                    cheapest = min(cheapest, self.cost[state])
                at = self.in_column[at - 1]
        for step in range(self.states - 1, -1, -1):
            error += self._substitute(self.order[step]) * ROUNDING
            if not self.values[self.order[step]] < LARGEST:
                return FAILED
        # The error of each elimination is proportional to those before; the second part of a value is left out.
        return 1.01 * error + INPUT_ROUNDING if error < 0.01 else FAILED

    def _eliminate(self, last: int) -> int:
        """Replace the entries that lead to a state by its row; return the number of roundings of a number, or -1."""
        count = 0
        high = self.leaves[last]
        low = self.leaves_low[last]
        before = 0
        at = self.row[last]
        while at > 0:
            entry = at - 1
            at = self.in_row[entry]
            if self.is_gone[self.target[entry]] != 0:
                # The row keeps only states that are eliminated later.
                if before > 0:
                    self.in_row[before - 1] = at
                else:
                    self.row[last] = at
                continue
            before = entry + 1
            self._add(high, low, self.chance[entry], self.chance_low[entry])
            high = self.high
            low = self.low
            count += 1
        if high < SMALLEST:
            return -1
        self.sum_high[last] = high
        self.sum_low[last] = low
        self.is_gone[last] = 1
        at = self.column[last]
        while at > 0:
            entry = at - 1
            at = self.in_column[entry]
            state = self.source[entry]
            if self.is_gone[state] == 0:
                self.row_length[state] -= 1
                if self._replace(state, last, entry) == 0:
                    return -1
        at = self.row[last]
        while at > 0:
            self.column_length[self.target[at - 1]] -= 1
            at = self.in_row[at - 1]
        return count + 4

    def _replace(self, state: int, last: int, entry: int) -> int:
        """Add the row of `last`, times the share of the entry that leads to it, to the row of a state; return 0 if
        there are too many entries or a number becomes too small."""
        self._divide(self.chance[entry], self.chance_low[entry], self.sum_high[last], self.sum_low[last])
        share = self.high
        share_low = self.low
        before = 0
        at = self.row[state]
        while at > 0:
            known = at - 1
            at = self.in_row[known]
            if self.is_gone[self.target[known]] != 0:
                if before > 0:
                    self.in_row[before - 1] = at
                else:
                    self.row[state] = at
                continue
            before = known + 1
            self.place[self.target[known]] = known + 1
        at = self.row[last]
        while at > 0:
            follows = at - 1
            at = self.in_row[follows]
            to = self.target[follows]
            if to == state:
                continue
            self._multiply(share, share_low, self.chance[follows], self.chance_low[follows])
            if self.high < SMALLEST:
                return 0
            if self.place[to] > 0:
                known = self.place[to] - 1
                self._add(self.chance[known], self.chance_low[known], self.high, self.low)
                self.chance[known] = self.high
                self.chance_low[known] = self.low
            else:
                if self.entries >= MAX_ENTRIES_PER_STATE * self.states:
                    return 0
                self._link(state, to, self.high, self.low)
            self.operations += 1
        self._leave_row(state)
        if self.leaves[last] > 0.0:
            self._multiply(share, share_low, self.leaves[last], self.leaves_low[last])
            if self.high < SMALLEST:
                return 0
            self._add(self.leaves[state], self.leaves_low[state], self.high, self.low)
            self.leaves[state] = self.high
            self.leaves_low[state] = self.low
        if self.gain[last] > 0.0:
            self._multiply(share, share_low, self.gain[last], self.gain_low[last])
            if self.high < SMALLEST:
                return 0
            self._add(self.gain[state], self.gain_low[state], self.high, self.low)
            self.gain[state] = self.high
            self.gain_low[state] = self.low
        return 1

    def _substitute(self, state: int) -> int:
        """Compute the value of a state from those of its row; return the number of roundings."""
        count = 3
        high = self.gain[state]
        low = self.gain_low[state]
        at = self.row[state]
        while at > 0:
            entry = at - 1
            at = self.in_row[entry]
            to = self.target[entry]
            self._multiply(self.chance[entry], self.chance_low[entry], self.values[to], self.values_low[to])
            self._add(high, low, self.high, self.low)
            high = self.high
            low = self.low
            count += 2
        self._divide(high, low, self.sum_high[state], self.sum_low[state])
        self.values[state] = self.high
        self.values_low[state] = self.low
        return count

    # ------------------------------------------------------------ lists

    def _link(self, state: int, target: int, chance: float, low: float) -> int:
        """Add an entry to a row and a column."""
        if self.entries == self.room:
            self.room *= 2
            self.source = grown(self.source, self.room)
            self.target = grown(self.target, self.room)
            self.in_row = grown(self.in_row, self.room)
            self.in_column = grown(self.in_column, self.room)
            self.chance = grown(self.chance, self.room)
            self.chance_low = grown(self.chance_low, self.room)
        entry = self.entries
        self.entries += 1
        self.source[entry] = state
        self.target[entry] = target
        self.chance[entry] = chance
        self.chance_low[entry] = low
        self.in_row[entry] = self.row[state]
        self.row[state] = entry + 1
        self.in_column[entry] = self.column[target]
        self.column[target] = entry + 1
        self.row_length[state] += 1
        self.column_length[target] += 1
        return 0

    def _leave_row(self, state: int) -> None:
        """Forget the places of the entries of a row."""
        at = self.row[state]
        while at > 0:
            self.place[self.target[at - 1]] = 0
            at = self.in_row[at - 1]
            self.operations += 1

    def _insert(self, state: int) -> None:
        """Insert a state into the bucket of its cost."""
        cost = self.row_length[state] * self.column_length[state]
        if cost >= BUCKETS or self.row_length[state] >= BUCKETS or self.column_length[state] >= BUCKETS:
            cost = BUCKETS - 1
        self.cost[state] = cost
        first = self.bucket[cost]
        self.after[state] = first
        self.before[state] = 0
        if first > 0:
            self.before[first - 1] = state + 1
        self.bucket[cost] = state + 1

    def _remove(self, state: int) -> None:
        """Remove a state from its bucket."""
        before = self.before[state]
        after = self.after[state]
        if before > 0:
            self.after[before - 1] = after
        else:
            self.bucket[self.cost[state]] = after
        if after > 0:
            self.before[after - 1] = before

    # ------------------------------------------------------------ numbers of two parts

    def _add(self, a: float, a_low: float, b: float, b_low: float) -> None:
        total = a + b
        part = total - a
        rest = (a - (total - part)) + (b - part) + (a_low + b_low)
        self.high = total + rest
        self.low = rest - (self.high - total)

    def _multiply(self, a: float, a_low: float, b: float, b_low: float) -> None:
        product = a * b
        rest = self._rest(a, b) + (a * b_low + a_low * b)
        self.high = product + rest
        self.low = rest - (self.high - product)

    def _rest(self, a: float, b: float) -> float:
        """The rounding error of a product."""
        part = SPLITTER * a
        a_high = part - (part - a)
        a_low = a - a_high
        part = SPLITTER * b
        b_high = part - (part - b)
        b_low = b - b_high
        return ((a_high * b_high - a * b) + a_high * b_low + a_low * b_high) + a_low * b_low

    def _divide(self, a: float, a_low: float, b: float, b_low: float) -> None:
        quotient = a / b
        rest = a - quotient * b - self._rest(quotient, b) + a_low - quotient * b_low
        second = rest / b
        self.high = quotient + second
        self.low = second - (self.high - quotient)
