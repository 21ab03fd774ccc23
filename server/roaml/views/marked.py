# SPDX-License-Identifier: Apache-2.0
"""Texts for users as HTML."""

from __future__ import annotations

from html import escape

from roaml.regex import regex

_CODE = regex(r"`([^`]+)`")


def marked(text: str) -> str:
    """A text of a message or a report as HTML. What it has between back-quotes is code."""
    return _CODE.sub(r"<code>\1</code>", escape(text))
