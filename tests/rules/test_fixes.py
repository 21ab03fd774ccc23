# SPDX-License-Identifier: Apache-2.0
"""Every quick fix keeps its promise, and the documents of the rules tell of it."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

import pytest
import test_cases_a
import test_cases_z
from test_documents import WITH_EXAMPLE, examples

from fixture import read_marks, split_files
from mending import applied, broken_promises, found, workspace_of
from roaml.diagnostics import Diagnostic, Fix
from roaml.ide.code_actions import quick_fixes
from roaml.project.fixing import fix_all
from roaml.rules import RULES, document
from roaml.rules.rule import Rule
from roaml.text import Span, TextEdit

BAD = [pytest.param(rule.code, text, id=rule.code) for rule in WITH_EXAMPLE for text in examples(rule.code, "Bad")]
ODD = [
    *(pytest.param(code, text, id=f"{code}: {title}") for code, title, text in test_cases_a.CASES),
    *test_cases_z.CASES,
]


def write(folder: Path, text: str) -> None:
    for name, content in split_files(text).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(read_marks(name, content)[0], encoding="utf-8", newline="")


@pytest.mark.parametrize(("code", "text"), BAD)
def test_fixes_of_the_bad_example(code: str, text: str, tmp_path: Path) -> None:
    write(tmp_path, text)
    assert not list(broken_promises(workspace_of(tmp_path), code))


@pytest.mark.parametrize(("code", "text"), ODD)
def test_fixes_of_odd_cases(code: str, text: str, tmp_path: Path) -> None:
    """Here several things are wrong at once, so that mending one may bring another to light."""
    write(tmp_path, text)
    assert not list(broken_promises(workspace_of(tmp_path), code, errors_may_come=True))


@pytest.mark.parametrize(("code", "text"), BAD)
def test_line_ends_are_those_of_the_file(code: str, text: str, tmp_path: Path) -> None:
    write(tmp_path, text)
    for path in tmp_path.rglob("*.*"):
        path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    snapshot = workspace_of(tmp_path).snapshot()
    for diagnostic in found(snapshot):
        for action in quick_fixes(snapshot, diagnostic.path, diagnostic):
            change = action.make()
            for path, after in applied(snapshot, change).items():
                if path not in change.created:
                    assert "\n" not in after.replace("\r\n", ""), action.title


@cache
def _offers_something() -> frozenset[str]:
    """The rules for which a fix is known."""
    codes = set()
    for parameters in (*BAD, *ODD):
        code, text = parameters.values
        assert isinstance(code, str)
        assert isinstance(text, str)
        if code not in codes:
            with tempfile.TemporaryDirectory() as folder:
                write(Path(folder), text)
                snapshot = workspace_of(Path(folder)).snapshot()
                for diagnostic in found(snapshot):
                    if diagnostic.code == code and any(quick_fixes(snapshot, diagnostic.path, diagnostic)):
                        codes.add(code)
    return frozenset(codes)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_document_tells_of_the_fix(rule: Rule) -> None:
    assert ("\n## Fix\n" in document(rule.code)) is (rule.code in _offers_something())


def test_no_fix_brings_an_error_to_another_file(tmp_path: Path) -> None:
    """The fix removes what is reported in one file and breaks another file of the same system."""
    talker = (
        '<ascxml name="Talker" version="1.0" initial="a"><datamodel><data id="n" type="int32" expr="0"/></datamodel>'
        '<ros_topic_publisher name="told" topic="/told" type="std_msgs/Int32"/>'
        '<state id="a"><transition event="go" target="a"><ros_topic_publish name="told">'
        '<field name="data" expr="1"/></ros_topic_publish></transition></state></ascxml>'
    )
    hearer = (
        '<ascxml name="Hearer" version="1.0" initial="a">'
        '<ros_topic_subscriber name="told" topic="/told" type="std_msgs/Int32"/>'
        '<state id="a"><ros_topic_callback name="told" target="a"><send event="go"/></ros_topic_callback></state>'
        "</ascxml>"
    )
    inputs = "".join(f'<input type="node-ascxml" src="{name}.ascxml"/>' for name in ("talker", "hearer"))
    main = (
        f'<roaml><parameters><max_time value="1" unit="s"/></parameters><node_models>{inputs}</node_models>'
        '<properties><input type="jani" src="p.jani"/></properties></roaml>'
    )
    texts = {"talker.ascxml": talker, "hearer.ascxml": hearer, "main.xml": main, "p.jani": '{"properties": []}'}
    write(tmp_path, "".join(f"-- {name} --\n{text}\n" for name, text in texts.items()))
    snapshot = workspace_of(tmp_path).snapshot()
    path = str(tmp_path / "talker.ascxml")
    source = snapshot.analysis.source(path)
    assert source is not None
    at = source.text.index("/told")
    harmful = Fix("Break the other file", (TextEdit(Span(at, at + 5), "/untold"),), safe=True)

    def chosen(diagnostic: Diagnostic) -> Fix | None:
        return harmful if diagnostic.code == "unused-variable" else None

    assert fix_all(snapshot, [path], chosen, careful=True) == {}
    [(_, text)] = fix_all(snapshot, [path], chosen, careful=False).items()
    assert "/untold" in text
