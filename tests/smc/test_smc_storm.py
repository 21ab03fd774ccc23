# SPDX-License-Identifier: Apache-2.0
"""Comparison with an independent model checker: Storm computes the probabilities that traces estimate."""

from __future__ import annotations

import json
import math
import random
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import stormpy
from smc_models import Json, at, automaton, document, edge, model, op, probability, variable, way
from storm import exact as storm_exact
from test_translate_storm import COINS, JUDGE, LISTENER, reaches, system
from translating import loaded

from explorer import Explorer, TooManyStatesError
from roaml import api
from roaml.explicit.space import StateLimits
from roaml.jani.model import Model
from roaml.smc.lss import Search, Side
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.program import FALSE, TRUE
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.exhaustive import UndecidedError, exact_values
from roaml.verification.small import LIMITS, attempt

ROOT = Path(__file__).resolve().parents[2]
TRACES = 3000


def estimates(actual_model: Model, seed: int = 3) -> dict[str, tuple[int, int]]:
    """Property -> the numbers of successes and traces."""
    checker = ModelChecker(actual_model)
    with Pool() as pool:
        options = Options(method=EstimationMethod.FIXED, max_traces=TRACES, seed=seed, max_steps=100_000)
        answers = {
            property_.question.name: checker.answer(property_, options, pool)
            for property_ in checker.compiled_properties
        }
    assert all(answer.tally.undecided == 0 for answer in answers.values())
    return {name: (answer.tally.successes, answer.tally.traces) for name, answer in answers.items()}


def two_sided(successes: int, traces: int, p: float) -> float:
    """The probability of a deviation of at least this size, by the normal approximation with continuity correction."""
    if p in (0, 1):
        return 1.0 if successes == p * traces else 0.0
    deviation = abs(successes - p * traces) - 0.5
    return math.erfc(max(0.0, deviation) / math.sqrt(2 * traces * p * (1 - p)))


def chain(source: random.Random, number: int) -> Json:
    """A random Markov chain over locations and a counter, with several properties."""
    places = [f"s{i}" for i in range(source.randint(3, 6))]
    edges = []
    for following, place in enumerate(places[:-1], 1):
        # The last location is always reached.
        targets = list(dict.fromkeys((places[following], *source.sample(places, source.randint(1, 2)))))
        weights = [source.randint(1, 5) for _ in targets]
        values = []
        for target, weight in zip(targets, weights, strict=True):
            x = op("min", 6, op("+", "x", source.randint(0, 2)))
            values.append(way(target, op("/", weight, sum(weights)), x=x, y=source.choice(["x", 0, 1])))
        edges.append(edge(place, *values))

    edges.append(edge(places[-1], way(places[-1], end=True)))
    conditions = [op("=", "x", source.randint(1, 6)), op("∧", "end", op("<", "x", 5)), op("=", "y", 1)]
    properties = {f"{number}-F{i}": probability(op("F", formula)) for i, formula in enumerate(conditions)}
    properties[f"{number}-U"] = probability(op("U", op("<", "x", 4), "end"))
    properties[f"{number}-G"] = probability(op("G", op("≠", "x", 3)))
    properties[f"{number}-B"] = probability({**op("F", conditions[0]), "step-bounds": {"upper": source.randint(2, 9)}})
    return document(
        automaton("a", " ".join(places), edges),
        variables=[
            variable("x", {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 8}),
            variable("y", {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 8}),
            variable("end", "bool", False),
        ],
        type_="dtmc",
        properties=properties,
    )


def computed(written: Json) -> dict[str, float]:
    """Property -> the probability that Storm computes."""
    parsed, properties = stormpy.parse_jani_model_from_string(json.dumps(written))
    values = {}
    for formula in properties:
        built = stormpy.build_model(parsed, [formula])
        result = stormpy.model_checking(built, formula, only_initial_states=True)
        values[formula.get_name()] = result.get_value(built.initial_states[0])
    return values


def test_estimates_agree_with_storm() -> None:
    """A binomial test for each of more than a hundred properties, and one for all of them together."""
    source = random.Random(2)
    surprises = []
    for number in range(18):
        written = chain(source, number)
        expected = computed(written)
        for name, (successes, traces) in estimates(model(written), seed=number).items():
            surprises.append(two_sided(successes, traces, expected[name]))
    assert len(surprises) > 100
    assert min(surprises) > 1e-5
    assert sum(p < 0.05 for p in surprises) <= 0.12 * len(surprises)


@pytest.mark.parametrize("name", COINS)
def test_translated_systems_agree_with_storm(name: str) -> None:
    coin, count, expected = COINS[name]
    actual_model = api.to_jani(loaded(system(coin, JUDGE, LISTENER, properties=reaches("told__heads", count))))
    ((successes, traces),) = estimates(actual_model).values()
    assert two_sided(successes, traces, float(expected)) > 1e-4


def induced(actual_model: Model, limit: int, folder: Path) -> float | None:
    """The probability that Storm computes for the Markov chain that uniform choices induce in a model."""
    checker = ModelChecker(actual_model)
    explorer = Explorer(checker.compiled(checker.compiled_properties[0]))
    try:
        verdicts = explorer.reachable(limit)
    except TooManyStatesError:
        return None
    index = {state: number for number, state in enumerate(verdicts)}
    lines = ["dtmc", "module chain", f"s : [0..{len(index)}] init 0;"]
    for state, row in index.items():
        chances: Counter[int] = Counter()
        choices = [] if verdicts[state] in (FALSE, TRUE) else list(explorer.choices(state))
        count = sum(times for times, _ in choices)
        for times, branches in choices:
            for chance, successor in branches:
                chances[index[successor]] += chance * times / count  # type: ignore[assignment]
        updates = " + ".join(f"{chance!r}:(s'={column})" for column, chance in (chances or {row: 1.0}).items())
        lines.append(f"[] s={row} -> {updates};")
    good = " | ".join(f"s={index[state]}" for state, verdict in verdicts.items() if verdict == TRUE)
    path = folder / "chain.prism"
    path.write_text("\n".join([*lines, "endmodule", f'label "good" = {good or "false"};']), encoding="utf-8")
    program = stormpy.parse_prism_program(str(path))
    (formula,) = stormpy.parse_properties('P=? [F "good"]', program)
    chain_ = stormpy.build_model(program, [formula])
    value = stormpy.model_checking(chain_, formula, only_initial_states=True).get_value(chain_.initial_states[0])
    assert isinstance(value, float)
    return value


def test_uniform_choices_agree_with_the_chain_that_they_induce(tmp_path: Path) -> None:
    surprises = []
    for seed in range(60):
        written = example(seed)
        actual_model = model(written)
        expected = induced(actual_model, 300, tmp_path)
        if expected is None:
            continue
        checker = ModelChecker(actual_model)
        with Pool() as pool:
            answer = checker.answer(
                checker.compiled_properties[0],
                Options(method=EstimationMethod.FIXED, max_traces=TRACES, max_steps=3000),
                pool,
            )
        low = answer.tally.successes
        high = low + answer.tally.undecided
        closest = min(max(expected * TRACES, low), high)
        surprises.append(two_sided(round(closest), TRACES, expected) if high == low else 1.0)
    assert len(surprises) > 30
    assert min(surprises) > 1e-5
    assert sum(p > 0.001 for p in surprises) > 0.9 * len(surprises)


def example(seed: int) -> Json:
    """A network with nondeterminism, made from random numbers."""
    source = random.Random(seed)
    parts = []
    for number in range(2):
        edges = []
        for _ in range(source.randint(2, 5)):
            place, target, other = (source.choice("lmn") for _ in range(3))
            value = op("%", op("+", source.choice(["x", "y"]), source.randint(0, 2)), 3)
            action = source.choice([None, "go", "stop"])
            guard = source.choice([None, op("<", "x", 2), op("=", "y", source.randint(0, 2))])
            first = way(target, 0.5, **{source.choice(["x", "y"]) if number else "x": value})
            edges.append(edge(place, first, way(other, 0.5), action=action, guard=guard))
        parts.append(automaton(f"m{number}", "l m n", edges))
    goal = op("F", op("∧", op("=", "x", 2), op("=", "y", source.randint(0, 2))))
    syncs = [["go", "go"], ["stop", None], [None, "stop"]]
    variables = [variable("x"), variable("y"), variable("v", {"kind": "array", "base": "int"}, ARRAY)]
    return document(*parts, variables=variables, syncs=syncs, properties={"p": probability(goal)})


ARRAY: Any = {"op": "av", "elements": [1, 2]}


def test_exact_answers() -> None:
    """The least and the greatest probability over all schedulers. The uniform one is between them."""
    steps = [edge("l", way("m", 0.25, x=1), way("m", 0.75, x=2)), edge("l", way("m", 0.5, x=1), way("m", 0.5, x=2))]
    actual_model = model(
        document(
            automaton("a", "l m", steps),
            variables=[variable("x"), variable("v", {"kind": "array", "base": "int"}, ARRAY)],
            properties={"p": probability(op("F", op("=", "x", at("v", 0))))},
        )
    )
    checker = ModelChecker(actual_model)
    result = exact_values(checker, checker.compiled_properties[0], StateLimits(100))
    assert (result.least, result.greatest, result.states) == (pytest.approx(0.25), pytest.approx(0.5), 3)
    with pytest.raises(UndecidedError, match=r"^stopped at 2 states \(max-states\)"):
        exact_values(checker, checker.compiled_properties[0], StateLimits(2))
    assert result.average == pytest.approx(0.375)
    ((successes, traces),) = estimates(actual_model).values()
    assert two_sided(successes, traces, 0.375) > 1e-4


def test_extremes_from_all_states_are_those_of_storm() -> None:
    """Random networks with the goal, its negation, and one until: the bounds contain the values of Storm."""
    solved = differing = 0
    for seed in range(40):
        written = example(seed)
        goal = written["properties"][0]["expression"]["values"]["exp"]
        opposite = op("G", op("¬", goal["exp"]))
        until = op("U", op("<", "y", 2), op("=", "x", 2))
        for path in (goal, opposite, until):
            written["properties"] = [{"name": "p", "expression": probability(path)}]
            actual_model = model(written)
            checker = ModelChecker(actual_model)
            solution = attempt(checker, checker.compiled_properties[0], LIMITS).exact
            if solution is None or solution.states > 300:
                continue
            expected = storm_exact(actual_model, "p")
            assert solution.minimum.lower - 2e-6 <= expected.least <= solution.minimum.upper + 2e-6, (seed, path)
            assert solution.maximum.lower - 2e-6 <= expected.greatest <= solution.maximum.upper + 2e-6, (seed, path)
            solved += solution.minimum.half_width < 1e-6 and solution.maximum.half_width < 1e-6
            differing += not solution.agrees
    assert solved > 75
    assert differing > 15


def test_schedulers_that_are_found_come_close_to_the_extremes() -> None:
    steps = []
    for place in ("a", "b", "c"):
        following = chr(ord(place) + 1)
        steps.append(edge(place, way(following, 0.9, x=op("+", "x", 1)), way(following, 0.1)))
        steps.append(edge(place, way(following, 0.2, x=op("+", "x", 1)), way(following, 0.8)))
    actual_model = model(
        document(
            automaton("a", "a b c d", steps),
            variables=[variable("x")],
            properties={"p": probability(op("F", op("=", "x", 3)))},
        )
    )
    expected = storm_exact(actual_model, "p")
    checker = ModelChecker(actual_model)
    with Pool() as pool:
        state = Search()
        checker.search(checker.compiled_properties[0], Options(epsilon=0.02), pool, state)
    share = {side: tally.successes / tally.traces for side, (_, tally) in state.selected.items()}
    assert share[Side.GREATEST] == pytest.approx(expected.greatest, abs=0.03)
    assert share[Side.LEAST] == pytest.approx(expected.least, abs=0.03)
