# SPDX-License-Identifier: Apache-2.0
"""The definition of the languages: its examples pass the check, its links and anchors are valid.

A complete file is a block after a line with its name in bold: **`battery.ascxml`**. The files of one page make one
folder.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

ROOT = Path(__file__).resolve().parents[1]
SPEC = ROOT / "docs" / "spec"
PAGES = sorted(SPEC.glob("*.md"))
STYLE = SPEC.parent / "STYLE.md"

_BLOCK = re.compile(r"(?:^\*\*`(\S+)`\*\*\n\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_ANCHOR = re.compile(r'^<a id="([a-z0-9-]+)"></a>\n\n#{2,} (?:\d+\.)+(?:\d+)? \S', re.MULTILINE)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_ROOT = re.compile(r"\s*<(?:ascxml|scxml|roaml|root|types)\b")


def files_in(page: Path) -> dict[str, str]:
    """The complete files of a page, by name."""
    return {name: content for name, _, content in _BLOCK.findall(page.read_text(encoding="utf-8")) if name}


def anchors_in(page: Path) -> list[str]:
    return _ANCHOR.findall(page.read_text(encoding="utf-8"))


EXAMPLES: Mapping[str, dict[str, str]] = {page.name: files for page in PAGES if (files := files_in(page))}


def test_there_are_examples() -> None:
    assert {"machines.md", "ros.md", "trees.md", "types.md", "plugins.md"} <= EXAMPLES.keys()


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_clean(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for path, content in EXAMPLES[name].items():
        (tmp_path / path).write_text(content, encoding="utf-8")
    assert run(["--check", *EXAMPLES[name], "--warnings-as-errors"]) == 0, capsys.readouterr().out
    if "main.xml" in EXAMPLES[name]:
        assert run(["translate", "main.xml"]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_whole_document_has_a_name(page: Path) -> None:
    unnamed = [text for name, _, text in _BLOCK.findall(page.read_text(encoding="utf-8")) if not name]
    assert not [text for text in unnamed if _ROOT.match(text)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_section_has_one_anchor(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    anchors = anchors_in(page)
    assert len(anchors) == len(set(anchors)) == len(re.findall(r"<a id=", text)) == len(re.findall(r"^##", text, re.M))


@pytest.mark.parametrize("page", [*PAGES, STYLE], ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    for target in _LINK.findall(page.read_text(encoding="utf-8")):
        if target.startswith("https://"):
            continue
        path, _, anchor = target.partition("#")
        linked = (page.parent / path) if path else page
        assert linked.exists(), target
        if anchor:
            known = anchors_in(linked) if linked.parent == SPEC else headings(linked)
            assert anchor in known, target


def headings(page: Path) -> list[str]:
    """The anchors that a page gets from its headings."""
    titles = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return [re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_sections_are_numbered_in_order(page: Path) -> None:
    numbers = re.findall(r"^##+ ([\d.]+) ", page.read_text(encoding="utf-8"), re.MULTILINE)
    expected: list[str] = []
    chapter = section = 0
    for number in numbers:
        if number.endswith("."):
            chapter, section = chapter + 1, 0
            expected.append(f"{chapter}.")
        else:
            section += 1
            expected.append(f"{chapter}.{section}")
    assert numbers == expected


def test_the_contents_name_every_page() -> None:
    linked = set(re.findall(r"^\| \[[^]]+\]\((\w[\w-]*\.md)\)", (SPEC / "README.md").read_text(encoding="utf-8"), re.M))
    assert linked == {page.name for page in PAGES} - {"README.md"}
