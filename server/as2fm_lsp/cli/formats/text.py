# SPDX-License-Identifier: Apache-2.0
"""The format for terminals: the position, the message, and the line with the range underlined."""

from __future__ import annotations

import unicodedata

from as2fm_lsp.cli.formats.report import CheckReport, Entry
from roaml.diagnostics import Severity

_COLORS = {Severity.ERROR: "31", Severity.WARNING: "33", Severity.INFORMATION: "36", Severity.HINT: "34"}
_MAX_COLUMNS = 160


def render(report: CheckReport) -> str:
    paint = _paint if report.color else _plain
    blocks = [_block(entry, paint) for entry in report.entries]
    end = f"{summary(report)}\n" if report.has_summary else ""
    return "".join(block + "\n" for block in blocks) + end


def summary(report: CheckReport) -> str:
    """The number of diagnostics of each severity, and of files."""
    counts = dict.fromkeys(sorted(Severity, reverse=True), 0)
    for entry in report.entries:
        counts[entry.diagnostic.severity] += 1
    plural = {Severity.INFORMATION: "information"}
    parts = [
        f"{count} {plural.get(severity, severity.label + ('' if count == 1 else 's'))}"
        for severity, count in counts.items()
        if count
    ]
    checked = report.checked - report.ignored
    files = [f"{_files(checked)} checked"] if checked or not report.ignored else []
    if report.ignored:
        files.append(f"{_files(report.ignored)} ignored (plain SCXML)")
    found = f": {', '.join(parts) or 'no diagnostics'}" if parts or checked or not report.ignored else ""
    return ", ".join(files) + found


def _files(count: int) -> str:
    return f"{count} {'file' if count == 1 else 'files'}"


def _paint(text: str, color: str) -> str:
    return f"\033[{color}m{text}\033[0m"


def _plain(text: str, _: str) -> str:
    return text


def _block(entry: Entry, paint) -> str:  # type: ignore[no-untyped-def]
    place, color = entry.place, _COLORS[entry.diagnostic.severity]
    where = paint(_visible(f"{entry.file}:{place.line}:{place.column}"), "1")
    head = f"{where}: {paint(entry.severity, color)}: {_visible(entry.message)} {paint(f'[{entry.code}]', '2')}"
    related = [_visible(f"      {r.file}:{r.place.line}:{r.place.column}: {r.message}") for r in entry.related]
    return "\n".join((head, *_excerpt(entry, paint, color), *related))


def _excerpt(entry: Entry, paint, color: str) -> list[str]:  # type: ignore[no-untyped-def]
    """The first line of the range, with a caret below each of its characters that are in the range."""
    place, line = entry.place, entry.line
    start = place.column - 1
    end = place.end_column - 1 if place.end_line == place.line else line.end - line.start
    cut = start - 40 if start > _MAX_COLUMNS - 40 else 0
    text = _visible(entry.source.text[line.start + cut : min(line.end, line.start + cut + _MAX_COLUMNS)])
    if cut:
        text, start, end = f"…{text[1:]}", start - cut, end - cut
    # Tabs are kept in the line of carets, so that each caret is below its character.
    margin = "".join("\t" if character == "\t" else " " * _columns(character) for character in text[:start])
    carets = "^" * max(1, sum(map(_columns, text[start:end])))
    return [f"{place.line:5} | {text}", f"{'':5} | {margin}{paint(carets, color)}"]


def _visible(text: str) -> str:
    """Replace control characters, which would move the terminal's cursor."""
    return "".join(c if c == "\t" or c.isprintable() else "\ufffd" for c in text)


def _columns(character: str) -> int:
    """The width of a character in a terminal, in columns."""
    if unicodedata.category(character) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in ("W", "F") else 1
