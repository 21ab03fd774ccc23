# SPDX-License-Identifier: Apache-2.0
"""The drawings of all conformance models have no geometric errors."""

from __future__ import annotations

from pathlib import Path

import pytest
from drawing_check import problems

from conformance import ROOT, systems
from roaml import api
from roaml.figures.layout import LayoutDirection
from roaml.ide.diagrams import DiagramKind, draw, picture_of
from roaml.project.settings import Settings

FOLDERS = sorted({path.parent for path in systems()})


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.relative_to(ROOT).as_posix())
def test_drawings(folder: Path) -> None:
    analysis = api.check([str(folder)], settings=Settings()).snapshot.analysis
    mains = [str(path) for path in systems() if path.parent == folder]
    machines = map(str, folder.rglob("*scxml"))
    subjects = [(DiagramKind.MACHINE, path) for path in machines]
    subjects += [(kind, path) for kind in (DiagramKind.TREE, DiagramKind.ROS) for path in mains]
    shown = 0
    for kind, path in subjects:
        picture = picture_of(kind, analysis, path)
        for direction in LayoutDirection if picture else ():
            assert picture is not None
            assert problems(picture, draw(kind, picture, direction)) == [], (path, kind, direction)
            shown += 1
    assert shown > 0
