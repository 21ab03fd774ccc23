# SPDX-License-Identifier: Apache-2.0
"""The tutorial is correct: the test performs its steps in a folder and compares the output.

What a block means follows from its language:

- `console`: commands behind `$`, each followed by exactly what it prints, but for the time that a verification takes;
- `diff`: a change in the file that was named last, **`like this`**;
- `sh`: shown only, for it needs a network;
- anything else: the whole of a file, whose name stands alone on the line before.
"""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from as2fm_lsp.cli.main import run

DOCS = Path(__file__).resolve().parents[1] / "docs"
TUTORIAL, TREES = DOCS / "tutorial.md", DOCS / "nav2-tree.md"
FILES = ("xml", "json", "toml", "text")

_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"\*\*`([^`]+)`\*\*")
_COMMAND = re.compile(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", re.MULTILINE)


class Block(NamedTuple):
    """A block of code. `before` is the text between the previous block and this one; `line` is the line where the block
    begins."""

    language: str
    content: str
    before: str
    line: int


def blocks(text: str) -> Iterator[Block]:
    end = 0
    for match in _BLOCK.finditer(text):
        yield Block(match[1], match[2], text[end : match.start()], text.count("\n", 0, match.start()) + 1)
        end = match.end()


def patched(text: str, diff: str) -> str:
    """The text after a change, which must fit in exactly one place."""
    lines = diff.splitlines()
    old, new = ("".join(f"{line[1:]}\n" for line in lines if line[:1] != sign) for sign in "+-")
    places = [match.start() for match in re.finditer(f"^{re.escape(old)}", text, re.MULTILINE)]
    assert len(places) == 1, f"{len(places)} places have this, not 1:\n{old}"
    return text[: places[0]] + new + text[places[0] + len(old) :]


def timeless(text: str) -> str:
    return re.sub(r", [\d.]+ s$", "", text, flags=re.MULTILINE)


class Reader:
    """Performs the steps of a reader of the tutorial in the current folder."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self.capsys = capsys
        self.file = Path()
        self.status = 0

    def take(self, block: Block) -> None:
        """Perform the step that a block describes."""
        if names := _FILE.findall(block.before):
            self.file = Path(names[-1])
        match block.language:
            case "console":
                for command, printed in _COMMAND.findall(block.content):
                    assert timeless(self.printed(command)) == timeless(printed), command
            case "diff":
                self.file.write_text(patched(self.file.read_text("utf-8"), block.content), "utf-8")
            case language if language in FILES:
                assert block.before.endswith(f"\n**`{self.file}`**\n\n"), "the block does not say which file it is"
                self.file.parent.mkdir(parents=True, exist_ok=True)
                self.file.write_text(block.content, "utf-8")
            case _:
                assert block.language == "sh", f"nothing is known of blocks of {block.language or 'no language'}"

    def printed(self, command: str) -> str:
        """The output of a command."""
        match shlex.split(command):
            case ["cd", folder]:
                os.chdir(folder)
            case ["mkdir", folder]:
                Path(folder).mkdir()
            case ["echo", "$?"]:
                return f"{self.status}\n"
            case ["as2fm-lsp", *arguments]:
                self.status = run(arguments)
                out, err = self.capsys.readouterr()
                return err + out
            case _:
                raise AssertionError(f"nothing is known of the command {command}")
        return ""


def test_tutorial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    reader = Reader(capsys)
    for block in blocks(TUTORIAL.read_text("utf-8")):
        try:
            reader.take(block)
        except AssertionError as error:
            raise AssertionError(f"{TUTORIAL.name}:{block.line}: {error}") from error
    assert Path.cwd() == tmp_path / "stop_button"


def test_trees(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The page on trees with mocks. Its tree is that of the example."""
    monkeypatch.chdir(tmp_path)
    reader = Reader(capsys)
    for block in blocks(TREES.read_text("utf-8")):
        reader.take(block)
    assert reader.status == 0
    example = DOCS.parent / "examples" / "fetch_tree"
    assert Path("fetch.xml").read_text("utf-8") == (example / "fetch.xml").read_text("utf-8")
    assert run(["verify", str(example / "fetch.xml"), "--mocks", str(example / "fetch.mocks")]) == 0


@pytest.mark.parametrize("page", [TUTORIAL, TREES], ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)(?:#[\w-]+)?\)", page.read_text("utf-8")):
        assert (page.parent / target).exists(), target


def test_a_change_must_fit_in_one_place() -> None:
    assert patched("a\nb\nc\n", " a\n-b\n+x\n+y\n c\n") == "a\nx\ny\nc\n"
    for diff in ("-z\n+y\n", "-b\n+y\n"):
        with pytest.raises(AssertionError, match="places have this"):
            patched("a\nb\nb\n", diff)


@pytest.mark.parametrize(
    "text",
    [
        "```console\n$ echo $?\n1\n```\n",
        "```console\n$ ls\n```\n",
        "```xml\n<a/>\n```\n",
        "```python\npass\n```\n",
        "```\nwhat\n```\n",
    ],
    ids=["other output", "other command", "no file name", "other language", "no language"],
)
def test_what_is_wrong_is_noticed(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = blocks(text)
    with pytest.raises(AssertionError):
        Reader(capsys).take(block)
