# SPDX-License-Identifier: Apache-2.0
"""Names and white space in XML (XML 1.0, productions 3 to 5; Namespaces in XML 1.0, productions 4 and 7)."""

from __future__ import annotations

import re

from roaml.regex import regex

SPACE = " \t\r\n"

SCXML_NAMESPACE = "http://www.w3.org/2005/07/scxml"

_START = (
    "A-Z_a-z\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c\u200d\u2070-\u218f\u2c00-\u2fef"
    "\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
_LOCAL_NAME = f"[{_START}][{_START}.0-9\u00b7\u0300-\u036f\u203f\u2040-]*"


_ASCII_LOCAL_NAME = r"[A-Za-z_][A-Za-z_.0-9-]*"
ASCII_NAME = f"{_ASCII_LOCAL_NAME}(?::{_ASCII_LOCAL_NAME})?"
"""A pattern: a name of ASCII characters, with or without a prefix. It compiles much faster than one for Unicode."""


class _Pattern:
    """A pattern for names, which is tried with ASCII names first. The pattern for Unicode names is compiled on first
    use, because it takes long and most models do not need it."""

    def __init__(self, form: str) -> None:
        self._ascii = regex(form.format(_ASCII_LOCAL_NAME))
        self._all = regex(form.format(_LOCAL_NAME))

    def match(self, text: str) -> re.Match[str] | None:
        return self._ascii.match(text) or (None if text.isascii() else self._all.match(text))


_NAME = _Pattern(r"{0}(?::{0})?\Z")
_LOCAL = _Pattern(r"{0}\Z")
_LEADING = _Pattern(rf"{{0}}(?=[{SPACE}]|\Z)")


def is_name(text: str) -> bool:
    """Whether `text` is a name, with or without a prefix."""
    return _NAME.match(text) is not None


def is_local_name(text: str) -> bool:
    """Whether `text` is a name without prefix."""
    return _LOCAL.match(text) is not None


def leading_local_name(text: str) -> str:
    """The name without a prefix, up to white space, at the beginning of `text`; "" if there is none."""
    match = _LEADING.match(text)
    return match[0] if match else ""
