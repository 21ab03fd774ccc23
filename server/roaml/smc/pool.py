# SPDX-License-Identifier: Apache-2.0
"""Runs batches on several processors or machines, even if workers die.

The results are in the order of the batches, so they do not depend on the speed of workers. A batch is a pure function:
if a worker dies, its batch is run again.
"""

from __future__ import annotations

import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from roaml.smc.batch import BatchOutcome, Bundle, Simulator, Task, run, run_all, run_in_worker, run_on, start_worker
from roaml.smc.program import Compiled

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future
    from ctypes import c_bool
    from multiprocessing.context import BaseContext

WORKER_START_DELAY_S = 0.4
"""The time in s before workers are started, because most questions are answered in less time."""
MAX_CONSECUTIVE_LOSSES = 5
"""The maximum number of consecutive losses of workers without progress."""
BUNDLE_S = 0.03
"""The approximate time in s of the batches that a worker gets at once. To send the compiled model with them takes about
a millisecond."""
MAX_BUNDLE_TASKS = 32
_POLL_INTERVAL_S = 0.1

Pulse: TypeAlias = Callable[[int, int], None]


class WorkersLostError(Exception):
    """Workers die repeatedly."""


class Alone:
    """Runs batches in this thread. Each object has its own simulator, so several threads may use one each."""

    def __init__(self, compiled: Compiled) -> None:
        self._simulator = Simulator(compiled)

    def outcomes(self, tasks: Iterable[Task], pulse: Pulse | None = None) -> Iterator[tuple[Task, BatchOutcome]]:
        """The outcome of each task, in the order of the tasks."""
        return ((task, run_on(self._simulator, task, pulse)) for task in tasks)


class Runner(Protocol):
    """Runs batches."""

    def outcomes(self, tasks: Iterable[Task], pulse: Pulse | None = None) -> Iterator[tuple[Task, BatchOutcome]]:
        """The outcome of each task, in the order of the tasks."""


class Pool:
    """Runs batches, first in this process and after a delay in `jobs` processes; or on a given executor.

    If `start_delay_s` is `None`, no batch is run in this process, so that it stays responsive.

    Use it in a `with` statement, which ends the workers at its end.
    """

    def __init__(
        self, jobs: int = 1, executor: Executor | None = None, start_delay_s: float | None = WORKER_START_DELAY_S
    ) -> None:
        self.jobs = jobs
        self.executor = executor
        self.is_own = executor is None
        self.start_delay_s = start_delay_s
        self._stopping: c_bool | None = None

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        with _uninterrupted(redelivers=kind is not KeyboardInterrupt):
            self._stop()

    def outcomes(self, tasks: Iterable[Task], pulse: Pulse | None = None) -> Iterator[tuple[Task, BatchOutcome]]:
        """The outcome of each task, in the order of the tasks. The caller may stop the iteration at any time.

        Raises:
            WorkersLostError: workers die repeatedly.
        """
        waiting = iter(tasks)
        if self.executor is None and self.start_delay_s is not None:
            started = time.monotonic()
            for task in waiting:
                yield task, run(task, pulse)
                if self.jobs > 1 and time.monotonic() - started > self.start_delay_s:
                    break
            else:
                return
        yield from self._distributed(waiting, pulse)

    def _distributed(self, waiting: Iterator[Task], pulse: Pulse | None) -> Iterator[tuple[Task, BatchOutcome]]:
        from concurrent.futures import BrokenExecutor  # noqa: PLC0415 - most questions are answered without workers

        running: deque[tuple[list[Task], Future[Bundle] | None]] = deque()
        size = 1
        lost = 0
        try:
            while True:
                while len(running) < 2 * self.jobs:
                    tasks = list(islice(waiting, size))
                    if not tasks:
                        break
                    running.append((tasks, self._submit(tasks)))
                if not running:
                    return
                tasks, future = running[0]
                try:
                    bundle = self._wait(tasks, future, pulse)
                except Exception as error:
                    if self.is_own and not isinstance(error, BrokenExecutor):
                        raise
                    lost += 1
                    if lost > MAX_CONSECUTIVE_LOSSES:
                        raise WorkersLostError(f"worker processes end repeatedly: {error}") from error
                    if self.is_own:
                        self._stop()
                    again = [tasks for tasks, _ in running]
                    running.clear()
                    running.extend((tasks, self._submit(tasks)) for tasks in again)
                    continue
                lost = 0
                running.popleft()
                size = _next_size(len(tasks), bundle.seconds)
                yield from zip(tasks, bundle.outcomes, strict=True)
        finally:
            for _, future in running:
                if future is not None:
                    future.cancel()

    def _submit(self, tasks: list[Task]) -> Future[Bundle] | None:
        """Submit batches; return `None` if this fails because workers have just been lost."""
        from concurrent.futures import BrokenExecutor  # noqa: PLC0415 - most questions are answered without workers

        # A worker that is being started is not known to the executor yet, so it would not be ended.
        with _uninterrupted(redelivers=True), starting_workers():
            try:
                return self._executor().submit(run_in_worker if self.is_own else run_all, tasks)
            except BrokenExecutor:
                return None

    def _executor(self) -> Executor:
        from concurrent.futures import ProcessPoolExecutor  # noqa: PLC0415 - most questions are answered without workers
        from ctypes import c_bool  # noqa: PLC0415

        if self.executor is None:
            context = process_context()
            self._stopping = context.RawValue(c_bool, False)
            self.executor = ProcessPoolExecutor(self.jobs, context, start_worker, (self._stopping,))
        return self.executor

    def _wait(self, tasks: list[Task], future: Future[Bundle] | None, pulse: Pulse | None) -> Bundle:
        from concurrent.futures import BrokenExecutor  # noqa: PLC0415 - most questions are answered without workers
        from concurrent.futures import TimeoutError as FutureTimeoutError  # noqa: PLC0415

        if future is None:
            raise BrokenExecutor("a worker has ended")
        while True:
            try:
                return future.result(timeout=_POLL_INTERVAL_S)
            except (FutureTimeoutError, TimeoutError):
                if future.done():
                    raise
                if pulse is not None:
                    pulse(tasks[0].first, 0)

    def _stop(self) -> None:
        if self.executor is None or not self.is_own:
            return
        if self._stopping is not None:
            self._stopping.value = True
        self.executor.shutdown(wait=True, cancel_futures=True)
        self.executor = None


@contextmanager
def _uninterrupted(*, redelivers: bool) -> Iterator[None]:
    """Delay SIGINT and SIGTERM while workers start or end, which takes a tenth of a second: if the end of `executor` is
    interrupted, Python may wait for ever. Other threads than the main one receive no signals.

    Args:
        redelivers: whether such a signal is delivered after this, instead of ignored.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    received: list[int] = []
    previous: dict[int, Any] = {}
    for number in (int(signal.SIGINT), int(signal.SIGTERM)):
        if signal.getsignal(number) is not None:  # a handler that Python has not set cannot be restored
            previous[number] = signal.signal(number, lambda number, _: received.append(number))
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
        if received and redelivers:
            signal.raise_signal(received[0])


@contextmanager
def starting_workers() -> Iterator[None]:
    """Worker processes that are started in it do not receive SIGINT before they have chosen how to handle it
    (`batch.follow_main_process`, `batch.stop_on_interrupts`). Python would print a traceback for each."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker  # noqa: PLC0415 - most questions are answered without workers

    resource_tracker.ensure_running()  # When it is started, some versions of Python unblock the signals.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def process_context() -> BaseContext:
    """How processes are started: by a server process where there is one, because threads do not survive a fork."""
    import multiprocessing  # noqa: PLC0415 - most questions are answered without workers

    methods = multiprocessing.get_all_start_methods()
    return multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")


def _next_size(size: int, seconds: float) -> int:
    """The number of batches for the next worker, after a worker took `seconds` for `size` batches."""
    wanted = int(size * BUNDLE_S / seconds) if seconds > 0 else MAX_BUNDLE_TASKS
    return max(1, min(wanted, 2 * size, MAX_BUNDLE_TASKS))
