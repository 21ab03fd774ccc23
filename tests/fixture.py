# SPDX-License-Identifier: Apache-2.0
"""Test input as one string: several files, with expectations below their lines.

    -- main.xml --
    <roaml>…</roaml>
    -- node.ascxml --
    <ascxml …>

Text before the first `-- path --` is one file, whose name its root element suggests. A line of carets states what is
expected of exactly the characters above them, and is removed before anything reads the file:

        <asign location="x" expr="1" />
         ^^^^^ unknown-element

A `.` in place of the carets marks an empty span. A span of several lines has two marks:

        "type": {
                ^ json-schema begins
        },
        ^ json-schema ends

A file of cases (`tests/rules/cases`) has several inputs of this form, each below a line `## title`; see `read_cases`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from roaml.model.kinds import FileKind, kind_of

_FILE = re.compile(r"^-- (\S+) --[ \t]*\n", re.MULTILINE)
_TITLE = re.compile(r"^## (.+)\n", re.MULTILINE)
_FIX_ADDS = re.compile(r"fix adds: ([a-z0-9, -]+)\n")
_MARK = re.compile(r"^([ \t]*)(\^+|\.)[ \t]+([a-z][a-z0-9-]*)(?: (begins|ends))?[ \t]*$")

_NAMES = {
    FileKind.SYSTEM: "main.xml",
    FileKind.TREE: "tree.xml",
    FileKind.STRUCTS: "types.xml",
    FileKind.PROPERTIES: "properties.jani",
    FileKind.XML_PROPERTIES: "properties.xml",
}


@dataclass(frozen=True, order=True)
class Mark:
    """An expected finding: `code` is expected at these characters."""

    file: str
    start: int
    end: int
    code: str


@dataclass(frozen=True)
class Case:
    """One case of a file of cases.

    Attributes:
        subject: the name of its file, without `.txt`: the code of a rule, or what the cases of `one_report` are about.
        title: what the case shows.
        text: its files, as one input.
        fix_adds: the codes of the errors that a preferred fix may bring to light.
    """

    subject: str
    title: str
    text: str
    fix_adds: frozenset[str] = frozenset()

    def marks(self) -> list[Mark]:
        return [mark for name, text in split_files(self.text).items() for mark in read_marks(name, text)[1]]


def read_cases(path: Path) -> list[Case]:
    """The cases of a file.

    The files before the first title belong to each case that names its files or has none of its own; a case replaces
    those of them whose names it uses. A line `fix adds: CODE, …` below the title names the errors that preferred fixes
    of the case may bring to light; they may add no others.
    """
    common, *parts = _TITLE.split(path.read_text(encoding="utf-8"))
    cases = []
    for title, text in zip(parts[::2], parts[1::2], strict=True):
        declared = _FIX_ADDS.match(text)
        files = text[declared.end() :] if declared else text
        is_whole = files.strip() and not files.startswith("-- ")
        codes = frozenset(declared[1].split(", ")) if declared else frozenset()
        cases.append(Case(path.stem, title, files if is_whole else common + files, codes))
    return cases


def split_files(text: str) -> dict[str, str]:
    """File name -> text, with the expectations still in it. Of files of one name the last is used."""
    parts = _FILE.split(text)
    files = dict(zip(parts[1::2], parts[2::2], strict=True))
    if parts[0].strip():
        files = {guess_name(parts[0]): parts[0], **files}
    return files


def guess_name(text: str) -> str:
    if text.lstrip().startswith("{"):
        return "properties.jani"
    return _NAMES.get(kind_of("x.ascxml", text), "machine.ascxml")


def read_marks(name: str, text: str) -> tuple[str, list[Mark]]:
    """A file's text without its lines of carets, and what they expect."""
    lines: list[str] = []
    marks: list[Mark] = []
    begun: dict[str, int] = {}
    for line in text.splitlines(keepends=True):
        match = _MARK.match(line.rstrip("\r\n"))
        if match is None or not lines:
            lines.append(line)
            continue
        space, carets, code, part = match.groups()
        start = sum(map(len, lines[:-1])) + len(space)
        end = start if carets == "." else start + len(carets)
        if part == "begins":
            begun[code] = start
        else:
            marks.append(Mark(name, begun.pop(code) if part == "ends" else start, end, code))
    assert not begun, f"{name}: no end is marked of {', '.join(begun)}"
    return "".join(lines), marks


def write_files(folder: Path, text: str) -> list[Mark]:
    """Write the files of `text` into `folder`; what is expected of them."""
    expected: list[Mark] = []
    for name, content in split_files(text).items():
        clean, marks = read_marks(name, content)
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(clean, encoding="utf-8", newline="")
        expected += marks
    return expected
