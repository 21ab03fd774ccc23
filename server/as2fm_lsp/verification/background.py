# SPDX-License-Identifier: Apache-2.0
"""Verification while the server stays responsive: traces run in separate processes, and a thread waits for them."""

from __future__ import annotations

import asyncio
import os
import threading
import time
from collections.abc import Callable, Sequence
from typing import TypeVar

from roaml.interruption import Interrupted
from roaml.record import replace
from roaml.smc.goal import CompiledProperty
from roaml.smc.pool import Pool
from roaml.smc.tally import Tally
from roaml.verification.results import Result
from roaml.verification.verifier import Verifier

T = TypeVar("T")
ESTIMATE_INTERVAL_S = 0.2
"""The interval between two estimates that are shown, in s."""


async def answer(
    verifier: Verifier,
    property_: CompiledProperty,
    checkpoint: Callable[[], None],
    show: Callable[[Tally], None],
) -> Result:
    """The result of a property.

    Args:
        checkpoint: called in the thread, several times per second; an exception that it raises ends the work.
        show: called on the event loop with the intermediate result.

    Raises:
        Interrupted: the result is no longer needed.
        FaultError: a trace failed.
        WorkersLostError: the processes end repeatedly.
    """
    loop = asyncio.get_running_loop()
    latest = Tally()
    shown_at = time.monotonic()

    def work(checked: Callable[[], None]) -> Result:
        def pulse(_: int, __: int) -> None:
            nonlocal shown_at
            checked()
            now = time.monotonic()
            if latest.traces and now - shown_at > ESTIMATE_INTERVAL_S:
                shown_at = now
                loop.call_soon_threadsafe(show, replace(latest))

        with Pool(_jobs(), start_delay_s=None) as pool:
            return verifier.answer(property_, pool, latest, watch=lambda _: pulse(0, 0), pulse=pulse)

    return await in_thread(work, checkpoint)


async def answer_together(
    verifier: Verifier,
    properties: Sequence[CompiledProperty],
    checkpoint: Callable[[], None],
    show: Callable[[Sequence[Tally]], None],
    keep: Callable[[Result], None],
) -> None:
    """Verify properties that can share traces.

    Args:
        checkpoint: see `answer`.
        show: called on the event loop with the intermediate results.
        keep: called on the event loop with each result, in the order of the properties. If the work is cancelled, it is
            called with the results of the properties that have enough traces, without values of other schedulers.

    Raises:
        Interrupted, WorkersLostError: see `answer`.
    """
    loop = asyncio.get_running_loop()
    tallies = [Tally() for _ in properties]
    began = time.monotonic()
    shown_at = began

    def work(checked: Callable[[], None]) -> None:
        def pulse(_: int, __: int) -> None:
            nonlocal shown_at
            checked()
            now = time.monotonic()
            if now - shown_at > ESTIMATE_INTERVAL_S and any(tally.traces for tally in tallies):
                shown_at = now
                loop.call_soon_threadsafe(show, [replace(tally) for tally in tallies])

        with Pool(_jobs(), start_delay_s=None) as pool:
            results.extend(verifier.answer_together(properties, pool, tallies, lambda *_: pulse(0, 0), pulse))

    results: list[Result] = []
    try:
        await in_thread(work, checkpoint)
    except Interrupted:
        seconds = time.monotonic() - began
        for property_, tally in zip(properties, tallies, strict=True):
            if tally.is_finished:
                keep(verifier.interrupted(property_, tally, seconds, is_partial=False))
        raise
    for result in results:
        keep(result)


async def in_thread(work: Callable[[Callable[[], None]], T], checkpoint: Callable[[], None]) -> T:
    """Do some work in a thread. The work receives a function that it must call regularly, and that raises an exception
    if the result is no longer needed."""
    abandoned = threading.Event()

    def checked() -> None:
        if abandoned.is_set():
            raise Interrupted
        checkpoint()

    try:
        return await asyncio.to_thread(work, checked)
    finally:
        abandoned.set()


def _jobs() -> int:
    """The number of processes, at least 1: one less than the available processors, to leave one for the editor."""
    count = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, count - 1)
