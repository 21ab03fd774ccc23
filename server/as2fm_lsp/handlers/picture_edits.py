# SPDX-License-Identifier: Apache-2.0
"""`as2fm/pictureEdit`: the edit of an action on a part of a picture, or the next question to the user."""

from __future__ import annotations

from typing import Any, TypedDict

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, natural, string
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.handlers.workspace_edit import workspace_edit
from roaml.ide.picture_edits import ActionRefusal, PictureAction, UserQuestion, answer

METHOD = "as2fm/pictureEdit"


class EditQuestion(TypedDict):
    """A question to the user: a choice if there are options, otherwise a text, which begins with the proposal."""

    text: str
    options: list[dict[str, str]]
    proposal: str


class PictureEdit(TypedDict):
    """The edit, or the next question to the user, or the reason why neither is possible (`problem`); the others are
    null, or empty."""

    edit: types.WorkspaceEdit | None
    question: EditQuestion | None
    problem: str


def register(context: Context) -> None:
    @context.feature(METHOD)
    def picture_edit(params: Any) -> PictureEdit:
        """`range` is the place of the part, null for the whole file; `answers` are those of the previous questions."""
        document = requested_document(context, types.TextDocumentIdentifier(document_uri(params)))
        name = string(params, "action")
        action = next((action for action in PictureAction if action.value == name), None)
        answers = getattr(params, "answers", None)
        if action is None:
            raise JsonRpcInvalidParams(f"there is no action `{name}`")
        if not isinstance(answers, list) or not all(isinstance(text, str) for text in answers):
            raise JsonRpcInvalidParams("`answers` must be a list of strings")
        place = getattr(params, "range", None)
        range_ = None if place is None else types.Range(_position(place, "start"), _position(place, "end"))
        if document is None:
            return {"edit": None, "question": None, "problem": "The file does not exist any more."}
        span = None if range_ is None else document.span(range_)
        match answer(document.analysis, document.path, span, action, answers):
            case ActionRefusal(reason):
                return {"edit": None, "question": None, "problem": f"{reason[0].upper()}{reason[1:]}."}
            case UserQuestion(text, options, proposal):
                shown = [
                    {"label": option.label, "answer": option.answer, "description": option.description}
                    for option in options
                ]
                return {
                    "edit": None,
                    "question": {"text": text, "options": shown, "proposal": proposal},
                    "problem": "",
                }
            case change:
                return {"edit": workspace_edit(context, document.snapshot, change), "question": None, "problem": ""}


def _position(range_: object, end: str) -> types.Position:
    position = getattr(range_, end, None)
    return types.Position(natural(position, "line"), natural(position, "character"))
