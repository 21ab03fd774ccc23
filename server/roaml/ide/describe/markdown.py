# SPDX-License-Identifier: Apache-2.0
"""Building blocks of Markdown, and Markdown as plain text.

Names and comments may contain any text, so they are escaped and cannot affect the text around them. Some editors show
HTML in Markdown, load images and follow links. Therefore no text of a file becomes a tag, an image or a link.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from roaml.regex import regex

_MAX_NAMES = 6
"""The maximum number of names in a list; further names are counted."""

_TICKS = regex(r"`+")
_FENCE = regex(r"^(`{3,})[^`\n]*\n(.*?)\n\1$", re.MULTILINE | re.DOTALL)
_SPAN = regex(r"(?<![\\`])(`+)(?!`)( ?)(.+?)\2(?<!`)\1(?!`)", re.DOTALL)
_LINK = regex(r"\[((?:\\.|[^\]\\\n])*)\]\([^)\n]*\)")
_EMPHASIS = regex(r"(?<![\\*\w])\*(?=[^\s*])((?:\\.|[^*\\\n])+)(?<!\s)\*(?![*\w])")
_RULE = regex(r"^---$", re.MULTILINE)
_NAME_MARKS = regex(r"([\\*_`!\[\]])")
_ESCAPE = r"\\\1"
_ESCAPED = regex(r"\\([\\<*_`#~!\[\]])")
_ENTITY = regex(r"&(?=#?\w+;)")
_ENTITIES = (("&lt;", "<"), ("&amp;", "&"))
_USERS_CODE = regex(r"(?<![\\`])(`+)(?!`)(.+?)(?<!`)\1(?!`)")
_USERS_MARKS = regex(r"\\(?=[!-/:-@\[-`{-~])|`|!(?=\[)|\](?=[(\[:])")
_USERS_BLOCK = regex(r"^(?=#|~~~)")


def code(text: str, language: str = "") -> str:
    """A block of code."""
    ticks = "`" * max(3, 1 + max((len(ticks_in_text[0]) for ticks_in_text in _TICKS.finditer(text)), default=0))
    return f"{ticks}{language}\n{text}\n{ticks}"


def name(text: str) -> str:
    """A name as code in a sentence."""
    text = " ".join(text.split())
    if not text:
        return "` `"
    ticks = "`" * (1 + max((len(ticks_in_text[0]) for ticks_in_text in _TICKS.finditer(text)), default=0))
    space = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{ticks}{space}{text}{space}{ticks}"


def names(texts: Iterable[str], most: int = _MAX_NAMES) -> str:
    """Names with commas, without duplicates; a long list ends with the number of the remaining names. "" if there are
    none."""
    different = list(dict.fromkeys(texts))
    shown = different[:most] if len(different) > most + 1 else different
    rest = len(different) - len(shown)
    return ", ".join(map(name, shown)) + (f" and {rest} more" if rest else "")


def file(path: str) -> str:
    """The name of a file without its folder, in italics."""
    shown = path.replace("\\", "/").rpartition("/")[2]
    return f"*{_without_tags(_NAME_MARKS.sub(_ESCAPE, shown))}*"


def sentence(text: str) -> str:
    """A text with a capital letter."""
    return text[:1].upper() + text[1:]


def prose(text: str) -> str:
    """Text that a user wrote, as paragraphs. Its code and emphasis are kept; its tags, images and links become plain
    text."""
    paragraphs = re.split(r"\n\s*\n", text.strip())
    return "\n\n".join(_tame(" ".join(paragraph.split())) for paragraph in paragraphs)


def _tame(paragraph: str) -> str:
    """A paragraph that a user wrote, with escapes. Escapes would be visible in code, so code that needs them becomes
    plain text."""
    parts: list[str] = []
    text = ""
    done = 0
    for span in _USERS_CODE.finditer(paragraph):
        text += paragraph[done : span.start()]
        if "<" in span[2] or "&" in span[2]:
            text += span[2]
        else:
            parts += (_without_marks_of_users(text), span[0])
            text = ""
        done = span.end()
    parts.append(_without_marks_of_users(text + paragraph[done:]))
    return _USERS_BLOCK.sub(r"\\", _without_tags("".join(parts)))


def _without_marks_of_users(text: str) -> str:
    return _USERS_MARKS.sub(r"\\\g<0>", text)


def _without_tags(text: str) -> str:
    """`text` with `<` as an entity. A backslash would not be enough: not all programs that show Markdown support it
    before `<`."""
    return _ENTITY.sub("&amp;", text).replace("<", "&lt;")


def lines(*parts: str) -> str:
    """The parts as separate lines of one paragraph; empty parts are omitted."""
    return "  \n".join(filter(None, parts))


def paragraphs(*parts: str) -> str:
    """The parts as paragraphs, separated by empty lines; empty parts are omitted."""
    return "\n\n".join(filter(None, parts))


def plain(markdown: str) -> str:
    """A Markdown text without markup, for clients without Markdown."""
    pieces: list[str] = []
    done = 0
    for block in _FENCE.finditer(markdown):
        pieces += [_without_marks(markdown[done : block.start()]), block[2]]
        done = block.end()
    return "".join([*pieces, _without_marks(markdown[done:])]).strip()


def _without_marks(text: str) -> str:
    text = _LINK.sub(r"\1", text.replace("  \n", "\n").replace("**", ""))
    text = _RULE.sub("", _EMPHASIS.sub(r"\1", text))
    text = re.sub(r"\n{3,}", "\n\n", text)
    parts: list[str] = []
    done = 0
    for span in _SPAN.finditer(text):
        parts += (_unescaped(text[done : span.start()]), span[3])
        done = span.end()
    return "".join([*parts, _unescaped(text[done:])])


def _unescaped(text: str) -> str:
    text = _ESCAPED.sub(r"\1", text)
    for written, meant in _ENTITIES:
        text = text.replace(written, meant)
    return text
