# SPDX-License-Identifier: Apache-2.0
"""Writes the expectation of a property into the table `[verify.expect]` of a configuration file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

from roaml.model.config_files import CONFIG_FILE
from roaml.regex import regex
from roaml.text import Span, TextEdit
from roaml.toml import Path, Places, TomlError, loads, places

_BARE_KEY = regex(r"[A-Za-z0-9_-]+")


def expectation_edit(path: str, text: str, name: str, expected: str) -> TextEdit | None:
    """The edit that sets the expectation of a property; `None` if the file is not valid TOML, or if no supported edit
    gives the expected result.

    Args:
        path: the configuration file, which need not exist.
        text: the text of the file.
        name: the name of the property.
        expected: the expectation, such as `>= 0.9`.
    """
    prefix: Path = () if os.path.basename(path) == CONFIG_FILE else ("tool", "as2fm")
    try:
        before = loads(text)
    except TomlError:
        return None
    keys = (*prefix, "verify", "expect", name)
    goal = _with_value(before, keys, expected)
    for edit in _candidates(text, places(text), keys, expected):
        after = text[: edit.span.start] + edit.new_text + text[edit.span.end :]
        try:
            if loads(after) == goal:
                return edit
        except TomlError:
            continue
    return None


def _candidates(text: str, known: Places, keys: Path, expected: str) -> Iterator[TextEdit]:
    """Edits for the different forms in which TOML can express the table. The caller uses the first one with the correct
    result."""
    *_, name = keys
    assert isinstance(name, str)
    pair = f"{_key(name)} = {_string(expected)}"
    if keys in known.values:
        yield TextEdit(known.values[keys], _string(expected))
    line_end = "\r\n" if "\r\n" in text else "\n"
    for depth in (1, 2):  # the table `verify.expect`, or its enclosing table
        table, dotted = keys[:-depth], "".join(f"{_key(str(key))}." for key in keys[-depth:-1])
        span = known.values.get(table)
        if span is None:
            continue
        if text[span.start] == "{":
            inside = text[span.start + 1 : span.end - 1].strip()
            at = span.start + 1
            yield TextEdit(Span(at, at), f" {dotted}{pair}{',' if inside else ' '}")
        else:
            at = _line_end(text, span.end)  # after a comment on the same line
            yield TextEdit(Span(at, at), f"{line_end}{dotted}{pair}")
    header = ".".join(_key(str(key)) for key in keys[:-1])
    gap = "" if not text.strip() else line_end if text.endswith("\n") else line_end * 2
    yield TextEdit(Span(len(text), len(text)), f"{gap}[{header}]{line_end}{pair}{line_end}")
    first = min((span.start for table, span in known.values.items() if text[span.start] == "["), default=len(text))
    yield TextEdit(Span(first, first), f"{header}.{pair}{line_end}")


def _line_end(text: str, offset: int) -> int:
    """The offset of the end of the line that contains `offset`, before its line break."""
    end = text.find("\n", offset)
    end = len(text) if end < 0 else end
    return end - 1 if text[end - 1 : end] == "\r" else end


def _with_value(table: Any, keys: Path, value: str) -> Any:
    """A copy of `table` with `value` at `keys`. If `table` is not a table, it is returned unchanged."""
    if not keys:
        return value
    if not isinstance(table, dict):
        return table
    return {**table, keys[0]: _with_value(table.get(keys[0], {}), keys[1:], value)}


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _string(name)


def _string(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'
