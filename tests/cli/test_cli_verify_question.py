# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify`: the answer states its question, and a question without an answer is reported."""

from __future__ import annotations

import copy
import json
import os
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command import Command
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from as2fm_lsp.verification.report import one_as_text
from as2fm_lsp.verification.scheduler_report import OTHERS, note
from roaml.explicit.space import StateLimits
from roaml.jani.operators import BinaryOperator
from roaml.rules import document as rule_document
from roaml.smc.choices import Choices
from roaml.smc.goal import Question, Threshold
from roaml.verification.expectations import Expectation, Verdict
from roaml.verification.results import Result, Sampled
from roaml.verification.small import NOTHING_LEFT, SHARED_LIMITS, UNIFORM_LIMITS
from roaml.verification.target import VerificationTarget, target_of
from roaml.verification.verifier import verifier_of


def write(folder: Path, written: Json, name: str = "model.jani") -> str:
    (folder / name).write_text(json.dumps(written, indent=1), encoding="utf-8")
    return name


def rows(text: str) -> dict[str, dict[str, Any]]:
    return {row["property"]: row for row in json.loads(text)["results"]}


def starving(operator: str = "Pmin", length: int = 50, steps: int = 0) -> Json:
    """A machine takes `steps` + 1 steps, unless another machine takes its steps for ever."""
    counts = [edge("a", way("a", w=op("+", "w", 1)), guard=op("<", "w", steps))]
    ends = edge("a", way("b", done=True), guard=op("=", "w", steps))
    return document(
        automaton("busy", "s", [edge("s", way("s", c=op("%", op("+", "c", 1), length)))]),
        automaton("worker", "a b", [ends, *counts]),
        variables=[variable("c"), variable("w"), variable("done", "bool", False)],
        properties={"p": probability(op("F", "done"), operator)},
    )


def coin(**more: Any) -> Json:
    steps = [edge("s", way("e", 0.3, x=1), way("e", 0.7))]
    goal = {"heads": probability(op("F", op("=", "x", 1)))}
    return document(automaton("a", "s e", steps), variables=[variable("x")], properties=goal, **more)


# ------------------------------------------------------------------ minimum and maximum


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ("Pmin=? [ F done ]", "minimum 0, maximum 1"),
        ("Pmax=? [ F done ]", "maximum 1, minimum 0"),
        ("P=? [ F done ]", "minimum 0, maximum 1"),
        ("P>=0.5 [ F done ]", "minimum 0, maximum 1"),
        ("P<=0.5 [ F done ]", "maximum 1, minimum 0"),
    ],
)
def test_the_extreme_for_which_a_property_asks_is_first(
    command: Command, tmp_path: Path, asked: str, words: str
) -> None:
    out = command("verify", write(tmp_path, starving()), "--property", asked).out
    assert f": {words}, 1 under uniform choices, exact, " in out


def test_each_of_two_properties_about_the_same_paths_has_its_extreme_first(command: Command, tmp_path: Path) -> None:
    """They share one exploration."""
    written = starving("Pmax")
    written["properties"] += starving("Pmin")["properties"]
    written["properties"][1]["name"] = "q"
    lines = command("verify", write(tmp_path, written), "--exhaustive").out.splitlines()
    assert any(line.startswith("p: maximum 1, minimum 0, ") for line in lines)
    assert any(line.startswith("q: minimum 0, maximum 1, ") for line in lines)


def test_a_diagnostic_has_the_asked_extreme_first(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, starving("Pmax"))
    done = command("verify", name, "--expect", "p <= 0.1", "--format", "github")
    assert "`p`: maximum 1, minimum 0, exact, " in done.out


def test_a_small_model_is_answered_exactly(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, starving())
    done = command("verify", name, "--expect", "p <= 0.1")
    assert done.status == 0
    first, *others = done.out.splitlines()
    assert first.startswith("p: minimum 0, ")
    assert others == [
        "  `done` holds at some time.",
        "  the property does not hold, for example, if `worker` is delayed for ever while `busy` repeats 50 steps",
        "  expected ≤ 0.1: met by the minimum over all schedulers, which is 0, because the property asks for it; "
        "not met by the maximum, which is 1, so ask for the maximum if all schedulers must meet it",
        "uniform choices: each step that is possible is equally probable; a scheduler: a rule that chooses which of "
        "the possible steps is next, such as which of two messages arrives first",
    ]
    lines = command("verify", name, "--expect", "p <= 0.1", "--verbose").out.splitlines()
    assert re.fullmatch(r"p: minimum 0, maximum 1, 1 under uniform choices, exact, 100 states, \d\.\d s", lines[0])
    assert lines[1:6] == [
        others[0],
        "  shortest traces: it holds after 1 step",
        others[1],
        "  ends of 200 random traces: goal decided 200",
        "  expected ≤ 0.1: met by the minimum over all schedulers, which is 0, because the property asks for it; "
        "not met by the maximum, which is 1, so ask for the maximum if all schedulers must meet it",
    ]
    assert lines[6].startswith("exact values, computed from all reachable states: minimum and maximum over all ")
    assert lines[7:] == others[3:]
    row = rows(command("verify", name, "--format", "json").out)["p"]
    assert [row[key] for key in ("probability", "lower", "upper", "method", "interval")] == [0, 0, 0, "exact", "exact"]
    assert [row["exact"][key] for key in ("least", "greatest", "uniform", "states")] == [0, 1, 1, 100]
    assert (row["minimum"]["value"], row["maximum"]["value"], row["schedulers"]["agree"]) == (0, 1, False)
    assert (row["traces"], row["passed"], "warning" in row) == (200, 200, False)
    row = rows(command("verify", write(tmp_path, starving("Pmax")), "--format", "json").out)["p"]
    assert row["probability"] == 1


@pytest.mark.parametrize(
    "option",
    [
        ("--method", "adaptive"),
        ("--confidence", "0.9"),
        ("--epsilon", "0.1"),
        ("--max-traces", "50"),
        ("--max-steps", "1000"),
        ("--seed", "0"),
        ("--separate",),
        ("--resume", "state.json"),
        ("--traces", "out"),
    ],
)
def test_an_option_for_traces_asks_for_traces(command: Command, tmp_path: Path, option: tuple[str, ...]) -> None:
    row = rows(command("verify", write(tmp_path, coin()), "--format", "json", *option).out)["heads"]
    assert "exact" not in row
    assert row["lower"] < row["probability"] < row["upper"]


def test_more_than_20000_states_are_left_to_traces(command: Command, tmp_path: Path) -> None:
    for steps, is_small in ((198, True), (199, False)):
        written = starving("Pmax", 100, steps)
        out = command("verify", write(tmp_path, written)).out
        assert (", exact, 20,000 states, " in out) is is_small


@pytest.mark.parametrize("steps", [0, 500])
def test_a_minimum_that_a_scheduler_is_known_to_miss_is_refuted(command: Command, tmp_path: Path, steps: int) -> None:
    """The value under uniform choices is 1, which is at least 0.9. But the property asks for the minimum, which is
    0."""
    traces = ("--method", "adaptive")
    done = command("verify", write(tmp_path, starving(steps=steps)), "--expect", "p >= 0.9", *traces)
    assert done.status == 1
    first, *more = done.out.splitlines()
    assert first.startswith(f"p: minimum {'0, exact' if steps == 0 else 'between 0 and 0.'}")
    warnings = [line for line in more if line.startswith("  warning: ")]
    if steps == 0:
        assert not warnings, "the first line contains the minimum"
    else:
        [line] = warnings
        assert line.startswith(
            "  warning: the order of steps matters; the bound of the minimum is from sampled scheduler "
        )
        assert first.partition(" and ")[2].partition(",")[0] not in line, "the first line contains the bound"
    assert "expected ≥ 0.9: NOT MET" in done.out
    row = rows(command("verify", "model.jani", "--format", "json", *traces).out)["p"]
    assert row["probability"] == 1
    assert (row["minimum"]["value"], row["maximum"]["value"]) == (0, 1)
    assert row["minimum"]["found"] == ("all states" if steps == 0 else "sampled schedulers")
    assert row["schedulers"]["agree"] is False
    assert "asks for the minimum" in row["warning"]


def test_the_side_that_is_asked_for_decides(command: Command, tmp_path: Path) -> None:
    """One scheduler can show that a minimum is small, or that a maximum is large."""
    for operator, expected, status in (
        ("Pmin", "p <= 0.1", 0),
        ("Pmin", "p >= 0.1", 1),
        ("Pmax", "p >= 0.9", 0),
        ("Pmax", "p <= 0.9", 1),
        ("Pmin", "p = 0", 0),
        ("Pmin", "p = 1", 1),
        ("Pmax", "p = 1", 0),
    ):
        name = write(tmp_path, starving(operator))
        assert command("verify", name, "--expect", expected).status == status, (operator, expected)


def test_all_schedulers_agree(command: Command, tmp_path: Path) -> None:
    done = command("verify", write(tmp_path, coin()), "--expect", "heads <= 0.4")
    assert done.status == 0
    assert done.out.startswith("heads: = 0.3 for all schedulers, exact, 3 states, ")
    assert "expected ≤ 0.4: met\n" in done.out
    assert "warning" not in done.out
    row = rows(command("verify", "model.jani", "--format", "json").out)["heads"]
    assert row["schedulers"]["agree"] is True
    assert row["minimum"] == row["maximum"]
    assert "warning" not in row
    traces = command("verify", "model.jani", "--method", "adaptive").out
    assert "the exact value is 0.3 for all schedulers: all 3 states were explored" in traces
    few = command("verify", "model.jani", "--method", "adaptive", "--max-states", "2").out
    assert "were explored" not in few
    assert few.startswith("heads: minimum between 0 and 0.3")
    note = command("verify", "model.jani", "--max-states", "2").out
    assert "is undecided (too many states: the search stopped at 2 states, at the limit --max-states; " in note
    assert "\n  help: use a higher --max-states to search for longer, --exhaustive to compute" in note


@pytest.mark.parametrize("seed", range(4))
def test_the_exact_value_of_all_schedulers_decides_an_expectation(seed: int, command: Command, tmp_path: Path) -> None:
    """Traces alone would be on the other side of the number for some seeds, and never be certain."""
    name = write(tmp_path, coin())
    options = ("--method", "adaptive", "--seed", str(seed), "--traces", "200", "--expect")
    for expected, words in (
        ("heads >= 0.3", "≥ 0.3: met\n"),
        ("heads <= 0.3", "≤ 0.3: met\n"),
        ("heads = 0.3", "= 0.3: met\n"),
        ("heads > 0.301", "> 0.301: NOT MET"),
    ):
        done = command("verify", name, *options, expected)
        assert f"expected {words}" in done.out
        assert "not certain" not in done.out
        assert done.status == (0 if "NOT" not in words else 1)


def test_an_interrupted_search_for_schedulers_has_a_name() -> None:
    lines = one_as_text(Result("p", Sampled((), 512, is_interrupted=True), seconds=2.0), str).splitlines()
    assert lines[0] == "p: interrupted; there is no result so far"
    assert lines[1].startswith("  512 schedulers were tried, 2.0 s; ")


def hidden() -> Json:
    """There are too many states to explore, also after reductions, because each step of one automaton writes what the
    other one reads. No sampled scheduler shows that the choices matter."""
    steps = [
        edge("s", way("s", 0.5, n=op("+", "n", 1), k=op("%", op("+", "k", 7), 1001)), way("s", 0.5, n=op("+", "n", 1)))
    ]
    steps = [{**steps[0], "guard": {"exp": op("<", "n", 200)}}]
    steps.append(edge("s", way("e", 0.95, done=True), way("e", 0.05), guard=op("=", "n", 200)))
    return document(
        automaton("a", "s e", steps),
        automaton("b", "s", [edge("s", way("s", m=op("+", "m", 1)), guard=op("∧", op("<", "m", 40), op("≥", "n", 0)))]),
        variables=[variable("n"), variable("k"), variable("m"), variable("done", "bool", False)],
        properties={"p": probability(op("F", "done"))},
    )


def test_met_under_uniform_choices(command: Command, tmp_path: Path) -> None:
    """The exit status is 0 with a warning, and every format states that the expectation is met only under uniform
    choices."""
    name = write(tmp_path, hidden())
    options = ("--expect", "p >= 0.9", "--epsilon", "0.03")
    done = command("verify", name, *options)
    assert done.status == 0
    assert "expected ≥ 0.9: met under uniform choices" in done.out
    assert "\n1 of 1 expectation is met only under uniform choices, not known to be met under" in done.out
    assert done.out.count("\nnote: ") == 1
    known = r"\nnote: the minimum of p over all schedulers is undecided \(up to \d+ sampled schedulers show no "
    assert re.search(known, done.out)
    assert "\n  help: use --exhaustive to compute it from all states, or --scheduler uniform if " in done.out
    assert "may differ" in rows(command("verify", name, *options, "--format", "json").out)["p"]["warning"]
    (judged,) = rows(command("verify", name, *options, "--format", "json").out)["p"]["expectations"]
    assert (judged["met"], judged["under_uniform_choices_only"]) == (True, True)
    suites = ET.fromstring(command("verify", name, *options, "--format", "junit").out)
    (case,) = suites.iter("testcase")
    assert case.find("failure") is None
    properties = {about.get("name"): about.get("value") for about in case.iter("property")}
    assert properties["expected ≥ 0.9"] == "met under uniform choices"
    assert "which may differ; " in (properties["warning"] or "")


@pytest.mark.parametrize(
    ("policy", "status", "text"),
    [
        ("accept", 0, "met under uniform choices"),
        ("warn", 0, "met under uniform choices"),
        ("fail", 1, "NOT MET: known only under uniform choices"),
    ],
)
def test_the_worth_of_what_is_met_only_under_uniform_choices(
    command: Command, tmp_path: Path, policy: str, status: int, text: str
) -> None:
    name = write(tmp_path, hidden())
    arguments = ("verify", name, "--expect", "p >= 0.9", "--method", "fixed", "--max-traces", "200")
    done = command(*arguments, "--uniform", policy)
    assert done.status == status
    (tmp_path / "as2fm.toml").write_text(f'[verify]\nuniform = "{policy}"\n')
    assert command(*arguments).status == status
    assert command(*arguments, "--uniform", "accept").status == 0
    assert f"\n  expected ≥ 0.9: {text}; " in done.out or f"\n  expected ≥ 0.9: {text}\n" in done.out
    count = "\n1 of 1 expectation is met only under uniform choices, not known to be met under all schedulers: p\n"
    assert (count in done.out) is (policy != "accept")
    about = f"expected ≥ 0.9: {text}"
    reports = {form: command(*arguments, "--format", form).out for form in ("json", "junit", "sarif", "markdown")}
    (row,) = rows(reports["json"]).values()
    assert (row["expectations"][0]["met"], row["expectations"][0]["uniform"]) == (status == 0, policy)
    assert (about in row["warning"]) is (policy == "warn")
    (case,) = ET.fromstring(reports["junit"]).iter("testcase")
    assert (case.find("failure") is not None) is (status == 1)
    properties = {item.get("name"): item.get("value") for item in case.iter("property")}
    assert (properties["expected ≥ 0.9"] or "").startswith(text)
    (run_,) = json.loads(reports["sarif"])["runs"]
    levels = [found["level"] for found in run_["results"] if about in found["message"]["text"]]
    assert levels == {"accept": [], "warn": ["warning"], "fail": ["error"]}[policy]
    assert f"| ≥ 0.9 | {text}" in reports["markdown"]
    assert (count in reports["markdown"]) is (policy != "accept")


def test_the_note_names_each_property_once(command: Command, tmp_path: Path) -> None:
    """The note also states why no schedulers were sampled, if none were."""
    written = hidden()
    written["properties"].append({**written["properties"][0], "name": "q"})
    most = probability(op("F", "done"), "Pmax")
    cost = {"op": "Emax", "exp": 1, "accumulate": ["steps"], "reach": op("=", "n", 200)}
    written["properties"] += [{"name": "most", "expression": most}, {"name": "cost", "expression": cost}]
    out = command("verify", write(tmp_path, written), "--method", "fixed", "--max-traces", "60").out
    notes = re.findall(r"^note: the (.*) over all schedulers is undecided \((.*)\)$", out, re.MULTILINE)
    assert [of for of, _ in notes] == ["minimum of p, q", "maximum of most", "maximum of cost"]
    assert notes[2][1] == "schedulers are not sampled for expected rewards"
    assert out.count("\n  help: use --exhaustive ") == 1


def test_an_infinite_exact_reward_states_its_reason(command: Command, tmp_path: Path) -> None:
    """The coin shows no head with 0.7, and then the condition is never reached."""
    written = coin()
    reward = {"op": "Emax", "exp": 1, "accumulate": ["steps"], "reach": op("=", "x", 1)}
    finite = {**reward, "reach": op("≥", "x", 0)}
    written["properties"] = [{"name": "cost", "expression": reward}, {"name": "free", "expression": finite}]
    lines = command("verify", write(tmp_path, written)).out.splitlines()
    assert lines[0].startswith("cost (expected value): = ∞ for all schedulers, exact, ")
    assert lines[2] == "  infinite: some traces never reach the condition; `|| F …` with this condition leaves them out"
    assert lines[3].startswith("free (expected value): = 0 for all schedulers, exact, ")


def test_ends_of_examples_are_shown_only_in_verbose_output(command: Command, tmp_path: Path) -> None:
    """The traces end where no step is possible, which says nothing about an exact value."""
    written = coin()
    written["properties"] = [{"name": "never", "expression": probability(op("F", op("=", "x", 2)))}]
    name = write(tmp_path, written)
    assert "random traces" not in command("verify", name).out
    assert "  ends of 200 random traces: no step possible 200\n" in command("verify", name, "--verbose").out


def test_traces_that_cannot_be_explained(command: Command, tmp_path: Path) -> None:
    """All traces under uniform choices hold; some of a sampled scheduler fail."""
    err = command("verify", write(tmp_path, starving(steps=500)), "--max-states", 400, "--explain").err
    none = r"^p: none of the [\d,]+ random traces failed"
    help_ = "but cannot be shown: use --exhaustive --explain"
    assert re.search(rf"{none}; some of those of sampled scheduler 1, which lets .*, fail, {help_}$", err, re.MULTILINE)
    alone = coin()
    alone["automata"][0]["edges"] = [edge("s", way("e", x=1))]
    err = command("verify", write(tmp_path, alone), "--method", "adaptive", "--explain").err
    assert re.search(r"^heads: none of the [\d,]+ random traces failed$", err, re.MULTILINE)


def test_an_expectation_that_is_not_met_names_the_scheduler(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, starving(steps=500))
    done = command("verify", name, "--expect", "p >= 0.9", "--max-states", 400)
    assert "  expected ≥ 0.9: NOT MET under sampled scheduler 1, which lets `" in done.out
    row = rows(command("verify", name, "--expect", "p >= 0.9", "--max-states", 400, "--format", "json").out)["p"]
    assert row["expectations"][0]["not_met"].startswith("under sampled scheduler 1, which lets `")
    few = write(tmp_path, starving(length=50), "few.jani")
    done = command("verify", few, "--expect", "p >= 0.9", "--method", "adaptive")
    assert "  expected ≥ 0.9: NOT MET: the minimum over all schedulers is 0\n" in done.out
    for options in ((), ("--exhaustive",)):
        exact = command("verify", few, "--expect", "p >= 0.9", *options)
        assert "  expected ≥ 0.9: NOT MET: the minimum over all schedulers is 0\n" in exact.out
    assert command("verify", few, "--expect", "p <= 0.1", "--exhaustive").status == 0
    searched = command("verify", few, "--expect", "p >= 0.9", "--scheduler", "lss", "--epsilon", "0.1")
    assert "  expected ≥ 0.9: NOT MET under sampled scheduler " in searched.out
    alone = command("verify", few, "--expect", "p < 0.9", "--scheduler", "uniform")
    assert "  expected < 0.9: NOT MET\n" in alone.out


@pytest.mark.parametrize(
    ("expected", "said"),
    [
        ("heads >= 0.3", "undecided: the estimate meets it, but the interval includes values below 0.3"),
        ("heads >= 0.31", "undecided: the interval includes values of at least 0.31 and values below 0.31"),
        ("heads > 0.3", "undecided: the estimate meets it, but the interval includes values of at most 0.3"),
        ("heads > 0.31", "undecided: the interval includes values above 0.31 and values of at most 0.31"),
        ("heads <= 0.31", "undecided: the estimate meets it, but the interval includes values above 0.31"),
        ("heads <= 0.3", "undecided: the interval includes values of at most 0.3 and values above 0.3"),
        ("heads < 0.31", "undecided: the estimate meets it, but the interval includes values of at least 0.31"),
        ("heads < 0.3", "undecided: the interval includes values below 0.3 and values of at least 0.3"),
        (
            "heads = 0.3",
            "undecided: the estimate meets it, but the interval includes values more than 0.01 away from 0.3",
        ),
        (
            "heads = 0.313",
            "undecided: the interval includes values within 0.01 of 0.313 and values more than 0.01 away from 0.313",
        ),
        ("heads >= 0.2", "met"),
        ("heads = 0.7", "NOT MET"),
    ],
)
def test_verdicts_that_are_not_certain(command: Command, tmp_path: Path, expected: str, said: str) -> None:
    """The estimate is 0.302371 in [0.292749, 0.312123]."""
    options = ("--scheduler", "uniform", "--method", "adaptive")
    out = command("verify", write(tmp_path, coin()), *options, "--expect", expected).out
    (line,) = (line for line in out.splitlines() if line.startswith("  expected "))
    assert line.partition(": ")[2] == said


@pytest.mark.parametrize(("expected", "status"), [("heads >= 0.3", 0), ("heads >= 0.31", 1)])
def test_an_undecided_expectation_is_one_in_all_formats(
    command: Command, tmp_path: Path, expected: str, status: int
) -> None:
    """The interval contains the number. The estimate decides the exit status, and nothing says `met` or `not met`."""
    arguments = (
        "verify",
        write(tmp_path, coin()),
        "--scheduler",
        "uniform",
        "--method",
        "adaptive",
        "--expect",
        expected,
    )
    done = command(*arguments)
    assert done.status == status
    assert "\n1 of 1 expectation is undecided, because the interval is too wide; a smaller --epsilon" in done.out
    meets = "but the estimate meets it" if status == 0 else "and the estimate does not meet it"
    assert done.out.endswith(f"\nexit status {status} (undecided, {meets}: heads)\n")
    limited = command(*arguments, "--max-traces", 500)
    assert "is too wide; a higher --max-traces makes it narrower: heads\n" in limited.out
    assert "(epsilon), because max-traces ended the estimate\n" in limited.out
    row = rows(command(*arguments, "--format", "json").out)["heads"]
    assert (row["verdict"], row["expectations"][0]["certain"]) == ("undecided", False)
    assert ("undecided: the estimate meets it, but" in row.get("warning", "")) is (status == 0)
    assert "| undecided: the " in command(*arguments, "--format", "markdown").out
    (case,) = ET.fromstring(command(*arguments, "--format", "junit").out).iter("testcase")
    assert case.find("failure") is None
    assert (case.find("error") is None) is (status == 0)
    narrow = command(*arguments[:-1], "heads >= 0.295", "--epsilon", "0.003")
    assert (narrow.status, "undecided" in narrow.out) == (0, False)


@pytest.mark.parametrize("format_", ["text", "markdown", "csv"])
def test_a_value_under_a_condition_is_one_under_uniform_choices(command: Command, tmp_path: Path, format_: str) -> None:
    """The property asks for a minimum, which is not computed under a condition: the headline says what it answers."""
    text = "P=? [ F done || F done ]"
    options = ("--property", text, "--method", "fixed", "--max-traces", "50", "--format", format_)
    out = command("verify", write(tmp_path, starving(length=3)), *options).out
    assert re.search(r"P=\? .*(: |\| |,)under uniform choices(: 1 in \[|$)", out, re.MULTILINE)


def test_schedulers_that_were_looked_for_have_all_that_results_have(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, starving(length=3))
    options = ("--scheduler", "lss", "--epsilon", "0.1", "--seed", "7")
    out = command("verify", name, *options, "--verbose").out
    first, sentence = (
        r"p: (minimum|maximum) with the best scheduler found: .* failed\n",
        r"  `done` holds at some time\.\n",
    )
    rest = r"  by sampled scheduler \d+, which .*\n  ends: .*\n"
    assert re.match(
        rf"{first}{sentence}{rest}{first}{rest}  [\d,]+ schedulers were tried, \d+\.\d s; {OTHERS}\n",
        out,
    )
    assert "seed 7" in out
    row = rows(command("verify", name, *options, "--format", "json").out)["p"]
    for side in ("least", "greatest"):
        assert row[side]["by"].startswith("sampled scheduler ")
        assert (row[side]["seed"], sum(row[side]["ends"].values())) == (7, row[side]["traces"])
    assert row["schedulers"]["tried"] > 100


@pytest.mark.parametrize("states", ["deadlock", "timelock", None])
def test_states_that_are_not_the_initial_ones_are_named(command: Command, tmp_path: Path, states: str | None) -> None:
    written = coin()
    written["properties"][0]["expression"]["states"] = {"op": states} if states else op("=", "x", 0)
    done = command("verify", write(tmp_path, written), "--format", "json")
    row = rows(done.out)["heads"]
    assert done.status == 1
    assert "probability" not in row
    what = f"`{states}`" if states else "a condition"
    expected = f'`states` of the filter is {what}, but traces begin in the initial states; write `{{"op": "initial"}}`'
    assert row["error"]["message"].startswith(expected)


def test_too_many_combinations_are_reported(command: Command, tmp_path: Path) -> None:
    """2^64 of them."""
    parts = [automaton(f"m{n}", "s t", [edge("s", way("t", x=k), action="a") for k in (0, 1)]) for n in range(64)]
    goals = {"p": probability(op("F", op("=", "x", 1)))}
    for number, part in enumerate(parts[1:], 1):
        part["edges"] = [edge("s", way("t", **{f"y{number}": k}), action="a") for k in (0, 1)]
    variables = [variable("x"), *(variable(f"y{n}") for n in range(1, 64))]
    written = document(*parts, variables=variables, syncs=[["a"] * 64], properties=goals)
    done = command("verify", write(tmp_path, written), "--exhaustive")
    assert done.status == 1
    assert re.search(r"undecided: stopped at \d states?: one .* more than 1,048,576 combinations of edges", done.out)


@pytest.mark.parametrize("way_of_saying", ["configuration", "option"])
def test_uniform_choices_that_are_requested(command: Command, tmp_path: Path, way_of_saying: str) -> None:
    name = write(tmp_path, starving())
    options: tuple[str, ...] = ("--scheduler", "uniform")
    if way_of_saying == "configuration":
        (tmp_path / "as2fm.toml").write_text('[verify]\nscheduler = "uniform"\n')
        options = ()
    done = command("verify", name, "--expect", "p >= 0.9", *options)
    assert done.status == 0
    assert "expected ≥ 0.9: met" in done.out
    assert done.out.startswith("p: = 1 under uniform choices, exact, 100 states, ")
    assert "met under uniform choices" not in done.out
    assert "warning" not in done.out
    row = rows(command("verify", name, "--format", "json", *options).out)["p"]
    assert row["schedulers"] == {"wanted": "uniform"}
    assert "minimum" not in row


@pytest.mark.parametrize(
    "text", ["[verify]\nscheduler = 1", "[verify]\nsched = 'uniform'", "verify = 3", "[verify]\nuniform = 'ok'"]
)
def test_mistakes_in_the_configuration(command: Command, tmp_path: Path, text: str) -> None:
    (tmp_path / "as2fm.toml").write_text(text)
    done = command("verify", write(tmp_path, coin()))
    assert done.status == 2
    assert "verify" in done.err


@pytest.mark.parametrize(("count", "which"), [(1, "only sampled scheduler"), (1200, "1,200 sampled schedulers")])
def test_words_for_a_number_of_sampled_schedulers(count: int, which: str) -> None:
    verdict = Verdict(Expectation("p", Threshold(BinaryOperator.GREATER_EQUAL, 0)), True, True, sampled=count)
    assert verdict.text == f"met by the {which}; another one may miss it"


def test_expectations_of_sampled_schedulers(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, starving(length=3))
    options = ("--scheduler", "lss", "--epsilon", "0.05")
    assert command("verify", name, *options, "--expect", "p >= 0.9").status == 1
    shown = command("verify", name, *options, "--expect", "p <= 0.1")
    assert shown.status == 0
    assert "  expected ≤ 0.1: met\n" in shown.out
    options = (*options, "--expect", "p >= 0")
    met = r"met by the [\d,]+ sampled schedulers; another one may miss it"
    assert re.search(rf"  expected ≥ 0: {met}\n", command("verify", name, *options).out)
    assert re.search(
        rf"\| minimum with the best scheduler found: about 0 .*; maximum with the .*: about 1 .* \| ≥ 0 \| {met} \|",
        command("verify", name, *options, "--format", "markdown").out,
    )
    table = command("verify", name, *options, "--format", "csv").out
    assert re.search(
        rf"^p,sampled schedulers,,,,0\.0,1\.0,.*schedulers were tried; {OTHERS}$",
        table,
        re.M,
    )
    assert 'name="expected ≥ 0" value="met by the ' in command("verify", name, *options, "--format", "junit").out
    (row,) = json.loads(command("verify", name, *options, "--format", "json").out)["results"]
    assert row["expectations"][0]["sampled_schedulers"] > 100


def test_a_note_names_few_properties() -> None:
    entries = [(Question(name, "Pmin", False, None, ()), Choices()) for name in "abcdef"]
    assert note(entries)[0].startswith("note: the minimum of a, b, c and 3 more over all schedulers is undecided")
    assert note(entries[:4])[0].startswith("note: the minimum of a, b, c, d over all")


def test_a_note_names_the_limit_that_ended_each_search() -> None:
    stopped = [Choices(tried=2, explored=9, limit=f"max-{what}", reason="stopped") for what in ("states", "memory")]
    spent = Choices(tried=2, limit=NOTHING_LEFT.limit, reason=NOTHING_LEFT.reason)
    endless = Choices(tried=2, reason="the computation of its values takes too many operations")
    wide = Choices(tried=2, explored=1, reason="stopped at 1 state: one of them has more than 4,096 combinations")
    entries = [
        (Question(name, "Pmin", False, None, ()), choices)
        for name, choices in zip("abcde", [*stopped, spent, endless, wide], strict=True)
    ]
    *lines, help_ = note(entries)
    for line, words in zip(
        lines,
        (
            "a over all schedulers is undecided (too many states: the search stopped at 9 states, at the limit "
            "--max-states;",
            "b over all schedulers is undecided (too many states: the search stopped at 9 states, at the limit "
            "--max-memory;",
            "c over all schedulers is undecided (no values from all states: the searches for other properties have "
            "reached the limit --max-transitions;",
            "d over all schedulers is undecided (no values from all states: the computation of its values takes too "
            "many operations;",
            "e over all schedulers is undecided (the search stopped at 1 state: one of them has more than 4,096 ",
        ),
        strict=True,
    ):
        assert words in line
    assert "a higher --max-states and --max-memory and --max-transitions to search" in help_


# ------------------------------------------------------------------ JANI that says more


def test_a_model_with_plugins_is_refused(command: Command, tmp_path: Path) -> None:
    done = command("verify", write(tmp_path, coin(plugins=[{"name": "x"}])))
    assert done.status == 1
    assert "a model has no member `plugins`" in done.err
    assert done.out == ""


def counting() -> Json:
    bounded = {"kind": "bounded", "base": "int", "lower-bound": 1, "upper-bound": "N"}
    constants = [
        {"name": "N", "type": "int"},
        {"name": "p", "type": "real"},
        {"name": "on", "type": "bool"},
        {"name": "k", "type": bounded},
        {"name": "fixed", "type": "int", "value": 3},
    ]
    steps = [edge("s", way("e", "p", x="N"), way("e", op("-", 1, "p")), guard="on")]
    goal = {"heads": probability(op("F", op("=", "x", 20)))}
    return document(automaton("a", "s e", steps), variables=[variable("x")], properties=goal, constants=constants)


def test_constants(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path, counting())
    given = ["--constant", "N=20", "--constant", "p=0.25", "--constant", "on=true", "--constant", "k=20"]
    done = command("verify", name, *given, "--expect", "heads = 0.25")
    assert (done.status, done.err) == (0, "")
    fraction = [text.replace("p=0.25", "p=1/4") for text in given]
    assert command("verify", name, *fraction, "--constant", "fixed=3", "--expect", "heads = 0.25").status == 0
    without = command("verify", name, *given[2:])
    assert without.status == 1
    assert "the constant `N` has no value; give it one as `N=VALUE`" in without.err


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("N", "a constant must have the form `NAME=VALUE`, such as `N=20`, not `N`"),
        ("N=", "a constant must have the form `NAME=VALUE`"),
        ("N=2.5", "the constant `N` must be a whole number of 64 bits, not `2.5`"),
        ("N=99999999999999999999", "the constant `N` must be a whole number of 64 bits"),
        ("p=nan", "the constant `p` must be a number or a fraction, not `nan`"),
        ("p=1e999", "the constant `p` must be a number or a fraction, not `1e999`"),
        ("on=1", "the constant `on` must be true or false, not `1`"),
        ("k=0", "the constant `k` must be at least 1, not `0`"),
        ("k=21", "the constant `k` must be at most 20, not `21`"),
        ("fixd=1", "there is no constant `fixd`; did you mean `fixed`?"),
        ("p=0.1:0.1:0.9", "gives the constant `p` several values; use `as2fm-lsp experiment`"),
        ("N=3", "the constant `N` is given twice"),
    ],
)
def test_constants_that_do_not_fit(command: Command, tmp_path: Path, given: str, message: str) -> None:
    # A second value for a constant is a separate error.
    first = ("--constant", "N=20") if given[0] != "N" or given == "N=3" else ()
    done = command("verify", write(tmp_path, counting()), *first, "--constant", given)
    assert (done.status, done.out) == (2, "")
    assert message in done.err


# ------------------------------------------------------------------ one does not stop the others


def test_a_property_that_cannot_be_answered_does_not_stop_the_others(command: Command, tmp_path: Path) -> None:
    written = coin()
    nested = probability(op("F", op("X", op("=", "x", 1))))
    written["properties"].insert(0, {"name": "nested", "expression": nested})
    name = write(tmp_path, written)
    done = command("verify", name, "--format", "json")
    results = rows(done.out)
    assert done.status == 1
    assert list(results) == ["nested", "heads"]
    assert results["nested"]["error"]["code"] == "unsupported-property"
    assert results["nested"]["error"]["file"] == name
    assert "probability" not in results["nested"]
    assert results["heads"]["probability"] == pytest.approx(0.3, abs=0.02)
    text = command("verify", name)
    assert "nested: not answered: model.jani:" in text.out
    assert "supported are `Pmin` and `Pmax` of F, G, X, U, W and R" in text.out
    assert "heads: = 0.3 " in text.out
    suites = ET.fromstring(command("verify", name, "--format", "junit").out)
    cases = {case.get("name"): case for case in suites.iter("testcase")}
    (error,) = cases["nested"].iter("error")
    assert error.get("type") == "unsupported-property"
    assert cases["heads"].find("error") is None
    assert (suites.get("tests"), suites.get("failures"), suites.get("errors")) == ("2", "0", "1")
    assert command("verify", name, "--property", "heads").status == 0


def test_a_trace_that_goes_wrong_does_not_stop_the_others(command: Command, tmp_path: Path) -> None:
    steps = [edge("s", "t"), edge("t", way("u", x=op("%", 1, "x")))]
    goals = {"late": probability(op("F", op("=", "x", 3))), "early": probability(op("X", op("=", "x", 0)))}
    done = command("verify", write(tmp_path, document(automaton("a", "s t u", steps), variables=[variable("x")],
                   properties=goals)), "--format", "json")  # fmt: skip
    results = rows(done.out)
    assert done.status == 1
    assert "division by zero (in trace 0 of seed 0)" in results["late"]["error"]["message"]
    assert results["early"]["probability"] == 1


SYSTEM = {
    "main.xml": """<roaml><parameters><max_time value="5" unit="s" /></parameters><node_models>
<input type="node-ascxml" src="a.ascxml" /></node_models>
<properties><input type="jani" src="p.jani" /></properties></roaml>""",
    "a.ascxml": """<ascxml name="a" version="1.0" initial="s">
<datamodel><data id="n" type="int32" expr="0" /></datamodel>
<ros_time_rate name="second" rate_hz="1" /><ros_topic_publisher name="level" topic="/level" type="std_msgs/Int32" />
<state id="s"><ros_rate_callback name="second" target="s"><assign location="n" expr="n + 1" />
<ros_topic_publish name="level"><field name="data" expr="n" /></ros_topic_publish></ros_rate_callback></state>
</ascxml>""",
}


def test_check_reports_what_verify_refuses(command: Command, tmp_path: Path) -> None:
    """Both use the same code, and each code has a document."""
    for name, text in SYSTEM.items():
        (tmp_path / name).write_text(text)
    reached = op("≥", "topic_level_msg__ros_fields__data", 2)
    bounded = {**op("F", reached), "time-bounds": {"upper": 3}}
    long_run = {"op": "Smin", "exp": reached}
    formulas = {"good": probability(op("F", reached)), "nested": probability(op("F", op("X", reached)))}
    formulas |= {"bounded": probability(bounded), "long_run": long_run}
    written = {"properties": [{"name": name, "expression": formula} for name, formula in formulas.items()]}
    write(tmp_path, written, "p.jani")
    checked = {
        row["code"] for row in command("--check", "main.xml", "--format", "json").rows if row["file"] == "p.jani"
    }
    done = command("verify", "main.xml", "--format", "json")
    results = rows(done.out)
    refused = {name: row["error"]["code"] for name, row in results.items() if "error" in row}
    assert set(refused) == {"nested", "bounded", "long_run"}
    assert checked == set(refused.values()) == {"unsupported-property", "ignored-bounds"}
    assert all(rule_document(code) for code in checked)
    assert results["good"]["probability"] == 1


def test_the_code_of_faults_has_a_document(command: Command) -> None:
    assert "division" in rule_document("model-fault") or "divides by zero" in rule_document("model-fault")
    assert command("explain", "model-fault").status in (0, 2)


def test_max_time(command: Command, tmp_path: Path) -> None:
    for name, text in SYSTEM.items():
        (tmp_path / name).write_text(text)
    goal = probability(op("F", op("≥", "topic_level_msg__ros_fields__data", 8)))
    write(tmp_path, {"properties": [{"name": "late", "expression": goal}]}, "p.jani")
    assert rows(command("verify", "main.xml", "--format", "json").out)["late"]["probability"] == 0
    longer = command("verify", "main.xml", "--format", "json", "--max-time", "10 s")
    assert rows(longer.out)["late"]["probability"] == 1
    assert command("verify", "main.xml", "--max-time", "soon").status == 2
    done = command("verify", write(tmp_path, coin()), "--max-time", "10 s")
    assert (done.status, "a JANI model has no such parameter" in done.err) == (2, True)


# ------------------------------------------------------------------ intervals


def test_the_interval_of_a_sequential_test_holds_whenever_it_stops(command: Command, tmp_path: Path) -> None:
    done = command("verify", write(tmp_path, coin()), "--method", "sprt", "--expect", "heads >= 0.28")
    assert "decided by Wald's sequential test: wrong with a probability of at most 0.05" in done.out
    assert "unless the value is between 0.27 and 0.29" in done.out
    assert "valid whenever the traces are stopped (a confidence sequence)" in done.out
    row = rows(command("verify", "model.jani", "--method", "sprt", "--expect", "heads >= 0.5", "--format", "json").out)
    assert row["heads"]["interval"] == "confidence sequence"
    assert (
        rows(command("verify", "model.jani", "--epsilon", 0.02, "--format", "json").out)["heads"]["interval"]
        == "Clopper-Pearson"
    )


# ------------------------------------------------------------------ numbers that make no sense


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--method", "fixed"), "the method `fixed` needs a number of traces; set the maximum (max_traces)"),
        (("--epsilon", "1e-300"), "expected a number of at least 1e-09"),
        (("--epsilon", "1e-300", "--method", "okamoto"), "expected a number of at least 1e-09"),
        (("--epsilon", "nan"), "expected a number between 0 and 1"),
        (("--epsilon", "small"), "expected a number between 0 and 1"),
        (("--max-traces", "9" * 5000), "expected a whole number of at least 1"),
        (
            ("--expect", "heads > 2"),
            "`heads` is a probability and can only be compared with a number from 0 to 1, not 2",
        ),
        (("--expect", "heads >= -0.5"), "not -0.5"),
        (("--expect", "heads <= inf"), "not inf"),
    ],
)
def test_wrong_use(command: Command, tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    done = command("verify", write(tmp_path, coin()), *options)
    assert (done.status, done.out) == (2, "")
    assert message in done.err
    assert "Traceback" not in done.err


def test_a_reward_may_be_more_than_one(command: Command, tmp_path: Path) -> None:
    written = coin()
    cost = {"op": "Emin", "exp": 5, "accumulate": ["steps"], "reach": op("≤", "x", 1)}
    written["automata"][0]["edges"] = [edge("s", way("e", x=1))]
    written["variables"] = [variable("x", initial=2)]
    written["properties"] = [{"name": "cost", "expression": cost}]
    assert command("verify", write(tmp_path, written), "--expect", "cost > 2").status == 0


def test_traces_of_rewards_reach_their_condition_or_do_not(command: Command, tmp_path: Path) -> None:
    """A trace that does not reach the condition has no reward, and an undecided one no upper bound."""
    goal, ways = op("=", "x", 1), [way("e", 0.5, x=1), way("e", 0.5)]
    edges = [edge("s", *ways), edge("e", way("e"))]
    cost = {"op": "Emin", "exp": 1, "accumulate": ["steps"], "reach": goal}
    written = document(automaton("a", "s e", edges), variables=[variable("x")], properties={"cost": cost})
    name = write(tmp_path, written)
    done = command("verify", name, "--method", "fixed", "--max-traces", 50)
    assert re.match(r"cost \(expected value\): infinite from 50 traces: \d+ reached, \d+ not reached, ", done.out)
    edges[:] = [edge("s", way("s", 0.9), way("e", 0.1, x=1))]
    written = document(automaton("a", "s e", edges), variables=[variable("x")], properties={"cost": cost})
    done = command("verify", write(tmp_path, written), "--method", "fixed", "--max-traces", 200, "--max-steps", 20)
    assert re.match(r"cost \(expected value\): at least [\d.]+ from 200 traces: \d+ reached, 0 not reached, ", done.out)
    assert re.search(r"0 not reached, \d+ were cut after 20 steps: raise max-steps", done.out)
    done = command("verify", name, "--exhaustive", "--explain")
    assert "its condition has not been reached" not in done.out


# ------------------------------------------------------------------ states that were changed


def tampered(change: Callable[[Any], None]) -> Callable[[Path], None]:
    def apply(path: Path) -> None:
        value = json.loads(path.read_text())
        change(value)
        path.write_text(json.dumps(value))

    return apply


def tally(value: Any) -> Any:
    return value["properties"]["heads"]["tally"]


TAMPERED: list[Callable[[Any], None]] = [
    lambda v: tally(v).update(traces=10**30),
    lambda v: tally(v).update(traces=10**30, successes=10**30),
    lambda v: tally(v).update(traces=-1),
    lambda v: tally(v).update(traces="1000"),
    lambda v: tally(v).update(traces=1000.5),
    lambda v: tally(v).update(traces=True),
    lambda v: tally(v).update(successes=2000),
    lambda v: tally(v).update(successes=tally(v)["successes"] + 1),
    lambda v: tally(v).update(undecided=3),
    lambda v: tally(v).update(steps=10**12),
    lambda v: tally(v).update(steps=1),
    lambda v: tally(v).update(mean=[1, "0x1p0", "0x0p0"]),
    lambda v: tally(v).update(mean=[0, "nan", "0x0p0"]),
    lambda v: tally(v).update(mean=[0, "1", "x"]),
    lambda v: tally(v).update(mean=None),
    lambda v: tally(v).update(examples=[]),
    lambda v: tally(v).update(examples={}),
    lambda v: tally(v)["examples"].update({"7": []}),
    lambda v: tally(v)["examples"]["1"].pop(),
    lambda v: tally(v)["examples"]["1"].reverse(),
    lambda v: tally(v)["examples"]["1"].append([10**6, 1]),
    lambda v: tally(v)["examples"]["1"].append("nonsense"),
    lambda v: tally(v)["examples"]["1"].append([1, 2, 3]),
    lambda v: tally(v)["shortest"].clear(),
    lambda v: tally(v)["shortest"].update({"1": [0, -5]}),
    lambda v: tally(v)["shortest"].update({"2": [0, 5]}),
    lambda v: tally(v).update(finished="yes"),
    lambda v: tally(v).update(accepted="yes"),
    lambda v: tally(v).update(ends={}),
    lambda v: tally(v).update(ends={"nonsense": [1000, 0, 1]}),
    lambda v: tally(v).clear(),
    lambda v: v["properties"]["heads"].update(tally=None),
    lambda v: v["properties"].update(heads=None),
    lambda v: v.update(properties=[]),
    lambda v: v.update(version=99),
    lambda v: v.clear(),
]


@pytest.mark.parametrize("number", range(len(TAMPERED)))
def test_states_that_traces_cannot_have_given(command: Command, tmp_path: Path, number: int) -> None:
    name = write(tmp_path, coin())
    options = ("--method", "fixed", "--max-traces", "1000", "--resume", "state.json")
    assert command("verify", name, *options).status == 0
    state = tmp_path / "state.json"
    whole = json.loads(state.read_text())
    changed = copy.deepcopy(whole)
    TAMPERED[number](changed)
    assert changed != whole
    state.write_text(json.dumps(changed))
    done = command("verify", name, *options)
    assert (done.status, done.out) == (2, "")
    assert "state.json" in done.err
    assert "Traceback" not in done.err
    assert json.loads(state.read_text()) == changed


@pytest.mark.parametrize("text", ["[" * 100_000, "1" * 5000, '{"version": 1e999}', "\x00", "null"])
def test_states_that_are_none(command: Command, tmp_path: Path, text: str) -> None:
    (tmp_path / "state.json").write_text(text)
    done = command("verify", write(tmp_path, coin()), "--resume", "state.json")
    assert (done.status, done.out) == (2, "")
    assert "Traceback" not in done.err


def test_a_state_that_is_no_file(command: Command, tmp_path: Path) -> None:
    """Opening a pipe would wait for a writer."""
    os.mkfifo(tmp_path / "state.json")
    done = command("verify", write(tmp_path, coin()), "--resume", "state.json")
    assert done.status == 2
    assert "state.json: it is not a regular file" in done.err


# ------------------------------------------------------------------ what the options ask for


def test_a_requested_number_of_traces_requests_no_width(command: Command, tmp_path: Path) -> None:
    too_wide = "the interval is wider than requested"
    file = write(tmp_path, coin())
    assert too_wide not in command("verify", file, "--method", "fixed", "--max-traces", 20).out
    assert too_wide in command("verify", file, "--method", "adaptive", "--max-traces", 20).out
    grid = ("experiment", file, "--property", "heads", "--max-traces", 20)
    assert too_wide not in command(*grid, "--method", "fixed").out


def test_uniform_choices_have_a_narrower_limit_unless_the_model_has_no_others() -> None:
    nondeterministic = target_of(model(starving()))
    deterministic = target_of(model(coin(type_="dtmc")))

    def most(target: VerificationTarget, *, only_uniform: bool, limits: StateLimits | None = None) -> int | None:
        share = verifier_of(target, only_uniform=only_uniform, limits=limits).budget.share(1)
        assert share is not None
        return share.transitions

    assert most(nondeterministic, only_uniform=True) == UNIFORM_LIMITS.transitions
    assert most(nondeterministic, only_uniform=False) == SHARED_LIMITS.transitions
    assert most(deterministic, only_uniform=True) == SHARED_LIMITS.transitions
    assert most(nondeterministic, only_uniform=True, limits=SHARED_LIMITS) == SHARED_LIMITS.transitions


def test_a_property_that_is_no_condition_is_named(command: Command, tmp_path: Path) -> None:
    always = {"stays": probability(op("G", op("=", "x", 0)))}
    steps = [edge("s", way("e", 0.3, x=1), way("e", 0.7))]
    written = write(tmp_path, document(automaton("a", "s e", steps), variables=[variable("x")], properties=always))
    result = command("verify", written, "--property", "P=? [ F stays ]")
    assert result.status == 2
    assert "the property `stays` is no condition" in result.err
    assert "is no condition" not in command("verify", written, "--property", "P=? [ F other ]").err
