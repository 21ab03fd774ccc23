# SPDX-License-Identifier: Apache-2.0
"""Comments that suppress findings."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import Command

import clock

LINE = '            <assign location="coutn" expr="(count + 1) % 10" />\n'


@pytest.fixture
def codes(check: Command, tmp_path: Path):  # type: ignore[no-untyped-def]
    """The codes of the findings in the clock with another line instead of the one with the error."""

    def of(line: str) -> list[str]:
        assert LINE in clock.WRONG_CLOCK
        clock.write(tmp_path, clock=clock.WRONG_CLOCK.replace(LINE, line))
        return check(".", "--ignore", "unused-suppression").codes

    return of


ALONE = "            <!-- as2fm: ignore[undeclared-variable] -->\n"


@pytest.mark.parametrize(
    "line",
    [
        LINE.replace("/>\n", "/><!-- as2fm: ignore[undeclared-variable] -->\n"),
        LINE.replace("/>\n", "/> <!-- as2fm: ignore -->\n"),
        LINE.replace("/>\n", "/> <!--as2fm:ignore[ xml-syntax ,undeclared-variable, ]-->\n"),
        LINE.replace("<assign", "<!-- as2fm: ignore[undeclared-variable] --> <assign"),
        ALONE + LINE,
        ALONE + "\n\n" + LINE,
        ALONE + "            <!-- because -->\n" + LINE,
        ALONE + LINE.replace("expr", "\n\n   expr"),
        ALONE + LINE.replace("\n", "\r\n"),
        ALONE + '            <if cond="true">\n' + LINE + "            </if>\n",
        ALONE + ALONE.replace("undeclared-variable", "xml-syntax") + LINE,
    ],
)
def test_quiet(codes, line: str) -> None:  # type: ignore[no-untyped-def]
    assert codes(line) == []


@pytest.mark.parametrize(
    "line",
    [
        LINE.replace("/>\n", "/><!-- as2fm: ignore[xml-syntax] -->\n"),
        LINE.replace("/>\n", "/><!-- as2fm: ignore[] -->\n"),
        LINE.replace("/>\n", "/><!-- as2fm: ignored -->\n"),
        LINE.replace("/>\n", "/><!-- ignore[undeclared-variable] -->\n"),
        LINE.replace("/>\n", "/>\n<!-- as2fm: ignore[undeclared-variable] -->\n"),
        ALONE + LINE.replace("coutn", "count") + LINE,
        ALONE.replace("undeclared-variable", "undeclared") + LINE,
        LINE.replace("/>\n", 'id="<!-- as2fm: ignore -->" />\n').replace('id="<!--', 'name="&lt;!--'),
    ],
)
def test_not_quiet(codes, line: str) -> None:  # type: ignore[no-untyped-def]
    assert "undeclared-variable" in codes(line)


def test_a_comment_before_the_root_holds_for_the_file(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock="<!-- as2fm: ignore[undeclared-variable] -->\n" + clock.WRONG_CLOCK)
    assert check(".").codes == []


def test_in_system_files_and_trees(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, main=clock.MAIN.replace("clock.ascxml", "missing.ascxml"))
    assert "missing-file" in check("main.xml").codes
    quiet = clock.MAIN.replace('"clock.ascxml" />', '"missing.ascxml" /> <!-- as2fm: ignore[missing-file] -->')
    clock.write(tmp_path, main=quiet)
    assert "missing-file" not in check("main.xml").codes


@pytest.mark.parametrize(
    ("written", "meant"),
    [("undeclared-varible", "undeclared-variable"), ("xml-syntax, undeclared-varible", "undeclared-variable")],
)
def test_a_misspelt_code_is_reported_with_the_nearest(check: Command, tmp_path: Path, written: str, meant: str) -> None:
    comment = f"<!-- as2fm: ignore[{written}] -->"
    clock.write(tmp_path, clock=clock.WRONG_CLOCK.replace(LINE, LINE.replace("/>\n", f"/> {comment}\n")))
    messages = [row["message"] for row in check(".", "--select", "unused-suppression").rows]
    assert f"there is no rule `undeclared-varible`; did you mean `{meant}`?" in messages
    assert len(messages) == len(written.split(","))
