# SPDX-License-Identifier: Apache-2.0
"""Property files in XML in a session: tests, lenses, results and stories, all with the same sentence."""

from __future__ import annotations

from pathlib import Path

from client import connect
from lsprotocol import types
from test_lsp_verify import QUICK, ask, hints, lenses, verify, why

from as2fm_lsp.handlers.results import PROPERTIES
from fixture import split_files
from property_robot import ROBOT

SENTENCE = "Whenever level < 30 holds, /charge is called by Battery within 10 s."


async def test_properties_are_listed_run_and_explained(tmp_path: Path) -> None:
    for name, text in split_files(ROBOT).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    main, file = tmp_path / "main.xml", tmp_path / "properties.xml"
    async with connect(tmp_path) as client:
        (system,) = await ask(client, PROPERTIES, None)
        assert [row["name"] for row in system["properties"]] == ["charges", "polite", "counts", "steady", "fills"]
        assert system["properties"][0]["comment"] == SENTENCE
        client.open(file, file.read_text(encoding="utf-8"))
        assert (await lenses(client, file)).count("Verify") == 4
        answer = await verify(client, main, ["counts"], {**QUICK, "scheduler": "uniform"})
        (row,) = answer["results"]
        assert row["property"] == "counts"
        assert row["comment"].startswith("Each time from when `Main/Other/right_pick` is ticked until")
        ((text, _),) = await hints(client, file)
        assert "uniform 0 [" in text
        story = await why(client, main, "counts")
        assert story["heading"].startswith("Each time from when Main/Other/right_pick is ticked until")
        assert "counts failed in trace" in story["heading"]


async def test_the_lens_of_a_property_says_what_it_requires(tmp_path: Path) -> None:
    for name, text in split_files(ROBOT).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    file = tmp_path / "properties.xml"
    async with connect(tmp_path) as client:
        client.open(file, file.read_text(encoding="utf-8"))
        params = types.CodeLensParams(types.TextDocumentIdentifier(file.as_uri()))
        unresolved = [lens for lens in await client.text_document_code_lens_async(params) or () if lens.data]
        resolved = [await client.code_lens_resolve_async(lens) for lens in unresolved]
        titles = [lens.command.title for lens in resolved if lens.command is not None]
        assert SENTENCE in titles
