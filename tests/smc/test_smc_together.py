# SPDX-License-Identifier: Apache-2.0
"""Several questions that share traces: each has exactly the answer that it has alone."""

from __future__ import annotations

import json
from typing import Any

import pytest
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from both_kernels import plain_kernel
from roaml.smc import kernel
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.program import FALSE, FAULTY, UNKNOWN, Compiled, merged
from roaml.smc.run import Answer, EstimationMethod, Options
from roaml.smc.tally import Tally

QUESTIONS: dict[str, Json] = {
    "soon": op("F", op("=", "x", 2)),
    "never": op("G", op("<", "x", 3)),
    "stays": op("F", op("G", op("=", "x", 4))),
    "bounded": {**op("F", op("=", "x", 4)), "step-bounds": {"upper": 6}},
    "until": op("U", op("<", "y", 4), op("=", "x", 4)),
    "both": op("∧", op("F", op("=", "x", 1)), op("¬", op("F", op("=", "y", 2)))),
    "long": op("F", op("=", "y", 30)),
}


def walk(**more: Json) -> Json:
    """A model that counts x up to 4 with a random draw in each step, and y up to 30."""
    steps = [
        edge("go", way("go", 0.4, x=op("+", "x", 1), y=op("+", "y", 1)), way("go", 0.5, y=op("+", "y", 1)),
             way("end", 0.1), guard=op("∧", op("<", "x", 4), op("<", "y", 30))),
    ]  # fmt: skip
    return document(
        automaton("a", "go end", steps),
        variables=[variable("x"), variable("y")],
        properties={name: probability(path) for name, path in {**QUESTIONS, **more}.items()},
    )


def together(
    checker: ModelChecker,
    properties: list[CompiledProperty],
    options: Options,
    tallies: list[Tally] | None = None,
) -> list[Answer | FaultError]:
    with Pool() as pool:
        return checker.answer_together(
            properties, options, pool, tallies or [Tally() for _ in properties], lambda *_: None
        )


def alone(checker: ModelChecker, property_: CompiledProperty, options: Options) -> Answer:
    with Pool() as pool:
        return checker.answer(property_, options, pool)


def numbers(answer: Answer | FaultError) -> Any:
    assert isinstance(answer, Answer)
    return answer.question.name, answer.value, answer.bounds, answer.is_complete, json.dumps(answer.tally.to_json())


@pytest.mark.parametrize(
    "options",
    [
        Options(epsilon=0.03),
        Options(method=EstimationMethod.OKAMOTO, epsilon=0.05),
        Options(method=EstimationMethod.FIXED, max_traces=250, max_steps=9),
    ],
    ids=["adaptive", "okamoto", "cut"],
)
def test_each_answer_is_that_of_traces_of_its_own(options: Options) -> None:
    checker = ModelChecker(model(walk()))
    properties = list(checker.compiled_properties)
    shared = [numbers(answer) for answer in together(checker, properties, options)]
    separate = [numbers(alone(checker, property_, options)) for property_ in properties]
    assert shared == separate
    assert len({answer[1] for answer in shared}) >= 4


def test_each_question_is_asked_until_its_own_rule_stops_it() -> None:
    checker = ModelChecker(model(walk()))
    answers = together(checker, list(checker.compiled_properties), Options(epsilon=0.03))
    traces = {answer.question.name: answer.tally.traces for answer in answers if isinstance(answer, Answer)}
    assert len(set(traces.values())) > 1


def test_questions_that_are_continued_from_different_traces() -> None:
    checker = ModelChecker(model(walk()))
    properties = list(checker.compiled_properties)
    tallies = [Tally() for _ in properties]
    together(checker, properties[:3], Options(method=EstimationMethod.FIXED, max_traces=150), tallies[:3])
    for tally in tallies:
        tally.is_finished = False
    continued = together(checker, properties, Options(method=EstimationMethod.FIXED, max_traces=400), tallies)
    assert [numbers(answer) for answer in continued] == [
        numbers(alone(checker, property_, Options(method=EstimationMethod.FIXED, max_traces=400)))
        for property_ in properties
    ]


def test_a_trace_that_fails_concerns_only_the_questions_that_it_does_not_answer_before() -> None:
    # y reaches 3 in some traces, after `soon` has been decided in all of these that matter to it or not.
    checker = ModelChecker(model(walk(broken=op("G", op("<", op("/", 1, op("-", 3, "y")), 5)))))
    options = Options(method=EstimationMethod.FIXED, max_traces=100)
    answers = together(checker, list(checker.compiled_properties), options)
    assert [a.message for a in answers if isinstance(a, FaultError)] == ["division by zero"]
    assert isinstance(answers[-1], FaultError)
    good = [answer for answer in answers if isinstance(answer, Answer)]
    assert [numbers(a) for a in good] == [
        numbers(alone(checker, property_, options)) for property_ in checker.compiled_properties[:-1]
    ]


def test_both_kernels_say_the_same_of_all_questions() -> None:
    checker = ModelChecker(model(walk()))
    goal = merged([property_.goal for property_ in checker.compiled_properties])
    compiled = Compiled(checker.program, goal)
    seen = set()
    results: list[list[Any]] = []
    for module in (kernel, plain_kernel()):
        one = module.Kernel(compiled.program, compiled.goal)
        rows = []
        for trace in range(30):
            one.choose([0, 2, 3, 6] if trace % 3 else range(len(checker.compiled_properties)))
            status = one.begin(7, trace)
            assert status != FAULTY
            if status == UNKNOWN:
                one.advance(1000)
            rows.append([one.result(i) for i in range(len(checker.compiled_properties))])
            seen |= {row[0] for row in rows[-1]}
        results.append(rows)
    assert results[0] == results[1]
    assert seen == {FALSE, 1}
