# SPDX-License-Identifier: Apache-2.0
"""One module for each feature of the editor: convert in, one call, convert out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from as2fm_lsp.handlers import code_action, formatting, semantic_tokens, structure, tags, translate

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


def register(server: Server) -> None:
    """Make all features known to the server."""
    for module in (code_action, formatting, semantic_tokens, structure, tags, translate):
        module.register(server)
