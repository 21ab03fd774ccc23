# SPDX-License-Identifier: Apache-2.0
"""Widths of texts, and lines of limited width.

The widths are those of DejaVu Sans, which is wider than the other common fonts of user interfaces. A text therefore
fits into its box in any of them.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence

from roaml.regex import regex

SMALL, MEDIUM = 12.0, 14.0
"""The sizes of fonts, in pixels. No text is smaller than `SMALL`."""
LINE_HEIGHT = 1.4
"""The distance between two lines of text, as a multiple of the size of the font."""
ELLIPSIS = "…"

# Widths in thousandths of the font size, for the characters from U+0020 to U+007E.
_REGULAR = (
    "318 401 460 838 636 950 780 275 390 390 500 838 318 361 318 337 636 636 636 636 636 636 636 636 636 636 337 337 "
    "838 838 838 531 1000 684 686 698 770 632 575 775 752 295 295 656 557 863 748 787 603 787 695 635 611 732 684 989 "
    "685 611 685 390 337 390 838 500 500 613 635 550 635 615 352 635 634 278 278 579 278 974 634 612 635 635 411 521 "
    "392 634 592 818 592 592 525 636 337 636 838"
)
_BOLD = (
    "348 456 521 838 696 1002 872 306 457 457 523 838 380 415 380 365 696 696 696 696 696 696 696 696 696 696 400 400 "
    "838 838 838 580 1000 774 762 734 830 683 683 821 837 372 372 775 637 995 837 850 733 850 770 720 682 812 774 1103 "
    "771 724 725 457 365 457 838 500 500 675 716 593 716 678 435 716 712 343 343 665 343 1042 712 687 716 716 493 595 "
    "478 712 652 924 645 652 582 712 365 712 838"
)
_WIDTHS = {
    bold: {chr(32 + index): int(width) / 1000 for index, width in enumerate(table.split())}
    for bold, table in ((False, _REGULAR), (True, _BOLD))
}


_PARTS = tuple(
    map(
        regex,
        (
            r"\S+\s*|^\s+",
            r"[^/._,;(){}\[\]=&|:+*-]*[/._,;(){}\[\]=&|:+*-]+\s*|[^/._,;(){}\[\]=&|:+*-]+",
            r"[A-Z]*[^A-Z]+|[A-Z]+",
            r".\s*",
        ),
    )
)
"""Patterns of the parts after which a line may end: a word, a part that ends with punctuation, a part before a capital
letter, a character."""


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """The width of one line of text, in pixels, as `size`."""
    widths = _WIDTHS[bold]
    return size * sum(widths.get(character) or _other_width(character, widths) for character in text)


def _other_width(character: str, widths: Mapping[str, float]) -> float:
    if unicodedata.combining(character):
        return 0
    letter = unicodedata.normalize("NFD", character)[0]
    if letter in widths:
        return widths[letter]  # `ä` is as wide as `a`
    return 1.25 if unicodedata.east_asian_width(character) in "WF" else 1.0


def wrap(text: str, size: float, width: float, *, bold: bool = False, limit: int = 0) -> tuple[str, ...]:
    """The text, split into lines of at most `width` pixels. A line ends after a space or, in a long word, after
    punctuation or before a capital letter. A part that is still too long is cut at any place.

    Args:
        limit: the maximum number of lines, 0 for any number. The last line ends with an ellipsis if the text is longer.
    """
    lines: list[str] = []
    line = ""
    for part in _parts(text, size, width, bold):
        if line and text_width((line + part).rstrip(), size, bold=bold) > width:
            lines.append(line.rstrip())
            line = ""
        line += part
    lines.append(line.rstrip())
    if limit and len(lines) > limit:
        last = lines[limit - 1]
        while last and text_width(last + ELLIPSIS, size, bold=bold) > width:
            last = last[:-1]
        return (*lines[: limit - 1], last.rstrip() + ELLIPSIS)
    return tuple(lines)


def _parts(text: str, size: float, width: float, bold: bool) -> Iterator[str]:
    """The parts between which a line may end."""
    return _split(text, _PARTS, size, width, bold)


def _split(text: str, patterns: Sequence[re.Pattern[str]], size: float, width: float, bold: bool) -> Iterator[str]:
    """The matches of the first pattern. Matches that are too wide are split with the next patterns."""
    for part in patterns[0].findall(text):
        if len(patterns) == 1 or text_width(part.rstrip(), size, bold=bold) <= width:
            yield part
        else:
            yield from _split(part, patterns[1:], size, width, bold)
