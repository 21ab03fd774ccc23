# SPDX-License-Identifier: Apache-2.0
"""Runs batches of traces. The result of a batch depends only on the compiled model, the seed, the scheduler and the
numbers of the traces, so any executor can compute it."""

from __future__ import annotations

import signal
import threading
import time
from array import array
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from roaml.record import Record
from roaml.smc.counts import count
from roaml.smc.end import End
from roaml.smc.kernel import Kernel
from roaml.smc.kernel import compiled as kernel_compiled
from roaml.smc.program import FALSE, FAULTY, TRUE, UNKNOWN, Compiled, Ints, Reals
from roaml.smc.rounds import Rounds, limits
from roaml.smc.states import MAX_BYTES, TraceBatch
from roaml.smc.states import compiled as states_compiled
from roaml.smc.tally import REJECTED, Tally

if TYPE_CHECKING:
    from ctypes import c_bool
    from types import FrameType

T = TypeVar("T")
R = TypeVar("R")

STEPS_BETWEEN_PULSES = 200_000
"""The number of steps of a trace after which its progress is reported: these steps take some hundredths of a second."""


class Payload:
    """A compiled model and goal. They are packed once for all batches, when a worker or a saved run needs them: most
    questions are answered in one process, and to load OpenSSL for the digest takes a tenth of a short command."""

    def __init__(self, compiled: Compiled) -> None:
        self._compiled: Compiled | None = compiled

    @property
    def compiled(self) -> Compiled:
        if self._compiled is None:
            import pickle  # noqa: PLC0415 - only workers need it

            self._compiled = pickle.loads(self._data)
        return self._compiled

    @cached_property
    def digest(self) -> str:
        """A hash of the model and the goal."""
        import hashlib  # noqa: PLC0415 - only workers and saved runs need it

        digest = hashlib.sha256()
        for part in (self.compiled.program, self.compiled.goal):
            for name in part.__struct_fields__:
                value = getattr(part, name)
                digest.update(value.tobytes() if isinstance(value, array) else repr(value).encode())
                digest.update(name.encode())
        return digest.hexdigest()

    @cached_property
    def _data(self) -> bytes:
        import pickle  # noqa: PLC0415 - only workers need it

        return pickle.dumps(self._compiled)

    def has_same_content(self, other: Payload) -> bool:
        return self is other or self.digest == other.digest

    def __getstate__(self) -> tuple[str, bytes]:
        return self.digest, self._data

    def __setstate__(self, state: tuple[str, bytes]) -> None:
        self.digest, self._data = state
        self._compiled = None


class TraceProblem(Record, frozen=True):
    """An undefined operation in a trace: the number of the trace, and the numbers that `Kernel.problem` returns."""

    trace: int
    code: int
    at: int
    value: int
    size: int
    real: float


class Counting(Record, frozen=True):
    """What is counted for a question.

    Attributes:
        columns: the indices in `Task.questions` of the question, and of its assumptions if it has any.
        kept: the number of examples to store; see `Tally.room`.
        is_reward, can_be_late: see `goal.Question`.
        is_ordered: whether the order of the traces matters, so that they cannot be counted without those before them.
    """

    columns: tuple[int, ...]
    kept: tuple[int, int, int]
    is_reward: bool = False
    can_be_late: bool = False
    is_ordered: bool = False


class Task(Record, frozen=True):
    """A batch: the traces `first` to `first + size - 1`, each with at most `max_steps` steps, under the scheduler
    `scheduler` (0: uniform choices).

    `questions` are the numbers, in the goal of `payload`, of the questions that the traces answer. If `counted` is not
    empty, the outcome contains the tallies that it describes instead of rows.
    """

    payload: Payload
    seed: int
    first: int
    size: int
    max_steps: int
    scheduler: int = 0
    questions: tuple[int, ...] = (0,)
    counted: tuple[Counting, ...] = ()


class Rows(Record, frozen=True, eq=False):
    """The result of a batch for one question. For each trace it contains the verdict (FALSE, TRUE or UNKNOWN), the
    reason why the trace has ended for the question (`End`), the number of steps until then, the `goal.Activity` and,
    for questions about rewards, the reward."""

    verdicts: bytes
    ends: bytes
    steps: Ints
    activities: bytes
    rewards: Reals

    def given(self, assumptions: Rows) -> Rows:
        """The rows under assumptions. The verdict on a trace that violates them is REJECTED; a trace for which they are
        undecided is undecided. Such traces end when the assumptions do."""
        assumed = assumptions.verdicts
        verdicts = bytes(
            verdict if known == TRUE else REJECTED if known == FALSE else UNKNOWN
            for verdict, known in zip(self.verdicts, assumed, strict=True)
        )
        ends = bytes(
            end if known == TRUE else other
            for end, other, known in zip(self.ends, assumptions.ends, assumed, strict=True)
        )
        steps = array(
            "q",
            (
                length if known == TRUE else other
                for length, other, known in zip(self.steps, assumptions.steps, assumed, strict=True)
            ),
        )
        return Rows(verdicts, ends, steps, self.activities, self.rewards)

    def tally(self, counting: Counting, first: int, size: int | None = None) -> Tally:
        """The results of the first `size` traces, or all, in a few numbers. `first` is the number of the first one."""
        rewards = self.rewards[:size] if counting.is_reward else array("d")
        columns = self.verdicts[:size], self.ends[:size], self.steps[:size], self.activities[:size]
        return count(*columns, rewards, first, counting.kept, counting.can_be_late)


class BatchOutcome(Record, frozen=True, eq=False):
    """The result of a batch. A problem ends the batch; the trace with the problem has no row.

    Attributes:
        questions: rows for each question of the task, unless the task counts its results.
        counted: for each `Counting` of the task, the tally of the traces; their rows if their order matters.
    """

    questions: tuple[Rows, ...]
    problem: TraceProblem | None = None
    counted: tuple[Tally | Rows, ...] = ()


class Simulator:
    """The kernel of a compiled model and goal, the states that its traces have reached so far, and those in which they
    have been found to repeat.

    Args:
        bytes: the maximum memory for states, in bytes; 0 if the kernel generates all traces.
    """

    def __init__(self, compiled: Compiled, bytes: int = MAX_BYTES) -> None:  # noqa: A002
        self.kernel = Kernel(compiled.program, compiled.goal)
        # Python cannot read the data of a compiled kernel.
        is_readable = states_compiled() or not kernel_compiled()
        self.rounds = Rounds(compiled)
        self.batch = TraceBatch(self.kernel, compiled.program, bytes, self.rounds) if is_readable else None


class _Simulators(threading.local):
    """The last simulator of each thread. A kernel simulates one trace at a time, and some executors run batches in
    threads."""

    payload: Payload | None = None
    simulator: Simulator | None = None


_simulators = _Simulators()


def simulator_of(payload: Payload) -> Simulator:
    """The simulator of a payload for this thread. The last simulator is kept for the next call."""
    simulator = _simulators.simulator
    if simulator is None or _simulators.payload is None or not payload.has_same_content(_simulators.payload):
        _simulators.simulator = simulator = Simulator(payload.compiled)
    _simulators.payload = payload
    return simulator


def run(task: Task, pulse: Callable[[int, int], None] | None = None) -> BatchOutcome:
    """Run the traces of a batch.

    Args:
        pulse: called regularly with the number of the trace and the number of steps that the trace has at most; an
            exception that `pulse` raises ends the batch.
    """
    return run_on(simulator_of(task.payload), task, pulse)


def run_on(simulator: Simulator, task: Task, pulse: Callable[[int, int], None] | None = None) -> BatchOutcome:
    """Run the traces of a batch on a simulator that nothing else uses at the same time."""
    outcome = _generated(simulator, task, pulse)
    if not task.counted:
        return outcome
    counted: list[Tally | Rows] = []
    for counting in task.counted:
        rows, *assumptions = (outcome.questions[column] for column in counting.columns)
        if assumptions:
            rows = rows.given(*assumptions)
        counted.append(rows if counting.is_ordered else rows.tally(counting, task.first))
    return BatchOutcome((), outcome.problem, tuple(counted))


def _generated(simulator: Simulator, task: Task, pulse: Callable[[int, int], None] | None) -> BatchOutcome:
    """The rows of all questions."""
    batch = simulator.batch
    if batch is None or task.scheduler != 0:
        return _run_on_kernel(simulator, task, pulse)
    count = batch.run(task.seed, task.first, task.size, task.max_steps, task.questions, pulse)
    problem = None if count == task.size else TraceProblem(task.first + count, *simulator.kernel.problem())
    rewards = batch.rewards[:count]
    results = []
    for i in range(len(task.questions)):
        part = slice(i * task.size, i * task.size + count)
        columns = bytes(batch.verdicts[part]), bytes(batch.ends[part]), batch.steps[part], bytes(batch.activities[part])
        results.append(Rows(*columns, rewards))
    return BatchOutcome(tuple(results), problem)


def _run_on_kernel(simulator: Simulator, task: Task, pulse: Callable[[int, int], None] | None) -> BatchOutcome:
    kernel = simulator.kernel
    kernel.choose(task.questions)
    rows = [(bytearray(), bytearray(), array("q"), bytearray()) for _ in task.questions]
    rewards = array("d")
    problem: TraceProblem | None = None
    for trace in range(task.first, task.first + task.size):
        verdict = kernel.begin(task.seed, trace, task.scheduler)
        for limit in limits(task.max_steps):
            if verdict != UNKNOWN or kernel.ending() != End.DECIDED:
                break
            verdict = kernel.advance(limit)
            if verdict == UNKNOWN and kernel.ending() == End.DECIDED and task.scheduler == 0:
                verdict = simulator.rounds.check(kernel, task.seed, trace)
            if pulse is not None and (limit >= STEPS_BETWEEN_PULSES or not trace & 63):
                pulse(trace, limit)
        if verdict == FAULTY:
            problem = TraceProblem(trace, *kernel.problem())
            break
        for question, (verdicts, ends, steps, activities) in zip(task.questions, rows, strict=True):
            known, end, length, activity = kernel.result(question)
            verdicts.append(known)
            ends.append(end or End.CUT if known == UNKNOWN else end)
            steps.append(length)
            activities.append(activity)
        _, draws, reward = kernel.outcome()
        rewards.append(reward)
        if draws == 0 and task.scheduler != 0:
            # The scheduler makes all choices and nothing is random, so this is the first trace, and all are equal.
            rows = [(v * task.size, e * task.size, s * task.size, a * task.size) for v, e, s, a in rows]
            rewards *= task.size
            break
    results = (Rows(bytes(v), bytes(e), steps, bytes(a), rewards) for v, e, steps, a in rows)
    return BatchOutcome(tuple(results), problem)


class StoppedError(Exception):
    """Raised in a worker when its batch is no longer needed."""


_stopping: c_bool | None = None


def start_worker(stopping: c_bool) -> None:
    """Prepare a worker process.

    Args:
        stopping: true when the remaining batches are no longer needed, in shared memory. Workers then end by
            themselves: a worker that is killed may leave an incomplete result, for which the main process would wait
            for ever. It has no lock, because a worker that is killed while it has the lock would block the main
            process.
    """
    global _stopping  # noqa: PLW0603
    _stopping = stopping
    follow_main_process()


def follow_main_process() -> None:
    """Let this worker process ignore interrupts from the keyboard, which only the main process handles, and end when
    the main process has ended, even if it was killed."""
    _handle_interrupts(signal.SIG_IGN)
    _end_with_main_process()


def stop_on_interrupts() -> None:
    """Let this worker process stop its work when it is interrupted from the keyboard, as the main process is, and end
    when the main process has ended, even if it was killed. The work is done with `interruptible`."""

    def interrupt(number: int, frame: FrameType | None) -> None:
        global _is_interrupted  # noqa: PLW0603
        _is_interrupted = True
        if _is_working:  # The executor passes the exception on. Elsewhere, it would print a traceback.
            raise KeyboardInterrupt

    _handle_interrupts(interrupt)
    _end_with_main_process()


_is_interrupted = _is_working = False


def interruptible(work: Callable[[T], R], argument: T) -> R:
    """The result of some work in a worker process.

    Raises:
        KeyboardInterrupt: the process is interrupted, or was before.
    """
    global _is_working  # noqa: PLW0603
    _is_working = True
    try:
        if _is_interrupted:
            raise KeyboardInterrupt
        return work(argument)
    finally:
        _is_working = False


def _handle_interrupts(handler: Callable[[int, FrameType | None], object] | signal.Handlers) -> None:
    """Handle SIGINT from now on, also if it came while this process was started (`pool.starting_workers`)."""
    signal.signal(signal.SIGINT, handler)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,))


def _end_with_main_process() -> None:
    """Let this worker process end when the main process has ended, even if it was killed."""
    import multiprocessing  # noqa: PLC0415 - most questions are answered without workers

    main = multiprocessing.parent_process()
    if main is not None:
        threading.Thread(target=_end_with, args=(main.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    from multiprocessing.connection import wait  # noqa: PLC0415 - most questions are answered without workers

    wait([sentinel])
    signal.raise_signal(signal.SIGTERM)


class Bundle(Record, frozen=True):
    """The outcomes of some batches, in their order, and the elapsed time in s."""

    outcomes: list[BatchOutcome]
    seconds: float


def run_in_worker(tasks: Sequence[Task]) -> Bundle:
    """Run batches in a worker process.

    Raises:
        StoppedError: the batches are no longer needed.
    """
    _checkpoint(0, 0)
    return run_all(tasks, _checkpoint)


def run_all(tasks: Sequence[Task], pulse: Callable[[int, int], None] | None = None) -> Bundle:
    """Run batches; see `run`."""
    started = time.monotonic()
    return Bundle([run(task, pulse) for task in tasks], time.monotonic() - started)


def _checkpoint(trace: int, steps: int) -> None:
    if _stopping is not None and _stopping.value:
        raise StoppedError
