# SPDX-License-Identifier: Apache-2.0
"""Errors planted in trees of Nav2 and BehaviorTree.CPP: each is reported at its place, without consequential
findings."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

import conformance
from roaml import api
from roaml.diagnostics import Diagnostic, Severity

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

TREES = conformance.ROOT / "trees"
PLANTED = tomllib.loads(Path(__file__).with_name("planted_trees.toml").read_text(encoding="utf-8"))["planted"]


@pytest.fixture(scope="module")
def trees(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("trees")
    shutil.copytree(TREES, folder, dirs_exist_ok=True)
    return folder


def findings(path: Path) -> list[Diagnostic]:
    result = api.check([str(path)])
    return [d for d in result.diagnostics if d.path == str(path) and d.severity >= Severity.INFORMATION]


@pytest.mark.parametrize("mistake", PLANTED, ids=lambda mistake: f"{mistake['code']}: {mistake['new'][:30]}")
def test_planted_mistake(mistake: dict[str, str], trees: Path) -> None:
    path, old, code = trees / mistake["file"], mistake["old"], mistake["code"]
    sound = path.read_text(encoding="utf-8")
    assert old in sound
    before = {(d.code, d.message) for d in findings(path)}
    text = sound.replace(old, mistake["new"], 1)
    path.write_text(text, encoding="utf-8")
    try:
        planted = [d for d in findings(path) if (d.code, d.message) not in before]
    finally:
        path.write_text(sound, encoding="utf-8")
    shown = [(d.code, text[d.span.start : d.span.end], d.message) for d in planted]
    if not code:  # two names that may be constants of the program
        assert {d.severity for d in planted} == {Severity.INFORMATION}
        assert [text[d.span.start : d.span.end] for d in planted] == ["color", "RED"]
    else:
        assert [(d.code, text[d.span.start : d.span.end]) for d in planted] == [(code, mistake["place"])], shown


def test_sound_trees_have_no_finding() -> None:
    result = api.check([str(TREES)])
    bad = [d for d in result.diagnostics if d.severity >= Severity.WARNING]
    assert [(Path(d.path).name, d.code) for d in bad] == [("nav2_tree_nodes.xml", "unknown-element")]
    assert "`<inout_port>`" in bad[0].message
