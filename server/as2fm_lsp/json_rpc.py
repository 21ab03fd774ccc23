# SPDX-License-Identifier: Apache-2.0
"""Responses to invalid messages."""

from __future__ import annotations

from typing import Any

from pygls.exceptions import JsonRpcException

from as2fm_lsp.inbox import is_id

VERSION = "2.0"


def is_answered(message: object) -> bool:
    """Whether an invalid message is answered: notifications and responses are not."""
    return not isinstance(message, dict) or ("id" in message) == ("method" in message)


def error_response(message: object, error: JsonRpcException) -> dict[str, Any]:
    """The response to an invalid message; its id is null if the message has no valid id."""
    id_ = message.get("id") if isinstance(message, dict) else None
    body = {"code": error.code, "message": error.message}
    return {"jsonrpc": VERSION, "id": id_ if is_id(id_) else None, "error": body}
