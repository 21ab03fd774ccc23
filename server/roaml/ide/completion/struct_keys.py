# SPDX-License-Identifier: Apache-2.0
"""Completion of the keys of struct literals: `{'x': 1, 'y': 2}`."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.expr.types import Array, Struct, Type
from roaml.expr.zero import zero_text
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, escaped
from roaml.regex import regex
from roaml.text import Span

_TOKEN = regex(r"""(?P<text>'[^']*'|"[^"]*")|(?P<open>[\[{(])|(?P<close>[\]})])|(?P<sign>[:,])|[^\s'"]""")
_KEY_BEFORE = regex(r"""[{,]\s*(?P<key>['"]?\w*)\Z""", re.ASCII)
_KEY_AFTER = regex(r"""['"]?\w*['"]?(?P<colon>\s*:)?""", re.ASCII)


def struct_keys(text: str, start: int, offset: int, type_: Type | None) -> tuple[Span, list[CompletionItem]] | None:
    """The keys that a struct literal at the caret does not have yet; `None` if the caret is not at a key.

    Args:
        start: the offset at which the expression begins.
        type_: the type of the value of the expression.
    """
    begun = _KEY_BEFORE.search(text, start, offset)
    after = _KEY_AFTER.match(text, offset)
    if begun is None or after is None:
        return None
    path = _open_literals(text[start : begun.start("key")])
    struct = type_
    for key in path[:-1] if path else ():
        if isinstance(struct, Array):
            struct = struct.element
        elif isinstance(struct, Struct):
            struct = struct.member(key[-1]) if key else None
    if not path or not isinstance(struct, Struct) or path[-1] is None:
        return None
    present = set(path[-1])
    end = after.start("colon") if after["colon"] else after.end()
    return Span(begun.start("key"), end), list(_items(struct, present, bool(after["colon"])))


def _open_literals(text: str) -> list[list[str] | None]:
    """The literals that are open at the end of a text, the outermost first: the keys of a struct; `None` for others."""
    path: list[list[str] | None] = []
    last = ""
    for token in _TOKEN.finditer(text):
        if token["open"]:
            path.append([] if token["open"] == "{" else None)
        elif token["close"] and path:
            path.pop()
        elif token["sign"] == ":" and path and path[-1] is not None:
            path[-1].append(last[1:-1])
        last = token["text"] or ""
    return path


def _items(struct: Struct, present: set[str], has_colon: bool) -> Iterator[CompletionItem]:
    for name, member in struct.members:
        if name not in present:
            quoted = f"'{name}'"
            insert = escaped(quoted if has_colon else f"{quoted}: {zero_text(member)}")
            yield CompletionItem(quoted, ItemKind.MEMBER, insert, detail=str(member), rank=Rank.BEST)
