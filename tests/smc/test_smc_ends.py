# SPDX-License-Identifier: Apache-2.0
"""Why traces end, in JANI models without further information and in translated systems."""

from __future__ import annotations

from pathlib import Path

import pytest
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

import clock
from both_kernels import plain_kernel
from roaml import api
from roaml.jani.writer import write
from roaml.smc import end, kernel
from roaml.smc.batch import Task, run
from roaml.smc.end import End
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.run import Answer, EstimationMethod, Options
from roaml.smc.tally import Tally
from stuck_models import CROSSED, hospital, system

FINALLY = {"p": probability(op("F", op("=", "x", 9)))}
GLOBALLY = {"p": probability(op("G", op("<", "x", 9)))}


def answer(checker: ModelChecker, traces: int = 1, max_steps: int = 1000, jobs: int = 1) -> Answer:
    options = Options(method=EstimationMethod.FIXED, max_traces=traces, max_steps=max_steps)
    with Pool(jobs, start_delay_s=0 if jobs > 1 else 1) as pool:
        return checker.answer(checker.compiled_properties[0], options, pool)


def of_system(folder: Path, files: dict[str, str], *properties: str) -> ModelChecker:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return api.checker(api.to_jani(api.load(str(folder / "main.xml"))), properties or None)


def counts(actual_answer: Answer) -> dict[End, int]:
    return {reason: ended.count for reason, ended in actual_answer.tally.ends.items()}


def test_reasons_are_those_of_the_kernel() -> None:
    for reason in End:
        if reason is not End.CUT:
            assert getattr(plain_kernel(), reason.name) == reason.value
    assert len({reason.key for reason in End}) == len(End) == len(end._TEXTS)


ONE_WAY = [edge("s", way("t", x=1))]
ROUND = [edge("s", way("t", x=1)), edge("t", way("s", x=2))]
FALLING = [edge("s", way("t", x=op("-", "x", 1))), edge("t", "s")]
LOOP = [edge("s", way("t", x=1)), edge("t", "t")]


@pytest.mark.parametrize(
    ("edges", "goals", "reason", "value"),
    [
        (ONE_WAY, FINALLY, End.DEADLOCK, 0),
        (ONE_WAY, GLOBALLY, End.DEADLOCK, 1),
        (LOOP, FINALLY, End.IDLE, 0),
        (LOOP, GLOBALLY, End.IDLE, 1),
        (ROUND, FINALLY, End.ROUND, 0),
        (FALLING, FINALLY, End.CUT, 0.5),
        (ONE_WAY, {"p": probability(op("F", op("=", "x", 1)))}, End.DECIDED, 1),
        (ROUND, {"p": probability(op("G", op("=", "x", 0)))}, End.DECIDED, 0),
        # Decided at the start, without any step.
        (ROUND, {"p": probability(op("F", op("=", "x", 0)))}, End.DECIDED, 1),
        (ONE_WAY, {"p": probability(op("F", {"op": "deadlock"}))}, End.DEADLOCK, 1),
        (LOOP, {"p": probability(op("F", {"op": "deadlock"}))}, End.IDLE, 0),
    ],
)
def test_any_model(edges: list[Json], goals: dict[str, Json], reason: End, value: float) -> None:
    written = document(automaton("a", "s t", edges), variables=[variable("x")], properties=goals)
    actual_answer = answer(ModelChecker(model(written)))
    assert (counts(actual_answer), actual_answer.value) == ({reason: 1}, value)


def test_reasons_are_counted_with_their_shortest_traces() -> None:
    """Half of the traces reach the goal at once. Some of the others end after two steps, some after three."""
    ways = [way("goal", 0.5, x=9), way("two", 0.25), way("three", 0.25)]
    edges = [edge("s", *ways), edge("two", "end"), edge("three", "four"), edge("four", "end")]
    places = "s goal two three four end"
    written = document(automaton("a", places, edges), variables=[variable("x")], properties=FINALLY)
    checker = ModelChecker(model(written))
    actual_answer = answer(checker, traces=500)
    tally = actual_answer.tally
    assert sum(counts(actual_answer).values()) == tally.traces == 500
    assert counts(actual_answer)[End.DECIDED] == tally.successes
    assert tally.ends[End.DECIDED].shortest.steps == 1
    assert tally.ends[End.DEADLOCK].shortest == tally.shortest[0]
    assert tally.ends[End.DEADLOCK].shortest.steps == 2
    assert Tally.from_json(tally.to_json()) == tally
    assert counts(answer(checker, traces=500, jobs=2)) == counts(actual_answer)


def test_goals_decided_early_keep_their_end(tmp_path: Path) -> None:
    """It is unknown whether the system would have got stuck later in these traces."""
    checker = of_system(tmp_path, hospital())
    actual_answer = answer(checker, traces=300)
    assert counts(actual_answer)[End.DECIDED] == actual_answer.tally.successes
    assert counts(actual_answer)[End.STUCK] == actual_answer.failures
    assert 0 < actual_answer.failures < 300


NO_CLOCK = system(
    {
        "Left": """s
<state id="s"><onentry><send event="go" /></onentry></state>
""",
        "Right": """s
<state id="s"><transition event="go" target="t" /></state>
<state id="t" />
""",
    }
)


@pytest.mark.parametrize(
    ("files", "reason"),
    [
        (clock.FILES, End.TIME),
        (hospital(mended=True), End.FINISHED),
        (NO_CLOCK, End.QUIET),
        (CROSSED, End.STUCK),
    ],
)
def test_translated_systems(tmp_path: Path, files: dict[str, str], reason: End) -> None:
    actual_answer = answer(of_system(tmp_path, files, "stuck"), traces=20, max_steps=10_000)
    assert counts(actual_answer) == {reason: 20}
    assert actual_answer.value == (reason is End.STUCK)


@pytest.mark.parametrize(
    ("files", "value"), [(clock.FILES, 0), (hospital(mended=True), 0), (NO_CLOCK, 1), (CROSSED, 1)]
)
def test_the_end_of_time_is_no_deadlock(tmp_path: Path, files: dict[str, str], value: float) -> None:
    text = """
{"properties": [{"name": "dead", "expression": {"op": "filter", "fun": "values",
  "values": {"op": "Pmax", "exp": {"op": "F", "exp": {"op": "deadlock"}}}, "states": {"op": "initial"}}}]}
"""
    checker = of_system(tmp_path, {**files, "properties.jani": text}, "dead")
    assert answer(checker, traces=20, max_steps=10_000).value == value


def test_a_translation_that_is_read_again_ends_for_the_same_reasons(tmp_path: Path) -> None:
    of_system(tmp_path, hospital())
    loaded = api.load(str(tmp_path / "main.xml"))

    (tmp_path / "main.jani").write_text("".join(write(api.to_jani(loaded))), encoding="utf-8")
    again, _ = api.read_jani(str(tmp_path / "main.jani"))
    first = answer(api.checker(api.to_jani(loaded)), traces=50)
    assert counts(answer(api.checker(again), traces=50)) == counts(first)


def test_stuck_cannot_be_verified_in_a_plain_model() -> None:
    written = document(automaton("a", "s t", ONE_WAY), variables=[variable("x")], properties=FINALLY)
    with pytest.raises(api.PropertyError, match="the model has no property `stuck`; its properties are: p"):
        api.checker(model(written), ["stuck"])


def test_a_property_of_this_name_is_the_one_that_is_asked(tmp_path: Path) -> None:
    files = hospital()
    files["properties.jani"] = files["properties.jani"].replace('"name": "delivered"', '"name": "stuck"')
    (property_,) = of_system(tmp_path, files, "stuck").compiled_properties
    assert not property_.question.is_stuck
    assert property_.question.variables == ("topic_delivered_msg.valid",)


def test_both_kernels_end_for_the_same_reason(tmp_path: Path) -> None:
    checker = of_system(tmp_path, hospital())
    for property_ in (*checker.compiled_properties, checker.stuck):
        compiled = checker.compiled(property_)
        both = [module.Kernel(compiled.program, compiled.goal) for module in (kernel, plain_kernel())]
        ends = []
        for trace in range(8):
            results = []
            for simulator in both:
                simulator.begin(0, trace)
                simulator.advance(10_000)
                results.append((simulator.ending(), simulator.open_ways(0), simulator.outcome()))
            assert results[0] == results[1]
            ends.append(results[0][0])
        assert {End.STUCK.value} < set(ends)


def test_a_batch_returns_the_end_of_each_trace(tmp_path: Path) -> None:

    checker = of_system(tmp_path, hospital())
    outcome = run(Task(checker.payload(checker.compiled_properties[0]), 0, 0, 10, 10_000))
    (rows,) = outcome.questions
    assert len(rows.ends) == len(rows.verdicts) == 10
    assert {(verdict, reason) for verdict, reason in zip(rows.verdicts, rows.ends, strict=True)} == {
        (0, End.STUCK),
        (1, End.DECIDED),
    }
    cut = run(Task(checker.payload(checker.compiled_properties[0]), 0, 0, 10, 5))
    assert set(cut.questions[0].ends) == {End.CUT}
