# SPDX-License-Identifier: Apache-2.0
"""Odd cases of single rules, one file `cases_z/<code>.txt` for each rule.

A case is a line `## title` and files as in `fixture`. The carets are all that the rule has to say: where there are none
it is silent. Other rules do not matter, except that none may crash.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fixture import check_text, read_marks, split_cases, split_files
from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.language import HL_SCXML, SYSTEM
from roaml.language.validate import SchemaViolation
from roaml.project.settings import Settings
from roaml.rules import BY_CODE
from roaml.rules.elements import schema_violation
from roaml.rules.rule import FileContext
from roaml.text import SourceFile
from roaml.xml_syntax import parse

FILES = sorted((Path(__file__).parent / "cases_z").glob("*.txt"))


def cases(path: Path) -> list[tuple[str, str]]:
    """Title and text of each case in a file."""
    start, titled = split_cases(path)
    assert not start.strip(), f"{path.name} has text before its first case"
    return titled


CASES = [pytest.param(path.stem, text, id=f"{path.stem}: {title}") for path in FILES for title, text in cases(path)]


@pytest.mark.parametrize(("code", "text"), CASES)
def test_case(code: str, text: str, tmp_path: Path) -> None:
    diagnostics, marks = check_text(tmp_path, text)
    assert not [d.message for d in diagnostics if d.code == "internal-error"]
    found = sorted((place(d, tmp_path), d.span.start, d.code) for d in of_rule(diagnostics, code))
    assert found == sorted((mark.file, mark.start, mark.code) for mark in marks)


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    """Cannot be written as a case, which is UTF-8."""
    machine = '<ascxml name="Prüfer" version="1.0" initial="a"><state id="a"/></ascxml>'
    (tmp_path / "latin.ascxml").write_bytes(machine.encode("latin-1"))
    (tmp_path / "declared.ascxml").write_bytes(f'<?xml version="1.0" encoding="latin-1"?>{machine}'.encode("latin-1"))
    (tmp_path / "utf16.ascxml").write_bytes(machine.encode("utf-16"))
    (tmp_path / "bom.ascxml").write_bytes(b"\xef\xbb\xbf" + machine.encode("utf-8"))
    found = [d for d in api.check([str(tmp_path)], settings=Settings()).diagnostics if d.code == "undecodable-text"]
    assert [(Path(d.path).name, d.span, d.severity) for d in found] == [("latin.ascxml", (16, 17), Severity.ERROR)]


def test_encodings_that_are_not_obeyed(tmp_path: Path) -> None:
    """Cannot be written as a case, which is UTF-8 without a byte order mark."""

    def write(name: str, encoding: str, data_encoding: str, mark: bytes = b"", note: str = "") -> None:
        text = f'<?xml version="1.0" encoding="{encoding}"?><ascxml name="A" version="1.0" initial="a"><!--{note}-->'
        (tmp_path / f"{name}.ascxml").write_bytes(mark + f'{text}<state id="a"/></ascxml>'.encode(data_encoding))

    write("utf16_without_mark", "UTF-16", "utf-8")
    write("latin_with_mark", "ISO-8859-1", "utf-8", b"\xef\xbb\xbf", "é")
    write("ascii_with_mark", "US-ASCII", "utf-8", b"\xef\xbb\xbf")
    write("shifted", "UTF-7", "utf-8")
    write("utf16", "UTF-16", "utf-16")
    write("utf8", "utf8", "utf-8", note="é")
    write("latin", "latin-1", "latin-1", note="é")
    found = [d for d in api.check([str(tmp_path)], settings=Settings()).diagnostics if d.code == "ignored-encoding"]
    assert {(Path(d.path).stem, d.severity, d.message.rpartition(" ")[2]) for d in found} == {
        ("utf16_without_mark", Severity.WARNING, "UTF-8"),
        ("latin_with_mark", Severity.WARNING, "UTF-8"),
        ("shifted", Severity.WARNING, "UTF-8"),
    }
    assert {Path(d.path).read_bytes().decode("utf-8-sig")[d.span.start : d.span.end] for d in found} == {
        "UTF-16",
        "ISO-8859-1",
        "UTF-7",
    }


def test_schema_violations() -> None:
    """Today the tables of the grammars explain all that the schemas forbid; what they do not explain is passed on."""
    document = parse("<roaml><parameters/></roaml>")
    assert document.root is not None
    violation = SchemaViolation(document.root.elements[0], "something else")
    context = FileContext(SourceFile("main.xml", document.text), (), document, SYSTEM, (violation,))
    [finding] = schema_violation.check(context)
    assert (finding.code, finding.span) == ("schema-violation", (8, 18))
    assert "something else" in finding.message


def test_schema_violations_that_other_rules_explain() -> None:
    document = parse('<ascxml><state><transition><target id="a"/><send/></transition></state></ascxml>')
    assert document.root is not None
    transition = document.root.elements[0].elements[0]
    violation = SchemaViolation(transition, "Unexpected child with tag 'send' at position 2.")
    context = FileContext(SourceFile("a.ascxml", document.text), (), document, HL_SCXML, (violation,))
    assert not list(schema_violation.check(context))


def test_marks_are_of_the_rule_of_their_file() -> None:
    for path in FILES:
        for title, text in cases(path):
            marks = [mark for name, content in split_files(text).items() for mark in read_marks(name, content)[1]]
            assert {mark.code for mark in marks} <= {path.stem}, title


def test_every_file_shows_the_rule_at_work() -> None:
    for path in FILES:
        assert f"^ {path.stem}\n" in path.read_text(encoding="utf-8"), path.name


def of_rule(diagnostics: list[Diagnostic], code: str) -> list[Diagnostic]:
    """The findings of a rule that are more than hints, unless the rule only gives hints."""
    least = min(Severity.INFORMATION, BY_CODE[code].severity)
    return [d for d in diagnostics if d.code == code and d.severity >= least]


def place(diagnostic: Diagnostic, folder: Path) -> str:
    return Path(diagnostic.path).relative_to(folder).as_posix()
