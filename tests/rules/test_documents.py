# SPDX-License-Identifier: Apache-2.0
"""Every rule has a document, and what the document shows is what the rule does.

A document has the sections What it does, Why, Fix, Bad and Good, without Fix if nothing is offered. The bad example
gives the rule's code and nothing else that is a warning or worse; the good one gives nothing of the kind. What is
offered is tested in test_fixes.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import roaml.rules
from fixture import check_text, split_files
from roaml.diagnostics import Diagnostic, Severity
from roaml.rules import RULES, document
from roaml.rules.rule import Rule

SECTIONS = ["What it does", "Why", "Bad", "Good"]
# No small text file shows them: three are found outside the rules' own checks, two need certain bytes, and for one no
# file is known. The last three are tested in test_cases_z.
WITHOUT_EXAMPLE = {
    "file-too-large",
    "ignored-encoding",
    "internal-error",
    "model-fault",
    "undecodable-text",
    "schema-violation",
}
CAUSES = {"not-checked": "unknown-element"}
"""The mistakes that examples show besides, because a rule only says what follows from them."""
_BLOCK = re.compile(r"^```\w*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def section(code: str, title: str) -> str:
    match = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", document(code), re.MULTILINE | re.DOTALL)
    assert match is not None, f"{code} has no section {title}"
    return match[1].strip()


def examples(code: str, title: str) -> list[str]:
    return _BLOCK.findall(section(code, title))


WITH_EXAMPLE = [rule for rule in RULES if rule.code not in WITHOUT_EXAMPLE]
by_code = pytest.mark.parametrize("rule", WITH_EXAMPLE, ids=lambda rule: rule.code)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_has_its_parts(rule: Rule) -> None:
    text = document(rule.code)
    assert text.startswith(f"# {rule.code}\n\n{rule.summary}\n")
    wanted = SECTIONS if rule in WITH_EXAMPLE else SECTIONS[:2]
    found = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert [title for title in found if title != "Fix"] == wanted
    assert found[2:3] == ["Fix"] or "Fix" not in found
    assert all(section(rule.code, title) for title in wanted)


@by_code
def test_bad_example(rule: Rule, tmp_path: Path) -> None:
    found = [check_text(tmp_path / str(number), text)[0] for number, text in enumerate(examples(rule.code, "Bad"))]
    assert found, "there is no bad example"
    for diagnostics in found:
        assert rule.code in {d.code for d in diagnostics}, shown(diagnostics)
        allowed = {rule.code, CAUSES.get(rule.code)}
        other = [d for d in diagnostics if d.code not in allowed and d.severity >= Severity.WARNING]
        assert not other, shown(other)


@by_code
def test_good_example(rule: Rule, tmp_path: Path) -> None:
    found = [check_text(tmp_path / str(number), text)[0] for number, text in enumerate(examples(rule.code, "Good"))]
    assert found, "there is no good example"
    for diagnostics in found:
        bad = [d for d in diagnostics if d.code == rule.code or d.severity >= Severity.WARNING]
        assert not bad, shown(bad)


def test_every_document_belongs_to_a_rule() -> None:
    documents = sorted(path.stem for path in Path(roaml.rules.__file__).parent.rglob("*.md"))
    assert documents == [rule.code.replace("-", "_") for rule in RULES]


def test_examples_name_no_file_twice() -> None:
    for rule in WITH_EXAMPLE:
        for text in (*examples(rule.code, "Bad"), *examples(rule.code, "Good")):
            assert split_files(text)


def shown(diagnostics: list[Diagnostic]) -> str:
    return "\n".join(f"{Path(d.path).name} {d.span}: {d.severity.label} {d.code}: {d.message}" for d in diagnostics)
