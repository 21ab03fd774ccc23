# SPDX-License-Identifier: Apache-2.0
"""Pieces of Markdown, and Markdown for those who cannot show it.

Names may hold anything that a user typed: they are always put so that they cannot change what is around them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

_MOST = 6
"""More names than this are counted, not listed."""

_TICKS = re.compile(r"`+")
_FENCE = re.compile(r"^(`{3,})[^`\n]*\n(.*?)\n\1$", re.MULTILINE | re.DOTALL)
_SPAN = re.compile(r"(`+)( ?)(.+?)\2\1", re.DOTALL)
_LINK = re.compile(r"\[([^\]\n]*)\]\([^)\n]*\)")
_EMPHASIS = re.compile(r"(?<![\\*\w])\*(?=[^\s*])((?:\\.|[^*\\\n])+)(?<!\s)\*(?![*\w])")
_RULE = re.compile(r"^---$", re.MULTILINE)
_ESCAPE = r"\\\1"
_ESCAPED = re.compile(r"\\([\\<*_`\[\]])")


def code(text: str, language: str = "") -> str:
    """A block of code."""
    ticks = "`" * max(3, 1 + max((len(found[0]) for found in _TICKS.finditer(text)), default=0))
    return f"{ticks}{language}\n{text}\n{ticks}"


def name(text: str) -> str:
    """A name in a sentence."""
    text = " ".join(text.split())
    if not text:
        return "` `"
    ticks = "`" * (1 + max((len(found[0]) for found in _TICKS.finditer(text)), default=0))
    space = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{ticks}{space}{text}{space}{ticks}"


def names(found: Iterable[str], most: int = _MOST) -> str:
    """Names with commas, each once; the last of very many are only counted. "" if there are none."""
    different = list(dict.fromkeys(found))
    shown = different[:most] if len(different) > most + 1 else different
    rest = len(different) - len(shown)
    return ", ".join(map(name, shown)) + (f" and {rest} more" if rest else "")


def file(path: str) -> str:
    """The name of a file."""
    shown = path.replace("\\", "/").rpartition("/")[2]
    return f"*{re.sub(r'([*_`<[])', _ESCAPE, shown)}*"


def prose(text: str) -> str:
    """Text that a user wrote, as paragraphs: nothing in it is a tag."""
    paragraphs = re.split(r"\n\s*\n", text.strip())
    return "\n\n".join(" ".join(each.split()) for each in paragraphs).replace("<", r"\<")


def lines(*parts: str) -> str:
    """One below the other; empty ones are left out."""
    return "  \n".join(filter(None, parts))


def paragraphs(*parts: str) -> str:
    """With an empty line between; empty ones are left out."""
    return "\n\n".join(filter(None, parts))


def plain(markdown: str) -> str:
    """The same as text without markup, for clients that show no Markdown."""
    found: list[str] = []
    done = 0
    for block in _FENCE.finditer(markdown):
        found += [_without_marks(markdown[done : block.start()]), block[2]]
        done = block.end()
    return "".join([*found, _without_marks(markdown[done:])]).strip()


def _without_marks(text: str) -> str:
    text = _LINK.sub(r"\1", text.replace("  \n", "\n").replace("**", ""))
    text = _RULE.sub("", _EMPHASIS.sub(r"\1", text))
    text = re.sub(r"\n{3,}", "\n\n", text)
    return _ESCAPED.sub(r"\1", _SPAN.sub(r"\3", text))
