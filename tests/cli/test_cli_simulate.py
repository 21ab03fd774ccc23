# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp simulate`: a run as a story, in files, step by step."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from command import Command

ROBOT = Path(__file__).resolve().parents[2] / "examples/assembly_robot/main_with_bug.xml"


def test_a_run_is_printed_as_a_story(command: Command) -> None:
    done = command("simulate", str(ROBOT), "--seed", "3")
    assert done.status == 0
    lines = done.out.splitlines()
    assert lines[0] == "block_placed passed in trace 0 after 482 steps"
    assert "is ticked in idle → picking: RUNNING" in lines[1]
    assert lines[-1] == "  seed 3, trace 0, 482 steps, 10 s"


def test_the_run_is_the_trace_of_verify(command: Command) -> None:
    """Both tell the same of the trace that speaks against the property."""
    told = command("verify", str(ROBOT), "--property", "never_placed_empty", "--explain", "--seed", "0").out
    (heading,) = [line for line in told.splitlines() if line.startswith("never_placed_empty failed in trace ")]
    trace, steps = heading.split(" trace ")[1].split(" after ")
    done = command("simulate", str(ROBOT), "--property", "never_placed_empty", "--trace", trace)
    assert done.out.startswith(f"never_placed_empty failed in trace {trace} after {steps.split(',')[0]}")


@pytest.mark.parametrize(
    ("arguments", "last"),
    [
        (("--for", "4 s"), "  seed 0, trace 0, 119 steps, 4 s"),
        (("--max-steps", "10"), "  seed 0, trace 0, 10 steps, 1 s"),
    ],
)
def test_options_that_end_the_run(command: Command, arguments: tuple[str, ...], last: str) -> None:
    out = command("simulate", str(ROBOT), *arguments).out
    assert out.splitlines()[-1].rsplit(", ", 1)[1] == last.rsplit(", ", 1)[1]


def test_until_a_message_is_sent(command: Command) -> None:
    out = command("simulate", str(ROBOT), "--until", "/arm/command").out
    assert out.splitlines()[-2].strip() == "sends topic_arm__command_msg(data: 1)"


def test_files(command: Command, tmp_path: Path) -> None:
    names = {kind: str(tmp_path / f"run.{kind}") for kind in ("csv", "json", "mermaid", "html")}
    options = [text for kind, name in names.items() for text in (f"--{kind}", name)]
    done = command("simulate", str(ROBOT), "--seed", "3", *options)
    assert (done.status, done.out) == (0, "")
    rows = list(csv.DictReader(Path(names["csv"]).read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 483
    assert rows[0]["Arm.state"] == "still"
    assert rows[-1]["time"] == "10"
    value = json.loads(Path(names["json"]).read_text(encoding="utf-8"))
    assert (value["verdict"], len(value["steps"])) == ("passed", 482)
    assert value["steps"][-1]["changes"] == {
        "Arm.holding": False,
        "topic_block__placed_msg.valid": True,
        "topic_block__placed_msg__ros_fields__data": True,
    }
    assert Path(names["mermaid"]).read_text(encoding="utf-8").startswith("sequenceDiagram\n")
    assert "<table>" in Path(names["html"]).read_text(encoding="utf-8")


def test_a_saved_run_is_repeated(command: Command, tmp_path: Path) -> None:
    saved = str(tmp_path / "run.json")
    first = command("simulate", str(ROBOT), "--seed", "3", "--for", "5 s", "--save", saved)
    assert command("simulate", str(ROBOT), "--script", saved).out == first.out


def test_interactive_commands(command: Command, tmp_path: Path) -> None:
    saved = tmp_path / "run.json"
    lines = f"g 4 s\ns\nt\nb 10\n1\nnonsense\nu /nowhere\ne\nw {saved}\nq\n"
    out = command("simulate", str(ROBOT), "--seed", "3", "--interactive", stdin=lines.encode()).out
    assert "> step 119, 4.000 s\n" in out
    assert "  Arm: moving (holding: true, way: 0)\n" in out
    assert "  MoveToGoal (bt_1006): RUNNING\n" in out
    assert "way: 0 → 1" in out
    assert "`nonsense` is neither a choice nor a command" in out
    assert "there is no event, topic, service or action `/nowhere`" in out
    assert f"written to {saved}" in out
    decisions = json.loads(saved.read_text(encoding="utf-8"))["decisions"]
    assert sum(isinstance(row, dict) for row in decisions) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--until", "nowhere"), "there is neither a property nor an event of this name"),
        (("--property", "nowhere"), "there is no property nowhere"),
        (("--script", "nowhere.json"), "nowhere.json: No such file or directory"),
        (("--constant", "N=1"), "--constant needs a JANI model"),
    ],
)
def test_usage_errors(command: Command, arguments: tuple[str, ...], message: str) -> None:
    done = command("simulate", str(ROBOT), *arguments)
    assert done.status == 2
    assert message in done.err
