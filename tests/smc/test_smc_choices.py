# SPDX-License-Identifier: Apache-2.0
"""What is known about schedulers other than the uniform one: whether all agree, and how far apart some are."""

from __future__ import annotations

import pytest
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from both_kernels import plain_kernel
from explorer import Explorer
from roaml.record import replace
from roaml.smc import kernel
from roaml.smc.batch import Rows, Simulator, Task, run_on
from roaml.smc.choices import Choices, ExtremeMethod
from roaml.smc.lss import FAVOUR, MEMORY, STARVE, candidates, described
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.small import LIMITS, attempt
from roaml.verification.target import target_of
from roaml.verification.verifier import verifier_of

GOAL = op("F", "done")


def looked_at(written: Json, options: Options | None = None) -> Choices:
    verifier = verifier_of(target_of(model(written)), None, options or Options(epsilon=0.03))
    with Pool() as pool:
        choices = verifier.verify(verifier.names[0], pool).choices
    assert choices is not None
    return choices


def starving(length: int, chance: bool = False, operator: str = "Pmin", steps: int = 0) -> Json:
    """A worker that is done after `steps` + 1 steps, and a machine that can continue for ever."""
    goes_on = way("s", c=op("%", op("+", "c", 1), length))
    ways = [way("s", 0.5, c=op("%", op("+", "c", 1), length)), way("s", 0.5, c=0)] if chance else [goes_on]
    return document(
        automaton("busy", "s", [edge("s", *ways)]),
        automaton(
            "worker",
            "a b",
            [
                edge("a", way("b", done=True), guard=op("=", "w", steps)),
                edge("a", way("a", w=op("+", "w", 1)), guard=op("<", "w", steps)),
            ],
        ),
        variables=[variable("c"), variable("w"), variable("done", "bool", False)],
        properties={"p": probability(GOAL, operator)},
    )


def chain(length: int, type_: str = "mdp") -> Json:
    """One automaton without choices."""
    steps = [edge("s", way("s", 0.5, c=op("+", "c", 1)), way("e", 0.5, done=True), guard=op("<", "c", length))]
    return document(
        automaton("a", "s e", steps),
        variables=[variable("c"), variable("done", "bool", False)],
        properties={"p": probability(GOAL)},
        type_=type_,
    )


def test_nothing_to_choose() -> None:
    choices = looked_at(chain(5))
    # `c` is dead in `e`: six states with `s`, one with `e`.
    assert choices.agreement == "all 7 states were explored"
    assert (choices.minimum, choices.differ) == (choices.maximum, False)
    assert looked_at(chain(10**6, "dtmc")).agreement == "the model has no nondeterminism"


def test_choices_that_do_not_matter() -> None:
    """Two coins, thrown in any order."""
    coins = [automaton(f"coin{i}", "s e", [edge("s", way("e", 0.5, **{f"x{i}": 1}), way("e", 0.5))]) for i in range(2)]
    both = op("F", op("∧", op("=", "x0", 1), op("=", "x1", 1)))
    choices = looked_at(
        document(*coins, variables=[variable("x0"), variable("x1")], properties={"p": probability(both)})
    )
    assert choices.agreement.startswith("all ")
    assert choices.minimum is not None
    assert (choices.minimum.value, choices.minimum.method) == (pytest.approx(0.25), ExtremeMethod.EXPLORATION)
    assert choices.maximum is not None
    assert choices.maximum.value == pytest.approx(0.25)


@pytest.mark.parametrize("chance", [False, True])
def test_a_machine_that_can_be_made_to_wait_for_ever(chance: bool) -> None:
    """The uniform value is 1 and the minimum 0. It is computed from all states if there are few."""
    choices = looked_at(starving(20, chance))
    assert choices.differ
    assert choices.minimum is not None
    assert choices.maximum is not None
    assert (choices.minimum.value, choices.maximum.value) == (0, 1)
    assert choices.minimum.is_exact


def test_starving_is_found_by_sampling_where_there_are_many_states() -> None:
    choices = looked_at(starving(100, steps=300))
    assert choices.differ
    assert choices.minimum is not None
    assert (choices.minimum.value, choices.minimum.method) == (0, ExtremeMethod.SAMPLING)
    assert choices.minimum.scheduler.startswith("sampled scheduler 1, which lets `")
    assert choices.minimum.bounds.upper < 0.2
    assert choices.maximum is not None
    assert (choices.maximum.value, choices.maximum.method) == (1, ExtremeMethod.UNIFORM)


def test_results_do_not_depend_on_workers() -> None:
    checker = ModelChecker(model(starving(100, steps=300)))
    results = []
    for pool in (Pool(), Pool(2, start_delay_s=0)):
        with pool as used:
            answer = checker.answer(checker.compiled_properties[0], Options(epsilon=0.03), used)
            results.append(checker.choices(checker.compiled_properties[0], answer, used))
    assert results[0] == results[1]


def test_rewards_are_not_sampled() -> None:
    written = starving(100, steps=300)
    reward = {"op": "Emin", "exp": 1, "accumulate": ["steps"], "reach": "done"}
    written["properties"] = [{"name": "p", "expression": reward}]
    assert looked_at(written, Options(epsilon=0.3)) == Choices()


def test_described() -> None:
    names = ["`one`", "`two`"]
    assert described(7, names) == "sampled scheduler 7, which always makes the same choice in the same state"
    assert described(MEMORY | 3, names) == (
        "sampled scheduler 3, which always makes the same choice after the same step in the same state"
    )
    assert described(STARVE | (1 << 32) | 2, names) == (
        "sampled scheduler 2, which lets `two` proceed only where nothing else can proceed"
    )
    assert described(FAVOUR | 1, names) == "sampled scheduler 1, which lets `one` proceed wherever possible"
    some = candidates(2, per_automaton=1, memoryless=2, memory=2)
    assert len(set(some)) == len(some) == 2 + 4 + 2


def outcomes(written: Json, scheduler: int, steps: int = 10_000) -> tuple[int, int]:
    """The verdict and the steps of a trace under a scheduler. Both kernels must agree."""
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    results = []
    for module in (kernel, plain_kernel()):
        simulator = module.Kernel(compiled.program, compiled.goal)
        verdict = simulator.begin(1, 0, scheduler)
        if verdict == UNKNOWN:
            verdict = simulator.advance(steps)
        results.append((verdict, simulator.outcome()[0]))
    assert results[0] == results[1]
    return results[0]


def test_a_scheduler_in_a_cycle_never_reaches_the_goal() -> None:
    """A state is reached again without a random draw in between, so the trace repeats for ever. The kernel need not run
    until `max_steps`."""
    starve_worker, favour_worker = STARVE | (1 << 32) | 1, FAVOUR | (1 << 32) | 1
    verdict, steps = outcomes(starving(100), starve_worker)
    assert verdict == FALSE
    assert steps < 500
    assert outcomes(starving(100), favour_worker) == (TRUE, 1)
    # With random draws in between, this does not follow.
    assert outcomes(starving(100, chance=True), starve_worker, 2000) == (UNKNOWN, 2000)


def test_a_scheduler_with_memory_can_do_what_none_without_can() -> None:
    """The machines have only one state, in which the choices must be taken one after the other."""
    loops = [automaton(name, "s", [edge("s", "s", action=name)]) for name in ("one", "two")]
    watcher = automaton(
        "watcher",
        "s a b c bad",
        [
            edge("s", "a", action="one"),
            edge("s", "bad", action="two"),
            edge("a", way("b", done=True), action="two"),
            edge("a", "s", action="one"),
            edge("bad", "bad", action="one"),
        ],
    )
    written = document(
        *loops,
        watcher,
        variables=[variable("done", "bool", False)],
        syncs=[["one", None, "one"], [None, "two", "two"]],
        properties={"p": probability(GOAL, "Pmax")},
    )
    compiled = ModelChecker(model(written)).compiled(ModelChecker(model(written)).compiled_properties[0])
    assert len(Explorer(compiled).reachable(100)) == 4
    assert {outcomes(written, MEMORY | number)[0] for number in range(1, 40)} == {TRUE, FALSE}


@pytest.mark.parametrize("limit", [{"states": 50}, {"transitions": 50}])
def test_limits_of_looking_at_all_states(limit: dict[str, int]) -> None:
    checker = ModelChecker(model(starving(100, chance=True)))
    exact = attempt(checker, checker.compiled_properties[0], LIMITS).exact
    assert exact is not None
    assert (exact.states, exact.least, exact.average) == (200, 0, 1)
    assert attempt(checker, checker.compiled_properties[0], replace(LIMITS, **limit)).exact is None


def test_steps_are_part_of_the_work() -> None:
    """A bound on steps that needs a million sweeps over all states is left to traces."""
    written = starving(20, chance=True)
    written["properties"] = [{"name": "p", "expression": probability({**GOAL, "step-bounds": {"upper": 10**7}})}]
    checker = ModelChecker(model(written))
    assert attempt(checker, checker.compiled_properties[0], LIMITS).exact is None
    written["properties"] = [{"name": "p", "expression": probability({**GOAL, "step-bounds": {"upper": 3}})}]
    checker = ModelChecker(model(written))
    exact = attempt(checker, checker.compiled_properties[0], LIMITS).exact
    assert exact is not None
    assert (exact.least, exact.greatest, exact.average) == (0, 1, pytest.approx(0.875))


def test_goals_of_several_parts() -> None:
    """Whether a state is good depends on earlier states."""
    written = chain(5)
    both = op("∧", op("F", "done"), op("F", op("=", "c", 2)))
    written["properties"] = [{"name": "p", "expression": probability(both)}]
    choices = looked_at(written)
    assert choices.agreement == "all 11 states were explored"


@pytest.mark.parametrize("chance", [False, True])
@pytest.mark.parametrize("scheduler", [1, 2, *candidates(2, per_automaton=1, memoryless=1, memory=1)])
def test_traces_without_chance_are_repeated(scheduler: int, chance: bool) -> None:
    """A batch of traces under a scheduler is equal to batches of one trace each, of which none is repeated."""
    checker = ModelChecker(model(starving(5, chance=chance, steps=3)))
    payload = checker.payload(*checker.compiled_properties)

    def rows(first: int, size: int) -> Rows:
        outcome = run_on(Simulator(payload.compiled), Task(payload, 3, first, size, 40, scheduler))
        assert outcome.problem is None
        return outcome.questions[0]

    single = [rows(trace, 1) for trace in range(7, 27)]
    for name in ("verdicts", "ends", "steps", "activities", "rewards"):
        columns = [list(getattr(row, name)) for row in single]
        assert [value for column in columns for value in column] == list(getattr(rows(7, 20), name))
    if chance and scheduler in (1, 2):
        assert len({row.steps[0] for row in single}) > 1


def test_a_search_beside_traces_is_limited_by_their_steps() -> None:
    """Schedulers of a model that is small compared with its traces are compared by all its states, others by
    sampling."""
    written = starving(400, chance=True, steps=20)
    few, many = (looked_at(written, Options(method=EstimationMethod.FIXED, max_traces=n)) for n in (100, 60_000))
    assert few.minimum is not None
    assert few.minimum.method is not ExtremeMethod.EXPLORATION
    assert many.minimum is not None
    assert (many.minimum.method, many.minimum.value) == (ExtremeMethod.EXPLORATION, 0)
