# SPDX-License-Identifier: Apache-2.0
"""The drawings of all conformance models, trees and models with errors have no geometric errors."""

from __future__ import annotations

from pathlib import Path

import pytest
from drawing_check import problems

from conformance import ROOT, Mistake, mistakes, systems
from roaml import api
from roaml.figures.layout import LayoutDirection
from roaml.ide.diagrams import (
    OUTLINE_WIDTHS,
    DiagramKind,
    EdgeKind,
    Picture,
    collapsed,
    draw,
    draw_outline,
    picture_of,
    tree_picture,
)
from roaml.mocks.mock import read_mock
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings

FOLDERS = sorted({path.parent for path in systems()})


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.relative_to(ROOT).as_posix())
def test_drawings(folder: Path) -> None:
    analysis = api.check([str(folder)], settings=Settings(ignore=CODES)).snapshot.analysis
    mains = [str(path) for path in systems() if path.parent == folder]
    machines = map(str, folder.rglob("*scxml"))
    subjects = [(DiagramKind.MACHINE, path) for path in machines]
    subjects += [(kind, path) for kind in DiagramKind if kind is not DiagramKind.MACHINE for path in mains]
    shown = 0
    for kind, path in subjects:
        picture = picture_of(kind, analysis, path)
        if picture is not None:
            check(kind, picture, path)
            shown += 1
    assert shown > 0


def check(kind: DiagramKind, picture: Picture, path: str) -> None:
    for direction in LayoutDirection:
        assert problems(picture, draw(kind, picture, direction)) == [], (path, kind, direction)
    if kind is DiagramKind.TREE:
        for width in OUTLINE_WIDTHS:
            assert problems(picture, draw_outline(picture, width)) == [], path


TREES = sorted({path.parent for path in (ROOT / "trees").rglob("*.xml")})


@pytest.mark.parametrize("folder", TREES, ids=lambda folder: folder.relative_to(ROOT).as_posix())
def test_trees_without_a_system_with_mocks_and_with_collapsed_nodes(folder: Path) -> None:
    analysis = api.check([str(folder)], settings=Settings(ignore=CODES)).snapshot.analysis
    mocks = [read_mock("*: 0.9 in 1 s")]
    for path in map(str, folder.glob("*.xml")):
        for picture in (tree_picture(analysis, path), tree_picture(analysis, path, mocks)):
            if picture is not None:
                check(DiagramKind.TREE, picture, path)
                inner = [edge.source for edge in picture.edges if edge.kind is EdgeKind.CHILD]
                check(DiagramKind.TREE, collapsed(picture, inner[len(inner) // 2 :][:1]), path)


@pytest.mark.parametrize("mistake", mistakes(), ids=lambda mistake: mistake.id)
def test_models_with_errors(mistake: Mistake) -> None:
    """They are drawn as far as possible."""
    analysis = api.check([str(mistake.folder)], settings=Settings(ignore=CODES)).snapshot.analysis
    for path in sorted(map(str, mistake.folder.rglob("*xml"))):
        for kind in DiagramKind:
            picture = picture_of(kind, analysis, path)
            if picture is not None:
                check(kind, picture, path)


def test_a_tree_without_nodes_has_no_picture(tmp_path: Path) -> None:
    file = tmp_path / "tree.xml"
    file.write_text('<root BTCPP_format="4"><BehaviorTree ID="T"/></root>')
    analysis = api.check([str(tmp_path)], settings=Settings(ignore=CODES)).snapshot.analysis
    assert picture_of(DiagramKind.TREE, analysis, str(file)) is None
