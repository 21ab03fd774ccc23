# SPDX-License-Identifier: Apache-2.0
"""Every rule has a document, and what the document shows is what the rule does.

A document has the sections What it does, Why, Fix, Bad and Good, without Fix if the rule offers none. The bad example
has a finding of the rule and no other warning or error; the good one has no warning, no error and no finding of the
rule, and is near to the bad one. Each fix of the bad example is made: it removes its finding; a preferred one adds no
error.
"""

from __future__ import annotations

import difflib
import re
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest

from fixture import Case, split_files, write_files
from rule_files import cases_of_rules, documents, examples, has_fix, section

if TYPE_CHECKING:
    from collections.abc import Iterable

    from roaml.diagnostics import Diagnostic

SECTIONS = ["What it does", "Why", "Bad", "Good"]
# No small text file shows them: three are found outside the rules' own checks, two need certain bytes, and for one no
# file is known. The last three are tested in tests/findings.
WITHOUT_EXAMPLE = {
    "file-too-large",
    "ignored-encoding",
    "internal-error",
    "model-fault",
    "undecodable-text",
    "schema-violation",
}
CAUSES = {"not-checked": "unknown-element"}
"""Other findings in examples, of rules that only report consequences of other errors."""

WITH_EXAMPLE = [code for code in documents() if code not in WITHOUT_EXAMPLE]


def parameters(title: str) -> list[object]:
    cases = [case for code in WITH_EXAMPLE for case in examples(code, title)]
    return [pytest.param(case, id=f"{case.subject}: {case.title}") for case in cases]


BAD = pytest.mark.parametrize("case", parameters("Bad"))


@pytest.mark.parametrize("code", documents())
def test_has_its_parts(code: str) -> None:
    text = documents()[code]
    assert text.startswith(f"# {code}\n\n")
    expected = SECTIONS if code in WITH_EXAMPLE else SECTIONS[:2]
    titles = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert [title for title in titles if title != "Fix"] == expected
    assert titles[2:3] == ["Fix"] or "Fix" not in titles
    assert all(section(code, title) for title in expected)


@pytest.mark.parametrize("code", WITH_EXAMPLE)
def test_has_examples(code: str) -> None:
    """Whose files have different names."""
    for title in ("Bad", "Good"):
        assert examples(code, title)
        assert all(split_files(case.text) for case in examples(code, title))


@BAD
def test_bad_example(case: Case, checked: ModuleType, mending: ModuleType, tmp_path: Path) -> None:
    result, _ = checked.checked(tmp_path, case.text)
    diagnostics = result.diagnostics
    assert case.subject in {d.code for d in diagnostics}, shown(diagnostics)
    allowed = {case.subject, CAUSES.get(case.subject)}
    other = [d for d in diagnostics if d.code not in allowed and d.severity >= checked.Severity.WARNING]
    assert not other, shown(other)
    fixes = list(mending.offered(result.snapshot, case.subject))
    assert not fixes or has_fix(case.subject)
    assert not list(mending.broken_promises(result.snapshot, fixes))


@pytest.mark.parametrize("case", parameters("Good"))
def test_good_example(case: Case, checked: ModuleType, tmp_path: Path) -> None:
    diagnostics, _ = checked.check_text(tmp_path, case.text)
    bad = [d for d in diagnostics if d.code == case.subject or d.severity >= checked.Severity.WARNING]
    assert not bad, shown(bad)


TOO_LARGE = {"nesting-too-deep", "tree-too-large"}
"""Rules about sizes: what is small enough differs in most lines."""


@pytest.mark.parametrize("code", [code for code in WITH_EXAMPLE if code not in TOO_LARGE])
def test_the_good_example_is_near(code: str) -> None:
    """Some good example has most words of a bad one, in their order: the reader sees what makes the difference."""
    words = {title: [_WORD.findall(case.text) for case in examples(code, title)] for title in ("Bad", "Good")}
    pairs = ((bad, good) for bad in words["Bad"] for good in words["Good"])
    assert any(difflib.SequenceMatcher(None, *pair, autojunk=False).ratio() >= MIN_NEARNESS for pair in pairs)


_WORD = re.compile(r"\w+|[^\w\s]")
MIN_NEARNESS = 0.7
"""The least part of the words that two examples have in common, from 0 to 1, as computed by `difflib`."""


@BAD
def test_fixes_keep_line_ends(case: Case, mending: ModuleType, tmp_path: Path) -> None:
    write_files(tmp_path, case.text)
    for path in tmp_path.rglob("*.*"):
        path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    snapshot = mending.workspace_of(tmp_path).snapshot()
    for _, action in mending.offered(snapshot):
        change = action.make()
        for path, after in mending.applied(snapshot, change).items():
            if path not in change.created:
                assert "\n" not in after.replace("\r\n", ""), action.title


@pytest.mark.parametrize("code", [code for code in documents() if has_fix(code)])
def test_the_described_fix_is_offered(code: str, mending: ModuleType, tmp_path: Path) -> None:
    """In some example or case of the rule. That the document describes what is offered is tested with each of them."""
    cases = [case for case in cases_of_rules() if case.subject == code]
    cases += examples(code, "Bad") if code in WITH_EXAMPLE else []
    for number, case in enumerate(reversed(cases)):
        folder = tmp_path / str(number)
        write_files(folder, case.text)
        if any(mending.offered(mending.workspace_of(folder).snapshot(), code)):
            return
    pytest.fail(f"no example or case of {code} has a fix")


def shown(diagnostics: Iterable[Diagnostic]) -> str:
    return "\n".join(f"{Path(d.path).name} {d.span}: {d.severity.label} {d.code}: {d.message}" for d in diagnostics)
