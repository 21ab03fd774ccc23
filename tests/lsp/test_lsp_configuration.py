# SPDX-License-Identifier: Apache-2.0
"""Configuration files in the editor: errors are diagnostics of the file, until they are fixed."""

from __future__ import annotations

from pathlib import Path

import pytest
from client import connect
from lsprotocol import types

import clock


@pytest.mark.parametrize("name", ["as2fm.toml", "pyproject.toml"])
async def test_mistakes_are_diagnostics_of_the_file(tmp_path: Path, name: str) -> None:
    clock.write(tmp_path)
    configuration = tmp_path / name
    header = "[tool.as2fm]\n" if name == "pyproject.toml" else "\n"
    configuration.write_text(f'{header}ros-path = ["msgs"]\ningore = []\n')
    async with connect(tmp_path) as client:
        diagnostics = await client.until_codes(configuration, "missing-folder", "invalid-setting")
        assert [diagnostic.range.start.line for diagnostic in diagnostics] == [1, 2]
        (fix,) = await client.fixes(configuration, diagnostics[1].range)
        assert fix.title == "Change to `ignore`"
        # The text is not saved yet.
        client.open(configuration, language="toml")
        client.replace(configuration, f'{header}ros-path = ["msgs"]\nignore = ["no-such-rule"]\n')
        await client.until_codes(configuration, "missing-folder", "invalid-setting")
        client.replace(configuration, f'{header}ros-path = ["."]\n', version=3)
        await client.until_codes(configuration)
        client.close(configuration)
        await client.until_codes(configuration, "missing-folder", "invalid-setting")
        (tmp_path / "msgs").mkdir()
        configuration.write_text(f'{header}ros-path = ["msgs"]\n')
        client.changed(configuration)
        await client.until_codes(configuration)
        assert client.messages == []


async def test_an_invalid_toml_file_that_is_removed(tmp_path: Path) -> None:
    clock.write(tmp_path)
    configuration = tmp_path / "as2fm.toml"
    configuration.write_text("ignore = [")
    async with connect(tmp_path) as client:
        await client.until_codes(configuration, "toml-syntax")
        configuration.unlink()
        client.changed(configuration, kind=types.FileChangeType.Deleted)
        await client.until_codes(configuration)
        assert client.messages == []


async def test_the_configuration_above_the_folder(tmp_path: Path) -> None:
    """The configuration applies, so its errors are shown, although it is outside the open folder."""
    clock.write(tmp_path / "models")
    configuration = tmp_path / "as2fm.toml"
    configuration.write_text("ingore = []\n")
    async with connect(tmp_path / "models") as client:
        await client.until_codes(configuration, "invalid-setting")


async def test_saving_puts_settings_in_force(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    configuration = tmp_path / "as2fm.toml"
    configuration.write_text("")
    async with connect(tmp_path) as client:
        await client.until_codes(tmp_path / "clock.ascxml", "undeclared-variable")
        client.open(configuration, language="toml")
        configuration.write_text('ignore = ["undeclared-variable"]\n')
        client.replace(configuration, configuration.read_text())
        document = types.TextDocumentIdentifier(configuration.as_uri())
        client.text_document_did_save(types.DidSaveTextDocumentParams(document))
        await client.until_codes(tmp_path / "clock.ascxml")


async def test_errors_in_settings_of_the_editor_are_reported(tmp_path: Path) -> None:
    """They are shown as messages, because they are not in a file that the server knows."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    async with connect(tmp_path, options={"settings": {"ignore": ["no-such-rule"]}}) as client:
        client.open(tmp_path / "clock.ascxml")
        await client.until_codes(tmp_path / "clock.ascxml", "undeclared-variable")
        messages = [message.message for message in client.messages]
        assert messages == ["In the editor's settings: there is no rule `no-such-rule`."]
