# SPDX-License-Identifier: Apache-2.0
"""`--check --fix`: safe fixes are applied, other findings are reported."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import Command

MACHINE = """\
<!-- kept -->
<ascxml name="Drainer" version="1.0" initial="run">
    <ros_topic_publisher name="level" topic="level" type="std_msgs/Int16" />
    <ros_topic_publisher name="level" topic="level" type="std_msgs/Int16" />
    <datamodel>
        <data id="n" type="int16" expr="0" />
    </datamodel>
    <state id="run">
        <transition event="go" target="run">
            <log expr="n" />
            <log expr="n" />
            <asign location="n" expr="1" />
        </transition>
    </state>
</ascxml>
"""
FIXED = "".join(
    line for number, line in enumerate(MACHINE.splitlines(keepends=True)) if "<log" not in line and number != 3
)


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_safe_fixes_are_made(check: Command, tmp_path: Path, line_end: str, mark: bytes) -> None:
    """Nothing else is changed: a misspelled element is reported, because its correction is a guess."""
    path = tmp_path / "drainer.ascxml"
    path.write_bytes(mark + MACHINE.replace("\n", line_end).encode())
    done = check("drainer.ascxml", "--fix", "--severity", "error")
    assert path.read_bytes() == mark + FIXED.replace("\n", line_end).encode()
    more = "1 more finding has a fix that is not safe to apply without a review; an editor offers them: unknown-element"
    assert done.err == f"as2fm-lsp: fixed drainer.ascxml\nas2fm-lsp: {more}\n"
    assert (done.status, done.codes) == (1, ["unknown-element"])
    again = check("drainer.ascxml", "--fix", "--severity", "error")
    assert (again.err, again.codes) == (f"as2fm-lsp: {more}\n", ["unknown-element"]), "once is enough"
    without = check("drainer.ascxml", "--severity", "error")
    assert without.err == "", "nothing was to be fixed"


def test_nothing_more_is_offered_where_nothing_is_left(check: Command, tmp_path: Path) -> None:
    (tmp_path / "drainer.ascxml").write_text(MACHINE.replace('            <asign location="n" expr="1" />\n', ""))
    assert check("drainer.ascxml", "--fix", "--severity", "error").err == "as2fm-lsp: fixed drainer.ascxml\n"


def test_only_what_is_reported_is_fixed(check: Command, tmp_path: Path) -> None:
    path = tmp_path / "drainer.ascxml"
    path.write_text(MACHINE)
    check("drainer.ascxml", "--fix", "--ignore", "ignored-element")
    assert path.read_text().count("<log") == 2
    assert path.read_text().count("<ros_topic_publisher") == 1


def test_an_element_that_must_stay(check: Command, tmp_path: Path) -> None:
    """Without the `<log>` the `<if>` would be empty, which is an error."""
    path = tmp_path / "drainer.ascxml"
    text = MACHINE.replace('<log expr="n" />', '<if cond="n == 1"><log expr="n" /></if>')
    path.write_text(text)
    check("drainer.ascxml", "--fix")
    assert path.read_text().count("<log") == 2


def test_of_two_elements_one_must_stay(check: Command, tmp_path: Path) -> None:
    """Each alone could go. What else is safe is done all the same."""
    path = tmp_path / "drainer.ascxml"
    log = '<log expr="n" />'
    path.write_text(MACHINE.replace(f"{log}\n            {log}", f'<if cond="n == 1">{log}{log}</if>'))
    check("drainer.ascxml", "--fix")
    assert path.read_text().count("<log") == 1
    assert path.read_text().count("<ros_topic_publisher") == 1


def test_files_that_are_no_text_stay(check: Command, tmp_path: Path) -> None:
    path = tmp_path / "drainer.ascxml"
    data = MACHINE.replace("kept", "\udcff").encode("utf-8", "surrogateescape")
    path.write_bytes(data)
    check("drainer.ascxml", "--fix")
    assert path.read_bytes() == data


def test_not_with_standard_input(check: Command) -> None:
    done = check("--fix", "--stdin-filename", "a.ascxml", stdin=b"")
    assert (done.status, done.err) == (2, "as2fm-lsp: --fix changes files; it cannot be used with standard input\n")


def test_not_without_checking(command: Command) -> None:
    assert command("--fix").status == 2
