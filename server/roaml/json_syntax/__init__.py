# SPDX-License-Identifier: Apache-2.0
"""Tolerant JSON: any text gives a tree in which every value and every name has a position.

This package implements RFC 8259 only; packages that import it define the meaning of the members.
"""

from roaml.json_syntax.brackets import MAX_DEPTH
from roaml.json_syntax.layout import indented
from roaml.json_syntax.parse import parse
from roaml.json_syntax.strings import quote
from roaml.json_syntax.values import (
    JsonArray,
    JsonBool,
    JsonError,
    JsonNull,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
    Member,
    kind,
)

__all__ = [
    "MAX_DEPTH",
    "JsonArray",
    "JsonBool",
    "JsonError",
    "JsonNull",
    "JsonNumber",
    "JsonObject",
    "JsonString",
    "JsonValue",
    "Member",
    "indented",
    "kind",
    "parse",
    "quote",
]
