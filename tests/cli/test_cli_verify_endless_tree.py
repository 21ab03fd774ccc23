# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify`: a tree that no leaf ends needs a bounded number of steps."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command import Command

from roaml.verification import tree_outcome

_TREE = """\
<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <KeepRunningUntilFailure>
            <ForceSuccess><Parallel success_count="2" failure_count="2"><Scan /><Talk /></Parallel></ForceSuccess>
        </KeepRunningUntilFailure>
    </BehaviorTree>
</root>
"""


@pytest.mark.parametrize(
    ("most", "options", "traces"), [(1, (), 100), (10**9, (), 1000), (1, ("--max-traces", "7"), 7)]
)
def test_long_runs_are_repeated_less_often(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int, options: tuple[str, ...], traces: int
) -> None:
    monkeypatch.setattr(tree_outcome, "MAX_STEPS", most)
    (tmp_path / "tree.xml").write_text(_TREE, encoding="utf-8")
    mocks = ("--mock", "Scan: 0.9 in exponential(700 ms)", "--mock", "Talk: 0.5 in exponential(300 ms)")
    done = command(
        "verify", "tree.xml", *mocks, "--max-time", "5 s", "--max-states", "10", "--format", "json", *options
    )
    (row,) = json.loads(done.out)["results"]
    assert row["traces"] == traces
