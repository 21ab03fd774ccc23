# SPDX-License-Identifier: Apache-2.0
"""`workspace/didChangeConfiguration` and `as2fm/didChangeTrust`"""

from __future__ import annotations

from typing import Any

from lsprotocol import types

from as2fm_lsp.client import SECTION
from as2fm_lsp.context import Context
from as2fm_lsp.handlers.workspace import show_problems
from as2fm_lsp.trust import DID_CHANGE


def register(context: Context) -> None:
    @context.feature(types.WORKSPACE_DID_CHANGE_CONFIGURATION)
    async def did_change_configuration(params: types.DidChangeConfigurationParams) -> None:
        if not await fetch_settings(context):
            settings = params.settings if isinstance(params.settings, dict) else {}
            context.session.configure(settings.get(SECTION, settings) or {})
        show_problems(context)
        context.diagnostics.schedule()

    @context.feature(DID_CHANGE)
    def did_change_trust(params: Any) -> None:
        context.trust.set(getattr(params, "trusted", None))


async def fetch_settings(context: Context) -> bool:
    """Request the settings of the client; return whether it supports that."""
    settings = await context.client.settings()
    if settings is None:
        return False
    if settings != context.session.client_settings:  # the known results depend on the settings
        context.session.configure(settings)
    return True
