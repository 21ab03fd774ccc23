# SPDX-License-Identifier: Apache-2.0
"""References in XML text (`&lt;`, `&#10;`, ...): functions that resolve and write them, and map positions in a resolved
text to the source.

Only the five predefined entities and character references are supported (XML 1.0, sections 4.1 and 4.6); every other
reference is left unchanged. Declarations in a document type declaration are never expanded.
"""

from __future__ import annotations

import re
import sys

from roaml.regex import regex
from roaml.text import Decoded, Span

REFERENCE = regex(r"&(?:#([0-9]{1,7})|#[xX]([0-9a-fA-F]{1,6})|([A-Za-z_][\w.-]*));")
PREDEFINED = {"lt": "<", "gt": ">", "amp": "&", "quot": '"', "apos": "'"}


def resolve(match: re.Match[str]) -> str:
    """The text of the matched reference; the reference itself if the entity is unknown, or XML does not allow the
    character."""
    decimal, hexadecimal, name = match.groups()
    if name:
        return PREDEFINED.get(name, match[0])
    code = int(decimal) if decimal else int(hexadecimal, 16)
    return chr(code) if is_character(code) else match[0]


FORBIDDEN = regex("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
"""A character that XML 1.0 does not allow (production 2)."""


def is_character(code: int) -> bool:
    """Whether XML 1.0 allows the character with this code point."""
    return code <= sys.maxunicode and not FORBIDDEN.match(chr(code))


def replace_forbidden(text: str) -> str:
    """`text` with U+FFFD for each character that XML does not allow."""
    return text if text.isprintable() else FORBIDDEN.sub("\ufffd", text)


def unescape(raw: str) -> str:
    return REFERENCE.sub(resolve, raw) if "&" in raw else raw


def escape(value: str, quote: str = '"') -> str:
    """`value` with escapes, as the text of an attribute between `quote` characters."""
    value = value.replace("&", "&amp;").replace("<", "&lt;")
    return value.replace('"', "&quot;") if quote == '"' else value.replace("'", "&apos;")


def decoded(text: str, span: Span) -> Decoded:
    """The part of `text` in `span` with its references resolved, and the mapping back to the source."""
    raw = text[span.start : span.end]
    if "&" not in raw:
        return Decoded(raw, span.start)
    parts: list[str] = []
    sources: list[int] = []
    at = 0
    for match in REFERENCE.finditer(raw):
        parts += (raw[at : match.start()], resolve(match))
        sources.extend(range(span.start + at, span.start + match.start()))
        if parts[-1] == match[0]:
            sources.extend(range(span.start + match.start(), span.start + match.end()))
        else:
            sources.append(span.start + match.start())
        at = match.end()
    parts.append(raw[at:])
    sources.extend(range(span.start + at, span.end + 1))
    return Decoded("".join(parts), span.start, tuple(sources))
