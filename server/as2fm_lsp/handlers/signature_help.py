# SPDX-License-Identifier: Apache-2.0
"""`textDocument/signatureHelp`"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from as2fm_lsp.handlers.asked import asked
from as2fm_lsp.markup import documentation
from roaml.ide.signature_help import TRIGGERS, Signature, signature_help

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


def register(server: Server) -> None:
    @server.feature(types.TEXT_DOCUMENT_SIGNATURE_HELP, types.SignatureHelpOptions(list(TRIGGERS)))
    def help_(params: types.SignatureHelpParams) -> types.SignatureHelp | None:
        on = asked(server, params.text_document)
        found = signature_help(on.analysis, on.path, on.offset(params.position)) if on else None
        return None if found is None else types.SignatureHelp([_information(server, found)], 0, found.active)


def _information(server: Server, found: Signature) -> types.SignatureInformation:
    document = server.client_capabilities.text_document
    asks = document.signature_help.signature_information if document and document.signature_help else None
    takes_places = bool(asks and asks.parameter_information and asks.parameter_information.label_offset_support)
    labels = [(start, end) if takes_places else found.label[start:end] for start, end in found.parameters]
    return types.SignatureInformation(
        found.label,
        documentation(found.documentation, asks.documentation_format if asks else None),
        [types.ParameterInformation(label) for label in labels],
    )
