# SPDX-License-Identifier: Apache-2.0
"""When diagnostics are computed and how they reach the client.

- The newest text wins: a change cancels what was still to be done for older ones. The changed file comes first, then
  the other files of its workspace, with a pause after each in which newer messages are read.
- A file is published only when its diagnostics differ from what the client already has.
"""

from __future__ import annotations

import asyncio
import hashlib
import logging
from collections.abc import Callable, Iterable

from lsprotocol import types

from as2fm_lsp.session import Moment, Session
from roaml.text import SourceFile

log = logging.getLogger(__name__)

PAUSE = 0.002
"""Seconds without a further change after which a change is looked at: keys that come at once are looked at together."""

BREAK = 0.001
"""Seconds after each file in which newer messages are read. Each takes several turns of the event loop, and a thread
that must be let run."""


class Diagnostics:
    """Args:
    publish: sends diagnostics to the client.
    pushes: whether the client wants to be told, or asks by itself.
    refresh: tells a client that asks by itself to ask again.

    `finished` is called when all that is known of a change has been told.
    """

    def __init__(
        self,
        session: Session,
        publish: Callable[[types.PublishDiagnosticsParams], None],
        refresh: Callable[[], None],
    ) -> None:
        self.session = session
        self.pushes = True
        self.finished: Callable[[], None] = lambda: None
        self._publish = publish
        self._refresh = refresh
        self._sent: dict[str, tuple[int | None, list[types.Diagnostic]]] = {}
        self._task: asyncio.Task[None] | None = None
        self._waiting: dict[str, None] = {}

    # ------------------------------------------------------------------ push

    def schedule(self, *paths: str) -> None:
        """Files have changed; none are named if any may have."""
        self._waiting = dict.fromkeys((*paths, *self._waiting))
        if self._task is not None:
            self._task.cancel()
        self._task = asyncio.ensure_future(self._work())

    async def _work(self) -> None:
        await asyncio.sleep(PAUSE)
        if not self.pushes:
            self._waiting.clear()
            self._refresh()
            self.finished()
            return
        moment = self.session.moment()
        for path in [path for path in self._waiting if path in moment.versions]:
            self._check(moment, path)
            await asyncio.sleep(BREAK)
        there = moment.files()
        for path in there:
            self._check(moment, path)
            await asyncio.sleep(BREAK)
        for path in self._sent.keys() - set(there):
            self._send(path, [], None)
        self._waiting.clear()
        self.finished()

    def _check(self, moment: Moment, path: str) -> None:
        try:
            found = self.of(moment, path)
        except Exception:  # a failure of ours in one file must not keep the others from being checked
            log.exception("%s cannot be checked", path)
        else:
            self._send(path, found, moment.versions.get(path))

    def _send(self, path: str, found: list[types.Diagnostic], version: int | None) -> None:
        before = self._sent.get(path, (version, []))
        if before[1] == found and (before[0] == version or not found):
            return
        self._sent[path] = (version, found)
        self._publish(types.PublishDiagnosticsParams(self.session.convert.uri(path), found, version))

    # ------------------------------------------------------------------ pull

    def of(self, moment: Moment, path: str) -> list[types.Diagnostic]:
        """The diagnostics of a file, as the client takes them. None of a file that is not there."""
        snapshot = moment.snapshot(path)
        source = snapshot.analysis.source(path)
        if source is None:
            return []
        found = snapshot.checker.diagnostics(path)
        related = {r.location.path for d in found for r in d.related}
        sources: dict[str, SourceFile] = {p: s for p in related if (s := snapshot.analysis.source(p)) is not None}
        return [self.session.convert.diagnostic(d, source, sources) for d in found]

    def document_report(
        self, path: str, previous: str | None
    ) -> types.RelatedFullDocumentDiagnosticReport | types.RelatedUnchangedDocumentDiagnosticReport:
        found = self.of(self.session.moment(), path)
        result = result_id(found)
        if previous == result:
            return types.RelatedUnchangedDocumentDiagnosticReport(result)
        return types.RelatedFullDocumentDiagnosticReport(found, result_id=result)

    async def workspace_report(self, previous: Iterable[types.PreviousResultId]) -> types.WorkspaceDiagnosticReport:
        known = {self.session.convert.path(p.uri): p.value for p in previous}
        items: list[types.WorkspaceFullDocumentDiagnosticReport | types.WorkspaceUnchangedDocumentDiagnosticReport] = []
        moment = self.session.moment()
        there = moment.files()
        for path in there:
            found = self.of(moment, path)
            uri, version, result = self.session.convert.uri(path), moment.versions.get(path), result_id(found)
            if known.get(path) == result:
                items.append(types.WorkspaceUnchangedDocumentDiagnosticReport(uri, result, version))
            else:
                items.append(types.WorkspaceFullDocumentDiagnosticReport(uri, found, version, result_id=result))
            await asyncio.sleep(BREAK)
        for path in known.keys() - set(there):
            uri = self.session.convert.uri(path)
            items.append(types.WorkspaceFullDocumentDiagnosticReport(uri, [], None, result_id=result_id([])))
        return types.WorkspaceDiagnosticReport(items)


def result_id(found: list[types.Diagnostic]) -> str:
    """Equal diagnostics, equal id."""
    return hashlib.blake2b(repr(found).encode("utf-8", "surrogatepass"), digest_size=12).hexdigest()
