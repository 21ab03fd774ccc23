# SPDX-License-Identifier: Apache-2.0
"""The page on the library is correct: its examples run one after the other, and print the output on the page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/library.md"

_EXAMPLE = re.compile(r"^```python\n(.*?)^```\n\n```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_examples_print_what_the_page_says(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    page = PAGE.read_text(encoding="utf-8")
    examples = _EXAMPLE.findall(page)
    assert len(examples) == page.count("```python\n") >= 5
    monkeypatch.chdir(ROOT / "examples")
    names: dict[str, object] = {}
    for code, shown in examples:
        exec(compile(code, str(PAGE), "exec"), names)
        assert capsys.readouterr().out == shown, code
