# SPDX-License-Identifier: Apache-2.0
"""The editor and the command line report the same findings: for every model, every planted error, and after each error
is fixed."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TypeAlias

import pytest
from client import PULLS, Client, connect
from lsprotocol import types

import conformance
from as2fm_lsp.cli.main import run

Row: TypeAlias = tuple[str, int, int, int, int, str, str, str]
"""The file relative to the folder, the place counted from 1, severity, code and message."""

SEVERITIES = {1: "error", 2: "warning", 3: "information", 4: "hint"}
FOLDERS = tuple(dict.fromkeys(path.parent for path in conformance.systems()))


async def by_editor(client: Client, folder: Path) -> set[Row]:
    """The diagnostics of all files of a folder."""
    diagnostics_of = await client.pull_all()
    return {row(path, folder, diagnostic) for path, diagnostics in diagnostics_of.items() for diagnostic in diagnostics}


def row(path: Path, folder: Path, d: types.Diagnostic) -> Row:
    start, end = d.range.start, d.range.end
    place = (start.line + 1, start.character + 1, end.line + 1, end.character + 1)
    assert d.severity is not None
    return (os.path.relpath(path, folder), *place, SEVERITIES[d.severity.value], str(d.code), d.message)


def by_command_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> set[Row]:
    """The diagnostics of the command line for the same files."""
    status = run(["--check", "--format", "json", "--ros-path", str(conformance.INTERFACES), str(folder)])
    rows = json.loads(capsys.readouterr().out)
    assert status == any(r["severity"] == "error" for r in rows)
    keys = ("line", "column", "end_line", "end_column", "severity", "code", "message")
    return {(os.path.relpath(r["file"], folder), *(r[key] for key in keys)) for r in rows}


async def test_models(capsys: pytest.CaptureFixture[str]) -> None:
    async with connect(capabilities=PULLS, settings={"rosPath": [str(conformance.INTERFACES)]}) as client:
        for folder in FOLDERS:
            client.folders(added=[folder])
            assert await by_editor(client, folder) == by_command_line(folder, capsys), folder
            client.folders(removed=[folder])


async def test_mistakes_and_their_mending(capsys: pytest.CaptureFixture[str]) -> None:
    async with connect(capabilities=PULLS, settings={"rosPath": [str(conformance.INTERFACES)]}) as client:
        for mistake in conformance.mistakes():
            folder, base = mistake.folder, mistake.base.parent
            client.folders(added=[folder])
            assert await by_editor(client, folder) == by_command_line(folder, capsys), mistake.id
            restored = restore(client, folder, mistake.base)
            good = {r for r in by_command_line(base, capsys) if r[0] in restored}
            assert {r for r in await by_editor(client, folder) if r[0] in restored} == good, mistake.id
            for name in restored:
                client.close(folder / name)
            client.folders(removed=[folder])


def restore(client: Client, folder: Path, base: Path) -> set[str]:
    """Replace each file of a system with an error by the correct one, as an edit; return the names of the files."""
    names = set()
    for good in sorted(base.parent.iterdir()):
        broken = folder / ("main.xml" if good == base else good.name)
        if broken.is_file():
            names.add(broken.name)
            client.open(broken, broken.read_text(encoding="utf-8", errors="replace"))
            client.replace(broken, good.read_text(encoding="utf-8"))
    return names
