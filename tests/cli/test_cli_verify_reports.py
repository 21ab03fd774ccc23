# SPDX-License-Identifier: Apache-2.0
"""`verify --format github | gitlab | sarif | markdown`: what is wrong, at the line where the counterexample ends."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from command import Command, Done

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
EXPECTED = ("--property", "never_placed_empty", "--expect", "never_placed_empty >= 0.99")
TRACES = ("--method", "fixed", "--max-traces", "50", "--scheduler", "uniform")
MESSAGE = "`never_placed_empty`: "


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    shutil.copytree(EXAMPLES / "assembly_robot", tmp_path, dirs_exist_ok=True)
    return tmp_path


def arm_line(robot: Path) -> int:
    """The line of the arm at which the gripper is opened without a block: where the property fails."""
    lines = (robot / "arm.ascxml").read_text().splitlines()
    return next(number for number, line in enumerate(lines, 1) if "_msg.data == 3" in line)


@pytest.mark.parametrize("traces", [(), TRACES], ids=["exact", "traces"])
def test_github(command: Command, robot: Path, traces: tuple[str, ...]) -> None:
    done = command("verify", "main_with_bug.xml", *EXPECTED, *traces, "--format", "github")
    assert done.status == 1
    (line,) = done.out.splitlines()
    where, _, message = line[2:].partition("::")
    assert where.startswith(f"error file=arm.ascxml,line={arm_line(robot)},")
    assert where.endswith(",title=expectation-not-met")
    assert message.startswith(MESSAGE)
    assert "; expected ≥ 0.99: NOT MET" in message
    assert message.endswith("; the shortest trace that shows it ends here")


def test_gitlab(command: Command, robot: Path) -> None:
    (row,) = json.loads(command("verify", "main_with_bug.xml", *EXPECTED, "--format", "gitlab").out)
    assert row["check_name"] == "expectation-not-met"
    assert row["location"]["path"] == "arm.ascxml"
    assert row["location"]["lines"]["begin"] == arm_line(robot)


def test_sarif(command: Command, robot: Path) -> None:
    (run,) = json.loads(command("verify", "main_with_bug.xml", *EXPECTED, "--format", "sarif").out)["runs"]
    assert [rule["id"] for rule in run["tool"]["driver"]["rules"]] == ["expectation-not-met"]
    (result,) = run["results"]
    place = result["locations"][0]["physicalLocation"]
    assert (place["artifactLocation"]["uri"], place["region"]["startLine"]) == ("arm.ascxml", arm_line(robot))
    assert len(result["relatedLocations"]) > 1, "the turns before"


def test_markdown(command: Command, robot: Path) -> None:
    done = command("verify", "main_with_bug.xml", *EXPECTED, "--format", "markdown")
    lines = done.out.splitlines()
    assert lines[0] == "| property | value | expected | verdict |"
    assert lines[2].startswith("| `never_placed_empty` | = 0.5 ")
    assert "| ≥ 0.99 | NOT MET" in lines[2]
    assert any(line.startswith(f"| `arm.ascxml:{arm_line(robot)}` | error | `never_placed_empty`: ") for line in lines)
    checked = command("check", "main.xml", "--format", "markdown")
    assert checked.out == "8 files checked: no diagnostics\n\n"


@pytest.mark.parametrize("format_", ["github", "gitlab", "sarif"])
def test_nothing_is_reported_if_all_is_as_expected(command: Command, robot: Path, format_: str) -> None:
    expected = ("--property", "never_placed_empty", "--expect", "never_placed_empty >= 0.1")
    done = command("verify", "main_with_bug.xml", *expected, *TRACES, "--format", format_)
    assert done.status == 0
    assert "expectation-not-met" not in done.out


@pytest.mark.parametrize("format_", ["github", "gitlab", "sarif", "markdown"])
def test_errors_in_the_model_are_reported_as_by_a_check(command: Command, robot: Path, format_: str) -> None:
    arm = robot / "arm.ascxml"
    arm.write_text(arm.read_text().replace('location="holding"', 'location="hodling"'))

    def output(done: Done) -> str:
        return done.out.replace("8 files", "files")

    verified = command("verify", "main.xml", "--format", format_)
    assert verified.status == 1
    checked = command("check", "main.xml", "--severity", "error", "--format", format_)
    assert output(verified) == output(checked)
    assert "undeclared-variable" in verified.out


def test_a_property_without_an_answer(command: Command, robot: Path) -> None:
    done = command(
        "verify", "main.xml", "--property", "block_placed", "--exhaustive", "--max-states", "10", "--format", "github"
    )
    assert done.status == 1
    assert done.out.startswith("::error file=main.xml,line=1,endLine=1,")
    assert "title=property-not-answered::`block_placed`: undecided: " in done.out
