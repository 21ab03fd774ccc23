# SPDX-License-Identifier: Apache-2.0
"""The names of ROS 2 interfaces: which names are valid, and the valid name nearest to an invalid one.

The rules are those of `rosidl`: a package or field is lower_snake_case, a constant UPPER_SNAKE_CASE, a type CamelCase;
no name has two consecutive underscores or one at its end.
"""

from __future__ import annotations

import keyword
import re

from roaml.regex import regex

PACKAGE_NAME = regex(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
FIELD_NAME = PACKAGE_NAME
CONSTANT_NAME = regex(r"[A-Z][A-Z0-9]*(?:_[A-Z0-9]+)*")
TYPE_NAME = regex(r"[A-Z][A-Za-z0-9]*")

_CPP_KEYWORDS = """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl const const_cast constexpr
    continue decltype default delete do double dynamic_cast else enum explicit export extern false float for friend
    goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public
    register reinterpret_cast return short signed sizeof static static_assert static_cast struct switch template this
    thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t while xor
    xor_eq
"""
_KEYWORDS = {**dict.fromkeys(keyword.kwlist, "Python"), **dict.fromkeys(_CPP_KEYWORDS.split(), "C++")}


def keyword_of(name: str) -> str | None:
    """The language in which `name` is a keyword, Python or C++, so that ROS 2 cannot generate code for a field with
    this name; `None` if `name` is not a keyword."""
    return _KEYWORDS.get(name)


def lower_snake(name: str) -> str:
    """The valid field name nearest to `name`; empty if there is none."""
    humps = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)
    words = re.sub(r"[^A-Za-z0-9]+", "_", humps).strip("_").lower()
    return words.lstrip("0123456789_")


def upper_snake(name: str) -> str:
    """The valid constant name nearest to `name`; empty if there is none."""
    return lower_snake(name).upper()
