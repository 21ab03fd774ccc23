# SPDX-License-Identifier: Apache-2.0
"""The number of traces, the number of workers, and the handling of failures."""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import shutil
import signal
import tracemalloc
from array import array
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import suppress
from threading import Barrier
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from roaml.explicit.plain import plain_counts
from roaml.smc import counts
from roaml.smc.batch import BatchOutcome, Counting, Rows, Simulator, Task, run, simulator_of
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.goal import Activity
from roaml.smc.model import ModelChecker
from roaml.smc.pool import MAX_CONSECUTIVE_LOSSES, Alone, Pool, WorkersLostError
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.run import Answer, EstimationMethod, Options, batches
from roaml.smc.statistics import okamoto
from roaml.smc.tally import MAX_KEPT_TRACES, REJECTED, Ended, StoredTrace, Tally


def coin(p: float = 0.3, extra: int = 0) -> Json:
    """A coin that shows heads with probability `p`, after a given number of steps."""
    steps = [edge("count", way("count", n=op("+", "n", 1)), guard=op("<", "n", extra))]
    steps += [edge("count", way("end", p, x=1), way("end", 1 - p), guard=op("=", "n", extra))]
    return document(
        automaton("a", "count end", steps),
        variables=[variable("x"), variable("n")],
        properties={"heads": probability(op("F", op("=", "x", 1)))},
    )


def ask(options: Options, written: Json | None = None, pool: Pool | None = None, **more: Any) -> Answer:
    checker = ModelChecker(model(written or coin()))
    with pool or Pool() as used:
        return checker.answer(checker.compiled_properties[0], options, used, **more)


def numbers(answer: Answer) -> tuple[Any, ...]:
    return answer.value, answer.bounds, json.dumps(answer.tally.to_json())


def test_the_interval_gets_as_narrow_as_asked_for() -> None:
    for epsilon in (0.05, 0.02):
        answer = ask(Options(epsilon=epsilon))
        assert answer.is_complete
        assert answer.bounds.half_width <= epsilon
        assert answer.bounds.lower <= 0.3 <= answer.bounds.upper
        assert answer.tally.traces < okamoto(0.95, epsilon)


def test_methods_with_a_fixed_number_of_traces() -> None:
    assert ask(Options(method=EstimationMethod.OKAMOTO, epsilon=0.05)).tally.traces == okamoto(0.95, 0.05)
    assert ask(Options(method=EstimationMethod.FIXED, max_traces=123)).tally.traces == 123
    limited = ask(Options(method=EstimationMethod.ADAPTIVE, max_traces=150))
    assert (limited.tally.traces, limited.is_complete) == (150, False)


@pytest.mark.parametrize(("relation", "number", "accepted"), [("≥", 0.2, True), ("≥", 0.4, False), ("<", 0.4, True)])
def test_sequential_test(relation: str, number: float, accepted: bool) -> None:
    written = coin()
    written["properties"][0]["expression"] = op(relation, {"op": "Pmax", "exp": op("F", op("=", "x", 1))}, number)
    answer = ask(Options(method=EstimationMethod.SPRT, epsilon=0.02), written)
    assert answer.tally.accepted is accepted
    assert answer.tally.traces < 2000


def test_a_method_is_a_member_not_its_value() -> None:
    with pytest.raises(ValueError, match="there is no method `fixed`"):
        Options(method="fixed", max_traces=1)  # type: ignore[arg-type]


@pytest.mark.parametrize("p", [0.5, 0.01, 0.999])
@pytest.mark.parametrize(
    "method", [EstimationMethod.ADAPTIVE, EstimationMethod.OKAMOTO, EstimationMethod.FIXED, EstimationMethod.SPRT]
)
def test_coverage_over_150_runs(method: EstimationMethod, p: float) -> None:
    """The intervals of runs with different seeds contain the probability as often as their confidence states."""
    runs, confidence = 150, 0.9
    written = coin(p)
    written["properties"][0]["expression"] = op("≥", {"op": "Pmax", "exp": op("F", op("=", "x", 1))}, 0.7)
    checker = ModelChecker(model(written))
    property_ = checker.compiled_properties[0]
    pool = Alone(checker.compiled(property_))
    missed = 0
    for seed in range(runs):
        most = 300 if method is EstimationMethod.FIXED else None
        options = Options(confidence=confidence, epsilon=0.05, method=method, max_traces=most, seed=seed)
        lower, upper = checker.answer(property_, options, pool).bounds
        missed += not lower <= p <= upper
    # A correct interval fails this test once in ten thousand times.
    assert binom.sf(missed - 1, runs, 1 - confidence) > 1e-4


def test_another_seed_gives_other_traces_the_same_seed_the_same() -> None:
    first, again, other = (
        ask(Options(seed=seed, method=EstimationMethod.FIXED, max_traces=1000)) for seed in (7, 7, 8)
    )
    assert numbers(first) == numbers(again)
    assert first.tally.examples != other.tally.examples


@pytest.mark.parametrize("jobs", [2, 3])
def test_the_number_of_workers_has_no_influence(jobs: int) -> None:
    options = Options(epsilon=0.02)
    alone = ask(options)
    assert numbers(ask(options, pool=Pool(jobs, start_delay_s=0))) == numbers(alone)
    with ThreadPoolExecutor(jobs) as executor:
        assert numbers(ask(options, pool=Pool(jobs, executor))) == numbers(alone)


def test_threads_do_not_share_a_simulator() -> None:
    """With a shared simulator, one thread would continue the trace of another."""
    checker = ModelChecker(model(coin()))
    payload = checker.payload(checker.compiled_properties[0])
    together = Barrier(2)

    def simulator(_: int) -> Simulator:
        together.wait()
        return simulator_of(payload)

    with ThreadPoolExecutor(2) as executor:
        first, second = executor.map(simulator, range(2))
    assert first is not second


def test_going_on_after_an_interruption() -> None:
    """After any interruption, the answer is that of a run without interruption."""
    options = Options(epsilon=0.015)
    whole = ask(options)
    saved: list[str] = []

    def watch(tally: Tally) -> None:
        saved.append(json.dumps(tally.to_json()))
        if len(saved) == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ask(options, watch=watch)
    tally = Tally.from_json(json.loads(saved[-1]))
    assert 0 < tally.traces < whole.tally.traces
    assert numbers(ask(options, tally=tally)) == numbers(whole)


def test_a_killed_worker_costs_time_only() -> None:
    options = Options(method=EstimationMethod.FIXED, max_traces=60_000)
    written = coin(extra=400)
    whole = ask(options, written)
    pool = Pool(2, start_delay_s=0)
    killed: list[int] = []

    def watch(tally: Tally) -> None:
        if tally.traces > 500 and not killed:
            assert isinstance(pool.executor, ProcessPoolExecutor)
            killed.append(next(iter(pool.executor._processes)))
            os.kill(killed[0], signal.SIGKILL)

    assert numbers(ask(options, written, pool, watch=watch)) == numbers(whole)
    assert killed


class Hopeless(Executor):
    """An executor that loses every batch."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_exception(OSError("the machine is gone"))
        return future


def test_workers_that_are_always_lost_are_reported() -> None:
    with pytest.raises(WorkersLostError, match="the machine is gone"):
        ask(Options(), pool=Pool(2, Hopeless()))
    assert MAX_CONSECUTIVE_LOSSES > 1


def test_workers_end_with_the_run() -> None:
    pool = Pool(2, start_delay_s=0)
    processes: list[Any] = []

    def watch(tally: Tally) -> None:
        if isinstance(pool.executor, ProcessPoolExecutor):
            processes[:] = list(pool.executor._processes.values())
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ask(Options(method=EstimationMethod.FIXED, max_traces=10**9), coin(extra=1000), pool, watch=watch)
    assert processes
    for process in processes:
        process.join(10)
        assert process.exitcode is not None


def test_many_undecided_traces_end_the_run() -> None:
    """No number of traces would make the interval narrow enough, because a third of them is never decided."""
    steps = [edge("s", way("end", 1 / 3, x=1), way("end", 1 / 3), way("loop", 1 / 3)), edge("loop", "back")]
    steps.append(edge("back", "loop"))
    written = document(
        automaton("a", "s end loop back", steps),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    answer = ask(Options(max_steps=50), written)
    assert not answer.is_complete
    assert answer.tally.traces < 1000
    assert answer.bounds.lower < 0.34
    assert answer.bounds.upper > 0.66


def test_examples_are_remembered() -> None:
    answer = ask(Options(method=EstimationMethod.FIXED, max_traces=2000))
    examples = answer.tally.examples
    assert len(examples[TRUE]) == answer.tally.successes
    assert len(examples[FALSE]) == answer.failures or len(examples[FALSE]) == 1000
    assert answer.tally.shortest[TRUE] == min(examples[TRUE], key=lambda seen: seen.steps)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("is_first", [True, False])
def test_the_end_of_workers_is_not_interrupted(
    number: signal.Signals, is_first: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A signal in the meantime is delivered after the end, unless an earlier one is being handled."""
    events = []

    def stop(_: Pool) -> None:
        signal.raise_signal(number)
        events.append("workers ended")

    def handler(received: int, _: object) -> None:
        events.append(signal.Signals(received).name)

    monkeypatch.setattr(Pool, "_stop", stop)
    previous = signal.signal(number, handler)
    try:
        with suppress(KeyboardInterrupt), Pool():
            if not is_first:
                raise KeyboardInterrupt
        assert signal.getsignal(number) is handler
    finally:
        signal.signal(number, previous)
    assert events == ["workers ended", *([number.name] if is_first else [])]


def test_the_first_fault_is_reported_however_traces_are_distributed() -> None:
    steps = [edge("s", way("end", 0.999), way("bad", 0.001)), edge("bad", way("end", x=op("%", 1, "x")))]
    written = document(
        automaton("a", "s bad end", steps),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    traces = []
    for pool in (Pool(), Pool(2, start_delay_s=0)):
        with pytest.raises(FaultError, match="division by zero") as caught:
            ask(Options(method=EstimationMethod.FIXED, max_traces=20_000), written, pool)
        assert caught.value.origin is not None
        traces.append(caught.value.trace)
    assert traces[0] == traces[1]


def test_memory_does_not_grow_with_the_number_of_traces() -> None:
    peaks = []
    for traces in (20_000, 200_000):
        tracemalloc.start()
        ask(Options(method=EstimationMethod.FIXED, max_traces=traces))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.5 * peaks[0]


def tasks() -> Iterator[Task]:
    checker = ModelChecker(model(coin()))
    payload = checker.payload(checker.compiled_properties[0])
    first = 0
    while True:
        yield Task(payload, 1, first, 10, 1000)
        first += 10


def test_leaving_in_the_middle_of_large_results() -> None:
    """If a worker were killed while it sends, the main process would wait for the rest of the result."""
    for _ in range(5):
        with Pool(2, start_delay_s=0) as pool:
            results = pool.outcomes(Task(task.payload, 0, task.first * 1000, 10_000, 100) for task in tasks())
            next(results)
            next(results)
    assert not multiprocessing.active_children()


def test_no_more_tasks_are_taken_than_workers_need() -> None:
    taken = 0

    def counted() -> Iterator[Task]:
        nonlocal taken
        for task in tasks():
            taken += 1
            yield task

    with ThreadPoolExecutor(2) as executor, Pool(2, executor) as pool:
        results = pool.outcomes(counted())
        task, outcome = next(results)
        assert (task.first, len(outcome.questions[0].verdicts)) == (0, 10)
        assert taken <= 5


class _Submissions(ThreadPoolExecutor):
    """An executor that records the numbers of batches that it gets at once."""

    def __init__(self) -> None:
        super().__init__(1)
        self.sizes: list[int] = []

    def submit(self, function: Any, /, *arguments: Any, **named: Any) -> Future[Any]:
        self.sizes.append(len(arguments[0]))
        return super().submit(function, *arguments, **named)


def test_a_worker_gets_several_short_batches_at_once() -> None:
    first = 0
    with _Submissions() as executor, Pool(1, executor) as pool:
        for task, outcome in pool.outcomes(tasks()):
            assert (task.first, len(outcome.questions[0].verdicts)) == (first, 10)
            first += 10
            if max(executor.sizes) > 4:
                break
    assert executor.sizes[:2] == [1, 1]


@given(st.integers(0, 10_000), st.integers(1, 200_000))
def test_the_last_batches_are_small(done: int, count: int) -> None:
    limit = done + count
    reached = done
    for first, size in batches(done, limit):
        assert first == reached
        assert 1 <= size <= max(100, (limit - first) / 10)
        reached = first + size
    assert reached == limit


def test_a_batch_is_a_function_of_its_task() -> None:
    task = next(tasks())
    first, second = run(task), run(task)
    assert isinstance(first, BatchOutcome)
    (one,), (other,) = first.questions, second.questions
    assert (one.verdicts, one.steps, one.rewards) == (other.verdicts, other.steps, other.rewards)


def test_dask() -> None:
    """The same batches on a cluster, also when a worker dies."""
    distributed: Any = importlib.import_module("distributed")
    options = Options(method=EstimationMethod.FIXED, max_traces=30_000)
    written = coin(extra=200)
    whole = ask(options, written)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        killed: list[int] = []

        def watch(tally: Tally) -> None:
            if tally.traces > 1000 and not killed:
                process = next(iter(cluster.workers.values())).process
                killed.append(process.pid)
                os.kill(process.pid, signal.SIGKILL)

        pool = Pool(2, client.get_executor())
        assert numbers(ask(options, written, pool, watch=watch)) == numbers(whole)
        assert killed


def test_progress_is_reported_during_long_traces() -> None:
    loop = document(
        automaton("a", "l m", [edge("l", way("m", x=op("-", "x", 1))), edge("m", "l")]),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    calls: list[tuple[int, int]] = []

    def pulse(trace: int, steps: int) -> None:
        calls.append((trace, steps))
        if len(calls) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ask(Options(max_steps=10**15), loop, pulse=pulse)
    assert [trace for trace, _ in calls] == [0, 0, 0]
    assert calls[0][1] < calls[1][1] < calls[2][1]


Trace = tuple[int, int, int, int, float]
"""The verdict on a trace, the reason of its end, its activity, its number of steps and its reward."""
TRACE = st.tuples(
    st.sampled_from([FALSE, TRUE, UNKNOWN, REJECTED]), st.integers(0, 8), st.integers(0, 2), st.integers(0, 30),
    st.floats(-100, 100),
)  # fmt: skip


def rows_of(traces: Sequence[Trace]) -> Rows:
    verdicts, ends, activities, steps, rewards = zip(*traces, strict=True)
    return Rows(bytes(verdicts), bytes(ends), array("q", steps), bytes(activities), array("d", rewards))


def counted_one_by_one(traces: Sequence[Trace], first: int, can_be_late: bool) -> Tally:
    tally = Tally()
    for trace, (verdict, end, activity, steps, reward) in enumerate(traces, first):
        tally.steps += steps
        if verdict == REJECTED:
            tally.rejected += 1
            continue
        tally.traces += 1
        tally.successes += verdict == TRUE
        tally.undecided += verdict == UNKNOWN
        tally.late += verdict == FALSE and end == End.TIME and can_be_late
        if end != End.DECIDED:  # a trace that decides the property shows what it asks for
            tally.closed += activity == Activity.CLOSED
            tally.idle += activity == Activity.IDLE
        if verdict == TRUE:
            tally.mean = tally.mean.add(reward)
        seen = StoredTrace(trace, steps)
        if len(tally.examples[verdict]) < MAX_KEPT_TRACES:
            tally.examples[verdict].append(seen)
        if verdict not in tally.shortest or steps < tally.shortest[verdict].steps:
            tally.shortest[verdict] = seen
        ended = tally.ends.setdefault(End(end), Ended(0, seen))
        ended.count += 1
        if steps < ended.shortest.steps:
            ended.shortest = seen
    return tally


@pytest.mark.parametrize("is_plain", [False, True])
@given(st.lists(st.lists(TRACE, min_size=1, max_size=30), min_size=1, max_size=4), st.booleans())
def test_batches_that_are_counted_together_are_counted_as_one_by_one(
    is_plain: bool, batches: list[list[Trace]], can_be_late: bool
) -> None:
    traces = [trace for batch in batches for trace in batch]
    expected = counted_one_by_one(traces, 5, can_be_late)
    count = (plain_counts() if is_plain else counts).count
    tally = Tally()
    for batch in batches:
        rows = rows_of(batch)
        columns = rows.verdicts, rows.ends, rows.steps, rows.activities, rows.rewards
        tally.add(count(*columns, 5 + tally.simulated, tally.room(), can_be_late))
    assert tally.mean.number == expected.mean.number
    assert tally.mean.mean == pytest.approx(expected.mean.mean, abs=1e-9)
    assert tally.mean.squares == pytest.approx(expected.mean.squares, abs=1e-6)
    tally.mean = expected.mean
    assert tally.to_json() == expected.to_json()


def test_only_as_many_examples_are_counted_as_there_is_room_for() -> None:
    rows = rows_of([(TRUE, End.DECIDED, Activity.TRIGGERED, 3, 0.0)] * (MAX_KEPT_TRACES - 10))
    counting = Counting((0,), (0, MAX_KEPT_TRACES, 0))
    tally = Tally()
    # Two batches whose tasks were made when no example was stored.
    for first in (0, MAX_KEPT_TRACES - 10):
        tally.add(rows.tally(counting, first))
    assert [example.trace for example in tally.examples[TRUE]] == list(range(MAX_KEPT_TRACES))
    assert rows.tally(Counting((0,), tally.room()), 0).examples[TRUE] == []


def test_counting_is_compiled() -> None:
    assert counts.compiled() or shutil.which("cc") is None, "pip install -e . compiles it"
    assert not plain_counts().compiled()
