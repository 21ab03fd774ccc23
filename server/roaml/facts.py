# SPDX-License-Identifier: Apache-2.0
"""What a finding is about, as data.

Messages are for people. A fix that needs to know more than the place of a finding reads its facts, never its message.
A rule with such a fix has a frozen dataclass of facts, named in its `Rule`. The fields are strings, integers, booleans,
enums, tuples of one of these, or one of these or None.

Facts travel through LSP as JSON. What a client sends back may be anything: `facts_from_json` validates it.
"""

from __future__ import annotations

import enum
import types
import typing
from dataclasses import fields
from typing import Any, TypeVar

T = TypeVar("T", bound="Facts")


class Facts:
    """The base of the facts of all rules."""

    __slots__ = ()


def facts_to_json(facts: Facts) -> dict[str, Any]:
    """The fields of facts; an enum is written as its name."""
    return {name: _to_json(getattr(facts, name)) for name in _hints(type(facts))}


def facts_from_json(type_: type[T], value: object) -> T | None:
    """The facts that `facts_to_json` wrote as `value`; None if it did not write it."""
    hints = _hints(type_)
    if not isinstance(value, dict) or value.keys() != hints.keys():
        return None
    try:
        return type_(**{name: _from_json(hint, value[name]) for name, hint in hints.items()})
    except _MismatchError:
        return None


class _MismatchError(Exception):
    """A value is not of the type of its field."""


def _hints(type_: Any) -> dict[str, Any]:
    """Name -> type of each field of a dataclass."""
    hints = typing.get_type_hints(type_)
    return {field.name: hints[field.name] for field in fields(type_)}


def _to_json(value: object) -> object:
    if isinstance(value, enum.Enum):
        return value.name
    return [_to_json(item) for item in value] if isinstance(value, tuple) else value


def _from_json(hint: Any, value: object) -> object:
    if isinstance(hint, types.UnionType):
        [other] = set(typing.get_args(hint)) - {types.NoneType}
        return None if value is None else _from_json(other, value)
    if typing.get_origin(hint) is tuple:
        if isinstance(value, list):
            return tuple(_from_json(typing.get_args(hint)[0], item) for item in value)
    elif issubclass(hint, enum.Enum):
        if isinstance(value, str) and value in hint.__members__:
            return hint[value]
    elif type(value) is hint:
        return value
    raise _MismatchError
