# SPDX-License-Identifier: Apache-2.0
"""`textDocument/semanticTokens`: the tokens of a whole file, their changes since the last answer, and the tokens
of a range."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from functools import cache

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import RequestedDocument, requested_document
from roaml.ide.semantic_tokens import Modifier, SemanticToken, TokenKind, semantic_tokens

_TYPES = {
    TokenKind.STRUCTURE_TAG: types.SemanticTokenTypes.Keyword,
    TokenKind.STATE_TAG: types.SemanticTokenTypes.Class,
    TokenKind.TRANSITION_TAG: types.SemanticTokenTypes.Event,
    TokenKind.ROS_TAG: types.SemanticTokenTypes.Interface,
    TokenKind.BT_TAG: types.SemanticTokenTypes.Macro,
    TokenKind.CONTROL_TAG: types.SemanticTokenTypes.Keyword,
    TokenKind.DECORATOR_TAG: types.SemanticTokenTypes.Decorator,
    TokenKind.LEAF_TAG: types.SemanticTokenTypes.Function,
    TokenKind.SUBTREE_TAG: types.SemanticTokenTypes.Namespace,
    TokenKind.ATTRIBUTE: types.SemanticTokenTypes.Property,
    TokenKind.STATE: types.SemanticTokenTypes.Class,
    TokenKind.EVENT: types.SemanticTokenTypes.Event,
    TokenKind.HANDLE: types.SemanticTokenTypes.Interface,
    TokenKind.PORT: types.SemanticTokenTypes.Parameter,
    TokenKind.MEMBER: types.SemanticTokenTypes.Property,
    TokenKind.PLUGIN: types.SemanticTokenTypes.Function,
    TokenKind.TREE: types.SemanticTokenTypes.Namespace,
    TokenKind.TYPE: types.SemanticTokenTypes.Type,
    TokenKind.VARIABLE: types.SemanticTokenTypes.Variable,
    TokenKind.EVENT_VARIABLE: types.SemanticTokenTypes.Parameter,
    TokenKind.CONSTANT: types.SemanticTokenTypes.EnumMember,
    TokenKind.LIBRARY: types.SemanticTokenTypes.Namespace,
    TokenKind.FUNCTION: types.SemanticTokenTypes.Function,
    TokenKind.NUMBER: types.SemanticTokenTypes.Number,
    TokenKind.STRING: types.SemanticTokenTypes.String,
    TokenKind.LITERAL: types.SemanticTokenTypes.Keyword,
    TokenKind.OPERATOR: types.SemanticTokenTypes.Operator,
}
_MODIFIERS = {
    Modifier.DECLARATION: types.SemanticTokenModifiers.Declaration,
    Modifier.DEPRECATED: types.SemanticTokenModifiers.Deprecated,
}
LEGEND = types.SemanticTokensLegend(
    [str(type_.value) for type_ in dict.fromkeys(_TYPES.values())],
    [str(modifier.value) for modifier in _MODIFIERS.values()],
)
_TYPE_NUMBERS = {kind: LEGEND.token_types.index(type_.value) for kind, type_ in _TYPES.items()}
_BITS = {modifier: 1 << number for number, modifier in enumerate(_MODIFIERS)}

_MAX_REMEMBERED_FILES = 64
"""The maximum number of files for which the last answer is stored, so that the next answer contains only the
changes."""


def register(context: Context) -> None:
    last: OrderedDict[str, types.SemanticTokens] = OrderedDict()
    answers = 0

    def answer(file: RequestedDocument) -> types.SemanticTokens:
        nonlocal answers
        answers += 1
        tokens = types.SemanticTokens(encoded(file, semantic_tokens(file.analysis, file.path)), str(answers))
        last[file.path] = tokens
        last.move_to_end(file.path)
        if len(last) > _MAX_REMEMBERED_FILES:
            last.popitem(last=False)
        return tokens

    @context.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, LEGEND)
    def full(params: types.SemanticTokensParams) -> types.SemanticTokens:
        file = requested_document(context, params.text_document)
        return answer(file) if file else types.SemanticTokens([])

    @context.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL_DELTA)
    def delta(params: types.SemanticTokensDeltaParams) -> types.SemanticTokens | types.SemanticTokensDelta:
        file = requested_document(context, params.text_document)
        if file is None:
            return types.SemanticTokens([])
        before = last.get(file.path)
        after = answer(file)
        if before is None or before.result_id != params.previous_result_id:
            return after
        return types.SemanticTokensDelta(changes(before.data, after.data), after.result_id)

    @context.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE)
    def range_(params: types.SemanticTokensRangeParams) -> types.SemanticTokens:
        file = requested_document(context, params.text_document)
        if file is None:
            return types.SemanticTokens([])
        return types.SemanticTokens(encoded(file, semantic_tokens(file.analysis, file.path, file.span(params.range))))


def encoded(file: RequestedDocument, tokens: Sequence[SemanticToken]) -> list[int]:
    """The tokens in the encoding of the protocol: five numbers for each token, with its position relative to the
    previous one."""
    data: list[int] = []
    line = character = 0
    columns = file.convert.columns(file.source, (token.span for token in tokens))
    for token, (row, start, end) in zip(tokens, columns, strict=True):
        if row != line:
            character = 0
        data += (row - line, start - character, end - start, _TYPE_NUMBERS[token.kind], _bits(token.modifiers))
        line, character = row, start
    return data


@cache
def _bits(modifiers: frozenset[Modifier]) -> int:
    return sum(_BITS[modifier] for modifier in modifiers)


def changes(before: Sequence[int], after: Sequence[int]) -> list[types.SemanticTokensEdit]:
    """The edits that change `before` to `after`: at most one."""
    least = min(len(before), len(after))
    head = next((i for i in range(least) if before[i] != after[i]), least)
    least -= head
    tail = next((i for i in range(least) if before[-1 - i] != after[-1 - i]), least)
    if head == len(before) == len(after):
        return []
    stretch = list(after[head : len(after) - tail])
    return [types.SemanticTokensEdit(head, len(before) - tail - head, stretch)]
