# SPDX-License-Identifier: Apache-2.0
"""Answers to messages that are not understood."""

from __future__ import annotations

from typing import Any

from pygls.exceptions import JsonRpcException

from as2fm_lsp.inbox import is_id

VERSION = "2.0"


def is_answered(message: object) -> bool:
    """Whether a message that is not understood is answered: notifications and answers are not."""
    return not isinstance(message, dict) or ("id" in message) == ("method" in message)


def error_response(message: object, error: JsonRpcException) -> dict[str, Any]:
    """The answer to a message that is not understood; its id is null where the message has none that could be used."""
    id_ = message.get("id") if isinstance(message, dict) else None
    body = {"code": error.code, "message": error.message}
    return {"jsonrpc": VERSION, "id": id_ if is_id(id_) else None, "error": body}
