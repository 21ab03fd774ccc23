# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify MAIN.xml|MODEL.jani`"""

from __future__ import annotations

import csv
import errno
import io
import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from command import Command
from smc_models import Json, at, automaton, document, edge, op, probability, variable, way

import as2fm_lsp.atomic_write
from as2fm_lsp.cli.progress_bar import ProgressBar, line, search_line
from as2fm_lsp.cli.status_line import StatusLine
from roaml import api
from roaml.smc.goal import Question
from roaml.smc.lss import FIRST_SELECTION_TRACE, Search, SelectedScheduler, Side
from roaml.smc.run import EstimationMethod, Options
from roaml.smc.tally import Tally
from roaml.verification.expectations import parse
from timeouts import TIMEOUT_S


@pytest.fixture
def robot(command: Command, tmp_path: Path) -> Path:
    """The system that `init` writes, the working directory of the command."""
    command("init", ".")
    return tmp_path


def write(folder: Path, written: Json, name: str = "model.jani") -> str:
    (folder / name).write_text(json.dumps(written, indent=1), encoding="utf-8")
    return name


def coin(p: float = 0.3, **more: Any) -> Json:
    goal = op("F", op("=", "x", 1))
    properties = {"heads": probability(goal), "never": probability(op("G", op("≤", "x", 1)))}
    steps = [edge("s", way("e", p, x=1), way("e", 1 - p))]
    return document(automaton("a", "s e", steps), variables=[variable("x")], properties=properties, **more)


def rows(text: str) -> dict[str, dict[str, Any]]:
    return {row["property"]: row for row in json.loads(text)["results"]}


def test_verifies_what_init_writes(command: Command, robot: Path) -> None:
    done = command("verify", "main.xml", "--format", "json", "--seed", 1)
    assert (done.status, done.err) == (0, "")
    results = rows(done.out)
    names = {"all_delivered", "never_empty", "docks_only_when_low", "never_delivers_when_empty"}
    assert {name: row["probability"] for name, row in results.items()} == dict.fromkeys(names, 1.0)
    assert set(results["all_delivered"]) >= {"lower", "upper", "traces", "undecided", "seed", "method", "confidence"}
    assert not (robot / "main.jani").exists()


def test_undecided_traces_are_not_vacuous(command: Command, robot: Path) -> None:
    options = ("--method", "fixed", "--max-traces", 20, "--max-steps", 40)
    done = command("verify", "main.xml", "--property", "docks_only_when_low", *options)
    assert done.out.startswith("docks_only_when_low: undecided: all 20 traces were cut after 40 steps")
    assert "vacuous" not in done.out
    assert "did not happen" not in done.out


def test_text_says_how_choices_were_made(command: Command, robot: Path) -> None:
    done = command("verify", "main.xml", "--property", "never_empty", "--reaction-time", "any", "--epsilon", "0.05")
    assert done.status == 0
    assert done.out.startswith("never_empty: minimum undecided; under uniform choices: 1 in [0.9")
    assert "uniform choices: each step that is possible is equally probable; a scheduler: " in done.out
    assert "all_delivered" not in done.out


def test_expectations_decide_the_exit_status(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, coin())
    met = command("verify", name, "--expect", "heads <= 0.4", "--expect", "never >= 1")
    assert (met.status, "expected ≤ 0.4: met" in met.out) == (0, True)
    missed = command("verify", name, "--expect", "heads >= 0.4", "--format", "json", "--method", "adaptive")
    assert missed.status == 1
    (judged,) = rows(missed.out)["heads"]["expectations"]
    assert judged == {"expected": "≥ 0.4", "met": False, "certain": True, "under_uniform_choices_only": False}
    exactly = rows(command("verify", name, "--expect", "heads >= 0.4", "--format", "json").out)["heads"]
    assert exactly["expectations"] == [{**judged, "not_met": "the value is 0.3"}]
    assert command("verify", name, "--expect", "heads = 0.3").status == 0
    assert command("verify", name, "--expect", "heads = 0.305").status == 1
    assert command("verify", name, "--expect", "heads = 0.305", "--method", "adaptive").status == 1, "exact at the end"
    assert command("verify", name, "--expect", "heads = 0.32").status == 1


def test_a_threshold_of_the_property_is_an_expectation(command: Command, tmp_path: Path) -> None:
    written = coin()
    for number, status in ((0.2, 0), (0.4, 1)):
        value = op("≥", {"op": "Pmin", "exp": op("F", op("=", "x", 1))}, number)
        written["properties"] = [{"name": "p", "expression": value}]
        for method in ("adaptive", "sprt"):
            done = command("verify", write(tmp_path, written), "--method", method)
            assert done.status == status
            assert f"expected ≥ {number}" in done.out


def test_undecided_traces_count_against_an_expectation(command: Command, tmp_path: Path) -> None:
    steps = [edge("s", way("e", 0.9, x=1), way("l", 0.1)), edge("l", "m"), edge("m", "l")]
    goal = {"p": probability(op("F", op("=", "x", 1)))}
    name = write(tmp_path, document(automaton("a", "s e l m", steps), variables=[variable("x")], properties=goal))
    options = ("--max-steps", 100, "--method", "fixed", "--max-traces", 1000)
    done = command("verify", name, *options, "--expect", "p >= 0.94")
    assert done.status == 1
    assert " were cut after 100 steps: raise max-steps" in done.out
    assert command("verify", name, *options, "--expect", "p <= 0.94").status == 0, "the exact value is less"


def test_a_value_is_unknown_if_no_trace_is_decided(command: Command, tmp_path: Path) -> None:
    counts = edge("s", way("s", x=op("+", "x", 1)))
    goal = {"p": probability(op("F", op("=", "x", 50)))}
    name = write(tmp_path, document(automaton("a", "s", [counts]), variables=[variable("x")], properties=goal))
    done = command("verify", name, "--max-steps", 5, "--method", "adaptive")
    assert "p: undecided: all 100 traces were cut after 5 steps: raise max-steps, or" in done.out
    assert "the interval is wider" not in done.out, "there is none"
    few = command("verify", name, "--max-steps", 5, "--method", "adaptive", "--max-states", 2).out
    assert few.startswith("p: undecided: all 100 traces were cut after 5 steps: ")
    assert "note: the minimum of p over all schedulers is undecided" in few


def test_junit(command: Command, tmp_path: Path) -> None:
    done = command("verify", write(tmp_path, coin()), "--expect", "heads >= 0.9", "--format", "junit")
    suites = ET.fromstring(done.out)
    cases = {case.get("name"): case for case in suites.iter("testcase")}
    assert set(cases) == {"heads", "never"}
    assert cases["heads"].find("failure") is not None
    assert cases["never"].find("failure") is None


def test_results_do_not_depend_on_jobs(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, coin())

    def numbers(*options: object) -> dict[str, dict[str, Any]]:
        results = rows(command("verify", name, "--format", "json", *options).out)
        return {key: {k: v for k, v in row.items() if k != "seconds"} for key, row in results.items()}

    assert numbers("--jobs", 1) == numbers("--jobs", 2) == numbers()
    assert numbers("--seed", 1) != numbers()


# ------------------------------------------------------------------ why


def late(command: Command, folder: Path) -> None:
    """The system that `init` writes, with too little time: three parcels in five seconds."""
    main = (folder / "main.xml").read_text()
    (folder / "main.xml").write_text(main.replace('value="60"', 'value="7"'))


def test_properties_share_traces_with_the_same_results(command: Command, robot: Path) -> None:
    shared, separate = (
        rows(command("verify", "main.xml", "--format", "json", "--epsilon", 0.05, *more).out)
        for more in ((), ("--separate",))
    )
    assert [{**row, "seconds": 0} for row in shared.values()] == [{**row, "seconds": 0} for row in separate.values()]
    assert len(shared) == 4


def test_a_result_without_an_expectation_is_neither_good_nor_bad(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, coin())
    options = (name, "--expect", "never >= 1", "--epsilon", "0.05")
    done = command("verify", *options)
    assert done.status == 0
    assert "\nno expectation set: heads\n" in done.out
    verdicts = {
        row: values["verdict"] for row, values in rows(command("verify", *options, "--format", "json").out).items()
    }
    assert verdicts == {"heads": "no expectation set", "never": "met"}
    suites = ET.fromstring(command("verify", *options, "--format", "junit").out)
    cases = {case.get("name"): case for case in suites.iter("testcase")}
    skipped = cases["heads"].find("skipped")
    assert skipped is not None
    assert skipped.get("message") == "no expectation set"
    assert cases["never"].find("skipped") is None
    assert (suites.get("tests"), suites.get("failures"), suites.get("skipped")) == ("2", "0", "1")


def test_expectations_in_the_configuration(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, coin())
    (tmp_path / "as2fm.toml").write_text('[verify.expect]\nheads = ">= 0.9"\nelsewhere = "< 1"\n', encoding="utf-8")
    done = command("verify", name)
    assert done.status == 1
    assert "\n  expected ≥ 0.9: NOT MET" in done.out
    assert "\nno expectation set: never\n" in done.out
    assert "elsewhere" not in done.out
    assert command("verify", name, "--property", "never").status == 0
    (tmp_path / "as2fm.toml").write_text('[verify.expect]\nheads = ">= 1.5"\n', encoding="utf-8")
    done = command("verify", name)
    assert done.status == 2
    assert "a number from 0 to 1, not 1.5" in done.err


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('expect = ["x"]', "`verify.expect` must be a table"),
        ('expect.heads = "often"', "the expectation of `heads` must be a comparison with a number"),
        ("expect.heads = 1", "the expectation of `heads` must be a comparison with a number"),
        ("expects = 1", "there is no setting `verify.expects`; valid settings are `expect`, `scheduler` and `uniform`"),
    ],
)
def test_wrong_expectations_in_the_configuration(command: Command, tmp_path: Path, written: str, message: str) -> None:
    (tmp_path / "as2fm.toml").write_text(f"[verify]\n{written}\n", encoding="utf-8")
    done = command("verify", write(tmp_path, coin()))
    assert done.status == 2
    assert message in done.err


def test_unanimous_traces_prove_no_certainty(command: Command, tmp_path: Path) -> None:
    name, traces = write(tmp_path, coin()), ("--method", "adaptive", "--scheduler", "uniform")
    done = command("verify", name, "--expect", "never >= 1", "--expect", "heads >= 0.1", *traces)
    assert (
        "expected ≥ 1: met; no trace of 200 contradicts it, which proves nothing: the interval reaches down to 0.98\n"
        in done.out
    )
    assert "expected ≥ 0.1: met\n" in done.out
    done = command("verify", write(tmp_path, coin(0.0)), "--expect", "heads <= 0", "--property", "heads", *traces)
    assert re.search(
        r"expected ≤ 0: met; no trace of 200 contradicts it, which proves nothing: the interval reaches up to 0\.0[12]",
        done.out,
    )


def test_a_value_that_is_almost_1_is_not_1(command: Command, tmp_path: Path) -> None:
    """Of 60 attempts, one succeeds with the probability 1 - 2**-60, which no float64 can tell from 1."""
    trying = op("<", "n", 60)
    steps = [edge("s", way("t", 0.5), way("s", 0.5, n=op("+", "n", 1)), guard=trying)]
    goals = {"p": probability(op("F", op("=", "done", 1)))}
    steps.append(edge("t", way("u", 1, done=1)))
    variables = [variable("n"), variable("done")]
    name = write(tmp_path, document(automaton("a", "s t u", steps), variables=variables, properties=goals))
    done = command("verify", name, "--expect", "p >= 1", "--exhaustive")
    amount = r"fails with a probability of at most 2e-16|fails, but too rarely to compute how often"
    assert re.match(rf"p: almost 1 \(({amount})\) for all", done.out)
    assert "expected ≥ 1: NOT MET: the value is less than 1, as an example trace shows" in done.out
    assert done.status == 1
    assert "expected ≥ 0.99: met" in command("verify", name, "--expect", "p >= 0.99", "--exhaustive").out


def test_explains_a_failing_trace(command: Command, robot: Path) -> None:
    late(command, robot)
    done = command("verify", "main.xml", "--property", "all_delivered", "--explain", "--seed", 0)
    assert done.status == 0
    story = done.out.partition("all_delivered failed in trace ")[2]
    assert "it reads /parcels.data" in story
    # Each line contains its time and its place; the changes follow below it.
    lines = (robot / "plugins/deliver.ascxml").read_text().splitlines()
    number = next(n for n, text in enumerate(lines, 1) if '<bt_tick target="carrying"' in text)
    (first, *_) = [text for text in story.splitlines() if "  Deliver " in text and "is ticked" in text]
    assert f"plugins/deliver.ascxml:{number}" in first
    assert ".000 s  Deliver " in first
    assert "sends a request to /hand_over" in story
    assert re.search(r"\n +\w+: \S+ → \S+", story)


def test_explains_as_diagram_and_page(command: Command, robot: Path) -> None:
    late(command, robot)
    done = command("verify", "main.xml", "--explain", "why.mmd", "--explain", "why.html", "--format", "json")
    assert "there is no trace in which it fails" in done.err
    diagram = (robot / "why.mmd").read_text()
    assert diagram.startswith("sequenceDiagram\n")
    named = [row.partition(" as ") for row in diagram.splitlines() if "participant" in row]
    participants = {head.split()[1]: name for head, _, name in named}
    assert {"Building", "Deliver"} <= set(participants.values())
    arrows = [row for row in diagram.splitlines() if "->>" in row]
    assert arrows
    for row in arrows:
        source, _, rest = row.strip().partition("->>")
        assert {source, rest.partition(":")[0]} <= participants.keys()
    page = (robot / "why.html").read_text()
    assert "<html" in page
    assert "Building" in page
    assert "http" not in page.replace("http-equiv", "")


def test_explains_why_something_bad_happens(command: Command, tmp_path: Path) -> None:
    """If the expected probability is low, the trace in which the property holds is shown."""
    done = command("verify", write(tmp_path, coin()), "--expect", "heads <= 0.1", "--explain")
    assert done.status == 1
    assert "heads passed in the shortest trace after 1 step" in done.out
    assert "x: 0 → 1" in done.out
    done = command("verify", "model.jani", "--expect", "heads <= 0.1", "--explain", "--method", "adaptive")
    assert "heads passed in trace " in done.out
    assert "x: 0 → 1" in done.out


def test_writes_traces(command: Command, robot: Path) -> None:
    late(command, robot)
    options = ("--property", "all_delivered", "--traces", "out", "--traces-limit", 2)
    assert command("verify", "main.xml", *options).status == 0
    names = sorted(path.name for path in (robot / "out").iterdir())
    assert {name.rpartition("-")[2] for name in names} <= {"failed.csv", "failed.json", "passed.csv", "passed.json"}
    (first, *_) = [name for name in names if name.endswith("failed.csv")]
    table = list(csv.DictReader(io.StringIO((robot / "out" / first).read_text())))
    written = json.loads((robot / "out" / first.replace(".csv", ".json")).read_text())
    assert [row["step"] for row in table] == [str(n) for n in range(len(written["steps"]) + 1)]
    assert written["verdict"] == "failed"
    times = [float(row["time"]) for row in table]
    assert times == sorted(times)
    assert times[-1] >= 6
    levels = {row["/battery.data"] for row in table}
    assert levels >= {"0", "40", "100"}
    moves = [move for step in written["steps"] for move in step["moves"]]
    places = {(move["file"], move["line"]) for move in moves if move["automaton"] == "Battery"}
    assert {file for file, _ in places} == {"nodes/battery.ascxml"}
    values = dict(written["initial"])
    for step in written["steps"]:
        values.update({c["variable"]: c["value"] for c in step["changes"] if "automaton" not in c})
    shown = {written["names"].get(name, name): value for name, value in values.items()}
    numbers = {name: str(int(value)) for name, value in shown.items() if isinstance(value, (bool, int))}
    assert numbers.items() <= table[-1].items()


def test_any_name_is_a_column(command: Command, tmp_path: Path) -> None:
    """Line ends, quotes and separators in names of variables do not break the table."""
    names = ["a,b", 'c"d', "e\rf", "g\nh", "i"]
    goal = op("F", op("=", "i", 1))
    steps = [edge("s", way("e", **dict.fromkeys(names, 1)))]
    variables = [variable(name) for name in names]
    model = document(automaton("a", "s e", steps), variables=variables, properties={"done": probability(goal)})
    assert command("verify", write(tmp_path, model), "--traces", "out", "--traces-limit", 1).status == 0
    (path,) = tmp_path.glob("out/*.csv")
    with path.open(encoding="utf-8", newline="") as file:
        header, first, last = csv.reader(file)
    assert header == ["step", "end", *names]
    assert first == ["0", "", *["0"] * 5]
    assert last[2:] == ["1"] * 5


def test_a_full_disk_leaves_whole_traces(command: Command, robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_whole = as2fm_lsp.atomic_write.write_file
    written: list[str] = []

    def write_file(path: str, lines: Iterable[str]) -> None:
        if len(written) == 3:
            raise OSError(errno.ENOSPC, "No space left on device", path)
        written.append(path)
        write_whole(path, lines)

    monkeypatch.setattr(as2fm_lsp.atomic_write, "write_file", write_file)
    done = command("verify", "main.xml", "--traces", "out")
    assert done.status == 2
    assert "No space left on device" in done.err
    assert "never_empty: minimum undecided" in done.out
    assert sorted(written) == sorted(f"out/{path.name}" for path in (robot / "out").iterdir())


# ------------------------------------------------------------------ long runs


def test_resume(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, coin())
    whole = rows(command("verify", name, "--method", "fixed", "--max-traces", 5000, "--format", "json").out)
    first = command("verify", name, "--method", "fixed", "--max-traces", 1000, "--resume", "state.json")
    assert first.status == 0
    state = json.loads((tmp_path / "state.json").read_text())
    assert state["properties"]["heads"]["tally"]["traces"] == 1000
    again = command(
        "verify", name, "--method", "fixed", "--max-traces", 5000, "--resume", "state.json", "--format", "json"
    )
    keys = ("probability", "traces", "steps")
    for name in ("heads", "never"):
        one, other = rows(again.out)[name], whole[name]
        assert [one[key] for key in keys] == [other[key] for key in keys]
        # The user has seen results before choosing other options, so the interval must be valid at any stopping time.
        assert (one["interval"], other["interval"]) == ("confidence sequence", "Clopper-Pearson")
        assert one["lower"] <= other["lower"] <= other["upper"] <= one["upper"]


def test_resume_of_a_property_in_xml(command: Command, tmp_path: Path) -> None:
    for name, text in COIN_IN_XML.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    fixed = ("verify", "main.xml", "--method", "fixed", "--scheduler", "uniform", "--format", "json")
    whole = rows(command(*fixed, "--max-traces", 600).out)["tossed"]
    first = rows(command(*fixed, "--max-traces", 200, "--resume", "state.json").out)["tossed"]
    again = rows(command(*fixed, "--max-traces", 600, "--resume", "state.json").out)["tossed"]
    counts = ("traces", "passed", "failed", "undecided", "open_at_end_of_time", "vacuous", "steps", "ends")
    assert first["traces"] == 200
    assert [again[count] for count in counts] == [whole[count] for count in counts]
    assert min(whole["passed"], whole["failed"], whole["open_at_end_of_time"]) > 0


COIN_IN_XML = {
    "main.xml": """<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="coin.ascxml" /></node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>""",
    "coin.ascxml": """<ascxml name="Coin" version="1.0" initial="toss">
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="heads" topic="/heads" type="std_msgs/Empty" />
    <ros_topic_publisher name="tails" topic="/tails" type="std_msgs/Empty" />
    <state id="toss">
        <ros_rate_callback name="second">
            <target id="toss" prob="0.4"><ros_topic_publish name="heads" /></target>
            <target id="toss"><ros_topic_publish name="tails" /></target>
        </ros_rate_callback>
    </state>
</ascxml>""",
    "properties.xml": """<properties>
    <ports>
        <ros_topic topic_name="/heads" type="std_msgs/Empty" event="publish"><event_var id="heads" /></ros_topic>
        <ros_topic topic_name="/tails" type="std_msgs/Empty" event="publish"><event_var id="tails" /></ros_topic>
    </ports>
    <guarantees>
        <property id="tossed" pattern="response">
            <events><event>tails</event><event>heads</event></events>
            <scope type="globally" />
            <time_interval time="3" time_unit="s" />
        </property>
    </guarantees>
</properties>""",
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda folder: write(folder, coin(0.4)), "another model"),
        (lambda folder: (folder / "state.json").write_text("{}"), "not the state of a verification"),
        (lambda folder: (folder / "state.json").write_text("nonsense"), "not the state of a verification"),
    ],
)
def test_a_state_that_does_not_fit(command: Command, tmp_path: Path, change: Any, message: str) -> None:
    name = write(tmp_path, coin())
    command("verify", name, "--resume", "state.json")
    change(tmp_path)
    before = (tmp_path / "state.json").read_bytes()
    done = command("verify", name, "--resume", "state.json")
    assert done.status == 2
    assert message in done.err
    assert (tmp_path / "state.json").read_bytes() == before
    assert command("verify", write(tmp_path, coin()), "--resume", "other.json").status == 0
    assert command("verify", write(tmp_path, coin()), "--resume", "other.json", "--seed", 5).status == 2


INTERRUPTIBLE = """
import runpy, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
runpy.run_module("as2fm_lsp", run_name="__main__", alter_sys=True)
"""
"""Processes that a shell starts in the background ignore SIGINT, unless it is reset. Whole test runs may run there."""


@contextmanager
def started(folder: Path, *arguments: str, **more: Any) -> Iterator[subprocess.Popen[str]]:
    """A command that keeps running. It is ended after the test in any case."""
    command = [sys.executable, "-c", INTERRUPTIBLE, "verify", *arguments]
    with subprocess.Popen(command, cwd=folder, text=True, stdout=subprocess.PIPE, **more) as running:
        try:
            yield running
        finally:
            running.kill()


def test_interrupted_by_the_keyboard(tmp_path: Path) -> None:
    """The results so far are printed and saved, and another run continues from there."""
    name = write(tmp_path, coin())
    options = (name, "--property", "heads", "--method", "fixed", "--max-traces", "900000000", "--jobs", "2")
    options += ("--resume", "state.json")
    with started(tmp_path, *options, "--format", "json", stderr=subprocess.PIPE, start_new_session=True) as running:
        while not (tmp_path / "state.json").exists():
            assert running.poll() is None
            time.sleep(0.05)
        os.killpg(running.pid, signal.SIGINT)
        out, err = running.communicate(timeout=TIMEOUT_S)
    assert (running.returncode, err) == (130, "")
    row = rows(out)["heads"]
    assert row["interrupted"]
    assert row["lower"] < 0.3 < row["upper"]
    kept = json.loads((tmp_path / "state.json").read_text())["properties"]["heads"]["tally"]
    assert kept["traces"] == row["traces"] > 0


@pytest.mark.parametrize("is_group", [False, True])
def test_terminated(tmp_path: Path, is_group: bool) -> None:
    """SIGTERM, for example of `timeout`, alone or also to the workers: the same, without warnings of Python."""
    name = write(tmp_path, coin())
    options = (name, "--property", "heads", "--method", "fixed", "--max-traces", "900000000", "--jobs", "2")
    with started(tmp_path, *options, "--format", "json", stderr=subprocess.PIPE, start_new_session=True) as running:
        while not has_workers(running.pid):
            assert running.poll() is None
            time.sleep(0.05)
        (os.killpg if is_group else os.kill)(running.pid, signal.SIGTERM)
        out, err = running.communicate(timeout=TIMEOUT_S)
    assert (running.returncode, err) == (143, "")
    row = rows(out)["heads"]
    assert row["interrupted"]
    assert row["lower"] < 0.3 < row["upper"]


def has_workers(main: int) -> bool:
    """Whether a process has workers: children of its only child, from which they are forked."""
    rows = subprocess.run(["ps", "-A", "-o", "ppid=,pid="], capture_output=True, text=True, check=True).stdout
    parents = {int(child): int(parent) for parent, child in (row.split() for row in rows.splitlines())}
    return any(parents.get(parent) == main for parent in parents.values())


def test_interrupted_while_traces_look_for_stuck_ones(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The values are known by then."""

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("roaml.verification.verifier.Verifier.check_stuck", interrupted)
    monkeypatch.setattr("roaml.verification.stuck.can_be_stuck", lambda _: True)
    done = command("verify", write(tmp_path, coin()), "--property", "heads")
    assert done.status == 130
    assert done.out.startswith("heads: = 0.3 for all schedulers")


def test_interrupted_before_there_are_results(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("as2fm_lsp.cli.verify.read_target", interrupted)
    done = command("verify", write(tmp_path, coin()))
    assert (done.status, done.out) == (130, "")
    assert done.err.endswith("as2fm-lsp: interrupted before there were results\n")


def test_a_bar_on_a_terminal(tmp_path: Path) -> None:
    name = write(tmp_path, coin())
    ours, theirs = pty.openpty()
    options = (name, "--method", "fixed", "--max-traces", "900000000", "--jobs", "1")
    with started(tmp_path, *options, stderr=theirs) as running:
        os.close(theirs)
        seen = b""
        while b"traces" not in seen:
            seen += os.read(ours, 1000)
        running.send_signal(signal.SIGINT)
        out, _ = running.communicate(timeout=TIMEOUT_S)
    os.close(ours)
    assert b"heads" in seen
    assert "interrupted; this is the result so far" in out


def endless() -> Json:
    """A model with choices whose traces are long enough to be interrupted."""
    steps = [edge("s", way("s", n=op("+", "n", 1)), guard=op("<", "n", 500_000)), edge("s", way("t", x=1))]
    steps.append(edge("t", way("t", m=op("+", "m", 1)), guard=op("<", "m", 500_000)))
    goals = {"p": probability(op("F", op("=", "m", 500_000)))}
    variables = [variable("n"), variable("m"), variable("x")]
    return document(automaton("a", "s t", steps), variables=variables, properties=goals)


def test_a_search_for_schedulers_shows_how_far_it_is_and_can_be_interrupted(tmp_path: Path) -> None:
    name = write(tmp_path, endless())
    ours, theirs = pty.openpty()
    with started(tmp_path, name, "--scheduler", "lss", "--jobs", "1", stderr=theirs) as running:
        os.close(theirs)
        seen = b""
        while b"schedulers tried" not in seen:
            seen += os.read(ours, 1000)
        running.send_signal(signal.SIGINT)
        out, _ = running.communicate(timeout=TIMEOUT_S)
    os.close(ours)
    assert re.search(rb"p, minimum probability: round \d+ of \d+, [\d,]+ of [\d,]+ schedulers tried", seen)
    assert running.returncode == 130
    assert "interrupted" in out
    assert "seed 0" in out


def test_progress_bar_of_a_search() -> None:
    question, state = Question("p", "Pmin", False, None, ()), Search(rounds=9)
    assert search_line(question, state, Options()) == "p, minimum probability …"
    state.round, state.left, state.done, state.best = 2, 160, 40, 0.125
    text = search_line(question, state, Options())
    assert text == "p, minimum probability: round 2 of 9, 40 of 160 schedulers tried, best so far 0.125"
    state.selected[Side.LEAST] = SelectedScheduler(7, Tally(traces=250, successes=100))
    text = search_line(question, state, Options(method=EstimationMethod.FIXED, max_traces=1000))
    assert text.startswith("p, minimum probability ━━━━━───────────────  25%  250 traces  0.4 [0.29")
    state.side = Side.GREATEST
    assert search_line(question, state, Options()).startswith("p, maximum probability: round 2 of 9")


def test_progress_bar() -> None:
    question = Question("p", "Pmin", False, None, ())
    text = line(
        question, Options(method=EstimationMethod.FIXED, max_traces=1000), Tally(traces=250, successes=100), 10.0
    )
    assert text.startswith("p ━━━━━───────────────  25%  250 traces  0.4 [0.29")
    assert text.endswith("30 s left")
    assert line(question, Options(), Tally(), 1.0) == "p …"


def test_the_progress_within_a_trace_has_no_internal_number(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    monkeypatch.setattr(StatusLine, "is_due", True)
    monkeypatch.setattr(StatusLine, "show", lambda _, text: shown.append(text))
    bar = ProgressBar()
    bar.begin(Question("p", "Pmin", False, None, ()), Options(), Tally(traces=250, successes=100))
    bar.pulse(FIRST_SELECTION_TRACE, 10_000)
    assert "  250 traces  " in shown[0]
    assert shown[0].endswith(", a trace at step 10,000")


# ------------------------------------------------------------------ other answers


@pytest.mark.parametrize("option", ["--exhaustive", "--exact"])
def test_exhaustive(command: Command, tmp_path: Path, option: str) -> None:
    name = write(tmp_path, coin())
    exact = rows(command("verify", name, option, "--format", "json").out)["heads"]["exact"]
    assert [exact[key] for key in ("least", "greatest", "uniform")] == [pytest.approx(0.3)] * 3
    assert (exact["states"], exact["shortest"]) == (3, {"failed": 1, "passed": 1})
    done = command("verify", name, option, "--explain", "--verbose")
    assert re.match(r"heads: = 0.3 for all schedulers, exact, 3 states, \d+\.\d s\n", done.out)
    assert "  shortest traces: it fails after 1 step, it holds after 1 step\n" in done.out
    assert "heads failed in the shortest trace after 1 step" in done.out
    assert done.status == 0


def test_limits_of_an_exhaustive_verification(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, coin())
    done = command("verify", name, "--exhaustive", "--max-states", 2, "--expect", "heads >= 0")
    assert done.status == 1
    remedy = "raise this limit, or estimate the value from traces with uniform choices instead"
    reason = f"stopped at 2 states (max-states); {remedy}"
    assert done.out.startswith(f"heads: undecided: {reason}, ")
    assert "  expected ≥ 0: undecided\n" in done.out
    row = rows(command("verify", name, "--exhaustive", "--max-states", 2, "--format", "json").out)["heads"]
    assert (row["undecided"], row["growing"]) == (reason, [])
    assert "so far" not in done.out
    junit = command("verify", name, "--exhaustive", "--max-states", 2, "--format", "junit").out
    assert 'message="undecided: stopped at 2 states' in junit
    assert command("verify", name, "--exhaustive", "--max-memory", "none").status == 2
    assert command("verify", name, "--exhaustive", "--max-memory", "100M").status == 0


def test_invariants_are_proved(command: Command, tmp_path: Path) -> None:
    written = coin()
    heads = written["properties"][0]["expression"]["values"]["exp"]["exp"]
    for symbol, goal in (("G", op("¬", op("∧", heads, op("¬", heads)))), ("F", op("∧", heads, op("¬", heads)))):
        written["properties"] = [{"name": "p", "expression": probability(op(symbol, goal))}]
        out = command("verify", write(tmp_path, written), "--exhaustive", "--verbose").out
        states = "all 3 states" if symbol == "G" else "none of the 3 states"
        assert f"  proof: its condition holds in {states}\n" in out
        row = rows(command("verify", "model.jani", "--exhaustive", "--format", "json").out)["p"]
        assert row["exact"]["proof"] == ("all" if symbol == "G" else "none")


def test_schedulers(command: Command, tmp_path: Path) -> None:
    written = coin()
    written["automata"][0]["edges"].append(edge("s", way("e", 0.8, x=1), way("e", 0.2)))
    name = write(tmp_path, written)
    options = ("--scheduler", "lss", "--epsilon", 0.03, "--property", "heads")
    result = rows(command("verify", name, *options, "--format", "json").out)["heads"]
    assert result["least"]["probability"] == pytest.approx(0.3, abs=0.05)
    assert result["greatest"]["probability"] == pytest.approx(0.8, abs=0.05)
    assert command("verify", name, *options).out.startswith("heads: minimum with the best scheduler found: about 0.")
    out = command("verify", name, *options[:-1], "Pmax=? [ F x=1 ]").out
    assert re.match(
        r"Pmax.*: maximum with the best scheduler found: about 0\.(.|\n)*\nPmax.*: minimum with the best", out
    )


def test_expected_rewards(command: Command, tmp_path: Path) -> None:
    written = coin()
    value = {"op": "Emin", "exp": 2, "accumulate": ["steps"], "reach": op("≤", "x", 1)}
    written["properties"] = [{"name": "cost", "expression": value}]
    written["properties"][0]["expression"]["reach"] = op("=", "x", 1)
    done = command("verify", write(tmp_path, written), "--format", "json")
    assert rows(done.out)["cost"]["expected_value"] == "infinity"
    written["automata"][0]["edges"] = [edge("s", way("e", 0.5, x=1), way("s", 0.5))]
    row = rows(command("verify", write(tmp_path, written), "--format", "json", "--epsilon", 0.05).out)["cost"]
    assert row["lower"] < 4 < row["upper"]


# ------------------------------------------------------------------ what is wrong


def errors(text: str) -> list[dict[str, Any]]:
    entries = json.loads(text)["errors"]
    assert isinstance(entries, list)
    return entries


def place(folder: Path, text: str, name: str = "model.jani") -> int:
    """The line of the first occurrence of a text."""
    lines = (folder / name).read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


def test_unreadable_files(command: Command, tmp_path: Path) -> None:
    (tmp_path / "nonsense.jani").write_text("this is no JSON")
    (tmp_path / "bytes.jani").write_bytes(b"\xff\xfe\x00\xd8")
    (tmp_path / "other.jani").write_text('{"some": "thing"}')
    (tmp_path / "list.jani").write_text("[]")
    for name, status in (("nonsense", 1), ("other", 1), ("list", 1), ("bytes", 2), ("missing", 2)):
        done = command("verify", f"{name}.jani")
        assert (done.status, done.out) == (status, ""), done
        assert f"{name}.jani" in done.err
        assert "Traceback" not in done.err


@pytest.mark.parametrize(
    ("change", "message", "at_text"),
    [
        ({"ref": "x", "value": "y"}, "no variable `y`", '"y"'),
        ({"ref": "x", "value": True}, "`x` must be an int, not a bool", '"value": true'),
        ({"ref": "x", "value": at("v", 7)}, "index 7 is outside of the array, whose length is 2", '"op": "aa"'),
        ({"ref": "x", "value": op("%", 1, "x")}, "division by zero", '"op": "%"'),
        ({"ref": "x", "value": op("+", "big", 1)}, "integer overflow", '"op": "+"'),
        ({"ref": at("v", op("-", "x", 1)), "value": 1}, "index -1 is outside of the array", '"op": "aa"'),
        ({"ref": "small", "value": op("+", "x", 5)}, "5 is outside of the bounds", '"op": "+"'),
        ({"ref": "x", "value": op("floor", op("log", "x", 2))}, "no value", '"op": "log"'),
    ],
)
def test_faults_of_a_model(command: Command, tmp_path: Path, change: Json, message: str, at_text: str) -> None:
    written = coin()
    bounded = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 3}
    array = {"op": "av", "elements": [1, 2]}
    written["variables"] += [
        variable("v", {"kind": "array", "base": "int"}, array),
        variable("big", initial=(1 << 63) - 1),
        variable("small", bounded),
    ]
    written["automata"][0]["edges"][0]["destinations"][1]["assignments"] = [change]
    name = write(tmp_path, written)
    done = command("verify", name, "--format", "json", "--traces", "out", "--resume", "state.json")
    assert done.status == 1
    (row, *_) = errors(done.out)
    assert message in row["message"]
    # An operator is written below the bracket with which it begins.
    assert (row["file"], row["line"]) == (name, place(tmp_path, at_text) - ('"op"' in at_text))
    assert not (tmp_path / "out").exists()
    text = command("verify", name)
    assert text.status == 1
    # An error in the model is reported before any property is evaluated.
    if row["code"] == "model-fault" and json.loads(done.out)["results"]:
        assert [result["error"]["code"] for result in json.loads(done.out)["results"]] == ["model-fault"] * 2
        assert "heads: not answered: " in text.out
    else:
        assert text.out == ""
    assert f"{name}:{row['line']}:{row['column']}: error: " in text.err


def test_faults_of_a_system_are_reported_at_their_line(command: Command, tmp_path: Path) -> None:
    (tmp_path / "a.ascxml").write_text(
        """<ascxml name="a" version="1.0" initial="s">
<datamodel><data id="n" type="int32" expr="2" /><data id="m" type="int32" expr="0" /></datamodel>
<state id="s">
<transition cond="m &gt;= 0" target="s"><assign location="n" expr="n - 1" />
<assign location="m" expr="7 % n" /></transition>
</state>
</ascxml>"""
    )
    goal = {"properties": [{"name": "p", "expression": probability(op("F", False))}]}
    (tmp_path / "p.jani").write_text(json.dumps(goal))
    (tmp_path / "main.xml").write_text(
        '<roaml><parameters><max_time value="1" unit="s" /></parameters><node_models>'
        '<input type="node-ascxml" src="a.ascxml" /></node_models>'
        '<properties><input type="jani" src="p.jani" /></properties></roaml>'
    )
    done = command("verify", "main.xml")
    assert done.status == 1
    assert "a.ascxml:5:" in done.err
    assert "division by zero (in trace 0 of seed 0)" in done.err


def test_constants_without_value_and_other_kinds_of_models(command: Command, tmp_path: Path) -> None:
    written = coin(constants=[{"name": "N", "type": "int"}])
    done = command("verify", write(tmp_path, written))
    assert (done.status, "the constant `N` has no value" in done.err) == (1, True)
    done = command("verify", write(tmp_path, coin(type_="ctmc")))
    assert (done.status, "models of type `ctmc` are not supported" in done.err) == (1, True)
    written = coin()
    del written["variables"][0]["initial-value"]
    done = command("verify", write(tmp_path, written))
    assert (done.status, "`x` has no initial value, its type has no bounds" in done.err) == (1, True)


@pytest.mark.parametrize("type_", ["dtmc", "mdp"])
def test_several_initial_states(command: Command, tmp_path: Path, type_: str) -> None:
    """A model without nondeterminism, except for its initial states, has no words for schedulers."""
    is_chain = type_ == "dtmc"
    written = coin(type_=type_)
    row = written["variables"][0]
    del row["initial-value"]
    row["type"] = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 1}
    expression = written["properties"][0]["expression"]
    name = write(tmp_path, written)
    done = command("verify", name, "--exhaustive")
    which = "minimum and maximum over 2 initial states, which are the only choice"
    assert f"  {which if is_chain else 'the scheduler chooses one of 2 initial states'}\n" in done.out
    assert ("a scheduler:" in done.out, "uniform choices" in done.out) == (not is_chain, not is_chain)
    expression["fun"] = "max"
    name = write(tmp_path, written)
    done = command("verify", name)
    assert "  maximum over 2 initial states\n" in done.out
    done = command("verify", name, "--format", "json")
    assert rows(done.out)["heads"]["exact"]["initial_states"] == {"number": 2, "combined": "max"}
    done = command("verify", name, "--method", "adaptive")
    assert (
        f"warning: this is the mean over 2 initial states{'' if is_chain else ' under uniform choices'}, and"
        in done.out
    )
    assert done.out.startswith("heads: maximum over the initial states ")
    average = "on average over the initial states" if is_chain else "under uniform choices"
    assert f"; {average}: " in done.out
    assert f"; each of 2 initial states is equally probable{'' if is_chain else '; uniform choices: '}" in done.out
    assert ("uniform choices" in done.out) is not is_chain
    done = command("verify", name, "--scheduler", "lss")
    assert "minimum or maximum over several initial states" in done.err


def test_a_property_on_an_unknown_variable(command: Command, tmp_path: Path, robot: Path) -> None:
    written = coin()
    written["properties"][0]["expression"] = probability(op("F", "unknown"))
    name = write(tmp_path, written)
    done = command("verify", name, "--format", "json")
    assert done.status == 1
    assert errors(done.out)[0]["line"] == place(tmp_path, '"unknown"')
    text = (robot / "properties.jani").read_text()
    (robot / "properties.jani").write_text(text.replace("topic_parcels_msg.valid", "topic_parcel_msg.valid"))
    done = command("verify", "main.xml")
    assert (done.status, "properties.jani:" in done.err) == (1, True)


def test_deep_expressions(command: Command, tmp_path: Path) -> None:
    """Every expression that can be read can be compiled."""
    total: Any = "x"
    for _ in range(250):
        total = op("+", total, 0)
    written = coin()
    written["automata"][0]["edges"][0]["destinations"][1]["assignments"] = [{"ref": "x", "value": total}]
    (tmp_path / "deep.jani").write_text(json.dumps(written))
    assert command("verify", "deep.jani").status == 0
    nested: Any = "x"
    for _ in range(250):
        nested = op("abs", op("-", 0, nested))
    written["automata"][0]["edges"][0]["destinations"][1]["assignments"] = [{"ref": "x", "value": nested}]
    (tmp_path / "deep.jani").write_text(json.dumps(written))
    done = command("verify", "deep.jani")
    assert (done.status, done.err) == (0, "")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--property", "unknown"), "has no property `unknown`"),
        (("--expect", "unknown >= 1"), "there is no property `unknown`"),
        (("--expect", "heads is good"), "an expectation must have a form like"),
        (("--expect", "heads >= many"), "an expectation must have a form like"),
        (("--epsilon", "2"), "between 0 and 1"),
        (("--confidence", "0"), "between 0 and 1"),
        (("--max-traces", "0"), "of at least 1"),
        (("--seed", "-1"), "from 0"),
        (
            ("--method", "sprt"),
            "but `heads` has no expectation; set one",
        ),
        (("--explain", "story.doc"), "does not end in"),
        (("--dask", "tcp://127.0.0.1:9"), "there is no Dask scheduler"),
    ],
)
def test_wrong_use(command: Command, tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    done = command("verify", write(tmp_path, coin()), *options)
    assert (done.status, done.out) == (2, "")
    assert message in done.err


def test_expectations_are_read_as_people_write_them() -> None:
    for text, symbol in (("p>=0.5", "≥"), ("p ≤ 0.5", "≤"), ("a b == 0.5", "="), ("p.q < 0.5", "<")):
        expectation = parse(text)
        assert (expectation.threshold.relation.symbol, expectation.threshold.number) == (symbol, 0.5)
    assert parse("a b == 0.5").name == "a b"


def test_from_python(robot: Path) -> None:
    model = api.to_jani(api.load("main.xml"))
    [result] = api.verify(model, ["never_empty"], Options(epsilon=0.05))
    assert result.name == "never_empty"
    assert result.answer is not None
    assert result.answer.value == 1
    with pytest.raises(api.PropertyError, match="has no property `x`"):
        list(api.verify(model, ["x"]))
    (robot / "bad.jani").write_text("{")
    with pytest.raises(api.JaniError):
        api.read_jani("bad.jani")


@pytest.mark.parametrize("options", [(), ("--exhaustive", "--max-states", "500"), ("--max-traces", "20")])
def test_a_property_in_xml_is_shown_as_a_sentence(command: Command, robot: Path, options: tuple[str, ...]) -> None:
    """The sentence is the line below the value, also if there is none, and the comment in JSON."""
    name = ("--property", "never_delivers_when_empty")
    first, second, *_ = command("verify", "main.xml", *name, *options).out.splitlines()
    assert first.startswith("never_delivers_when_empty: ")
    assert second == "  `hands_over && battery <= 10` never holds."
    if "--max-traces" in options:
        (row,) = json.loads(command("verify", "main.xml", *name, *options, "--format", "json").out)["results"]
        assert row["comment"] == second.strip()


def test_the_sentence_of_a_property_in_jani_names_topics_as_ros_does(command: Command, tmp_path: Path) -> None:
    node = """<ascxml name="Robot" version="1.0" initial="s">
  <ros_topic_publisher name="out" topic="arrived" type="std_msgs/Int16" />
  <ros_topic_subscriber name="in" topic="arrived" type="std_msgs/Int16" />
  <ros_time_rate name="t" rate_hz="1" />
  <state id="s">
    <ros_rate_callback name="t" target="s">
      <ros_topic_publish name="out"><field name="data" expr="1" /></ros_topic_publish>
    </ros_rate_callback>
    <ros_topic_callback name="in" target="s" />
  </state>
</ascxml>
"""
    system = """<roaml>
  <parameters><max_time value="2" unit="s" /></parameters>
  <node_models><input type="node-ascxml" src="robot.ascxml" namespace="r0/arm" /></node_models>
  <properties><input type="jani" src="p.jani" /></properties>
</roaml>
"""
    message = "topic_r0__arm__arrived_msg"
    goal = op("F", op("∧", f"{message}.valid", op("=", f"{message}__ros_fields__data", 1)))
    properties = json.dumps({"properties": [{"name": "p", "expression": probability(goal)}]})
    for name, text in (("main.xml", system), ("robot.ascxml", node), ("p.jani", properties)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    out = command("verify", "main.xml").out
    assert "  `/r0/arm/arrived.valid ∧ /r0/arm/arrived.data = 1` holds at some time.\n" in out


def test_the_sentence_of_a_property_in_jani_names_nodes_of_the_tree_and_statuses(
    command: Command, tmp_path: Path
) -> None:
    tree = """<root BTCPP_format="4">
  <BehaviorTree ID="T"><Sequence><AlwaysSuccess/><AlwaysSuccess/></Sequence></BehaviorTree>
</root>
"""
    system = """<roaml>
  <parameters><max_time value="2" unit="s" /></parameters>
  <behavior_tree><input type="bt.cpp-xml" src="bt.xml" /></behavior_tree>
  <properties><input type="jani" src="p.jani" /></properties>
</roaml>
"""
    done = op("=", "bt_1000_response__status", 1)
    first = op("∧", "bt_1001_response.valid", op("≠", "bt_1001_response__status", 2))
    goals = {"done": op("F", done), "first": op("F", first)}
    listed = [{"name": name, "expression": probability(goal)} for name, goal in goals.items()]
    for name, text in (("main.xml", system), ("bt.xml", tree), ("p.jani", json.dumps({"properties": listed}))):
        (tmp_path / name).write_text(text, encoding="utf-8")
    out = command("verify", "main.xml").out
    assert "  `Sequence.status = SUCCESS` holds at some time.\n" in out
    node = "AlwaysSuccess (bt_1001)"
    assert f"  `{node} response.valid ∧ {node}.status ≠ FAILURE` holds at some time.\n" in out
    assert "nodes of the behavior tree: Sequence (bt.xml:2), bt_1001 is AlwaysSuccess (bt.xml:2)\n" in out


def test_the_sentence_of_a_property_in_jani_names_services_and_their_fields(command: Command, tmp_path: Path) -> None:
    system = """<roaml>
  <parameters><max_time value="2" unit="s" /></parameters>
  <node_models>
    <input type="node-ascxml" src="server.ascxml" /><input type="node-ascxml" src="client.ascxml" />
  </node_models>
  <properties><input type="jani" src="p.jani" /></properties>
</roaml>
"""
    service = 'name="open" service_name="/door/open" type="std_srvs/SetBool"'
    server = f"""<ascxml name="Door" version="1.0" initial="s">
  <ros_service_server {service} />
  <state id="s">
    <ros_service_handle_request name="open" target="s">
      <ros_service_send_response name="open">
        <field name="success" expr="true" /><field name="message" expr="''" />
      </ros_service_send_response>
    </ros_service_handle_request>
  </state>
</ascxml>
"""
    client = f"""<ascxml name="Robot" version="1.0" initial="s">
  <ros_service_client {service} />
  <state id="s">
    <onentry>
      <ros_service_send_request name="open"><field name="data" expr="true" /></ros_service_send_request>
    </onentry>
    <ros_service_handle_response name="open" target="end" />
  </state>
  <state id="end" />
</ascxml>
"""
    asked, answered = "srv_door__open_req_client_Robot", "srv_door__open_response_client_Robot"
    goal = op(
        "F", op("∧", f"{asked}__ros_fields__data", op("∧", f"{answered}.valid", f"{answered}__ros_fields__success"))
    )
    properties = json.dumps({"properties": [{"name": "p", "expression": probability(goal)}]})
    for name, text in (
        ("main.xml", system),
        ("server.ascxml", server),
        ("client.ascxml", client),
        ("p.jani", properties),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
    out = command("verify", "main.xml").out
    answer = "Robot: /door/open response"
    assert f"  `Robot: /door/open request.data ∧ {answer}.valid ∧ {answer}.success` holds at some time.\n" in out


def test_the_comment_of_a_property_in_jani_is_its_sentence(command: Command, robot: Path) -> None:
    path = robot / "properties.jani"
    written = json.loads(path.read_text(encoding="utf-8"))
    (first, *_) = written["properties"]
    first["comment"] = "All parcels arrive."
    path.write_text(json.dumps(written), encoding="utf-8")
    name = ("--property", first["name"], "--max-traces", "20")
    assert command("verify", "main.xml", *name).out.splitlines()[1] == "  All parcels arrive."
    (row,) = json.loads(command("verify", "main.xml", *name, "--format", "json").out)["results"]
    assert row["comment"] == "All parcels arrive."
