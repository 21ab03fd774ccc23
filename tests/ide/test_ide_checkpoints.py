# SPDX-License-Identifier: Apache-2.0
"""A check gives way to a message in each step whose time grows with a machine, and keeps nothing half-done."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import pytest

from as2fm_lsp.diagnostics import Diagnostics
from as2fm_lsp.inbox import Inbox
from bench.generate import FIRST, write_system
from roaml.interruption import Interrupted, checkpoint, go_on, run
from roaml.model import value_types
from roaml.model.behavior import explore, summary
from roaml.project.analysis import sources
from roaml.project.analysis import values as analysis_values
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.rules.support import sent_values

STEPS: dict[str, tuple[Any, str]] = {
    "parsing": (sources, "parse_xml"),
    "violations of the grammar": (sources, "validate"),
    "building the model": (sources, "build_machine"),
    "types": (value_types._Typer, "chart"),
    "values": (analysis_values, "analyse"),
    "graph of the steps": (explore._Explorer, "run"),
    "summary of the graph": (summary._Summary, "outline"),
    "comparisons with what is sent": (sent_values, "_numbers_never_sent"),
}
"""The steps of a check whose time grows with the number of states: each the owner and the name of its function."""


def check(workspace: Workspace) -> dict[str, object]:
    snapshot = workspace.snapshot()
    return {path: snapshot.checker.diagnostics(path) for path in snapshot.files()}


class Watched:
    """The calls of a step. `begun` is called when the step begins for the first time.

    Attributes:
        ends: how each call ended: "whole" or "abandoned".
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, step: str, begun: Callable[[], None]) -> None:
        owner, name = STEPS[step]
        compute = getattr(owner, name)
        self.ends: list[str] = []

        def watched(*arguments: Any, **named: Any) -> Any:
            if not self.ends:
                begun()
            try:
                result = compute(*arguments, **named)
                result = list(result) if isinstance(result, Iterator) else result
            except Interrupted:
                self.ends.append("abandoned")
                raise
            self.ends.append("whole")
            return result

        monkeypatch.setattr(owner, name, watched)


@pytest.mark.parametrize("step", STEPS)
async def test_a_message_does_not_wait_for_the_end_of_a_step(
    step: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A message that arrives while a step is computed is handled before the step ends."""
    write_system(tmp_path, files=4, lines=150)
    inbox, events = Inbox(), list[str]()
    diagnostics = Diagnostics(*cast(Any, (None, None, inbox, SimpleNamespace())))
    workspace = Workspace((str(tmp_path),), Settings(), checkpoint=diagnostics.checkpoint)

    def press() -> None:
        """What the thread that reads messages does when one arrives."""
        inbox.put(b'{"jsonrpc": "2.0", "method": "key"}')
        inbox._news.set()

    watched = Watched(monkeypatch, step, press)

    async def handle() -> None:
        async for message in inbox:
            events.append(message["method"])
            events.extend(watched.ends)

    handling = asyncio.ensure_future(handle())
    result = await diagnostics._interruptible(lambda: check(workspace))
    handling.cancel()
    assert events == ["key", "abandoned"]
    assert watched.ends[1:]
    assert set(watched.ends[1:]) == {"whole"}
    assert result == check(Workspace((str(tmp_path),), Settings()))


@pytest.mark.parametrize("step", STEPS)
def test_checkpoints_grow_with_the_machine(step: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each further state adds a checkpoint to a step."""

    def checkpoints(lines: int) -> tuple[int, int]:
        """The number of checkpoints, and the number of states."""
        count = 0

        def counted() -> None:
            nonlocal count
            count += 1

        folder = tmp_path / str(lines)
        write_system(folder, files=4, lines=lines)
        with monkeypatch.context() as patch:
            owner, name = STEPS[step]
            compute = getattr(owner, name)

            def watched(*arguments: Any, **named: Any) -> Any:
                result = run(lambda: compute(*arguments, **named), counted)
                return run(lambda: list(result), counted) if isinstance(result, Iterator) else result

            patch.setattr(owner, name, watched)
            check(Workspace((str(folder),), Settings()))
        return count, (folder / FIRST).read_text(encoding="utf-8").count("<state ")

    (few, short), (many, long) = checkpoints(200), checkpoints(600)
    assert many - few >= long - short > 5


def test_interrupted_at_any_place(tmp_path: Path) -> None:
    """After interruptions at random places, a check reports what a check without interruptions reports, also after
    the next edit."""
    main = write_system(tmp_path, files=5, lines=120)
    path = tmp_path / FIRST
    text = path.read_text(encoding="utf-8")
    texts = [text, text.replace("counter + 1", "counter + 2", 1), text.replace("<assign ", "<assig ", 1), text]
    random = Random(28)
    left = 0

    def interrupt() -> None:
        nonlocal left
        left -= 1
        if left == 0:
            raise Interrupted

    kept = Workspace((str(tmp_path),), Settings(), checkpoint=interrupt)
    interruptions = 0
    for written in texts:
        kept.open(str(path), written)
        new = Workspace((str(tmp_path),), Settings(), [str(main)])
        new.open(str(path), written)
        for furthest in (10, 100, 1000, 3000):
            left = random.randint(1, furthest)
            try:
                check(kept)
            except Interrupted:
                interruptions += 1
        left = 0
        assert check(kept) == check(new)
    assert interruptions >= len(texts) * 2


def test_a_check_of_other_texts_is_abandoned(tmp_path: Path) -> None:
    """A check of a copy, as for a fix that is tried before it is offered, has the checkpoints of the workspace."""
    write_system(tmp_path, files=4, lines=120)
    path = str(tmp_path / FIRST)
    is_needed = True

    def stop_if_not_needed() -> None:
        if not is_needed:
            raise Interrupted

    workspace = Workspace((str(tmp_path),), Settings(), checkpoint=stop_if_not_needed)
    text = Path(path).read_text(encoding="utf-8")
    copy = workspace.snapshot().with_texts({path: text.replace("counter + 1", "counter + 2", 1)})
    is_needed = False
    with pytest.raises(Interrupted):
        copy.checker.diagnostics(path)


def test_other_threads_go_on() -> None:
    """A checkpoint interrupts the computation that was started with it, not one in another thread, or one after it."""

    def interrupt() -> None:
        raise Interrupted

    def compute() -> str:
        thread = threading.Thread(target=lambda: results.append(checkpoint()))
        thread.start()
        thread.join()
        results.append(run(checkpoint, go_on))
        checkpoint()
        return "not reached"

    results: list[None] = []
    with pytest.raises(Interrupted):
        run(compute, interrupt)
    assert results == [None, None]
    checkpoint()
