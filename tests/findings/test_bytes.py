# SPDX-License-Identifier: Apache-2.0
"""Files that a case of a rule cannot contain, because cases are UTF-8 without a byte order mark."""

from __future__ import annotations

from pathlib import Path

from roaml import api
from roaml.diagnostics import Severity
from roaml.project.settings import Settings


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    machine = '<ascxml name="Prüfer" version="1.0" initial="a"><state id="a"/></ascxml>'
    (tmp_path / "latin.ascxml").write_bytes(machine.encode("latin-1"))
    (tmp_path / "declared.ascxml").write_bytes(f'<?xml version="1.0" encoding="latin-1"?>{machine}'.encode("latin-1"))
    (tmp_path / "utf16.ascxml").write_bytes(machine.encode("utf-16"))
    (tmp_path / "bom.ascxml").write_bytes(b"\xef\xbb\xbf" + machine.encode("utf-8"))
    diagnostics = [
        d for d in api.check([str(tmp_path)], settings=Settings()).diagnostics if d.code == "undecodable-text"
    ]
    assert [(Path(d.path).name, d.span, d.severity) for d in diagnostics] == [
        ("latin.ascxml", (16, 17), Severity.ERROR)
    ]


def test_encodings_that_are_not_obeyed(tmp_path: Path) -> None:
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
    diagnostics = [
        d for d in api.check([str(tmp_path)], settings=Settings()).diagnostics if d.code == "ignored-encoding"
    ]
    assert {(Path(d.path).stem, d.severity, d.message.rpartition(" ")[2]) for d in diagnostics} == {
        ("utf16_without_mark", Severity.WARNING, "UTF-8"),
        ("latin_with_mark", Severity.WARNING, "UTF-8"),
        ("shifted", Severity.WARNING, "UTF-8"),
    }
    assert {Path(d.path).read_bytes().decode("utf-8-sig")[d.span.start : d.span.end] for d in diagnostics} == {
        "UTF-16",
        "ISO-8859-1",
        "UTF-7",
    }
