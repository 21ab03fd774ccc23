# SPDX-License-Identifier: Apache-2.0
"""What XML calls a name and white space (XML 1.0, productions 3 to 5; Namespaces in XML 1.0, productions 4 and 7)."""

from __future__ import annotations

import re

SPACE = " \t\r\n"

_START = (
    "A-Z_a-z\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c\u200d\u2070-\u218f\u2c00-\u2fef"
    "\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
_LOCAL_NAME = f"[{_START}][{_START}.0-9\u00b7\u0300-\u036f\u203f\u2040-]*"
_ASCII_LOCAL_NAME = "[A-Z_a-z][A-Z_a-z.0-9-]*"
NAME = f"{_LOCAL_NAME}(?::{_LOCAL_NAME})?"
"""A pattern: a name, with or without a prefix. It takes many milliseconds to compile."""
ASCII_NAME = f"{_ASCII_LOCAL_NAME}(?::{_ASCII_LOCAL_NAME})?"
"""The same for names in ASCII, quick to compile."""


def is_name(text: str) -> bool:
    """Whether `text` is a name, with or without a prefix."""
    return all(map(is_local_name, text.split(":", 1)))


def is_local_name(text: str) -> bool:
    """Whether `text` is a name without prefix."""
    return re.fullmatch(_ASCII_LOCAL_NAME if text.isascii() else _LOCAL_NAME, text) is not None
