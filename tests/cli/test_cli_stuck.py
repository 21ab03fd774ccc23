# SPDX-License-Identifier: Apache-2.0
"""Output of `as2fm-lsp verify` about systems that get stuck, and about the ends of traces."""

from __future__ import annotations

import csv
import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from command import Command
from smc_models import automaton, document, edge, op, probability, variable, way

from roaml.smc.end import End
from stuck_models import hospital

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "verification.md"


@pytest.fixture
def ward(command: Command, tmp_path: Path) -> Path:
    """Eight machines, one of which makes the time stand still. The working directory contains them."""
    return write(tmp_path, hospital())


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def parsed(text: str) -> dict[str, Any]:
    report: dict[str, Any] = json.loads(text)
    return report


def test_a_stuck_system_is_reported_prominently(command: Command, ward: Path) -> None:
    done = command("verify", "main.xml")
    assert done.status == 0
    lines = done.out.splitlines()
    assert re.fullmatch(
        r"  warning: [\d,]+ of [\d,]+ traces got stuck, because machines wait for each other for ever; they say "
        r"nothing about the property, so its value is doubtful; "
        r"for example trace \d+ after 46 steps at 2 s:",
        lines[2],
    )
    assert lines[3].startswith("    the clock waits at 2 s for the tree")
    assert lines[7].startswith("    help: a tick must end before the next one is due")
    assert lines[7].endswith(" [answer-needs-time]")
    assert re.fullmatch(r"  ends: goal decided [\d,]+, stuck [\d,]+", lines[8])
    assert done.out.count("the clock waits") == 1
    assert re.search(
        r"\nprobability of getting stuck: 0\.\d+ in \[0\.\d+, 0\.\d+\] from 100 traces to their end\n"
        r"warning: the system gets stuck and time does not advance; "
        r"who waits for whom is shown above, below `delivered`\n",
        done.out,
    )


def test_a_stuck_system_whose_properties_are_decided_before(command: Command, ward: Path) -> None:
    """No result is doubtful. The waiting automata are shown with the traces that continued."""
    text = (ward / "properties.jani").read_text(encoding="utf-8")
    (ward / "properties.jani").write_text(text.replace('"topic_delivered_msg.valid"', "true"), encoding="utf-8")
    out = command("verify", "main.xml").out
    assert "got stuck" not in out
    assert re.search(
        r"\nwarning: the system gets stuck and time does not advance: trace \d+ after 46 steps at 2 s\n  the", out
    )
    assert out.count("the clock waits") == 1


def test_waiting_automata_are_shown_once_for_two_properties(command: Command, ward: Path) -> None:
    written = json.loads((ward / "properties.jani").read_text(encoding="utf-8"))
    written["properties"].append({**written["properties"][0], "name": "again"})
    (ward / "properties.jani").write_text(json.dumps(written), encoding="utf-8")
    out = command("verify", "main.xml").out
    assert out.count("the clock waits") == 1
    assert "doubtful; who waits for whom is shown above, below `delivered`\n" in out
    explained = command("verify", "main.xml", "--explain").out
    assert explained.count("waits at 2 s for the tree") == 1
    assert explained.count("doubtful; who waits for whom is shown in the trace below\n") == 2
    assert "\n  who waits for whom is shown above, at the end of the trace of `delivered`\n" in explained


def test_waiting_automata_are_shown_as_in_the_manual(command: Command, ward: Path) -> None:
    page = DOCUMENT.read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```text\n(  warning: .*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert shown in command("verify", "main.xml").out


def test_the_manual_names_every_reason() -> None:
    page = DOCUMENT.read_text(encoding="utf-8")
    for reason in End:
        assert f"| {reason.text} | `{reason.key}` |" in page


def test_a_fixed_system_is_not_reported_as_stuck(command: Command, tmp_path: Path) -> None:
    write(tmp_path, hospital(mended=True))
    done = command("verify", "main.xml", "--stuck", "error")
    assert done.status == 0
    assert "stuck" not in done.out
    done = command("verify", "main.xml", "--stuck", "error", "--verbose")
    assert "probability of getting stuck: 0 in [0, " in done.out
    assert parsed(command("verify", "main.xml", "--format", "json").out)["stuck"]["example"] is None


@pytest.mark.parametrize("level", ["warning", "error"])
def test_getting_stuck_can_be_an_error(command: Command, ward: Path, level: str) -> None:
    done = command("verify", "main.xml", "--stuck", level)
    assert done.status == (level == "error")
    assert f"\n{level}: the system gets stuck" in done.out


def test_json(command: Command, ward: Path) -> None:
    report = parsed(command("verify", "main.xml", "--format", "json", "--stuck", "error").out)
    (result,) = report["results"]
    assert result["ends"] == {
        **{reason.key: 0 for reason in End},
        "goal_decided": result["passed"],
        "stuck": result["failed"],
    }
    known = report["stuck"]
    assert (known["level"], known["traces"], known["cut"]) == ("error", 100, 0)
    assert known["lower"] < known["stuck"] / 100 < known["upper"]
    waits = known["example"]["waits"]
    assert [(row["who"], row["file"], row["line"]) for row in waits] == [
        ("the clock", "tree.xml", 3),
        ("the tree", "tree.xml", 5),
        ("Fetch", "fetch.ascxml", line(ward, "fetch.ascxml", "ros_service_handle_response")),
        ("Pharmacy", "pharmacy.ascxml", line(ward, "pharmacy.ascxml", "ros_rate_callback")),
    ]
    assert known["example"]["time"] == 2.0
    assert "return RUNNING" in known["example"]["advice"]
    assert known["example"]["rule"] == "answer-needs-time"
    assert re.match(
        r"[\d,]+ of [\d,]+ traces got stuck, because machines wait for each other for ever; they say ",
        result["warning"],
    )
    assert "minimum" in result["warning"]


def line(folder: Path, name: str, text: str) -> int:
    lines = (folder / name).read_text(encoding="utf-8").splitlines()
    return next(number for number, other_line in enumerate(lines, 1) if text in other_line)


@pytest.mark.parametrize("level", ["warning", "error"])
def test_junit(command: Command, ward: Path, level: str) -> None:
    suites = ET.fromstring(command("verify", "main.xml", "--format", "junit", "--stuck", level).out)
    cases = {case.get("name"): case for case in suites.iter("testcase")}
    assert set(cases) == {"delivered", "does not get stuck"}
    failure = cases["does not get stuck"].find("failure")
    assert (failure is not None) == (level == "error")
    assert suites.get("failures") == ("1" if level == "error" else "0")
    assert suites.get("tests") == "2"
    output = cases["does not get stuck"].findtext("failure" if level == "error" else "system-out") or ""
    assert "Fetch waits in `asked` for the response of the service `/ward/prepare`" in output
    beneath = cases["delivered"].findtext("skipped") or ""
    assert f"  {level}: " in beneath
    assert "    the clock waits at 2 s" in beneath
    requirement, about = cases["delivered"].iter("property")
    assert (requirement.get("name"), about.get("name")) == ("requirement", "warning")
    assert "traces got stuck" in (about.get("value") or "")


def test_the_property_stuck_can_be_verified(command: Command, ward: Path) -> None:
    report = parsed(command("verify", "main.xml", "--property", "stuck", "--format", "json").out)
    (result,) = report["results"]
    assert result["property"] == "stuck"
    assert result["upper"] - result["lower"] < 0.021
    assert result["passed"] == result["ends"]["stuck"]
    assert result["failed"] == result["ends"]["tree_finished"]
    # The property `stuck` was requested, so no further traces are generated.
    assert "traces" not in report["stuck"]
    assert report["stuck"]["example"]["waits"]


def test_it_can_be_expected_not_to_get_stuck(command: Command, tmp_path: Path) -> None:
    write(tmp_path, hospital())
    done = command("verify", "main.xml", "--expect", "stuck <= 0", "--expect", "delivered >= 0")
    assert done.status == 1
    assert "expected ≤ 0: NOT MET" in done.out
    write(tmp_path, hospital(mended=True))
    assert command("verify", "main.xml", "--expect", "stuck <= 0").status == 0


def test_explained_to_the_end(command: Command, ward: Path) -> None:
    for options in ((), ("--property", "stuck")):
        story = command("verify", "main.xml", *options, "--explain").out
        assert re.search(r": trace \d+ gets stuck after \d+ steps; \d+ turns matter", story)
        *last, advice = story.rstrip().splitlines()[-5:]
        assert advice.startswith("  help: a tick must end")
        assert [re.sub(r" {2,}", "  ", text).split("  ")[2] for text in last] == [
            "the clock",
            "the tree",
            "Fetch",
            "Pharmacy",
        ]
        assert last[-1].endswith("pharmacy.ascxml:8")
    command("verify", "main.xml", "--explain", "why.mmd", "--explain", "why.html")
    assert "waits in `busy` for its timer `dispense`" in (ward / "why.mmd").read_text(encoding="utf-8")
    assert "waits in `busy` for its timer `dispense`" in (ward / "why.html").read_text(encoding="utf-8")


def test_traces_contain_the_reason_of_their_end(command: Command, ward: Path) -> None:
    command("verify", "main.xml", "--traces", "out", "--traces-limit", 1)
    (failed,) = sorted((ward / "out").glob("*-failed.csv"))
    with open(failed, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["end"] for row in rows] == [""] * (len(rows) - 1) + ["stuck"]
    assert [int(row["step"]) for row in rows] == list(range(len(rows)))
    trace = json.loads(failed.with_suffix(".json").read_text(encoding="utf-8"))
    assert (trace["verdict"], trace["end"]) == ("failed", "stuck")
    assert trace["waits"][-1]["who"] == "Pharmacy"
    passed = min((ward / "out").glob("*-passed.json"))
    trace = json.loads(passed.read_text(encoding="utf-8"))
    assert (trace["end"], trace.get("waits")) == ("goal_decided", None)


def test_traces_that_were_cut_are_reported(command: Command, ward: Path) -> None:
    done = command("verify", "main.xml", "--max-steps", 30, "--method", "fixed", "--max-traces", 50)
    assert "  ends: too many steps 50\n" in done.out
    assert "undecided: all 100 traces were cut after 30 steps (max-steps)" in done.out


def test_counts_are_saved(command: Command, ward: Path) -> None:
    options = ("verify", "main.xml", "--resume", "state.json", "--format", "json", "--method", "fixed", "--max-traces")
    command(*options, 100)
    more = parsed(command(*options, 300).out)
    fresh = parsed(command("verify", "main.xml", "--format", "json", "--method", "fixed", "--max-traces", 300).out)
    assert more["results"][0]["ends"] == fresh["results"][0]["ends"]
    assert more["stuck"] == fresh["stuck"]


def test_sampled_schedulers_that_get_stuck_are_reported(command: Command, ward: Path) -> None:
    done = command("verify", "main.xml", "--scheduler", "lss", "--epsilon", 0.1)
    assert re.search(r"\n  by sampled scheduler .*\n  warning: .* traces got stuck, because machines wait", done.out)
    assert "warning: the system gets stuck" in done.out


def test_a_trace_with_a_fault_after_its_goal_is_reported(command: Command, tmp_path: Path) -> None:
    """The property is answered, because its traces end before the fault."""
    write(tmp_path, hospital(mended=True))
    text = (tmp_path / "nurse.ascxml").read_text(encoding="utf-8")
    text = text.replace(
        'target="happy" />', 'target="happy"><assign location="a[n]" expr="1" /></ros_topic_callback>'
    ).replace(
        "<ros_topic_subscriber",
        '<datamodel><data id="n" type="int32" expr="Math.floor(Math.pow(49, 0.5))" />'
        '<data id="a" type="int32[3]" expr="[1]" /></datamodel>'
        "<ros_topic_subscriber",
    )
    (tmp_path / "nurse.ascxml").write_text(text, encoding="utf-8")
    done = command("verify", "main.xml")
    assert done.status == 0
    assert "delivered: minimum 0, maximum 1, exact, " in done.out
    assert "  under uniform choices: 1 in" in done.out
    why = "a trace that went on after the properties were decided went wrong: "
    assert f"probability of getting stuck: undecided, because {why}" in done.out


def test_a_model_without_machines_is_not_asked(command: Command, tmp_path: Path) -> None:
    goals = {"p": probability(op("F", op("=", "x", 1)))}
    steps = [edge("s", way("e", 0.3, x=1), way("e", 0.7))]
    written = document(automaton("a", "s e", steps), variables=[variable("x")], properties=goals)
    (tmp_path / "model.jani").write_text(json.dumps(written), encoding="utf-8")
    done = command("verify", "model.jani", "--method", "adaptive")
    assert re.search(r"\n  ends: goal decided [\d,]+, no step possible [\d,]+\n", done.out)
    assert "stuck" not in done.out
    assert command("verify", "model.jani", "--property", "stuck").status == 2
