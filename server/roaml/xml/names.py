# SPDX-License-Identifier: Apache-2.0
"""What XML calls a name and white space (XML 1.0, productions 3 to 5; Namespaces in XML 1.0, productions 4 and 7)."""

from __future__ import annotations

import re

SPACE = " \t\r\n"

_START = (
    "A-Z_a-z\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c\u200d\u2070-\u218f\u2c00-\u2fef"
    "\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
LOCAL_NAME = f"[{_START}][{_START}.0-9\u00b7\u0300-\u036f\u203f\u2040-]*"
NAME = f"{LOCAL_NAME}(?::{LOCAL_NAME})?"
"""A pattern: a name, with or without a prefix."""

_NAME = re.compile(NAME)
_LOCAL = re.compile(LOCAL_NAME)


def is_name(text: str) -> bool:
    return _NAME.fullmatch(text) is not None


def is_local_name(text: str) -> bool:
    """Whether `text` is a name without prefix."""
    return _LOCAL.fullmatch(text) is not None
