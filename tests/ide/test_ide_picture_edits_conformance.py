# SPDX-License-Identifier: Apache-2.0
"""All actions on all parts of the pictures of the conformance models."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from conformance import INTERFACES, ROOT, systems
from mending import applied
from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.ide.diagrams import DiagramKind, picture_of
from roaml.ide.picture_edits import ActionRefusal, Answer, PictureAction, PictureParts, UserQuestion, answer
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import Location


def parts(analysis: Analysis, system: str) -> Iterator[tuple[Location, PictureAction]]:
    allowed = PictureParts(analysis)
    pictures = [picture_of(kind, analysis, system) for kind in (DiagramKind.SYSTEM, DiagramKind.TREE, DiagramKind.ROS)]
    shown = [part for picture in pictures if picture for part in (*picture.nodes, *picture.edges)]
    uses = [node.use for picture in pictures if picture for node in picture.nodes]
    for place in dict.fromkeys((*(part.place for part in shown), *uses)):
        for action in allowed.actions(place):
            assert place is not None
            yield place, action


def last_answer(analysis: Analysis, place: Location, action: PictureAction) -> Answer:
    """The answer when each question is answered with its last option, or with a new name."""
    answers: list[str] = []
    while isinstance(answered := answer(analysis, place.path, place.span, action, answers), UserQuestion):
        answers.append(answered.options[-1].answer if answered.options else "entirely_new")
    return answered


@pytest.mark.parametrize("model", systems(), ids=lambda path: str(path.relative_to(ROOT)))
def test_each_action_leaves_a_well_formed_file(model: Path) -> None:
    snapshot = Workspace((str(model.parent),), Settings(ros_paths=(str(INTERFACES),))).snapshot()
    edited = set()
    for place, action in parts(snapshot.analysis, str(model)):
        change = last_answer(snapshot.analysis, place, action)
        if isinstance(change, ActionRefusal):
            continue
        assert isinstance(change, WorkspaceEdit)
        texts = applied(snapshot, change)
        after = snapshot.with_texts(texts).analysis
        for path in texts:
            document = after.document(path) if path.endswith("xml") else None
            assert document is None or not document.findings, (place, action)
        machine = after.machine(place.path)
        assert machine is None or all(chart.states for chart in machine.charts), (place, action)
        edited.add(action)
    assert {PictureAction.ADD_STATE, PictureAction.ADD_TRANSITION, PictureAction.RENAME} <= edited
    if snapshot.analysis.tree_paths(str(model)):
        assert {PictureAction.WRAP, PictureAction.CHANGE_NODE, PictureAction.SET_NAME} <= edited
