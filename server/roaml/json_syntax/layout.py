# SPDX-License-Identifier: Apache-2.0
"""Compact JSON -> indented JSON, as a stream: only the current nesting depth is kept in memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.regex import regex

_TOKEN = regex(r'"(?:[^"\\]|\\.)*"|[^\[\]{},:"]+|[\[{][\]}]?|[\]},:]')


def indented(chunks: Iterable[str], indent: int) -> Iterator[str]:
    """JSON with one member or item per line and `indent` spaces per level, laid out as
    `json.dumps(indent=...)` does.

    `chunks` are compact JSON without white space between the tokens, split between tokens and not inside empty
    brackets.
    """
    depth = 0
    for chunk in chunks:
        parts: list[str] = []
        for token in _TOKEN.findall(chunk):
            if token in ("[", "{"):
                depth += 1
                parts += (token, "\n", " " * (indent * depth))
            elif token in ("]", "}"):
                depth -= 1
                parts += ("\n", " " * (indent * depth), token)
            elif token == ",":
                parts += (",\n", " " * (indent * depth))
            elif token == ":":
                parts.append(": ")
            else:
                parts.append(token)
        yield "".join(parts)
