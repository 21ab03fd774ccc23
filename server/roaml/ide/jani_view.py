# SPDX-License-Identifier: Apache-2.0
"""A readable view of a JANI model: indented, with an outline. The file, which a translator has written in a compact
form, is not changed."""

from __future__ import annotations

from roaml.ide.formatting.json import gaps
from roaml.ide.formatting.layout import FileLayout, edits
from roaml.ide.navigation.document_symbol import DocumentSymbol
from roaml.ide.navigation.jani_symbols import jani_symbols
from roaml.json_syntax import parse
from roaml.record import Record
from roaml.text import apply_edits

_LAYOUT = FileLayout(width=2)


class JaniView(Record, frozen=True):
    """The text of a view, and its outline with positions in this text."""

    text: str
    symbols: tuple[DocumentSymbol, ...]


def jani_view(text: str) -> JaniView:
    """The view of a JANI file. Each member or item has its own line, but an object or list that is on one line in the
    file and fits stays on one line.

    Args:
        text: the text of the file; text with syntax errors is not changed.
    """
    value, findings = parse(text)
    if any(finding.code == "json-syntax" for finding in findings):
        return JaniView(text, tuple(jani_symbols(value)))
    laid_out = apply_edits(text, tuple(edits(text, gaps(text, _LAYOUT))))
    return JaniView(laid_out, tuple(jani_symbols(parse(laid_out)[0])))
