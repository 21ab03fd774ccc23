# SPDX-License-Identifier: Apache-2.0
"""Experiments on trees with mocks, whose numbers are the parameters, and with parameter files of ROS 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.api.parametric_mocks import MockTexts
from roaml.mocks.mock import MockError

TREE = '<Sequence><RetryUntilSuccessful num_attempts="3"><A/></RetryUntilSuccessful><B/></Sequence>'


@pytest.fixture
def tree(tmp_path: Path) -> str:
    path = tmp_path / "tree.xml"
    path.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="M">{TREE}</BehaviorTree></root>', encoding="utf-8")
    return str(path)


def test_closed_forms(tree: str) -> None:
    """With at most three attempts, the tree succeeds with the probability q (1 - (1 - p)³)."""
    mocks = MockTexts(("A: $(var p)",), "# both\nB: $(var q)\n")
    result = api.experiment(tree, {"p": [0.1, 0.6], "q": [0.5, 1]}, ["succeeds"], mocks=mocks)
    for point in result.points:
        setting = {name: float(value) for name, value in point.setting}
        assert point.value == pytest.approx(setting["q"] * (1 - (1 - setting["p"]) ** 3), abs=1e-9)
    assert len(result.points) == 4


@pytest.mark.parametrize(
    ("sweeps", "texts", "problem"),
    [
        ({"p": [0.5], "r": [1]}, ("A: $(var p)", "B: 1"), "no mock uses the parameter `r`"),
        ({}, ("A: $(var p)", "B: 1"), "the parameter `p` of a mock has no values; give it at least one"),
        ({"p": [0.5]}, ("A: $(var p)",), "these leaves need mocks: B"),
    ],
)
def test_mistakes(tree: str, sweeps: dict[str, list[float]], texts: tuple[str, ...], problem: str) -> None:
    with pytest.raises(MockError) as raised:
        api.experiment(tree, sweeps, ["succeeds"], mocks=MockTexts(texts))
    assert problem in str(raised.value)


def test_the_command(tree: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Without `--mock`, the file beside the tree is used."""
    Path(tree).with_suffix(".mocks").write_text("A: $(var p)\nB: 0.5\n", encoding="utf-8")
    assert run(["experiment", tree, "--set", "p=0.5,1", "--property", "succeeds"]) == 0
    assert capsys.readouterr().out.startswith("  p  succeeds\n0.5  0.4375\n  1  0.5\n")
    assert run(["experiment", tree, "--set", "p=0.5,1", "--mock", "A: 1", "--mock", "B: $(var p)"]) == 0
    assert run(["experiment", "model.jani", "--mock", "A: 1"]) == 2
    assert "a JANI model has none" in capsys.readouterr().err
