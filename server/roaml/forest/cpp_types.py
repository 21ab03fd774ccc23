# SPDX-License-Identifier: Apache-2.0
"""The C++ types of ports as written in models, and the texts that BehaviorTree.CPP converts to them
(docs/spec/lone-trees.md#literals)."""

from __future__ import annotations

import re

from roaml.libraries.scripts import SCRIPT
from roaml.record import Record
from roaml.regex import regex

STRING, ANY = "string", "any"

_SAME = {
    "int": "int", "int32": "int", "integer": "int", "signed": "int",
    "unsigned": "unsigned", "unsignedint": "unsigned", "uint": "unsigned", "uint32": "unsigned",
    "short": "int16", "longlong": "int64", "long": "int64", "unsignedlong": "uint64", "unsignedshort": "uint16",
    "size": "uint64", "boolean": "bool", "float64": "double", "real": "double", "float32": "float",
    "str": "string", "String": "string", "string_view": "string", "StringView": "string", "char*": "string",
    "Any": "any", "AnyTypeAllowed": "any", "BlackboardEntry": "any", "undefined": "any",
}  # fmt: skip
"""Spelling of a type, without `std::`, `BT::`, `_t` and spaces -> the normal name of the type."""

_RANGES = {
    "int8": (-(2**7), 2**7 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "int": (-(2**31), 2**31 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint8": (0, 2**8 - 1),
    "uint16": (0, 2**16 - 1),
    "unsigned": (0, 2**32 - 1),
    "uint64": (0, 2**64 - 1),
}
INTEGER_TYPES = frozenset(_RANGES)
"""The normal names of the integer types."""
SIMPLE_TYPES = (*_RANGES, "double", "float", "bool", "string", "NodeStatus")
"""The types without templates and namespaces."""
_REALS = ("double", "float", "chrono::milliseconds", "chrono::seconds")
_BOOLS = ("0", "1", "true", "false", "True", "False", "TRUE", "FALSE")
_STATUSES = ("SUCCESS", "FAILURE", "RUNNING", "SKIPPED")

_INTEGER = regex(r"[+-]?[0-9]+")
_REAL = regex(r"[+-]?(?:[0-9]+\.?[0-9]*(?:[eE][+-]?[0-9]+)?|\.[0-9]+(?:[eE][+-]?[0-9]+)?|inf(?:inity)?|nan)", re.I)
_LIST = regex(r"(?:vector|queue|SharedQueue|deque)<(.*)>\Z")
_ALIASES = (
    (regex(r"\b__cxx11::"), ""),
    (regex(r"\bbasic_string<char(?:,char_traits<char>,allocator<char>)?>"), "string"),
    (regex(r"\bchrono::duration<(?:long)+,ratio<1l?,1000l?>>"), "chrono::milliseconds"),
    (regex(r"\bchrono::duration<(?:long)+(?:,ratio<1l?,1l?>)?>"), "chrono::seconds"),
    (regex(r"_<allocator<void>>"), ""),
    (regex(r"([\w:]+)::(?:Const)?(?:SharedPtr|Ptr)\b"), r"shared_ptr<\1>"),
    (regex(r"([A-Za-z]\w*)/(?:msg/)?([A-Za-z]\w*)"), r"\1::msg::\2"),
)
"""Types as compilers and ROS spell them, without `std::` and spaces -> the names that programs use. Editors write what
the compiler says, such as `PoseStamped_<std::allocator<void> >`; people write names."""


def normal(written: str) -> str:
    """The normal name of a type, such as `int` for `int32_t`; `any` for "" and for the types of BehaviorTree.CPP that
    accept any value."""
    name = re.sub(r"\b(?:std|BT)::|\bconst\b|[\s&]", "", written)
    name = re.sub(r"_t\b", "", name)
    for pattern, replacement in () if name.isalnum() else _ALIASES:
        name = pattern.sub(replacement, name)
    match = _LIST.match(name)
    if match:
        return f"vector<{normal(match[1].partition(',')[0])}>"
    return _SAME.get(name, name) or ANY


def element_type(name: str) -> str | None:
    """The type of the elements of a list; `None` if the type is not a list."""
    match = _LIST.match(name)
    return match[1] if match else None


def is_converted(type_name: str) -> bool:
    """Whether BehaviorTree.CPP itself converts texts to a type. For other types, the program must provide a
    function."""
    name = normal(type_name)
    inner = element_type(name)
    return is_converted(inner) if inner is not None else name in (*SIMPLE_TYPES, *_REALS, ANY, SCRIPT)


class Mismatch(Record, frozen=True):
    """Why a text does not fit a type. `ignored` is true if BehaviorTree.CPP reads the beginning of the text and ignores
    the rest. `instead` is a text that fits and was probably intended, or ""."""

    message: str
    ignored: bool = False
    instead: str = ""


def mismatch(type_name: str, text: str) -> Mismatch | None:
    """Why a text does not fit a port of a type; `None` if it fits, or if BehaviorTree.CPP itself does not convert texts
    to this type."""
    name = normal(type_name)
    if text.startswith("json:"):
        return None
    inner = element_type(name)
    if inner is not None:
        return _elements(inner, text)
    text = text.strip()
    if name in _RANGES:
        return _integer(name, text)
    if name in _REALS:
        return _prefix(_REAL, text, "a number")
    if name == "bool" and text not in _BOOLS:
        lower = text.lower()
        return Mismatch("must be `true` or `false`", instead=lower if lower in ("true", "false") else "")
    if name == "NodeStatus" and text not in _STATUSES:
        upper = text.upper()
        known = ", ".join(f"`{status}`" for status in _STATUSES)
        return Mismatch(f"must be one of {known}", instead=upper if upper in _STATUSES else "")
    return None


def _elements(inner: str, text: str) -> Mismatch | None:
    """Why a text does not fit a list; `None` if it does. The elements are separated by semicolons."""
    wrong = (mismatch(inner, item.strip()) for item in text.split(";")) if text.strip() else ()
    first = next(filter(None, wrong), None)
    meant = [item.strip() for item in text.replace(";", ",").split(",")]
    if first is None or "," not in text or any(mismatch(inner, item) for item in meant):
        return first
    instead = ";".join(meant)
    return Mismatch(f"must separate its elements by `;`: write `{instead}`", first.ignored, instead)


def _integer(name: str, text: str) -> Mismatch | None:
    wrong = _prefix(_INTEGER, text, "an integer")
    if wrong is not None:
        return wrong
    low, high = _RANGES[name]
    if len(text) > 25 or not low <= int(text) <= high:
        return Mismatch(
            "must be 0 or greater" if low == 0 and text.startswith("-") else f"must be from {low} to {high}"
        )
    return None


def _prefix(pattern: re.Pattern[str], text: str, noun: str) -> Mismatch | None:
    match = pattern.match(text)
    if match is None:
        return Mismatch(f"must be {noun}")
    if match.end() < len(text):
        return Mismatch(f"must be {noun}; the library reads `{match[0]}` and ignores the rest", True, match[0])
    return None
