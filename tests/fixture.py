# SPDX-License-Identifier: Apache-2.0
"""Test input as one string: several files, with expectations beside the lines.

    -- main.xml --
    <roaml>…</roaml>
    -- node.ascxml --
    <ascxml …>

Text before the first `-- path --` is one file, whose name its root element suggests. A line of carets below a line says
what is expected of the characters above them, and is removed before anything reads the file:

        <asign location="x" expr="1" />
         ^^^^^ unknown-element
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.model.kinds import FileKind, kind_of
from roaml.project.settings import Settings

_FILE = re.compile(r"^-- (\S+) --[ \t]*\n", re.MULTILINE)
_TITLE = re.compile(r"^## (.+)\n", re.MULTILINE)
_MARK = re.compile(r"^([ \t]*)(\^+)[ \t]+([a-z][a-z0-9-]*)[ \t]*$")

_NAMES = {
    FileKind.SYSTEM: "main.xml",
    FileKind.TREE: "tree.xml",
    FileKind.STRUCTS: "types.xml",
    FileKind.PROPERTIES: "properties.jani",
}


@dataclass(frozen=True)
class Mark:
    """`code` is expected at these characters."""

    file: str
    start: int
    end: int
    code: str


def split_files(text: str) -> dict[str, str]:
    """File name -> text, with the expectations still in it."""
    parts = _FILE.split(text)
    files = dict(zip(parts[1::2], parts[2::2], strict=True))
    if parts[0].strip():
        files = {guess_name(parts[0]): parts[0], **files}
    return files


def split_cases(path: Path) -> tuple[str, list[tuple[str, str]]]:
    """What stands before the first line `## title`; title and text of each case."""
    start, *parts = _TITLE.split(path.read_text(encoding="utf-8"))
    return start, list(zip(parts[::2], parts[1::2], strict=True))


def guess_name(text: str) -> str:
    if text.lstrip().startswith("{"):
        return "properties.jani"
    return _NAMES.get(kind_of("x.ascxml", text), "machine.ascxml")


def read_marks(name: str, text: str) -> tuple[str, list[Mark]]:
    """A file's text without its lines of carets, and what they expect."""
    lines: list[str] = []
    marks: list[Mark] = []
    for line in text.splitlines(keepends=True):
        match = _MARK.match(line.rstrip("\r\n"))
        if match is None or not lines:
            lines.append(line)
            continue
        start = sum(map(len, lines[:-1])) + len(match[1])
        marks.append(Mark(name, start, start + len(match[2]), match[3]))
    return "".join(lines), marks


def check_text(folder: Path, text: str, settings: Settings | None = None) -> tuple[list[Diagnostic], list[Mark]]:
    """Write the files of `text` into `folder` and check them all as a folder."""
    marks: list[Mark] = []
    for name, content in split_files(text).items():
        clean, expected = read_marks(name, content)
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(clean, encoding="utf-8", newline="")
        marks += expected
    result = api.check([str(folder)], settings=settings or Settings())
    return list(result.diagnostics), marks
