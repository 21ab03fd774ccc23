# SPDX-License-Identifier: Apache-2.0
"""Diagnostics directly after an edit: in the edited state, the rules that need one state only report what a complete
check reports; everywhere else, the findings move with the text."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from bench.generate import FIRST, write_system
from bench.keystrokes import keys
from fixture import Case, write_files
from fuzz import damage
from roaml.diagnostics import Diagnostic
from roaml.project import provisional
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.rules import BY_CODE, RULES
from roaml.text import Span
from roaml.xml_syntax import Element, parse
from rule_files import cases_of_rules, examples

MACHINE_RULES = [rule.code for rule in RULES if rule.machine or rule.code == "xml-syntax"]
CASES = [case for case in cases_of_rules() if case.subject in MACHINE_RULES]
WAYS = (damage.rename, damage.change_words, damage.change_elements, damage.change_attributes, damage.change_expressions)
EDITS = 25


@pytest.fixture(autouse=True)
def _any_length(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(provisional, "MIN_CHARACTERS", 0)


class Files:
    """The files of a folder, as an editor changes them."""

    def __init__(self, folder: Path) -> None:
        self._workspace = Workspace((str(folder),), Settings())

    def with_text(self, path: Path, text: str) -> Snapshot:
        self._workspace.open(str(path), text)
        return self._workspace.snapshot()

    def checked(self, path: Path, text: str) -> provisional.Checked | None:
        return provisional.checked(self.with_text(path, text).checker, str(path))

    def diagnostics(self, path: Path, text: str) -> tuple[Diagnostic, ...]:
        return self.with_text(path, text).checker.diagnostics(str(path))


def states(text: str) -> list[Element]:
    root = parse(text).root
    return [element for element in (root.elements if root else ()) if element.name == "state" and element.close_span]


def local(diagnostics: tuple[Diagnostic, ...], span: Span) -> set[tuple[str, Span, str]]:
    """The diagnostics in a span that come from rules that need one state only."""
    return {
        (d.code, d.span, d.message)
        for d in diagnostics
        if not BY_CODE[d.code].whole and span.start <= d.span.start and d.span.end <= span.end
    }


@pytest.mark.parametrize("code", MACHINE_RULES)
def test_written_states(code: str, tmp_path: Path) -> None:
    """A state that receives its content has the findings of this content."""
    for number, case in enumerate((*examples(code, "Bad"), *(case for case in CASES if case.subject == code))):
        written_states(tmp_path / str(number), case)


def written_states(folder: Path, case: Case) -> None:
    folder.mkdir()
    write_files(folder, case.text)
    files = Files(folder)
    for path in sorted(folder.glob("**/*.*scxml")):
        text = path.read_text(encoding="utf-8")
        for state in states(text)[:1]:
            content = state.content_span
            known = files.checked(path, text[: content.start] + text[content.end :])
            now = provisional.after(known, text) if known is not None and content.start < content.end else None
            if now is not None:
                assert local(now.diagnostics, state.span) == local(files.diagnostics(path, text), state.span)


def test_random_edits(tmp_path: Path) -> None:
    """After random changes of one state, one after the other, the findings in it are those of a complete check."""
    write_system(tmp_path, files=6, lines=200)
    random, path, files = Random(28), tmp_path / FIRST, Files(tmp_path)
    text = path.read_text(encoding="utf-8")
    compared = 0
    for _ in range(EDITS):
        known = files.checked(path, text)
        assert known is not None
        state = random.choice(states(text)).span
        part = random.choice(WAYS)(random, text[state.start : state.end], (text,))
        changed = text[: state.start] + part + text[state.end :]
        now = provisional.after(known, changed)
        assert now is not None
        complete = files.diagnostics(path, changed)
        span = Span(state.start, state.start + len(part))
        assert local(now.diagnostics, span) == local(complete, span)
        compared += len(local(complete, span))
    assert compared > EDITS


def test_keys(tmp_path: Path) -> None:
    """Key by key, each result from the one before, the findings in the part that is written are those of a complete
    check; and findings elsewhere stay at their words."""
    write_system(tmp_path, files=5, lines=340)
    path, files = tmp_path / FIRST, Files(tmp_path)
    text = path.read_text(encoding="utf-8").replace('location="speed"', 'location="sped"')
    known = files.checked(path, text)
    assert known is not None
    misspelled = sum(d.code == "undeclared-variable" for d in known.diagnostics)
    seen = 0
    for key in keys(text, rounds=1):
        known = provisional.after(known, key.text)
        assert known is not None
        assert known.source.text == key.text
        root = parse(key.text).root
        assert root is not None
        for element in root.elements:
            if element.span.start < key.start < element.span.end:
                complete = local(files.diagnostics(path, key.text), element.span)
                assert local(known.diagnostics, element.span) == complete
                seen += len(complete)
    assert seen > misspelled > 1
    assert sum(key.text[slice(*d.span)] == "sped" for d in known.diagnostics) == misspelled


@pytest.mark.parametrize(
    ("old", "new"),
    [("<ascxml name", "<ascxml nam"), ("</ascxml>", "</ascxm>"), ("<?xml", "<?xm"), ("<state", "<stat" + " " * 20_000)],
)
def test_other_edits(old: str, new: str, tmp_path: Path) -> None:
    """An edit of the root, and a large one, need a complete check."""
    write_system(tmp_path, files=5, lines=100)
    path = tmp_path / FIRST
    text = path.read_text(encoding="utf-8")
    known = Files(tmp_path).checked(path, text)
    assert known is not None
    assert provisional.after(known, text.replace(old, new, 1)) is None


@pytest.mark.parametrize(
    "written", ["<!-- about <state> -->", '<state id="new"><transition target="state_0" event="e" x=""/></state>']
)
def test_unfinished_markup(written: str, tmp_path: Path) -> None:
    """A comment or an element that is being written may contain what follows it. When it is closed, the findings are
    those of a complete check."""
    write_system(tmp_path, files=5, lines=100)
    path, files = tmp_path / FIRST, Files(tmp_path)
    text = path.read_text(encoding="utf-8")
    known = files.checked(path, text)
    assert known is not None
    at = text.index("\n", text.index("</state>"))
    for length in range(1, len(written) + 1):
        known = provisional.after(known, text[:at] + written[:length] + text[at:])
        assert known is not None
    everywhere = Span(0, len(known.source.text))
    complete = local(files.diagnostics(path, known.source.text), everywhere)
    assert {code for code, _, _ in complete} == ({"unknown-attribute"} if "x=" in written else set())
    assert local(known.diagnostics, everywhere) == complete


def test_suppressions_and_settings(tmp_path: Path) -> None:
    """Comments and settings hide findings as in a complete check."""
    write_system(tmp_path, files=5, lines=100)
    path, files = tmp_path / FIRST, Files(tmp_path)
    text = path.read_text(encoding="utf-8")
    known = files.checked(path, text)
    wrong = '<assign location="counter" expr="countr" />'
    hidden = f"<!-- as2fm: ignore[undeclared-variable] -->\n{wrong}"
    for inserted, codes in ((wrong, ["undeclared-variable"]), (hidden, [])):
        assert known is not None
        at = text.index("<onentry>") + len("<onentry>\n")
        now = provisional.after(known, text[:at] + inserted + "\n" + text[at:])
        assert now is not None
        assert [d.code for d in now.diagnostics] == codes
