# SPDX-License-Identifier: Apache-2.0
"""Odd cases of single rules, one file `cases_a/<code>.txt` for each rule.

A case is a line `## title` and files as in `fixture`. Files before the first case belong to every case that names its
files, unless it has one of that name itself. The carets show all that the rule has to say, and exactly where; where
there are none it is silent. A span of several lines ends for them at the end of its first line. Hints count only
for rules that give hints. Other rules do not matter, except that none may crash.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fixture import check_text, split_cases
from roaml.diagnostics import Diagnostic, Severity
from roaml.rules import BY_CODE

FOLDER = Path(__file__).parent / "cases_a"


def cases() -> list[tuple[str, str, str]]:
    """Rule, title and text of every case."""
    found = []
    for path in sorted(FOLDER.glob("*.txt")):
        common, titled = split_cases(path)
        for title, text in titled:
            found.append((path.stem, title, common + text if text.startswith("-- ") else text))
    return found


CASES = cases()


@pytest.mark.parametrize(("code", "text"), [pytest.param(c, text, id=f"{c}: {title}") for c, title, text in CASES])
def test_case(code: str, text: str, tmp_path: Path) -> None:
    diagnostics, marks = check_text(tmp_path, text)
    least = min(Severity.INFORMATION, BY_CODE[code].severity)
    found = {place(tmp_path, d) for d in diagnostics if d.code == code and d.severity >= least}
    assert found == {(mark.file, mark.start, mark.end, mark.code) for mark in marks}
    assert not [d.message for d in diagnostics if d.code == "internal-error"]


@pytest.mark.parametrize(
    ("declaration", "severity"),
    [
        ('<ros_time_rate name="t" rate_hz="1" />', Severity.ERROR),
        ('<ros_topic_publisher name="t" topic="/t" type="std_msgs/Empty" />', Severity.WARNING),
    ],
)
def test_only_timers_may_not_be_declared_twice_in_the_same_way(
    declaration: str, severity: Severity, tmp_path: Path
) -> None:
    text = f'<ascxml name="A" version="1.0" initial="a">{declaration * 2}<state id="a" /></ascxml>'
    diagnostics, _ = check_text(tmp_path, text)
    assert [d.severity for d in diagnostics if d.code == "duplicate-handle"] == [severity]


def place(folder: Path, diagnostic: Diagnostic) -> tuple[str, int, int, str]:
    """File, start and end on the first line, and code; what is empty is marked by one caret."""
    path = Path(diagnostic.path)
    text, start = path.read_bytes().decode("utf-8"), diagnostic.span.start
    line_end = start + len(text[start:].partition("\n")[0])
    end = max(start + 1, min(diagnostic.span.end, line_end))
    return path.relative_to(folder).as_posix(), start, end, diagnostic.code


def test_every_rule_is_seen_at_work_and_silent() -> None:
    for code in {code for code, _, _ in CASES}:
        texts = [text for c, _, text in CASES if c == code]
        assert any(f"^ {code}\n" in text for text in texts), f"{code} is never expected"
        assert any(f"^ {code}\n" not in text for text in texts), f"{code} is never silent"
