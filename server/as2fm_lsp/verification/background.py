# SPDX-License-Identifier: Apache-2.0
"""Answers a question while the server goes on: traces run in processes of their own, a thread waits for them."""

from __future__ import annotations

import asyncio
import os
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from roaml.project.memo import Interrupted
from roaml.smc.choices import Choices
from roaml.smc.goal import Asked
from roaml.smc.model import Checker
from roaml.smc.pool import Pool
from roaml.smc.run import Answer, Options, Tally

T = TypeVar("T")
PAUSE = 0.2
"""Seconds between two estimates that are told."""


async def answer(
    checker: Checker,
    asked: Asked,
    options: Options,
    checkpoint: Callable[[], None],
    tell: Callable[[Tally], None],
    is_uniform: bool = False,
) -> tuple[Answer, Choices | None]:
    """
    Args:
        checkpoint: called in the thread, several times a second; what it raises ends the work.
        tell: called on the event loop with what is known so far.
        is_uniform: whether uniform choices are what is wanted; else it is looked into whether they matter.

    Raises:
        Interrupted: the work is not wanted any more.
        FaultError: a trace went wrong.
        WorkersLostError: the processes die again and again.
    """
    loop = asyncio.get_running_loop()
    latest = Tally()
    told = time.monotonic()

    def pulse(_: int, __: int, checked: Callable[[], None]) -> None:
        nonlocal told
        checked()
        now = time.monotonic()
        if latest.traces and now - told > PAUSE:
            told = now
            loop.call_soon_threadsafe(tell, replace(latest))

    def work(checked: Callable[[], None]) -> tuple[Answer, Choices | None]:
        def pulsed(trace: int, steps: int) -> None:
            pulse(trace, steps, checked)

        with Pool(_jobs(), patience=None) as pool:
            found = checker.answer(asked, options, pool, latest, watch=lambda _: pulsed(0, 0), pulse=pulsed)
            return found, None if is_uniform else checker.choices(asked, found, pool, pulsed)

    return await in_thread(work, checkpoint)


async def in_thread(work: Callable[[Callable[[], None]], T], checkpoint: Callable[[], None]) -> T:
    """Do some work in a thread. It is given what it must call now and then, so that it ends when nobody waits."""
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
    """All processors but one, which is the editor's."""
    count = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, count - 1)
