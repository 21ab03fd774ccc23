# SPDX-License-Identifier: Apache-2.0
"""The reaction time in random networks: the kernel, guards in JANI, reductions, and an explorer that follows the
definition have the same answers."""

from __future__ import annotations

import pytest
from clocked_networks import STEP, clocked, is_local
from compared_spaces import ALL, both, check
from hypothesis import Phase, given, settings
from slow_explorer import SlowExplorer, reach

from examples import examples
from roaml.durations import ANY_TIME, AT_ONCE, ReactionTime, duration_text, reaction_time
from roaml.explicit.plain import plain_kernel, plain_search
from roaml.explicit.space import explore
from roaml.explicit.values import values_of
from roaml.jani.model import Model
from roaml.jani.reaction import ReactionError, reacting
from roaml.jani.reader import read_model
from roaml.jani.writer import write
from roaml.json_syntax import parse
from roaml.smc.model import ModelChecker

TIMES = [ANY_TIME, AT_ONCE, ReactionTime(STEP), ReactionTime(2 * STEP)]
LIMIT = 1500


def rewritten(model: Model) -> Model:
    """The model in a JANI file."""
    read, findings = read_model(parse("".join(write(model)))[0])
    assert not findings
    assert read is not None
    return read


def extremes(model: Model, *, modules: object = None) -> tuple[float, float, int]:
    checker = ModelChecker(model)
    space = explore(checker, checker.compiled_properties[0], ALL, modules=modules)
    values = values_of(space)
    return values.minimum.lower, values.maximum.lower, space.states


@given(clocked())
@settings(max_examples=examples(30), deadline=None, phases=[Phase.generate])
def test_all_agree_with_the_definition(model: Model) -> None:
    known: dict[ReactionTime, tuple[float, float]] = {}
    for time in TIMES if is_local(model) else TIMES[:2]:
        explorer = SlowExplorer(ModelChecker(model), time)
        states = explorer.reachable(LIMIT)
        if states is None:
            continue
        lowest, highest = (reach(states, explorer.initial, best) for best in (False, True))
        known[time] = lowest, highest
        reacts = reacting(model, time)
        minimum, maximum, _ = extremes(reacts)
        assert minimum == pytest.approx(lowest, abs=1e-8), time
        assert maximum == pytest.approx(highest, abs=1e-8), time
        minimum, maximum, _ = extremes(rewritten(reacts))
        assert minimum == pytest.approx(lowest, abs=1e-8), time
        assert maximum == pytest.approx(highest, abs=1e-8), time
    for shorter, longer in ((AT_ONCE, TIMES[2]), (TIMES[2], TIMES[3]), (TIMES[3], ANY_TIME)):
        if shorter in known and longer in known:
            assert known[shorter][0] >= known[longer][0] - 1e-9
            assert known[shorter][1] <= known[longer][1] + 1e-9


@given(clocked())
@settings(max_examples=examples(60), deadline=None)
def test_guards_have_the_same_states_as_the_kernel(model: Model) -> None:
    """Without dead variables and reductions, which might hide a difference."""
    instant = reacting(model, AT_ONCE)
    assert extremes(instant)[2] == extremes(rewritten(instant))[2]


@given(clocked())
@settings(max_examples=examples(60), deadline=None)
def test_reductions_keep_the_extremes(model: Model) -> None:
    for time in TIMES if is_local(model) else TIMES[:2]:
        checker = ModelChecker(reacting(model, time))
        spaces = both(checker, checker.compiled_properties[0])
        assert spaces is not None
        check(*spaces)


@given(clocked())
@settings(max_examples=examples(20), deadline=None)
def test_both_kernels_hold_the_clock(model: Model) -> None:
    instant = reacting(model, AT_ONCE)
    assert extremes(instant) == extremes(instant, modules=(plain_kernel(), plain_search()))


@given(clocked())
@settings(max_examples=examples(20), deadline=None)
def test_a_file_keeps_its_reaction_time(model: Model) -> None:
    for time in TIMES[1:]:
        file = rewritten(reacting(model, time))
        assert file.metadata is not None
        assert file.metadata.reaction_time == time
        assert reacting(file, time) == file
        with pytest.raises(ReactionError):
            reacting(file, ANY_TIME)


def test_texts() -> None:
    assert reaction_time("any") == ANY_TIME
    assert reaction_time(" instant ") == AT_ONCE
    assert reaction_time("0 s") == AT_ONCE
    assert reaction_time("20ms") == ReactionTime(20_000_000)
    assert reaction_time("20") is None
    assert reaction_time("soon") is None
    assert [time.text for time in TIMES] == ["any", "instant", "1 s", "2 s"]
    assert duration_text(1500) == "1500 ns"
    assert ReactionTime(1).steps(STEP) == 1
    assert ReactionTime(STEP + 1).steps(STEP) == 2
