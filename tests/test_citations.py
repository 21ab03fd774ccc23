# SPDX-License-Identifier: Apache-2.0
"""Every citation of the definition of the languages leads to a section of it (docs/STYLE.md)."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml.rules import RULES, cited, document, in_reference
from test_spec import PAGES, ROOT, anchors_in

FOLDERS = ("server", "schemas", "docs", "tests", "vscode-extension", "examples")
TEXT = (".py", ".md", ".xsd", ".json", ".ts", ".txt", ".ascxml", ".xml", ".toml", ".pxd", ".sh")

_CITATION = re.compile(r"docs/spec/([\w-]+)\.md(?:#([\w-]+))?")
_NOTES = re.compile(r"(?<!docs/)\bspec/\d|spec §")
_LINK = r"\[[^]]+\]\(((?:\.\./)+docs/spec/[^\s)]+)\)"
_DEFINITION = re.compile(rf"\nDefinition: {_LINK}(?:,\s{_LINK})*\n(?=\n## |\Z)")
"""What a rule checks may have a definition in systems and another one in trees without a system."""

SECTIONS = {page.stem: {"", *anchors_in(page)} for page in PAGES}


def lines() -> Iterator[tuple[str, str]]:
    """`file:line` and text of each line that may contain a citation."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *FOLDERS, "*.md"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    for name in listed:
        path = ROOT / name
        if path.suffix in TEXT and path != Path(__file__) and path.is_file():
            for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
                yield f"{name}:{number}", line


def test_every_citation_leads_to_a_section() -> None:
    cited_sections = [(place, match) for place, line in lines() for match in _CITATION.finditer(line)]
    assert len(cited_sections) > 100
    wrong = [
        f"{place}: {match[0]}"
        for place, match in cited_sections
        if match[1] != "PAGE" and (match[1] not in SECTIONS or (match[2] or "") not in SECTIONS[match[1]])
    ]
    assert not wrong


def test_citations_refer_only_to_the_repository() -> None:
    assert not [f"{place}: {line.strip()}" for place, line in lines() if _NOTES.search(line)]


@pytest.mark.parametrize("code", [rule.code for rule in RULES])
def test_the_document_of_a_rule_links_its_definition(code: str) -> None:
    text = document(code)
    definition = _DEFINITION.search(text)
    targets = re.findall(_LINK, definition[0]) if definition else []
    assert len(targets) == text.count("docs/spec/")
    if definition:
        assert text[: definition.start()].count("\n## ") == 1, "the definition ends what the rule does"
    for target in targets:
        path, _, anchor = target.partition("#")
        folder = next((ROOT / "server" / "roaml" / "rules").rglob(f"{code.replace('-', '_')}.md")).parent
        page = (folder / path).resolve()
        assert page in PAGES, target
        assert anchor in SECTIONS[page.stem], target


def test_the_definition_is_linked_in_the_reference() -> None:
    assert "[Time](../spec/semantics.md#time)" in in_reference(document("answer-needs-time"))


def test_the_definition_is_cited_elsewhere(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--explain", "answer-needs-time"]) == 0
    printed = capsys.readouterr().out
    assert "\nDefinition: Time (docs/spec/semantics.md#time)\n" in printed
    assert printed == cited(document("answer-needs-time"))
