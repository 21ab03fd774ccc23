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
    assert lines[0] == "block_placed passed in trace 0 after 481 steps"
    assert "is ticked in idle → picking: RUNNING" in lines[1]
    assert lines[-1] == "  seed 3, trace 0, 481 steps, 10 s"


def test_the_run_is_the_trace_of_verify(command: Command) -> None:
    """`simulate` and `verify` describe the counterexample in the same way."""
    story = command("verify", str(ROBOT), "--property", "never_placed_empty", "--explain", "--seed", "0").out
    (heading,) = [line for line in story.splitlines() if line.startswith("  never_placed_empty failed in trace ")]
    trace, steps = heading.split(" trace ")[1].split(" after ")
    done = command("simulate", str(ROBOT), "--property", "never_placed_empty", "--trace", trace)
    assert done.out.startswith(f"never_placed_empty failed in trace {trace} after {steps.split(';')[0]}")


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
    assert out.splitlines()[-2].strip() == "sends /arm/command (data: 1)"


def test_until_a_property_is_decided(command: Command) -> None:
    """`--until` determines the property, instead of the first one of the system."""
    out = command("simulate", str(ROBOT), "--until", "never_placed_empty", "--trace", "0").out
    assert out.startswith("never_placed_empty ")
    done = command("simulate", str(ROBOT), "--until", "never_placed_empty", "--property", "block_placed")
    assert done.status == 2
    assert "--until never_placed_empty and --property block_placed name two properties" in done.err


FAULTY = """{"jani-version": 1, "name": "faulty", "type": "mdp", "features": ["arrays"], "actions": [], "variables": [
{"name": "n", "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 2}, "initial-value": 0}],
"properties": [{"name": "never", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"},
"values": {"op": "Pmax", "exp": {"op": "F", "exp": {"op": "=", "left": "n", "right": 5}}}}}],
"automata": [{"name": "A", "locations": [{"name": "l"}], "initial-locations": ["l"], "edges": [{"location": "l",
"destinations": [{"location": "l", "assignments": [{"ref": "n", "value": {"op": "+", "left": "n", "right": 1}}]}]}]}],
"system": {"elements": [{"automaton": "A"}], "syncs": []}}"""


def test_the_run_up_to_a_fault_is_printed(command: Command, tmp_path: Path) -> None:
    (tmp_path / "faulty.jani").write_text(FAULTY, encoding="utf-8")
    done = command("simulate", str(tmp_path / "faulty.jani"))
    assert done.status == 1
    assert "the run fails after step 2: " in done.err
    assert done.out.splitlines()[-1].endswith(", 2 steps")


def test_the_terminal_survives_a_fault(command: Command, tmp_path: Path) -> None:
    (tmp_path / "faulty.jani").write_text(FAULTY, encoding="utf-8")
    out = command("simulate", str(tmp_path / "faulty.jani"), "--interactive", stdin=b"\n\n\nb\ns\nq\n").out
    assert out.count("the next step fails: ") == 1
    assert "  n: 1\n" in out[out.index("the next step fails: ") :]


def test_files(command: Command, tmp_path: Path) -> None:
    names = {kind: str(tmp_path / f"run.{kind}") for kind in ("csv", "json", "mermaid", "html")}
    options = [text for kind, name in names.items() for text in (f"--{kind}", name)]
    done = command("simulate", str(ROBOT), "--seed", "3", *options)
    assert (done.status, done.out) == (0, "")
    rows = list(csv.DictReader(Path(names["csv"]).read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 482
    assert rows[0]["Arm.state"] == "still"
    assert rows[-1]["time"] == "10.0"
    value = json.loads(Path(names["json"]).read_text(encoding="utf-8"))
    assert (value["verdict"], len(value["steps"])) == ("passed", 481)
    assert value["steps"][-1]["changes"] == [
        {"variable": "topic_block__placed_msg.valid", "name": "/block/placed: valid", "value": True},
        {"variable": "topic_block__placed_msg__ros_fields__data", "name": "/block/placed.data", "value": True},
        {"variable": "holding", "automaton": "Arm", "value": False},
    ]
    assert Path(names["mermaid"]).read_text(encoding="utf-8").startswith("sequenceDiagram\n")
    page = Path(names["html"]).read_text(encoding="utf-8")
    assert f"<h1>{ROBOT.parent.name}/{ROBOT.name}</h1>" in page
    assert ">plugins/pick_up.ascxml:11</small>" in page
    assert ">receives the tick of its timer <code>step</code> in moving" in page


def test_a_saved_run_is_repeated(command: Command, tmp_path: Path) -> None:
    saved = str(tmp_path / "run.json")
    first = command("simulate", str(ROBOT), "--seed", "3", "--for", "5 s", "--save", saved)
    assert command("simulate", str(ROBOT), "--script", saved).out == first.out


def test_interactive_commands(command: Command, tmp_path: Path) -> None:
    saved = tmp_path / "run.json"
    lines = f"g 4 s\ns\nt\nb 10\nb many\n1\nnonsense\nu /nowhere\ne\nw {saved}\nq\n"
    out = command("simulate", str(ROBOT), "--seed", "3", "--interactive", stdin=lines.encode()).out
    assert "> step 118, 4.000 s\n" in out
    assert "  Arm: moving (holding: true, way: 0)\n" in out
    assert "  MoveToGoal: RUNNING\n" in out
    assert "way: 0 → 1" in out
    assert "`b` needs a number of steps" in out
    assert "`nonsense` is neither a choice nor a command" in out
    assert "there is no event, topic, service or action `/nowhere`" in out
    assert f"written to {saved}" in out
    decisions = json.loads(saved.read_text(encoding="utf-8"))["decisions"]
    assert sum(isinstance(row, dict) for row in decisions) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--until", "nowhere"), "there is neither a property nor an event of this name"),
        (("--property", "nowhere"), "has no property `nowhere`"),
        (("--script", "nowhere.json"), "nowhere.json: there is no such file"),
        (("--constant", "N=1"), "--constant needs a JANI model"),
    ],
)
def test_usage_errors(command: Command, arguments: tuple[str, ...], message: str) -> None:
    done = command("simulate", str(ROBOT), *arguments)
    assert done.status == 2
    assert message in done.err


SKIPPING = """<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <Sequence>
            <Script code="x := 1" />
            <ForceSuccess><Skipped _skipIf="x == 1" /></ForceSuccess>
            <Last />
        </Sequence>
    </BehaviorTree>
</root>"""


def test_a_skipped_node(command: Command, tmp_path: Path) -> None:
    tree = tmp_path / "tree.xml"
    tree.write_text(SKIPPING, encoding="utf-8")
    run = ("simulate", str(tree), "--mock", "*: 1 in 1 s")
    assert any("  Skipped " in line and ": SKIPPED " in line for line in command(*run).out.splitlines())
    table = tmp_path / "run.csv"
    assert command(*run, "--csv", str(table)).status == 0
    assert command(*run, "--csv", "-").out == table.read_text(encoding="utf-8")
    rows = list(csv.DictReader(table.open(encoding="utf-8")))
    assert {row["Skipped: status"] for row in rows} == {"IDLE", "TICKED", "SKIPPED"}
    assert {row["Last: status"] for row in rows} == {"IDLE", "TICKED", "RUNNING", "SUCCESS"}
