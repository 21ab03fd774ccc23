# SPDX-License-Identifier: Apache-2.0
"""One module for each feature of the editor: convert in, one call, convert out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from as2fm_lsp.handlers import (
    about,
    call_hierarchy,
    code_action,
    code_lens,
    completion,
    first_error,
    formatting,
    hover,
    inlay_hint,
    jani_view,
    migrate,
    navigate,
    pictures,
    plain_scxml,
    rename,
    semantic_tokens,
    signature_help,
    structure,
    tags,
    translate,
    type_hierarchy,
    verify,
    workspace_symbol,
)

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


_FEATURES = (
    about,
    call_hierarchy,
    code_action,
    code_lens,
    completion,
    first_error,
    formatting,
    hover,
    inlay_hint,
    jani_view,
    migrate,
    navigate,
    pictures,
    plain_scxml,
    rename,
    semantic_tokens,
    signature_help,
    structure,
    tags,
    translate,
    type_hierarchy,
    verify,
    workspace_symbol,
)


def register(server: Server) -> None:
    """Make all features known to the server."""
    for module in _FEATURES:
        module.register(server)
