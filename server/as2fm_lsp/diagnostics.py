# SPDX-License-Identifier: Apache-2.0
"""When diagnostics are computed and how they reach the client.

- The newest text takes precedence: a change cancels the pending work for older texts. The changed file is checked
  first, then all other files.
- The diagnostics of a long machine are first provisional (`roaml.project.provisional`). The complete check follows when
  the user pauses; its results are those of the command line.
- The states that a system can reach are explored last, while the user is idle (`roaml.project.exploration`).
- Messages of the client take precedence: the work yields to them, and its results so far are kept.
- A file is published only when its diagnostics differ from those that the client already has.
"""

from __future__ import annotations

import asyncio
import gc
import hashlib
import logging
import time
from collections.abc import Callable, Iterable
from contextlib import AsyncExitStack
from functools import partial
from typing import TypeVar

from lsprotocol import types

from as2fm_lsp.buffer import MARK
from as2fm_lsp.client import Client
from as2fm_lsp.inbox import Inbox
from as2fm_lsp.progress import Progress, ProgressReporter
from as2fm_lsp.session import Moment, Session
from roaml.ide.names.occurrences import uses
from roaml.interruption import Interrupted
from roaml.project.provisional import MIN_CHARACTERS, Checked, after, checked

log = logging.getLogger(__name__)
T = TypeVar("T")

TITLE = "Checking models"
PROGRESS_DELAY_S = 0.5
"""The time after which progress is shown in the client, in s."""

IDLE_DELAY_S = 0.3
"""The time without input after which the user is considered idle, in s."""

MAX_INTERRUPTIONS = 5
"""The maximum number of times that a computation gives way to messages before it is completed."""


class Diagnostics:
    """Computes the diagnostics of all files, sends them to the client or returns them on request.

    Attributes:
        pushes: whether diagnostics are sent to the client; otherwise the client requests them.
        finished: called after a change, when all diagnostics have been sent, or the client has been asked to request
        them."""

    def __init__(self, client: Client, session: Session, inbox: Inbox, progress: ProgressReporter) -> None:
        self.session = session
        self.pushes = True
        self.finished: Callable[[], None] = lambda: None
        self._client = client
        self._progress = progress
        self._inbox = inbox
        self._gives_way = False
        self._sent: dict[str, tuple[int | None, list[types.Diagnostic]]] = {}
        self._task: asyncio.Task[None] | None = None
        self._waiting: dict[str, None] = {}
        self._all_waiting = False
        self._checked: dict[str, Checked] = {}

    def checkpoint(self) -> None:
        """Stop a computation that must give way to messages.

        Raises:
            Interrupted: a message has arrived.
        """
        if self._gives_way and self._inbox.waiting:
            raise Interrupted

    # ------------------------------------------------------------------ push

    def schedule(self, *paths: str) -> None:
        """Schedule a check, because the files at `paths` have changed. Without paths, any file may have changed."""
        if not paths:
            self._all_waiting = True
            self._checked.clear()
        self._waiting = dict.fromkeys((*paths, *self._waiting))
        if self._task is not None:
            self._task.cancel()
        self._task = asyncio.ensure_future(self._work())

    async def _work(self) -> None:
        await self._let_messages_by()
        if self.pushes:
            if self._send_provisional():
                await asyncio.sleep(IDLE_DELAY_S)
            await self._check_all()
        else:
            self._client.refresh_diagnostics()
        self._waiting.clear()
        self._all_waiting = False
        self.finished()
        await asyncio.sleep(IDLE_DELAY_S)
        await self._explore()
        await self._prepare()

    def _send_provisional(self) -> bool:
        """Send the provisional diagnostics of the changed documents. Return whether all of them have such
        diagnostics, so that the complete check can wait."""
        versions = [self._newer(path) for path in self._waiting]
        for version in filter(None, versions):
            self._checked[version.source.path] = version
            sent = [self.session.convert.diagnostic(d, version.source) for d in version.diagnostics]
            self._send(version.source.path, sent, self.session.version(version.source.path))
        return bool(versions) and None not in versions

    def _newer(self, path: str) -> Checked | None:
        """The provisional result for the current text of a document; `None` if there is none."""
        known, text = self._checked.pop(path, None), self.session.text(path)
        return None if known is None or text is None else after(known, text.removeprefix(MARK))

    async def _prepare(self) -> None:
        """Compute, while the user is idle, data that the next request is likely to need, and collect garbage."""
        moment = self.session.moment()
        for path in await self._interruptible(moment.files):
            analysis = moment.snapshot(path).analysis
            for system in analysis.memberships.get(path, (None,)):
                await self._interruptible(partial(uses, analysis, path, system))
        await self._let_messages_by()
        gc.collect(1)

    async def _explore(self) -> None:
        """Add the findings that follow from the reachable states of the systems."""
        moment = self.session.moment()
        has_more = False
        for path in await self._interruptible(moment.files):
            before = None if self.pushes else await self._interruptible(partial(self.of, moment, path))
            diagnostics = await self._interruptible(partial(self.of, moment, path, explores=True))
            if self.pushes:
                self._send(path, diagnostics, moment.versions.get(path))
            else:
                has_more |= diagnostics != before
        if has_more:
            self._client.refresh_diagnostics()

    async def _check_all(self) -> None:
        started = time.monotonic()
        moment = self.session.moment()
        for path in [path for path in self._waiting if path in moment.versions]:
            await self._check(moment, path)
        there = await self._interruptible(moment.files)
        async with AsyncExitStack() as shown:
            bar: Progress | None = None
            for number, path in enumerate(there):
                if bar is None and self._all_waiting and time.monotonic() - started > PROGRESS_DELAY_S:
                    bar = await shown.enter_async_context(self._progress.show(TITLE))
                if bar is not None:
                    bar.report(number, len(there))
                await self._check(moment, path)
        for path in self._sent.keys() - set(there):
            self._send(path, [], None)

    async def _check(self, moment: Moment, path: str) -> None:
        try:
            diagnostics = await self._interruptible(lambda: self.of(moment, path))
        except Exception:  # a crash in one file must not prevent the check of the others
            log.exception("%s cannot be checked", path)
        else:
            self._send(path, diagnostics, moment.versions.get(path))
            is_long = len(self.session.text(path) or "") >= MIN_CHARACTERS
            if is_long and path in moment.versions:
                result = checked(moment.snapshot(path).checker, path)
                if result is not None:
                    self._checked[path] = result

    async def _interruptible(self, compute: Callable[[], T]) -> T:
        """The result of a computation that stops when a message arrives and begins again afterwards. After
        `MAX_INTERRUPTIONS` attempts it runs to its end, so that a steady stream of messages cannot delay it for ever.
        """
        for _ in range(MAX_INTERRUPTIONS):
            await self._let_messages_by()
            self._gives_way = True
            try:
                return compute()
            except Interrupted:
                continue
            finally:
                self._gives_way = False
        await self._let_messages_by()
        return compute()

    async def _let_messages_by(self) -> None:
        await asyncio.sleep(0)
        while self._inbox.waiting:
            await asyncio.sleep(0)

    def _send(self, path: str, diagnostics: list[types.Diagnostic], version: int | None) -> None:
        before = self._sent.get(path, (version, []))
        if before[1] == diagnostics and (before[0] == version or not diagnostics):
            return
        self._sent[path] = (version, diagnostics)
        self._client.publish_diagnostics(self.session.convert.uri(path), diagnostics, version)

    # ------------------------------------------------------------------ pull

    def of(self, moment: Moment, path: str, *, explores: bool = False) -> list[types.Diagnostic]:
        """The diagnostics of a file, in the protocol's types; empty if the file does not exist.

        Args:
            explores: see `RuleRunner.diagnostics`.
        """
        diagnostics = moment.snapshot(path).checker.diagnostics(path, explores=explores)
        return [self.session.convert.diagnostic(d, d.source) for d in diagnostics if d.source is not None]

    def document_report(
        self, path: str, previous: str | None
    ) -> types.RelatedFullDocumentDiagnosticReport | types.RelatedUnchangedDocumentDiagnosticReport:
        diagnostics = self.of(self.session.moment(), path)
        result = result_id(diagnostics)
        if previous == result:
            return types.RelatedUnchangedDocumentDiagnosticReport(result)
        return types.RelatedFullDocumentDiagnosticReport(diagnostics, result_id=result)

    async def workspace_report(self, previous: Iterable[types.PreviousResultId]) -> types.WorkspaceDiagnosticReport:
        known = {self.session.convert.path(p.uri): p.value for p in previous}
        items: list[types.WorkspaceFullDocumentDiagnosticReport | types.WorkspaceUnchangedDocumentDiagnosticReport] = []
        moment = self.session.moment()
        there = moment.files()
        for path in there:
            await self._let_messages_by()
            diagnostics = await self._interruptible(partial(self.of, moment, path, explores=True))
            uri, version, result = self.session.convert.uri(path), moment.versions.get(path), result_id(diagnostics)
            if known.get(path) == result:
                items.append(types.WorkspaceUnchangedDocumentDiagnosticReport(uri, result, version))
            else:
                items.append(types.WorkspaceFullDocumentDiagnosticReport(uri, diagnostics, version, result_id=result))
        for path in known.keys() - set(there):
            uri = self.session.convert.uri(path)
            items.append(types.WorkspaceFullDocumentDiagnosticReport(uri, [], None, result_id=result_id([])))
        return types.WorkspaceDiagnosticReport(items)


def result_id(diagnostics: list[types.Diagnostic]) -> str:
    """The `resultId` of a list of diagnostics. Equal lists have equal ids."""
    return hashlib.blake2b(repr(diagnostics).encode("utf-8", "surrogatepass"), digest_size=12).hexdigest()
