# SPDX-License-Identifier: Apache-2.0
"""`textDocument/completion` and `completionItem/resolve`.

The protocol has no command that requests completions. A client that has one names it in its initialization options, as
`triggerSuggest`: it is called after an item has been inserted whose first placeholder is an empty value.
"""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.handlers.symbols import pack, unpack
from as2fm_lsp.markup import documentation
from roaml.ide.completion import TRIGGERS, CompletionItem, ItemKind, complete, document, plain
from roaml.regex import regex

_KINDS = {
    ItemKind.ELEMENT: types.CompletionItemKind.Class,
    ItemKind.ATTRIBUTE: types.CompletionItemKind.Property,
    ItemKind.VALUE: types.CompletionItemKind.EnumMember,
    ItemKind.VARIABLE: types.CompletionItemKind.Variable,
    ItemKind.FUNCTION: types.CompletionItemKind.Function,
    ItemKind.MEMBER: types.CompletionItemKind.Field,
    ItemKind.EVENT: types.CompletionItemKind.Event,
    ItemKind.STATE: types.CompletionItemKind.Value,
    ItemKind.HANDLE: types.CompletionItemKind.Reference,
    ItemKind.INTERFACE: types.CompletionItemKind.Interface,
    ItemKind.TYPE: types.CompletionItemKind.Struct,
    ItemKind.PLUGIN: types.CompletionItemKind.Module,
    ItemKind.PORT: types.CompletionItemKind.Property,
    ItemKind.FILE: types.CompletionItemKind.File,
    ItemKind.OPERATOR: types.CompletionItemKind.Operator,
    ItemKind.SKELETON: types.CompletionItemKind.Snippet,
}


def register(context: Context) -> None:
    options = types.CompletionOptions(trigger_characters=list(TRIGGERS), resolve_provider=True)

    @context.feature(types.TEXT_DOCUMENT_COMPLETION, options)
    def completion(params: types.CompletionParams) -> types.CompletionList | None:
        on = requested_document(context, params.text_document)
        if on is None:
            return None
        trigger = params.context.trigger_character or "" if params.context else ""
        completions = complete(on.snapshot, on.path, on.offset(params.position), trigger)
        if completions is None:
            return None
        writer = _ItemWriter(context)
        range_ = on.range(completions.span)
        items = [writer.item(item, range_, rank, on.path) for rank, item in enumerate(completions.items)]
        return types.CompletionList(is_incomplete=completions.incomplete, items=items)

    @context.feature(types.COMPLETION_ITEM_RESOLVE)
    def resolve(item: types.CompletionItem) -> types.CompletionItem:
        if isinstance(item.data, list) and len(item.data) == 5:
            path, about = item.data[0], unpack(item.data[1:])
            text = document(context.session.moment().snapshot(path).analysis, about) if about else ""
            if text:
                item.documentation = documentation(text, _ItemWriter(context).formats)
        return item


_EMPTY_VALUE = regex(r"""=["']\$1\b""")
"""Matches a snippet whose first placeholder is the value of an attribute, without a choice of texts. The editor lists
the texts of a choice itself."""


class _ItemWriter:
    """Converts items to the form that the client supports."""

    def __init__(self, context: Context) -> None:
        document = context.client.capabilities.text_document
        asks = document.completion.completion_item if document and document.completion else None
        self.snippets = bool(asks and asks.snippet_support)
        self.tags = bool(asks and asks.tag_support)
        self.formats = asks.documentation_format if asks else None
        self.label_details = bool(asks and asks.label_details_support)
        self.trigger_suggest = context.client.trigger_suggest

    def item(self, item: CompletionItem, range_: types.Range, rank: int, path: str) -> types.CompletionItem:
        new = item.snippet if self.snippets else plain(item.snippet)
        made = types.CompletionItem(
            label=item.label,
            kind=_KINDS[item.kind],
            sort_text=f"{rank:04}",
            text_edit=types.TextEdit(range_, new),
        )
        if self.snippets and "$" in new:
            made.insert_text_format = types.InsertTextFormat.Snippet
            made.insert_text_mode = types.InsertTextMode.AdjustIndentation
            if self.trigger_suggest and _EMPTY_VALUE.search(new):
                made.command = types.Command("Suggest", self.trigger_suggest)
        elif self.snippets:
            made.text_edit = types.TextEdit(range_, plain(new))
        if item.detail and self.label_details and len(item.detail) <= _MAX_LABEL_DETAIL_CHARACTERS:
            made.label_details = types.CompletionItemLabelDetails(description=item.detail)
        elif item.detail:
            made.detail = item.detail
        if item.filter:
            made.filter_text = item.filter
        if item.deprecated and self.tags:
            made.tags = [types.CompletionItemTag.Deprecated]
        if item.about is not None:
            made.data = [path, *pack(item.about)]
        return made


_MAX_LABEL_DETAIL_CHARACTERS = 40
"""The maximum length, in characters, of details beside the label; longer details are shown with the documentation."""
