# SPDX-License-Identifier: Apache-2.0
"""`verify` says why an option has no effect, and what decided a value that a reader would otherwise attribute to the
machines."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import Command

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
ROBOT = EXAMPLES / "assembly_robot" / "main_with_bug.xml"
GRID = EXAMPLES / "grid_world" / "main.xml"
TOO_EARLY = (
    "failed traces (of 200 random examples) fail because the time ends (max_time) before what the property requires"
)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--reaction-time", "instant"), "--reaction-time has no effect: no time passes"),
        (("--max-time", "3 s"), "--max-time has no effect: no time passes"),
        (("--reaction-time", "instant", "--max-time", "3 s"), "--reaction-time and --max-time have no effect: no time"),
        ((), ""),
    ],
)
def test_times_have_no_effect_without_a_clock(command: Command, options: tuple[str, ...], words: str) -> None:
    done = command("verify", GRID, *options)
    assert done.status == 0
    assert done.err.count("no effect") == bool(words)
    assert words in done.err
    assert "no effect" not in command("verify", ROBOT, "--property", "block_dropped", *options).err


def test_quantiles_without_an_expected_value(command: Command, tmp_path: Path) -> None:
    err = command("verify", GRID, "--quantiles", "0.5").err
    assert "--quantiles has no effect: it is about expected values, and no property asks for one; ask for one" in err
    (tmp_path / "tree.xml").write_text(TREE)
    done = command("verify", "tree.xml", "--mock", "*: 0.5 in 1 s", "--quantiles", "0.5")
    assert "the line `time until success` of a tree has quantiles" in done.err
    assert "time until success: mean" in done.out


def test_a_plot_without_curves_is_said(command: Command, tmp_path: Path) -> None:
    given = "P=? [ F block_placed || F block_dropped ]"
    path = tmp_path / "curve.svg"
    done = command("verify", ROBOT, "--property", given, "--plot", path)
    assert "--plot draws nothing: a property with an assumption (`||`) has no curve" in done.err
    assert not path.exists()
    done = command("verify", ROBOT, "--property", "block_dropped", "--max-traces", "100", "--plot", path)
    assert "--plot draws nothing" not in done.err
    assert path.exists()


def test_the_end_of_time_decided(command: Command) -> None:
    """Within 3 s, no trace places the block, which says nothing about the robot. That a block was not lost until the
    end is a success, and the end of time is no reason to doubt it."""
    short = command("verify", ROBOT, "--property", "block_placed", "--max-time", "3 s").out
    assert short.startswith("block_placed: = 0 for all schedulers, exact")
    assert f"  all 200 {TOO_EARLY} has happened; a longer time may satisfy them\n" in short
    assert "the time ends" not in command("verify", ROBOT, "--property", "block_placed").out
    assert "the time ends" not in command("verify", ROBOT, "--property", "never_placed_empty", "--max-time", "5 s").out


TREE = """\
<root BTCPP_format="4">
  <BehaviorTree ID="Main">
    <RetryUntilSuccessful num_attempts="{attempts}"><Grasp/></RetryUntilSuccessful>
  </BehaviorTree>
</root>
""".replace("{attempts}", "3")


@pytest.mark.parametrize(("attempts", "is_said"), [(1, False), (3, True)])
def test_failures_by_chance_are_independent(command: Command, tmp_path: Path, attempts: int, is_said: bool) -> None:
    """Three failures in a row were taken for one that is seen three times."""
    text = TREE.replace('num_attempts="3"', f'num_attempts="{attempts}"')
    (tmp_path / "tree.xml").write_text(text)
    out = command("verify", "tree.xml", "--mock", "Grasp: 0.5 in 1 s").out
    assert "trace without success" in out
    words = f"trace without success; its {attempts} failures happen by chance, independently of each other:\n"
    assert (words in out) is is_said
    assert ("independently" in out) is is_said


def test_a_tree_with_one_node(command: Command, tmp_path: Path) -> None:
    node = '<BehaviorTree ID="M"><AlwaysSuccess/></BehaviorTree>'
    (tmp_path / "one.xml").write_text(f'<root BTCPP_format="4" main_tree_to_execute="M">{node}</root>')
    assert "\n1 node, 0 leaves with mocks; " in command("verify", "one.xml").out
