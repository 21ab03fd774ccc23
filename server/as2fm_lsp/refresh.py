# SPDX-License-Identifier: Apache-2.0
"""Asks the client to request hints and lenses again.

A client requests the hints and lenses of an edited document without being asked. The hints and lenses of *other*
documents depend on the linked systems, on the results of properties and on whether these are stale; nothing is sent
while all of them are unchanged. The first request is always sent, because the client may have requested hints before
any system was analysed.
"""

from __future__ import annotations

from as2fm_lsp.client import Client
from as2fm_lsp.display_settings import display_settings
from as2fm_lsp.session import Session
from as2fm_lsp.verification.known_results import KnownResults, expected_now


class Refresh:
    """Requests a refresh when the state on which hints and lenses depend has changed."""

    def __init__(self, client: Client, session: Session, results: KnownResults) -> None:
        self._client = client
        self._session = session
        self._results = results
        self._known: object = None

    def update(self) -> None:
        """Ask the client to request hints and lenses again, if the state has changed."""
        workspace = self._client.capabilities.workspace
        hints = bool(workspace and workspace.inlay_hint and workspace.inlay_hint.refresh_support)
        lenses = bool(workspace and workspace.code_lens and workspace.code_lens.refresh_support)
        if not hints and not lenses:
            return
        before, self._known = self._known, self._now()
        if before == self._known:
            return
        if hints:
            self._client.refresh_inlay_hints()
        if lenses:
            self._client.refresh_code_lenses()

    def _now(self) -> object:
        """The state on which hints and lenses depend, apart from the document that contains them."""
        moment = self._session.moment()
        systems = {
            system: (snapshot.analysis.system(system), len(snapshot.checker.errors(system)))
            for path in moment.versions
            for snapshot in (moment.snapshot(path),)
            for system in snapshot.analysis.memberships.get(path, ())
        }
        results = self._results
        stale = [results.is_stale(known, moment.snapshot(system).analysis, system) for system, known in results.all()]
        client_settings = self._session.client_settings
        expected = [expected_now(moment.snapshot(system), system, client_settings) for system in results.systems]
        return display_settings(client_settings), systems, results.changes, stale, expected
