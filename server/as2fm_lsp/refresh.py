# SPDX-License-Identifier: Apache-2.0
"""Tells the client to ask again for hints and lenses.

A client asks by itself about the document that is edited. What hints and lenses of *other* documents say changes only
with what files see of each other, and that is the linked systems: as long as they stay the same objects, it is quiet.
What is known of properties changes as well, and becomes stale.
The first time it speaks: the client may have asked before anything was known.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from as2fm_lsp.shown import shown

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


class Refresh:
    """What the client was last told of."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._known: object = None

    def look(self) -> None:
        """Something may have changed."""
        workspace = self._server.client_capabilities.workspace
        hints = bool(workspace and workspace.inlay_hint and workspace.inlay_hint.refresh_support)
        lenses = bool(workspace and workspace.code_lens and workspace.code_lens.refresh_support)
        if not hints and not lenses:
            return
        before, self._known = self._known, self._now()
        if before == self._known:
            return
        if hints:
            self._server.workspace_inlay_hint_refresh(None)
        if lenses:
            self._server.workspace_code_lens_refresh(None)

    def _now(self) -> object:
        """All that hints and lenses depend on beyond their own document."""
        session = self._server.session
        moment = session.moment()
        systems = {
            system: (snapshot.analysis.system(system), len(snapshot.checker.errors(system)))
            for path in moment.versions
            for snapshot in (moment.snapshot(path),)
            for system in snapshot.analysis.memberships.get(path, ())
        }
        verified = self._server.verified
        stale = [verified.is_stale(known, moment.snapshot(system).analysis, system) for system, known in verified.all()]
        return shown(session.client_settings), systems, verified.changes, stale
