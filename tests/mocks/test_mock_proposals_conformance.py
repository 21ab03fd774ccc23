# SPDX-License-Identifier: Apache-2.0
"""The trees of Nav2 run with the mocks that are proposed for them."""

from __future__ import annotations

from pathlib import Path

import pytest

from conformance import ROOT
from roaml import api
from roaml.api.trees import loaded_tree
from roaml.mocks.network import MockOptions

NAV2 = [path for path in sorted((ROOT / "trees" / "nav2").glob("*.xml")) if "<BehaviorTree" in path.read_text("utf-8")]


@pytest.mark.parametrize("path", NAV2, ids=lambda path: path.stem)
def test_trees_of_nav2_run_with_their_proposals(path: Path) -> None:
    leaves = api.propose_mocks(str(path))
    mocks = api.read_mocks(api.proposed_text(path.name, leaves))
    loaded = loaded_tree(api.check([str(path)]).snapshot, str(path), MockOptions(mocks))
    assert not loaded.mocked.assumed
    assert len(loaded.mocked.leaves) >= 2
