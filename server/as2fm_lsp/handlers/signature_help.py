# SPDX-License-Identifier: Apache-2.0
"""`textDocument/signatureHelp`"""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.markup import documentation
from roaml.ide.signature_help import TRIGGERS, SignatureHelp, signature_help


def register(context: Context) -> None:
    @context.feature(types.TEXT_DOCUMENT_SIGNATURE_HELP, types.SignatureHelpOptions(list(TRIGGERS)))
    def help_(params: types.SignatureHelpParams) -> types.SignatureHelp | None:
        on = requested_document(context, params.text_document)
        signature = signature_help(on.analysis, on.path, on.offset(params.position)) if on else None
        return (
            None if signature is None else types.SignatureHelp([_information(context, signature)], 0, signature.active)
        )


def _information(context: Context, signature: SignatureHelp) -> types.SignatureInformation:
    document = context.client.capabilities.text_document
    asks = document.signature_help.signature_information if document and document.signature_help else None
    takes_places = bool(asks and asks.parameter_information and asks.parameter_information.label_offset_support)
    labels = [(start, end) if takes_places else signature.label[start:end] for start, end in signature.parameters]
    return types.SignatureInformation(
        signature.label,
        documentation(signature.documentation, asks.documentation_format if asks else None),
        [types.ParameterInformation(label) for label in labels],
    )
