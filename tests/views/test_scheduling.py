# SPDX-License-Identifier: Apache-2.0
"""What explanations state about the choices of the scheduler, and that all of them begin with the same line."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path

import pytest
from smc_models import Json, automaton, document, edge, op, probability, variable, way

from as2fm_lsp.cli.verify import run
from roaml import api
from roaml.smc.program import FALSE
from roaml.verification.nearest import nearest
from roaml.views.story import as_html, as_text, lines

ROOT = Path(__file__).parent.parent.parent


def doors() -> Json:
    """A robot goes to the left or right door; both may be stuck. Another machine has no influence."""
    robot = [
        edge("home", way("left")),
        edge("home", way("right")),
        edge("left", way("goal", 0.9, done=True), way("pit", 0.1)),
        edge("right", way("goal", 0.5, done=True), way("pit", 0.5)),
    ]
    return document(
        automaton("robot", "home left right goal pit", robot),
        automaton("other", "s t", [edge("s", way("t", k=1))]),
        variables=[variable("done", "bool", False), variable("k")],
        properties={"p": probability(op("F", "done"), "Pmin")},
    )


def result_of(path: Path, **options: object) -> api.Result:
    path.write_text(json.dumps(doors()), encoding="utf-8")
    (result,) = api.verify(api.target(str(path)), **options)  # type: ignore[arg-type]
    return result


def test_the_turn_of_the_scheduler_is_marked(tmp_path: Path) -> None:
    result = result_of(tmp_path / "model.jani", exact_if_small=True)
    assert result.exact is not None
    shortest = result.exact.shortest(FALSE)
    assert shortest is not None
    shown = [(line.who, line.what, line.details) for line in lines(shortest.story(None), lambda _: "")]
    assert [(who, what) for who, what, _ in shown] == [("robot", "home → left"), ("robot", "left → pit")]
    assert [details for _, _, details in shown] == [
        ("chosen by the scheduler among 2 steps",),
        ("by chance, 0.1",),
    ]


@pytest.mark.parametrize("exact_if_small", [False, True])
def test_all_explanations_begin_with_the_same_line(tmp_path: Path, exact_if_small: bool) -> None:
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=100)
    result = result_of(tmp_path / "model.jani", exact_if_small=exact_if_small, options=options)
    assert result.traces is not None
    explained = api.counterexample(result, lambda _: "")
    assert explained is not None
    story = result.traces.story(explained.trace)
    near = nearest(result, story, None)
    assert near is not None
    pair = (near.parting, near.story)
    first, *_ = as_text(story, lambda _: "", "", pair).splitlines()
    assert re.match(
        r"by chance \(0\.\d\), robot (left|right) → pit, unlike in trace \d+, which passed; p fails, ", first
    )
    assert explained.heading.startswith(f"{first}. ")
    page = as_html([story], lambda _: "", "title", {"p": pair})
    assert f"<strong>{html.escape(first)}</strong>" in page


def test_the_files_of_the_command_line_begin_with_the_line_of_its_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("model.jani").write_text(json.dumps(doors()), encoding="utf-8")
    run(["model.jani", "--explain", "--explain", "why.html"])
    first = next(line for line in capsys.readouterr().out.splitlines() if "unlike in" in line)
    assert f"<strong>{html.escape(first)}</strong>" in Path("why.html").read_text(encoding="utf-8")


def test_delays_are_the_scheduler_s(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """If machines may wait, the machine for the battery waits a second before it publishes its level."""
    monkeypatch.chdir(ROOT / "examples/delivery_robot")
    options = ("--max-time", "3 s", "--property", "all_delivered", "--explain")
    run(["main.xml", "--reaction-time", "any", *options])
    out = capsys.readouterr().out
    assert re.search(r"Battery .*\n +delayed by the scheduler until 2\.000 s, before its effects are complete\n", out)
    run(["main.xml", "--reaction-time", "instant", *options])
    assert "delayed by the scheduler" not in capsys.readouterr().out


def test_a_trace_for_a_property_about_a_number_of_steps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The states of the exploration do not contain the number of steps, so the trace is a random one."""
    monkeypatch.chdir(tmp_path)
    turn = edge("s", way("s", 0.5, n=op("%", op("+", "n", 1), 3)), way("s", 0.5, done=True))
    bounds = {"step-bounds": {"upper": 4}}
    properties = {"p": probability({**op("F", "done"), **bounds}, "Pmin"), "q": probability(op("F", "done"))}
    variables = [variable("done", "bool", False), variable("n")]
    model = document(automaton("robot", "s", [turn]), variables=variables, properties=properties)
    Path("model.jani").write_text(json.dumps(model), encoding="utf-8")
    run(["model.jani", "--exhaustive", "--explain"])
    shown = capsys.readouterr()
    assert re.search(r"\n  p failed in trace \d+ after 4 steps; ", shown.out)
    assert shown.err == "q: there is no trace in which it fails\n"
