# SPDX-License-Identifier: Apache-2.0
"""Runs cases and reports failures, in this process or in several watched processes.

A watched process that does not return within `TIMEOUT_S` seconds is ended, and its case is a failure. The case of a
process that dies is also a failure.
"""

from __future__ import annotations

import contextlib
import faulthandler
import logging
import multiprocessing
import os
import signal
import tempfile
import time
import traceback
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import IO, Any

from fuzz.limits import OutOfTime, limited
from fuzz.strategies import strategies
from fuzz.strategy import Failure
from timeouts import TIMEOUT_S

CASES_OF_A_PROCESS = 400
"""The number of cases after which a process is replaced, so that memory that cases leave behind does not accumulate."""

_LOGGERS = ("roaml", "as2fm_lsp", "pygls")


@dataclass(frozen=True)
class Ran:
    """A case that has been run. `size` is the number of characters of its files; `seconds` is the CPU time of the
    run."""

    strategy: str
    seed: int
    title: str
    size: int
    seconds: float
    failures: tuple[Failure, ...]

    @property
    def name(self) -> str:
        return f"{self.strategy}:{self.seed}"


MAX_RUNS = 3
"""The number of times that a case may run out of time before this is a failure, because other work makes processors
slower."""

_OUT_OF_TIME = "out of time"


def run(strategy: str, seed: int, bounded: bool = True) -> Ran:
    """Runs a case in this process, and again if it runs out of time. Without `bounded`, time and memory are not
    limited, because tests do not measure time."""
    for _ in range(MAX_RUNS):
        ran = _run_once(strategy, seed, bounded)
        if not any(failure.kind.startswith(_OUT_OF_TIME) for failure in ran.failures):
            break
    return ran


def _run_once(strategy: str, seed: int, bounded: bool) -> Ran:
    case = strategies()[strategy].make(seed)
    failures: list[Failure] = []
    limits = limited() if bounded else contextlib.nullcontext()
    started = time.process_time()
    with Crashes() as crashes:
        try:
            with limits:
                failures.extend(case.run())
        except OutOfTime as error:
            failures.append(Failure(f"{_OUT_OF_TIME}: {place(error)}", traceback.format_exc()))
        except MemoryError as error:
            failures.append(Failure(f"out of memory: {place(error)}", traceback.format_exc()))
        except Exception as error:  # the very thing that is looked for
            failures.append(Failure(place(error), traceback.format_exc()))
    seconds = time.process_time() - started
    failures += [Failure(place(e), "".join(traceback.format_exception(e))) for e in crashes.errors]
    size = sum(map(len, case.files().values()))
    return Ran(strategy, seed, next(iter(case.description()), ""), size, seconds, tuple(failures))


def run_all(cases: Iterable[tuple[str, int]], jobs: int) -> Iterator[Ran]:
    """Runs cases (strategy, seed) in `jobs` watched processes. The results are in the order in which the cases end."""
    left = iter(cases)
    workers = [_Worker() for _ in range(jobs)]
    try:
        running = [worker for worker in workers if worker.take(left)]
        while running:
            wait([worker.pipe for worker in running], timeout=1.0)
            for worker in tuple(running):
                if (ran := worker.result()) is not None:
                    yield ran
                    if not worker.take(left):
                        running.remove(worker)
    finally:
        for worker in workers:
            worker.end()


class _Worker:
    """A process that runs cases one after the other, and the watch on it."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("fork")
        self.pipe, inner = context.Pipe()
        self._stack: IO[Any] = tempfile.TemporaryFile()  # noqa: SIM115 - open as long as the process is
        self._process = context.Process(target=_work, args=(inner, self._stack))
        self._process.start()
        inner.close()
        self._done = 0

    def take(self, cases: Iterator[tuple[str, int]]) -> bool:
        """Begin the next case, if there is one."""
        case = next(cases, None)
        if case is None:
            return False
        if self._done >= CASES_OF_A_PROCESS:
            self.end()
            self._start()
        self._case, self._since = case, time.monotonic()
        self.pipe.send(case)
        return True

    def result(self) -> Ran | None:
        """The result of the current case; `None` while it runs."""
        try:
            if self.pipe.poll():
                self._done += 1
                ran: Ran = self.pipe.recv()
                return ran
        except (EOFError, OSError):
            self._process.join(TIMEOUT_S)  # it is ending, which takes long on a busy machine
            return self._lost(f"the process died (exit code {self._process.exitcode})")
        if time.monotonic() - self._since > TIMEOUT_S:
            assert self._process.pid is not None
            os.kill(self._process.pid, signal.SIGUSR1)
            time.sleep(0.5)  # the stack is being written
            return self._lost("hangs")
        return None

    def _lost(self, kind: str) -> Ran:
        self._stack.seek(0)
        stack = self._stack.read().decode("utf-8", "replace")
        self.end()
        self._start()
        strategy, seed = self._case
        where = next((line.strip() for line in stack.splitlines() if "/roaml/" in line or "/as2fm_lsp/" in line), "")
        failure = Failure(f"{kind}: {where}", stack or "nothing is known about where it was")
        return Ran(strategy, seed, "", 0, time.monotonic() - self._since, (failure,))

    def end(self) -> None:
        self._process.kill()
        self._process.join()
        self.pipe.close()
        self._stack.close()


def _work(pipe: Connection, stack: IO[Any]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    faulthandler.enable(stack)
    faulthandler.register(signal.SIGUSR1, stack, all_threads=True)
    with contextlib.suppress(EOFError, BrokenPipeError):
        while True:
            pipe.send(run(*pipe.recv()))


def place(error: BaseException) -> str:
    """The place where an exception was raised, without parts that differ between cases."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = (f for f in reversed(frames) if "/roaml/" in f.filename or "/as2fm_lsp/" in f.filename)
    last = next(ours, frames[-1] if frames else None)
    if last is None:  # made, but never raised
        return f"{type(error).__name__} at an unknown place"
    return f"{type(error).__name__} at {last.filename.rpartition('/server/')[2]}:{last.lineno}"


class Crashes(logging.Handler):
    """Collects the exceptions that the tool has caught and reported."""

    def __init__(self) -> None:
        super().__init__()
        self.errors: list[BaseException] = []

    def emit(self, record: logging.LogRecord) -> None:
        if record.exc_info and record.exc_info[1]:
            self.errors.append(record.exc_info[1])

    def __enter__(self) -> Crashes:
        for logger in map(logging.getLogger, _LOGGERS):
            logger.addHandler(self)
            logger.propagate = False
        return self

    def __exit__(self, *_: object) -> None:
        for logger in map(logging.getLogger, _LOGGERS):
            logger.removeHandler(self)
            logger.propagate = True
