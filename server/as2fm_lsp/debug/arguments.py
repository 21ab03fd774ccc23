# SPDX-License-Identifier: Apache-2.0
"""The arguments of requests, which may be any JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class RequestError(ValueError):
    """A request cannot be carried out; the message contains the reason."""


class Arguments:
    """The members of a JSON object. Each method reads a member and checks its type."""

    def __init__(self, value: object) -> None:
        self._members: Mapping[str, Any] = value if isinstance(value, dict) else {}

    @property
    def members(self) -> Mapping[str, Any]:
        return self._members

    def text(self, name: str, default: str | None = "") -> str:
        """A string.

        Args:
            default: `None` if the member is required.

        Raises:
            RequestError: the member is not a string, or it is required and missing.
        """
        value = self._members.get(name)
        if value is None and default is not None:
            return default
        if not isinstance(value, str):
            raise RequestError(f"`{name}` must be a string")
        return value

    def number(self, name: str, default: int | None = None) -> int:
        """An integer.

        Args:
            default: `None` if the member is required.

        Raises:
            RequestError: the member is not an integer of at most 53 bits, or it is required and missing.
        """
        value = self._members.get(name)
        if value is None and default is not None:
            return default
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if not isinstance(value, int) or isinstance(value, bool) or abs(value) >= 1 << 53:
            raise RequestError(f"`{name}` must be an integer")
        return value

    def natural(self, name: str, default: int | None = None) -> int:
        """An integer of at least 0. Arguments and errors are those of `number`."""
        value = self.number(name, default)
        if value < 0:
            raise RequestError(f"`{name}` must not be negative")
        return value

    def decimal(self, name: str, default: float) -> float:
        """A number from -1e15 to 1e15.

        Raises:
            RequestError: the member is another value.
        """
        value = self._members.get(name)
        if value is None:
            return default
        if not isinstance(value, (int, float)) or isinstance(value, bool) or not abs(value) <= 1e15:
            raise RequestError(f"`{name}` must be a number")
        return float(value)

    def flag(self, name: str, default: bool = False) -> bool:
        value = self._members.get(name, default)
        if value is None:
            return default
        if not isinstance(value, bool):
            raise RequestError(f"`{name}` must be true or false")
        return value

    def texts(self, name: str) -> list[str]:
        values = self._list(name)
        if not all(isinstance(value, str) for value in values):
            raise RequestError(f"`{name}` must be a list of strings")
        return values

    def objects(self, name: str) -> list[Arguments]:
        values = self._list(name)
        if not all(isinstance(value, dict) for value in values):
            raise RequestError(f"`{name}` must be a list of objects")
        return [Arguments(value) for value in values]

    def object(self, name: str) -> Arguments:
        return Arguments(self._members.get(name))

    def has(self, name: str) -> bool:
        return self._members.get(name) is not None

    def _list(self, name: str) -> list[Any]:
        value = self._members.get(name)
        if value is None:
            return []
        if not isinstance(value, list):
            raise RequestError(f"`{name}` must be a list")
        return value
