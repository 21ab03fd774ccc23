# SPDX-License-Identifier: Apache-2.0
"""The measurements of a tree with mocks: its outcome, its time, its recoveries, and the influence of its leaves
(docs/spec/mocks.md#results). Here they are estimated from random traces; `roaml.experiments.exact_trees` computes them
from all states."""

from __future__ import annotations

import math
from collections.abc import Sequence

from roaml.jani.expressions import Binary, Expression, Integer, Name
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import Property, eventually
from roaml.lower.programs.executed import ExecutedNode
from roaml.mocks.network import TICKS, MockedLeaf, MockedTree
from roaml.record import Record
from roaml.scxml.names import (
    FAILS,
    MOCK_FAILURES,
    MOCK_SUCCESSES,
    SUCCEEDS,
    TREE_ROOT_PREFIX,
    TreeEventKind,
    tree_event_name,
)
from roaml.smc.affordable import affordable
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.program import FALSE, FAULTY, TRUE, UNKNOWN
from roaml.smc.run import Options
from roaml.smc.statistics import Bounds, Mean, clopper_pearson, incomplete_beta
from roaml.verification.target import VerificationTarget

TRACES = 1000
"""The default number of traces."""
LEAST_TRACES = 100
"""The default number of traces of a tree whose runs are long, and hence take more than `MAX_STEPS` steps in all."""
MAX_STEPS = 30_000_000
QUANTILES = (0.5, 0.9, 0.99)
COUNTERS = ("recoveries", "failed_attempts")
SUCCESS, FAILURE, RUNNING, SKIPPED, HELD = 1, 2, 3, 4, 5
"""The numbers of the statuses that the tree returns."""
FAILURES = (FAILURE, SKIPPED, HELD)
"""The statuses with which the tree has failed."""


def tree_properties(root: int) -> tuple[Property, ...]:
    """The properties of a translated tree: it succeeds, and it fails.

    Args:
        root: the number of the root of the tree.
    """
    return (eventually(SUCCEEDS, returned(root, SUCCESS)), eventually(FAILS, returned(root, *FAILURES)))


def status_variable(root: int) -> str:
    """The variable with the status that the tree returned last."""
    return f"{tree_event_name(root, TreeEventKind.RESPONSE)}__status"


def returned(root: int, *codes: int) -> Expression:
    """The condition that the tree has returned one of the statuses `codes`."""
    first, *others = (Binary(BinaryOperator.EQUAL, Name(status_variable(root)), Integer(code)) for code in codes)
    for other in others:
        first = Binary(BinaryOperator.OR, first, other)
    return first


class Measured(Record, frozen=True):
    """A measured value. Its bounds are its confidence interval; those of an exact value are equal to it."""

    value: float
    bounds: Bounds


def exactly(value: float) -> Measured:
    """A value that is exact."""
    return Measured(value, Bounds(value, value))


class Quantile(Record, frozen=True):
    """The time in s within which a share of the successful traces has ended, with its bounds. The upper end is infinite
    if there are too few traces."""

    share: float
    value: float
    bounds: Bounds


class Influence(Record, frozen=True):
    """The derivative of the probability of success with respect to the probability of a mock, with its bounds."""

    leaf: MockedLeaf
    value: float
    bounds: Bounds


class TreeOutcome(Record, frozen=True, eq=False):
    """The measurements of a tree.

    Attributes:
        traces: the number of traces; `None` if the values are exact.
        confidence: the confidence level of all intervals; 1 if the values are exact.
        success, failure: the probabilities of the outcomes of the tree; `failure` includes trees that were skipped.
        unfinished: the probability that the tree has not ended at the end of time.
        exceptions: the probability that a node gets stuck, because the library throws an exception there.
        rare: the number of traces with the rarer of both outcomes, success or not; `None` if the values are exact.
        time: the time until the tree succeeds, in s; `None` if it never does.
        quantiles: the quantiles of this time.
        counts: nodes, their counters, and the expected value of each counter at the end of a trace.
        influences: the influences of the leaves; first those whose sign is known, each time the greatest first. Leaves
            whose mock never or always succeeds are omitted. Empty if all traces had the same outcome, which shows no
            influence.
        shortest: the number of the shortest trace that does not succeed; `None` if there is none.
        reason: why the values are estimated although no option asks for traces, a clause for users; otherwise "".
    """

    traces: int | None
    confidence: float
    success: Measured
    failure: Measured
    unfinished: Measured
    exceptions: Measured
    rare: int | None
    time: Measured | None
    quantiles: tuple[Quantile, ...]
    counts: tuple[tuple[ExecutedNode, str, Measured], ...]
    influences: tuple[Influence, ...]
    shortest: int | None = None
    reason: str = ""

    @property
    def is_exact(self) -> bool:
        return self.traces is None


def root_automaton(mocked: MockedTree) -> str:
    """The name of the automaton that ticks the tree, and counts the ticks."""
    return f"{TREE_ROOT_PREFIX}{mocked.tree.name}"


def counters_of(mocked: MockedTree) -> list[tuple[ExecutedNode, str]]:
    """The nodes with counters, and their counters. The model must have counters (`MockOptions.counts`)."""
    own = {automaton.name: {data.id for data in automaton.data} for automaton in mocked.network.automata}
    return [(node, counter) for node in mocked.tree.nodes for counter in COUNTERS if counter in own[node.automaton]]


def measure(mocked: MockedTree, target: VerificationTarget, options: Options) -> TreeOutcome:
    """Generate traces until the tree has ended, and measure them.

    The model must have counters (`MockOptions.counts`). The number of traces is fixed in advance, so the intervals are
    valid without correction.

    Raises:
        ValueError: a trace executed an undefined operation.
    """
    return _Measuring(mocked, target, options).run()


def affordable_traces(mocked: MockedTree, target: VerificationTarget, options: Options) -> int:
    """The default number of traces for a tree, which is smaller if its runs are long.

    Raises:
        ValueError: see `measure`.
    """
    return _Measuring(mocked, target, options).affordable()


class _Measuring:
    def __init__(self, mocked: MockedTree, target: VerificationTarget, options: Options) -> None:
        self.mocked, self.target, self.options = mocked, target, options
        ends = eventually("ends", returned(mocked.tree.root, SUCCESS, *FAILURES))
        checker = ModelChecker(target.model, (ends,))
        compiled = checker.compiled(checker.compiled_properties[0])
        self.kernel = Kernel(compiled.program, compiled.goal)
        layout = checker.legend.layout
        shared = {storage.name: storage for storage in layout.shared}
        self.status = shared[status_variable(mocked.tree.root)]
        self.clock = tuple(shared[name] for name in target.clock or ())
        root = root_automaton(mocked)
        self.ticks = next(s for i in layout.instances if i.automaton.name == root for s in i.own if s.name == TICKS)
        self.own = {i.automaton.name: {storage.name: storage for storage in i.own} for i in layout.instances}

    def run(self) -> TreeOutcome:
        traces = self.options.max_traces or TRACES
        leaves = [leaf for leaf in self.mocked.leaves if 0 < leaf.probability < 1]
        counters = [(node, counter, self.own[node.automaton][counter]) for node, counter in counters_of(self.mocked)]
        tallies = [self.own[leaf.node.automaton] for leaf in leaves]
        answers: list[int] = []
        times: list[float] = []
        scores: list[list[float]] = []
        means = [Mean() for _ in counters]
        shortest: tuple[int, int] | None = None
        stuck = cut = 0
        for trace in range(traces):
            answer, steps, is_stuck, is_cut = self.trace(trace)
            answers.append(answer)
            stuck += is_stuck
            cut += is_cut
            if answer == SUCCESS:
                times.append(float(self.integer(self.ticks) * self.mocked.options.tick_time))
            elif shortest is None or steps < shortest[1]:
                shortest = (trace, steps)
            means = [mean.add(self.integer(s)) for mean, (_, _, s) in zip(means, counters, strict=True)]
            scores.append([self.score(leaf, own) for leaf, own in zip(leaves, tallies, strict=True)])
        successes = answers.count(SUCCESS)
        failures = sum(answer in FAILURES for answer in answers)
        time = Mean()
        for seconds in times:
            time = time.add(seconds)
        unfinished = traces - successes - failures - stuck
        counted = ((node, counter, mean) for (node, counter, _), mean in zip(counters, means, strict=True))
        return TreeOutcome(
            traces=traces,
            confidence=self.options.confidence,
            success=self.share(successes, traces, cut),
            failure=self.share(failures, traces, cut),
            unfinished=self.share(unfinished, traces),
            exceptions=self.share(stuck, traces),
            rare=min(successes, traces - successes),
            time=self.mean(time) if times else None,
            quantiles=tuple(quantile(share, sorted(times), self.options.confidence) for share in QUANTILES if times),
            counts=tuple((node, counter, self.mean(mean)) for node, counter, mean in counted),
            influences=self.influences(leaves, scores, [answer == SUCCESS for answer in answers]),
            shortest=None if shortest is None else shortest[0],
        )

    def affordable(self) -> int:
        """The default number of traces, which is smaller if runs are long."""
        return affordable(TRACES, LEAST_TRACES, lambda number: self.trace(number)[1], MAX_STEPS).traces

    def trace(self, number: int) -> tuple[int, int, bool, bool]:
        """The result of a trace: the status that the tree returned last (0 if it has not ended), the number of steps,
        whether a node has got stuck, and whether the trace was cut off, so that the tree might still have ended."""
        verdict = self.kernel.begin(self.options.seed, number, 0)
        if verdict == UNKNOWN:
            verdict = self.kernel.advance(self.options.max_steps)
        if verdict == FAULTY:
            raise ValueError(f"trace {number} executes an undefined operation")
        answer = self.integer(self.status) if verdict == TRUE else 0
        is_stuck = (
            verdict == FALSE
            and self.clock_time() < self.mocked.options.max_time / 1e9 - 2 * self.mocked.options.tick_time
        )
        return answer, self.kernel.outcome()[0], is_stuck, verdict == UNKNOWN

    def integer(self, storage: Storage) -> int:
        return self.kernel.integer(storage.base)

    def clock_time(self) -> float:
        """The time of the model in s. The clock may be one step ahead of the tree."""
        seconds, nanoseconds = map(self.integer, self.clock)
        return seconds + nanoseconds / 1e9

    def share(self, count: int, traces: int, undecided: int = 0) -> Measured:
        return Measured(count / traces, clopper_pearson(count, traces, self.options.confidence, undecided))

    def mean(self, mean: Mean) -> Measured:
        """The mean of a quantity that is never negative."""
        bounds = mean.bounds(self.options.confidence)
        return Measured(mean.mean, Bounds(max(bounds.lower, 0.0), bounds.upper))

    def score(self, leaf: MockedLeaf, own: dict[str, Storage]) -> float:
        """The derivative of the logarithm of the probability of the trace with respect to the probability of a mock."""
        p = leaf.probability
        successes = self.integer(own[MOCK_SUCCESSES]) if MOCK_SUCCESSES in own else 0
        failures = self.integer(own[MOCK_FAILURES]) if MOCK_FAILURES in own else 0
        return successes / p - failures / (1 - p)

    def influences(
        self, leaves: Sequence[MockedLeaf], scores: Sequence[Sequence[float]], outcomes: Sequence[bool]
    ) -> tuple[Influence, ...]:
        """The derivatives, computed with score functions: each is the expectation of outcome times score. Scores have
        the expectation 0, so subtracting the mean outcome only reduces the variance."""
        traces = len(outcomes)
        total = sum(outcomes)
        if total in (0, traces):
            return ()
        influences = []
        for position, leaf in enumerate(leaves):
            mean = Mean()
            for row, outcome in zip(scores, outcomes, strict=True):
                others = (total - outcome) / max(1, traces - 1)  # excludes the trace itself, which avoids a bias
                mean = mean.add((outcome - others) * row[position])
            influences.append(Influence(leaf, mean.mean, mean.bounds(self.options.confidence)))
        return tuple(sorted(influences, key=lambda i: (i.bounds.lower <= 0 <= i.bounds.upper, -abs(i.value))))


def quantile(share: float, values: Sequence[float], confidence: float) -> Quantile:
    """A quantile of sorted values, with a distribution-free confidence interval. Its ends are two of the values;
    if there are too few values, the lower end is 0, and the upper end is infinite."""
    count = len(values)
    tail = (1 - confidence) / 2

    def at_least(rank: int) -> float:
        """The probability that at least `rank` values are at most the quantile."""
        return 1.0 if rank <= 0 else incomplete_beta(share, rank, count - rank + 1)

    low = max((rank for rank in range(count + 1) if 1 - at_least(rank) <= tail), default=0)
    high = next((rank for rank in range(count + 1) if at_least(rank) <= tail), None)
    lower = values[low - 1] if low > 0 else 0.0
    upper = values[high - 1] if high is not None and 0 < high <= count else math.inf
    return Quantile(share, values[min(count - 1, math.ceil(share * count) - 1)], Bounds(lower, upper))
