# SPDX-License-Identifier: Apache-2.0
"""Every rule has a document, and what the document shows is what the rule does.

A document has the sections What it does, Why, Bad and Good. The bad example gives the rule's code and nothing else that
is a warning or worse; the good one gives nothing of the kind. Applying the rule's preferred fix removes the finding.
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
from roaml.text import apply_edits

SECTIONS = ["What it does", "Why", "Bad", "Good"]
# No small text file shows them: two are found outside the rules' own checks, one needs bytes that are no text, and for
# one no file is known. The last two are tested in test_cases_z.
WITHOUT_EXAMPLE = {"file-too-large", "internal-error", "undecodable-text", "schema-violation"}
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
    assert re.findall(r"^## (.*)$", text, re.MULTILINE) == wanted
    assert all(section(rule.code, title) for title in wanted)


@by_code
def test_bad_example(rule: Rule, tmp_path: Path) -> None:
    found = [check_text(tmp_path / str(number), text)[0] for number, text in enumerate(examples(rule.code, "Bad"))]
    assert found, "there is no bad example"
    for diagnostics in found:
        assert rule.code in {d.code for d in diagnostics}, shown(diagnostics)
        other = [d for d in diagnostics if d.code != rule.code and d.severity >= Severity.WARNING]
        assert not other, shown(other)


@by_code
def test_good_example(rule: Rule, tmp_path: Path) -> None:
    found = [check_text(tmp_path / str(number), text)[0] for number, text in enumerate(examples(rule.code, "Good"))]
    assert found, "there is no good example"
    for diagnostics in found:
        bad = [d for d in diagnostics if d.code == rule.code or d.severity >= Severity.WARNING]
        assert not bad, shown(bad)


@by_code
def test_fix_mends(rule: Rule, tmp_path: Path) -> None:
    """The preferred fix of the bad example's first finding removes that finding and brings no new error."""
    for number, text in enumerate(examples(rule.code, "Bad")):
        diagnostics, _ = check_text(tmp_path / str(number), text)
        first = next(d for d in diagnostics if d.code == rule.code)
        fix = next((fix for fix in first.fixes if fix.preferred), None)
        if fix is None:
            continue
        path = Path(first.path)
        path.write_text(apply_edits(path.read_text(encoding="utf-8"), fix.edits), encoding="utf-8")
        after, _ = check_text(tmp_path / str(number), "")
        assert count(after, rule.code) < count(diagnostics, rule.code), shown(after)
        assert errors(after) <= errors(diagnostics), shown(after)


def test_every_document_belongs_to_a_rule() -> None:
    documents = {path.stem for path in Path(roaml.rules.__file__).parent.glob("*.md")}
    assert documents == {rule.code.replace("-", "_") for rule in RULES}


def test_examples_name_no_file_twice() -> None:
    for rule in WITH_EXAMPLE:
        for text in (*examples(rule.code, "Bad"), *examples(rule.code, "Good")):
            assert split_files(text)


def count(diagnostics: list[Diagnostic], code: str) -> int:
    return sum(d.code == code for d in diagnostics)


def errors(diagnostics: list[Diagnostic]) -> int:
    return sum(d.severity is Severity.ERROR for d in diagnostics)


def shown(diagnostics: list[Diagnostic]) -> str:
    return "\n".join(f"{Path(d.path).name} {d.span}: {d.severity.label} {d.code}: {d.message}" for d in diagnostics)
