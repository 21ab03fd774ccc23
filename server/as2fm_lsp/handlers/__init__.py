# SPDX-License-Identifier: Apache-2.0
"""One module for each editor feature: convert the input, make one call, convert the output."""

from __future__ import annotations

from types import ModuleType

from as2fm_lsp.context import Context
from as2fm_lsp.handlers import (
    call_hierarchy,
    code_action,
    code_lens,
    completion,
    configuration,
    coverage,
    document_kind,
    expectation,
    experiment,
    first_error,
    formatting,
    hover,
    inlay_hint,
    jani_view,
    migrate,
    mocks,
    navigate,
    new_property,
    parting,
    picture_edits,
    pictures,
    plain_scxml,
    rename,
    results,
    semantic_tokens,
    signature_help,
    structure,
    tags,
    text_document,
    translate,
    type_hierarchy,
    verify,
    workspace,
    workspace_symbol,
)

_FEATURES = [value for value in globals().values() if isinstance(value, ModuleType) and hasattr(value, "register")]
"""The modules of all features: those that are imported above."""


def register(context: Context) -> None:
    """Register all features."""
    for module in _FEATURES:
        module.register(context)
