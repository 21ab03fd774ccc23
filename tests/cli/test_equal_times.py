# SPDX-License-Identifier: Apache-2.0
"""The report, `--explain` and `simulate` show the same time for the same event of a trace."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TREE = """\
<root BTCPP_format="4" main_tree_to_execute="Fetch"><BehaviorTree ID="Fetch">
    <Sequence>
        <RetryUntilSuccessful num_attempts="3"><Drive /></RetryUntilSuccessful>
        <ReactiveSequence><IsNear /><Grasp /></ReactiveSequence>
    </Sequence>
</BehaviorTree></root>
"""
NEAR = ("--mock", "IsNear: 1")
STEP = re.compile(r"^ +(\d+)  +(\d+\.\d{3} s)  (\S.*?)  ", re.MULTILINE)
STATUS = re.compile(r"^ +(\d+\.\d{3} s)  (\S+) +(SUCCESS|FAILURE)  ", re.MULTILINE)
TRACE = re.compile(r"^  \S+ failed in (?:the shortest )?trace (\d+)", re.MULTILINE)


def steps(text: str) -> dict[tuple[str, str], str]:
    """The number of a step, and who takes it -> its time."""
    return {(number, who): time for number, time, who in STEP.findall(text)}


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    run(list(arguments))
    return capsys.readouterr().out


@pytest.mark.parametrize("rate", ["10", "7", "3", "13.7"])
def test_trees(tmp_path: Path, capsys: pytest.CaptureFixture[str], rate: str) -> None:
    """A period that is no whole number of ms is that of the clock everywhere; within a tick no time passes."""
    path = tmp_path / "tree.xml"
    path.write_text(TREE, encoding="utf-8")
    options = (str(path), *NEAR, "--mock", "*: 0.4 in 1 s", "--tick-rate", rate)
    traces = ("--method", "fixed", "--max-traces", "30")
    report = shown(capsys, "verify", *options, *traces)
    (number,) = re.findall(r"trace without success \(trace (\d+)\)", report)
    statuses = STATUS.findall(report[report.index("trace without success") :])
    run_ = shown(capsys, "simulate", *options, "--trace", number)
    explained = shown(capsys, "verify", *options, *traces, "--explain")
    assert statuses
    for time, name, status in statuses:
        for text in (run_, explained):
            assert re.search(rf"^ +\d+  +{re.escape(time)}  {name} .*{status}", text, re.MULTILINE), (time, name)
    (ended,) = set(re.findall(r"^the tree ends with FAILURE at (\d+\.\d{3} s)", report, re.MULTILINE))
    assert ended == statuses[-1][0]
    common = steps(explained).items() & steps(run_).items()
    assert len(common) == len(steps(explained).keys() & steps(run_).keys()) > 1


@pytest.mark.parametrize("rate", ["10", "7", "13.7"])
@pytest.mark.parametrize("method", [(), ("--method", "fixed", "--max-traces", "20")])
def test_the_time_until_success(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], rate: str, method: tuple[str, ...]
) -> None:
    path = tmp_path / "tree.xml"
    path.write_text(TREE, encoding="utf-8")
    options = (str(path), *NEAR, "--mock", "*: 1 in 1 s", "--tick-rate", rate)
    (row,) = json.loads(shown(capsys, "verify", *options, *method, "--format", "json"))["tree"]["quantiles"][:1]
    (*_, last) = steps(shown(capsys, "simulate", *options)).values()
    assert row["value"] == pytest.approx(float(last[:-2]), abs=5e-4)


@pytest.mark.parametrize("rate", ["10", "7", "13.7"])
def test_the_end_of_a_tree_without_success(tmp_path: Path, capsys: pytest.CaptureFixture[str], rate: str) -> None:
    """The run ends when the tree ends, although the clock advances once more."""
    path = tmp_path / "tree.xml"
    path.write_text(TREE, encoding="utf-8")
    options = (str(path), *NEAR, "--mock", "*: 0 in 1 s", "--tick-rate", rate)
    report = shown(capsys, "verify", *options)
    (ended,) = set(re.findall(r"^the tree ends with FAILURE at (\d+\.\d{3} s)", report, re.MULTILINE))
    run_ = shown(capsys, "simulate", *options)
    *_, ((_, who), last) = steps(run_).items()
    assert (who, last) == ("the tree", ended)
    (summary,) = re.findall(r"^  seed 0, trace 0, .* steps, (\S+) s, tree finished$", run_, re.MULTILINE)
    assert float(summary) == pytest.approx(float(ended[:-2]), abs=5e-4)


@pytest.mark.parametrize("options", [(), ("--reaction-time", "instant")])
def test_systems(capsys: pytest.CaptureFixture[str], options: tuple[str, ...]) -> None:
    path = str(EXAMPLES / "assembly_robot" / "main_with_bug.xml")
    property_ = (path, "--property", "never_placed_empty", *options)
    explained = shown(capsys, "verify", *property_, "--method", "fixed", "--max-traces", "30", "--explain")
    (number,) = TRACE.findall(explained)
    run_ = shown(capsys, "simulate", *property_, "--trace", number)
    common = steps(explained).keys() & steps(run_).keys()
    assert len(common) > 10
    assert all(steps(explained)[step] == steps(run_)[step] for step in common)
    (failed,) = re.findall(r"never_placed_empty fails at (\d+\.\d{3} s)", explained)
    assert failed == max(steps(run_).values(), key=lambda time: float(time[:-2]))
