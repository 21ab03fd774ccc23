# SPDX-License-Identifier: Apache-2.0
"""The layout of JSON: one member or item per line. A file that is indented by two or four spaces keeps this width.

- An object or list on one line stays on one line if it fits. Several blank lines become one.
- The formatter works on tokens, not on the tree, because JSON may be nested more deeply than functions can recurse.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate, pairwise

from roaml.ide.formatting.layout import FileLayout, Spacing, breaks, new_line
from roaml.record import replace
from roaml.regex import regex
from roaml.text import Span

_TOKEN = regex(r'"(?:[^"\\]|\\.)*"|[\[\]{},:]|[^\s\[\]{},:"]+')
_FIRST_INDENT = regex(r"[\n\r]([ ]+|\t+)\S")
_WIDTHS = (2, 4)


def gaps(text: str, layout: FileLayout) -> Iterator[Spacing]:
    """The new white space before, between and after the tokens of a text without syntax errors."""
    spans = [Span(*match.span()) for match in _TOKEN.finditer(text)]
    if not spans:
        return
    layout = _like(text, layout)
    tokens = [text[span.start : span.end] for span in spans]
    closers = _closers(tokens)
    flat = [0, *accumulate(len(token) + _flat_space(tokens, i) for i, token in enumerate(tokens))]
    spaces = [Span(before.end, after.start) for before, after in pairwise(spans)]
    lines = [0, *accumulate(breaks(text[space.start : space.end]) for space in spaces)]
    yield Spacing(Span(0, spans[0].start), "")
    open_flat: list[bool] = []
    column = 0
    for i, (token, space) in enumerate(zip(tokens, spaces, strict=False)):
        if token in ("{", "["):
            end = closers[i]
            # A comma after the closing bracket must fit as well.
            length = flat[end] - flat[i] + 1 + (tokens[end + 1 : end + 2] == [","])
            fits = lines[end] == lines[i] and column + length <= layout.line_length
            open_flat.append(end == i + 1 or fits or (bool(open_flat) and open_flat[-1]))
        following = tokens[i + 1]
        if following in ("}", "]"):
            is_flat = open_flat.pop()
            white_space = _flat_gap(tokens, i) if is_flat else f"\n{layout.indent(len(open_flat))}"
        elif token in ("{", "[", ",") and not open_flat[-1]:
            white_space = new_line(text[space.start : space.end] if token == "," else "", layout.indent(len(open_flat)))
        else:
            white_space = _flat_gap(tokens, i)
        yield Spacing(space, white_space)
        if white_space.startswith("\n"):
            column = layout.column(len(open_flat))
        else:
            column += len(token) + len(white_space)
    yield Spacing(Span(spans[-1].end, len(text)), "\n")


def _like(text: str, layout: FileLayout) -> FileLayout:
    """`layout` with the indentation width of the file, which is that of the first indented line if it is 2 or 4."""
    first_indent = _FIRST_INDENT.search(text)
    if first_indent is None or len(first_indent[1]) not in _WIDTHS or first_indent[1][0] == "\t":
        return layout
    return replace(layout, width=len(first_indent[1]), tabs=False)


def _closers(tokens: list[str]) -> dict[int, int]:
    """Index of each opening bracket -> index of the matching closing one."""
    closer_of: dict[int, int] = {}
    opened: list[int] = []
    for i, token in enumerate(tokens):
        if token in ("{", "["):
            opened.append(i)
        elif token in ("}", "]"):
            closer_of[opened.pop()] = i
    return closer_of


def _flat_gap(tokens: list[str], i: int) -> str:
    """The white space after token `i` if the enclosing object or list is on one line."""
    return " " * _flat_space(tokens, i)


def _flat_space(tokens: list[str], i: int) -> int:
    following = tokens[i + 1] if i + 1 < len(tokens) else ""
    if tokens[i] == "{":
        return following != "}"
    return tokens[i] in (",", ":") or (following == "}" and tokens[i] != "{")
