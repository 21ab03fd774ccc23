# SPDX-License-Identifier: Apache-2.0
"""The facts of a finding: the data that describes it.

Messages are for people. A fix that needs more than the place of a finding reads the facts, never the message. A rule
that offers this kind of fix defines its facts as a frozen record, which its `Rule` names. The fields are strings,
integers, Booleans, enums, tuples of one of these, or optional values of one of these.

Facts are sent through LSP as JSON. A client may send back any JSON: `facts_from_json` validates it.
"""

from __future__ import annotations

import enum
import types
import typing
from typing import Any, TypeVar

from roaml.record import Record

T = TypeVar("T", bound="Facts")


class Facts(Record, frozen=True):
    """The base class of the facts of all rules."""


def facts_to_json(facts: Facts) -> dict[str, Any]:
    """The fields of facts as JSON; a member of an enum becomes its name."""
    return {name: _to_json(getattr(facts, name)) for name in _hints(type(facts))}


def facts_from_json(type_: type[T], value: object) -> T | None:
    """The facts in JSON that `facts_to_json` returned; `None` if names or types in the JSON do not match `type_`."""
    hints = _hints(type_)
    if not isinstance(value, dict) or value.keys() != hints.keys():
        return None
    try:
        return type_(**{name: _from_json(hint, value[name]) for name, hint in hints.items()})
    except _MismatchError:
        return None


class _MismatchError(Exception):
    """Raised for a value that does not match the type of its field; never leaves this module."""


def _hints(type_: Any) -> dict[str, Any]:
    """The types of the fields of a record, by their names."""
    hints = typing.get_type_hints(type_)
    return {name: hints[name] for name in type_.__struct_fields__}


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
