# SPDX-License-Identifier: Apache-2.0
"""All requests that the server supports, sent at some places of our own models; `sweep.py` sends them at all places."""

from __future__ import annotations

from pathlib import Path

import pytest
from ide_models import CORNERS, ROBOT
from lsp_sweep import Sweep, offered, some_places

import clock
from fixture import split_files

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*/main.xml"))


@pytest.mark.parametrize("main", EXAMPLES, ids=lambda path: path.parent.name)
def test_examples(main: Path) -> None:
    sweep = Sweep(main, (), some_places(1, 25))
    assert list(sweep.failures()) == []
    assert sweep.asked > 1000


@pytest.mark.parametrize("written", [ROBOT, CORNERS], ids=["robot", "corners"])
def test_models_of_other_tests(tmp_path: Path, written: str) -> None:
    for name, text in split_files(written).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    sweep = Sweep(tmp_path / "main.xml", (), some_places(2, 25))
    assert list(sweep.failures()) == []


def test_lines_of_other_lengths_than_their_code_points(tmp_path: Path) -> None:
    """Columns are in UTF-16 units, and many places follow characters of two units."""
    main = clock.write(tmp_path, clock=clock.CLOCK.replace('name="second"', 'name="\U0001f552é"'))
    sweep = Sweep(main, (), some_places(3, 60))
    assert list(sweep.failures()) == []


def test_a_feature_that_is_not_swept_is_noticed() -> None:
    with pytest.raises(AssertionError, match="monikerProvider"):
        offered({"hoverProvider": True, "monikerProvider": True})


def test_what_is_not_offered_is_not_asked() -> None:
    options = {"codeLensProvider": {"resolveProvider": False}, "renameProvider": {"prepareProvider": True}}
    methods, followed = offered(options)
    assert [method.name for method in methods] == [
        "textDocument/codeLens",
        "textDocument/prepareRename",
        "textDocument/rename",
    ]
    assert followed == ()


class Sloppy(Sweep):
    """A sweep with invented answers."""

    def found(self, name: str, result: object) -> list[str]:
        return list(self._wrong(name, str(self.main), {"result": result}))


def test_wrong_answers_are_noticed(tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    sweep = Sloppy(main, ())
    start, end = {"line": 0, "character": 0}, {"line": 0, "character": 7}
    assert sweep.found("textDocument/hover", {"range": {"start": start, "end": end}}) == []
    assert len(sweep.found("textDocument/hover", {"range": {"start": end, "end": start}})) == 1
    assert len(sweep.found("textDocument/hover", {"range": {"start": start, "end": {"line": 0, "character": 8}}})) == 1
    assert len(sweep.found("textDocument/foldingRange", [{"startLine": 3, "endLine": 50}])) == 1
    assert len(sweep.found("textDocument/semanticTokens/full", {"data": [0, 0, 5, 0, 0, 0, 1, 3, 0, 0]})) == 1
    elsewhere = {
        "uri": (tmp_path / "clock.ascxml").as_uri(),
        "range": {"start": start, "end": {"line": 90, "character": 0}},
    }
    assert len(sweep.found("textDocument/definition", [elsewhere])) == 1
    assert sweep.found("textDocument/rename", None) == []
    error = {"error": {"code": -32603, "message": "crash"}}
    assert list(sweep._wrong("textDocument/rename", str(main), error)) == ["-32603 crash"]
