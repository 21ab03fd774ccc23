# SPDX-License-Identifier: Apache-2.0
"""Asks the client to request hints and lenses again.

A client requests those of the edited document itself. The hints and lenses of *other* documents change only with the
linked systems: while these stay the same objects, nothing is sent. Results of properties change as well, and become
stale.

The first request is always sent: the client may have asked before anything was known.
"""

from __future__ import annotations

from as2fm_lsp.client import Client
from as2fm_lsp.display_settings import display_settings
from as2fm_lsp.session import Session
from as2fm_lsp.verification.known_results import KnownResults, expected_now


class Refresh:
    """The state that was last sent to the client."""

    def __init__(self, client: Client, session: Session, results: KnownResults) -> None:
        self._client = client
        self._session = session
        self._results = results
        self._known: object = None

    def update(self) -> None:
        """Request hints and lenses again if something has changed."""
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
        """Everything on which hints and lenses depend, except their own document."""
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
