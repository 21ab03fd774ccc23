# SPDX-License-Identifier: Apache-2.0
"""Parameters of custom requests, which pygls does not validate."""

from __future__ import annotations

from pygls.exceptions import JsonRpcInvalidParams


def document_uri(params: object) -> str:
    """The URI in `textDocument`.

    Raises:
        JsonRpcInvalidParams: there is no URI.
    """
    return string(getattr(params, "textDocument", None), "uri", "textDocument.uri")


def string(params: object, name: str, shown: str = "") -> str:
    """A parameter that is a string.

    Raises:
        JsonRpcInvalidParams: it is missing, or not a string.
    """
    value = getattr(params, name, None)
    if not isinstance(value, str):
        raise JsonRpcInvalidParams(f"`{shown or name}` must be a string")
    return value


def optional_string(params: object, name: str) -> str:
    """A parameter that is a string; "" if it is missing.

    Raises:
        JsonRpcInvalidParams: it is something else.
    """
    return "" if getattr(params, name, None) is None else string(params, name)


def natural(params: object, name: str) -> int:
    """A parameter that is an integer of at least 0.

    Raises:
        JsonRpcInvalidParams: it is missing, or another value.
    """
    value = getattr(params, name, None)
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise JsonRpcInvalidParams(f"`{name}` must be an integer of at least 0")
    return value


def strings(params: object, name: str) -> tuple[str, ...]:
    """A parameter that is a list of strings; empty if it is missing.

    Raises:
        JsonRpcInvalidParams: it is something else.
    """
    value = getattr(params, name, None)
    if value is None:
        return ()
    if not isinstance(value, (list, tuple)) or not all(isinstance(item, str) for item in value):
        raise JsonRpcInvalidParams(f"`{name}` must be a list of strings")
    return tuple(value)
