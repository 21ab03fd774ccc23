# SPDX-License-Identifier: Apache-2.0
"""The README is correct: its files form a system, its commands print the shown output, and its programs run."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

README = Path(__file__).resolve().parents[1] / "README.md"
_FILE = re.compile(r"^\*\*`(\S+)`\*\*\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_TRANSLATE = re.compile(r"^\$ as2fm-lsp (translate main\.xml)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_VERIFY = re.compile(r"^\$ as2fm-lsp (verify main\.xml[^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CHECK = re.compile(r"^\$ as2fm-lsp (--check \S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_PROGRAM = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_a_misspelled_variable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["init", "my_robot"]) == 0
    battery = tmp_path / "my_robot/nodes/battery.ascxml"
    text = battery.read_text(encoding="utf-8")
    wrong = text.replace('<assign location="level"', '<assign location="levle"', 1)
    assert wrong != text
    battery.write_text(wrong, encoding="utf-8")
    capsys.readouterr()
    ((command, printed),) = _CHECK.findall(README.read_text(encoding="utf-8"))
    assert run(command.split()) == 1
    assert capsys.readouterr().out == printed


def test_the_battery_monitor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = README.read_text(encoding="utf-8")
    files = dict(_FILE.findall(text))
    assert set(files) == {"battery.ascxml", "monitor.ascxml", "main.xml", "properties.jani"}
    for name, content in files.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    assert run(["--check", "main.xml", "--warnings-as-errors"]) == 0
    capsys.readouterr()
    ((command, printed),) = _TRANSLATE.findall(text)
    assert run(command.split()) == 0
    assert capsys.readouterr().out == printed
    ((command, printed),) = _VERIFY.findall(text)
    assert run(command.split()) == 0
    assert without_time(capsys.readouterr().out) == without_time(printed)
    checking, translating = _PROGRAM.findall(text)
    exec(checking, {})
    assert float(capsys.readouterr().out) == pytest.approx(0.75)
    names: dict[str, str] = {}
    exec(translating, names)
    assert f"{names['text']}\n" == (tmp_path / "main.jani").read_text(encoding="utf-8")


def test_drawn_pictures_are_current(tmp_path: Path) -> None:
    """`python docs/readme_pictures.py` makes them anew."""
    script = runpy.run_path(str(README.parent / "docs/readme_pictures.py"))
    script["main"](tmp_path)
    drawn = sorted(tmp_path.iterdir())
    assert len(drawn) == 4
    for path in drawn:
        assert path.read_bytes() == (script["PICTURES"] / path.name).read_bytes(), path.name


def test_pictures_exist_in_light_and_dark() -> None:
    shown = re.findall(r'srcset="(.+)">\n  <img .*src="(.+)">', README.read_text(encoding="utf-8"))
    assert len(shown) == README.read_text(encoding="utf-8").count("<picture>") > 2
    for dark, light in shown:
        assert light == dark.replace("dark", "light")
        assert (README.parent / dark).exists()
        assert (README.parent / light).exists()


def without_time(text: str) -> str:
    return re.sub(r", [\d.]+ s$", "", text, flags=re.MULTILINE)


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#:]+)(?:#[\w-]+)?\)", README.read_text(encoding="utf-8")):
        assert (README.parent / target).exists(), target
