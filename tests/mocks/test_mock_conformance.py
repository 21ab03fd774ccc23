# SPDX-License-Identifier: Apache-2.0
"""Every tree of Nav2 can be verified with mocks by one command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import conformance
from as2fm_lsp.cli.main import run

NAV2 = sorted(path for path in (conformance.ROOT / "trees/nav2").glob("*.xml") if path.name != "nav2_tree_nodes.xml")


@pytest.mark.parametrize("path", NAV2, ids=lambda path: path.stem)
def test_every_tree_of_nav2_verifies(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", str(path), "--mock", "*: 0.9 in 1 s", "--max-traces", "50", "--format", "json"]) == 0
    value = json.loads(capsys.readouterr().out)
    measured = value["tree"]
    ends = (measured[name]["value"] for name in ("success", "failure", "unfinished", "exceptions"))
    assert sum(ends) == pytest.approx(1)
