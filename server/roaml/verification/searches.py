# SPDX-License-Identifier: Apache-2.0
"""Explores the states for several properties at the same time: one property in this process, and the following ones in
processes of their own.

The results are those of one search after the other: each search has the same limits as alone. If the searches together
need more memory than one of them may have, the last one is stopped, and begins again when another one has ended.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import TYPE_CHECKING

from roaml.explicit.space import ExplorationProgress, ExplorationWatch, StateLimits
from roaml.record import Record, replace
from roaml.smc.batch import follow_main_process
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.memory import available
from roaml.smc.model import ModelChecker
from roaml.smc.pool import WORKER_START_DELAY_S, process_context, starting_workers
from roaml.verification.exhaustive import UndecidedError, alone, exact_values
from roaml.verification.results import Exact, ShortestTrace

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

    from roaml.explicit.path import Path

_REPORT_INTERVAL_S = 0.1


class _Found(Record, frozen=True):
    """The exact values that a process has computed, without traces; and the paths of the traces."""

    exact: Exact
    paths: tuple[Path, ...]


class _OwnProcess:
    """The search for a property in a process of its own."""

    def __init__(self, checker: ModelChecker, property_: CompiledProperty, limits: StateLimits) -> None:
        self.property = property_
        self.progress = ExplorationProgress(0, 0, 0)
        self._own = alone(checker, property_)
        self._began = time.monotonic()
        context = process_context()
        self.receiving, sending = context.Pipe(duplex=False)
        import pickle  # noqa: PLC0415 - only workers need it

        payload = pickle.dumps((*self._own, limits))
        # It is daemonic so that it ends with this process.
        self._process: BaseProcess = context.Process(target=_explore, args=(sending, payload), daemon=True)  # type: ignore[attr-defined]
        with starting_workers():
            self._process.start()
        sending.close()

    @property
    def seconds(self) -> float:
        """The time in s since the start."""
        return time.monotonic() - self._began

    def received(self) -> Exact | UndecidedError | FaultError | None:
        """The result; `None` if the process has only reported its progress.

        Raises:
            EOFError: the process has ended without a result.
        """
        message = self.receiving.recv()
        match message:
            case ExplorationProgress():
                self.progress = message
                return None
            case _Found(exact, paths):
                traces = (ShortestTrace(*self._own, path, exact.is_reduced) for path in paths)
                return replace(exact, traces=tuple(traces))
            case _:
                assert isinstance(message, (UndecidedError, FaultError))
                return message

    def stop(self) -> None:
        self._process.terminate()
        self._process.join()
        self._process.close()
        self.receiving.close()


class Searches:
    """The exact values of some properties. Use it in a `with` statement, which stops all processes at its end.

    Args:
        properties: the properties in the order in which their values will be needed.
        jobs: the maximum number of searches at the same time.

    Attributes:
        seconds: name of a property -> the duration of its search in another process, in s.
    """

    def __init__(
        self, checker: ModelChecker, properties: Iterable[CompiledProperty], limits: StateLimits, jobs: int = 1
    ) -> None:
        self.limits = replace(limits, bytes=available() // 2 if limits.bytes is None else limits.bytes)
        self._checker = checker
        self._waiting = list(properties)
        self._most = jobs
        self._running: list[_OwnProcess] = []
        self._ended: dict[str, Exact | UndecidedError | FaultError] = {}
        self._began = time.monotonic()
        self.seconds: dict[str, float] = {}

    def __enter__(self) -> Searches:
        return self

    def __exit__(self, *_: object) -> None:
        while self._running:
            self._running.pop().stop()

    def exact_values(self, property_: CompiledProperty, watch: ExplorationWatch | None = None) -> Exact:
        """The exact values of a property; see `exhaustive.exact_values`."""
        name = property_.question.name
        self._waiting = [waiting for waiting in self._waiting if waiting.question.name != name]
        while (search := self._search(name)) is not None:
            self._attend(None, _REPORT_INTERVAL_S)
            if watch is not None:
                watch(search.progress)
        result = self._ended.pop(name, None)
        if result is None:
            return exact_values(self._checker, property_, self.limits, self._watched(watch))
        if isinstance(result, Exact):
            return result
        raise result

    def _watched(self, watch: ExplorationWatch | None) -> ExplorationWatch:
        """`watch`, which also attends to the other searches."""

        def both(progress: ExplorationProgress) -> None:
            if watch is not None:
                watch(progress)
            self._attend(progress)

        return both

    def _search(self, name: str) -> _OwnProcess | None:
        return next((search for search in self._running if search.property.question.name == name), None)

    def _attend(self, own: ExplorationProgress | None, timeout_s: float = 0.0) -> None:
        """Receive what the other searches have reported, and start or stop one of them if necessary.

        Args:
            own: the progress of the search in this process; `None` if there is none.
        """
        self._receive(timeout_s)
        assert self.limits.bytes is not None
        count = len(self._running) + (own is not None)
        used = sum(search.progress.bytes for search in self._running) + (0 if own is None else own.bytes)
        if used > self.limits.bytes and self._running and count > 1:
            self._most = count - 1
            stopped = self._running.pop()
            stopped.stop()
            self._waiting.insert(0, stopped.property)
        elif self._waiting and count < self._most and used <= self.limits.bytes // 2 and self._lasts():
            self._running.append(_OwnProcess(self._checker, self._waiting.pop(0), self.limits))

    def _lasts(self) -> bool:
        """Whether the work takes so long that it pays to start processes."""
        return time.monotonic() - self._began > WORKER_START_DELAY_S

    def _receive(self, timeout_s: float) -> None:
        if not self._running:
            return
        from multiprocessing.connection import wait  # noqa: PLC0415 - most properties are answered without processes

        ready = wait([search.receiving for search in self._running], timeout_s)
        for search in [search for search in self._running if search.receiving in ready]:
            try:
                result = search.received()
            except (EOFError, OSError):  # the process was killed: its property is explored in this one
                self._end(search)
                continue
            if result is not None:
                name = search.property.question.name
                self._ended[name] = result
                self.seconds[name] = search.seconds
                self._end(search)

    def _end(self, search: _OwnProcess) -> None:
        self._running.remove(search)
        search.stop()


def _explore(sending: Connection, payload: bytes) -> None:
    """Explore the states for a property in a process of its own, and send its progress and its result."""
    follow_main_process()
    import pickle  # noqa: PLC0415 - only workers need it

    checker, property_, limits = pickle.loads(payload)
    reported = time.monotonic()

    def report(progress: ExplorationProgress) -> None:
        nonlocal reported
        now = time.monotonic()
        if now - reported > _REPORT_INTERVAL_S:
            reported = now
            sending.send(progress)

    try:
        exact = exact_values(checker, property_, limits, report)
    except (UndecidedError, FaultError) as error:
        sending.send(error)
    else:
        sending.send(_Found(replace(exact, traces=()), tuple(trace.path for trace in exact.traces)))
