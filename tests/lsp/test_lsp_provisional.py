# SPDX-License-Identifier: Apache-2.0
"""Typing in a long machine: the findings of the edited state arrive first, and those of a complete check when the user
pauses. The editor then shows what a new check reports."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from client import Client, connect
from lsprotocol import types

from bench.generate import FIRST, write_system
from bench.keystrokes import keys
from roaml import api
from roaml.project.provisional import MIN_CHARACTERS

WRONG = '<assign location="countr" expr="1" />'
UNUSED = '<data id="spare" type="int32" expr="0" />'


def shown(diagnostics: list[types.Diagnostic]) -> list[tuple[int, int, str, str]]:
    return [(d.range.start.line, d.range.start.character, str(d.code), d.message) for d in diagnostics]


def reported(path: Path) -> list[tuple[int, int, str, str]]:
    """The findings of a new check of the folder."""
    found = [d for d in api.check([str(path.parent)]).diagnostics if d.path == str(path)]
    places = [d.source.lines.position(d.span.start) for d in found if d.source is not None]
    return [(at.line, at.column, d.code, d.message) for at, d in zip(places, found, strict=True)]


async def until_complete(client: Client, path: Path) -> None:
    expected = reported(path)

    def is_complete() -> bool:
        last = client.published.get(path.as_uri())
        return last is not None and shown(list(last.diagnostics)) == expected

    await client.until(is_complete)


def edit(path: Path, text: str, **inserted: str) -> str:
    """Insert texts at the beginning of the first elements with these names."""
    for name, new in inserted.items():
        text = text.replace(f"<{name}>", f"<{name}>{new}", 1)
    path.write_text(text, encoding="utf-8")
    return text


async def test_the_edited_state_first(tmp_path: Path) -> None:
    write_system(tmp_path, files=5, lines=450)
    path = tmp_path / FIRST
    text = path.read_text(encoding="utf-8")
    assert len(text) > MIN_CHARACTERS
    async with connect(tmp_path) as client:
        text = edit(path, text, onentry=WRONG)
        client.open(path, text)
        await client.until_codes(path, "undeclared-variable")
        client.replace(path, edit(path, text, onentry=WRONG, datamodel=UNUSED))
        await until_complete(client, path)
        published = [[str(d.code) for d in p.diagnostics] for p in client.history if p.version == 2]
        assert published == [["undeclared-variable"] * 2, ["unused-variable", *["undeclared-variable"] * 2]]


async def test_many_keys(tmp_path: Path) -> None:
    write_system(tmp_path, files=5, lines=450)
    path = tmp_path / FIRST
    text = edit(path, path.read_text(encoding="utf-8"), onentry=WRONG)
    async with connect(tmp_path) as client:
        client.open(path, text)
        await until_complete(client, path)
        for version, key in enumerate(islice(keys(text, rounds=1), 55), 2):
            change = key.change()
            range_ = types.Range(*(types.Position(**change["range"][end]) for end in ("start", "end")))
            client.edit(path, types.TextDocumentContentChangePartial(range_, change["text"]), version=version)
            if version % 10 == 0:
                path.write_text(key.text, encoding="utf-8")
                await until_complete(client, path)
        path.write_text(key.text, encoding="utf-8")
        await until_complete(client, path)
