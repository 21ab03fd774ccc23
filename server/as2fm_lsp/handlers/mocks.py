# SPDX-License-Identifier: Apache-2.0
"""`as2fm/mocks`, the mocks of a tree that belongs to no system; `as2fm/setMock`, an edit that changes one."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, TypedDict

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, string
from as2fm_lsp.handlers.results import CurrentResults, result_words
from as2fm_lsp.handlers.workspace_edit import workspace_edit
from roaml.ide.lone_tree_mocks import LoneTreeMocks, lone_tree_mocks, set_mock
from roaml.lower.programs.refusal import TreeRefusal
from roaml.mocks.mock import Mock, MockError
from roaml.mocks.proposal import MockableLeaf
from roaml.model.drawn_durations import DrawnDuration
from roaml.project.analysis import Analysis
from roaml.project.mock_files import executed_tree
from roaml.scxml.names import SUCCEEDS

MOCKS = "as2fm/mocks"
SET_MOCK = "as2fm/setMock"
MAX_MILLISECONDS = 24 * 3600 * 1000


class MockRow(TypedDict):
    """A mock that an editor shows. `pattern` names the mock that a change sets, `kind` is the kind of the leaves in
    words, `milliseconds` is null if a duration has no effect or is drawn; `origin` states which mock applies now, or is
    empty; `reason` is the reason for the proposal; `nodes` are the ids of the leaves in the picture of the tree."""

    pattern: str
    kind: str
    probability: float
    milliseconds: float | None
    isSet: bool
    origin: str
    reason: str
    nodes: list[str]


class Mocks(TypedDict):
    """`uri` is that of the file with the mocks, which need not exist. `result` is the known result of the tree in a few
    words, or empty. `problem` is the reason if there are no mocks."""

    uri: str
    exists: bool
    rows: list[MockRow]
    result: str
    problem: str


class MockSet(TypedDict):
    """`problem` is the reason if there is no edit."""

    edit: types.WorkspaceEdit | None
    uri: str
    problem: str


def register(context: Context) -> None:
    session = context.session

    @context.feature(MOCKS)
    def mocks(params: Any) -> Mocks | None:
        """The mocks of a tree; null if the file belongs to a system, or contains no tree that is executed."""
        path = session.convert.path(document_uri(params))
        snapshot = session.moment().snapshot(path)
        analysis = snapshot.analysis
        if executed_tree(analysis, path) is None:
            return None
        known = _known(analysis, path)
        if isinstance(known, str):
            return {"uri": "", "exists": False, "rows": [], "result": "", "problem": known}
        current = CurrentResults(context, snapshot, path)
        found = current.get(SUCCEEDS)
        return {
            "uri": session.convert.uri(known.path),
            "exists": known.exists,
            "rows": [_row(leaf) for leaf in known.leaves if not leaf.kind.has_children],
            "result": "" if found is None else f"{SUCCEEDS}: {result_words(current, found)}",
            "problem": "",
        }

    @context.feature(SET_MOCK)
    def set_(params: Any) -> MockSet:
        """An edit that sets the mock `pattern` to a `probability` and a number of `milliseconds`."""
        context.trust.require(SET_MOCK)
        path = session.convert.path(document_uri(params))
        snapshot = session.moment().snapshot(path)
        known = _known(snapshot.analysis, path)
        if isinstance(known, str):
            return {"edit": None, "uri": "", "problem": known}
        pattern = string(params, "pattern")
        if known.leaf(pattern) is None:
            return {"edit": None, "uri": "", "problem": f"no leaf has the name or type `{pattern}`"}
        probability = _number(params, "probability", 1)
        duration = _number(params, "milliseconds", MAX_MILLISECONDS)
        if probability is None or duration is None:
            return {"edit": None, "uri": "", "problem": "a probability is from 0 to 1, a duration at most a day"}
        drawn = _drawn_duration(known, pattern) if getattr(params, "milliseconds", None) is None else None
        mock = Mock(pattern, probability, drawn or Fraction(str(duration)))
        change = set_mock(snapshot.analysis, path, known, mock)
        return {
            "edit": workspace_edit(context, snapshot, change),
            "uri": session.convert.uri(known.path),
            "problem": "",
        }


def _known(analysis: Analysis, path: str) -> LoneTreeMocks | str:
    """The mocks of a tree, or the reason why there are none."""
    try:
        return lone_tree_mocks(analysis, path)
    except TreeRefusal as refusal:
        return refusal.reason
    except (MockError, ValueError) as error:
        return str(error)


def _drawn_duration(known: LoneTreeMocks, pattern: str) -> DrawnDuration | None:
    """The distribution of the durations of the mock `pattern`, which an editor does not change."""
    mocks = (leaf.mock for leaf in known.leaves if leaf.mock is not None and leaf.proposed.pattern == pattern)
    return next((mock.duration for mock in mocks if isinstance(mock.duration, DrawnDuration)), None)


def _row(leaf: MockableLeaf) -> MockRow:
    mock = leaf.mock or leaf.proposed
    own = leaf.mock is not None and leaf.mock.pattern == leaf.proposed.pattern
    origin = "proposed" if leaf.mock is None else "" if own else f"from `{leaf.mock.pattern}`"
    return {
        "pattern": leaf.proposed.pattern,
        "kind": leaf.kind.value,
        "probability": mock.probability,
        "milliseconds": (
            float(mock.duration) if leaf.kind.has_duration and not isinstance(mock.duration, DrawnDuration) else None
        ),
        "isSet": leaf.mock is not None,
        "origin": origin,
        "reason": leaf.reason,
        "nodes": [str(node.number) for node in leaf.nodes],
    }


def _number(params: Any, name: str, most: float) -> float | None:
    """A number from 0 to `most`; `None` if the parameter is not one. 0 if it is missing."""
    value = getattr(params, name, None)
    if value is None:
        return 0.0
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= most:
        return None
    return float(value)
