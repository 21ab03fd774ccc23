# SPDX-License-Identifier: Apache-2.0
"""The search that leaves choices out has the same minimum, maximum, verdicts, faults and stuck states as the search
through all states, on random networks."""

from __future__ import annotations

from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from loose_networks import STUCK_AUTOMATON, STUCK_LOCATION, networks
from smc_models import Json, model
from smc_random import networks as entangled_networks

from examples import examples
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.path import PathRecorder, shortest
from roaml.explicit.plain import plain_kernel, plain_search
from roaml.explicit.space import Space, StateLimits, explore
from roaml.explicit.values import values_of
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.record import SELECTED, Recording

TOLERANCE = 2e-8
MARKS = {(STUCK_AUTOMATON, STUCK_LOCATION): End.STUCK}


def question_of(written: Json, *, is_stuck: bool = False) -> tuple[ModelChecker, CompiledProperty]:
    checker = ModelChecker(model(written), marks=MARKS, includes_stuck=True)
    return checker, checker.compiled_properties[-1 if is_stuck else 0]


def both(checker: ModelChecker, property_: CompiledProperty, modules: Any = None) -> tuple[Space, Space] | None:
    """The whole space and the reduced one; `None` if the property cannot be reduced."""
    compiled = checker.compiled(property_)
    if not can_be_reduced(compiled.program, compiled.goal):
        return None
    whole = explore(checker, property_, StateLimits(), modules=modules)
    return whole, explore(checker, property_, StateLimits(), modules=modules, is_reduced=True)


def is_smaller(whole: Space, reduced: Space) -> bool:
    return reduced.problem is None and reduced.states < whole.states


def replay(space: Space, verdict: int) -> None:
    """Check that the steps of a trace can be taken one after the other, and that it has the verdict at its end, and not
    before."""
    path = shortest(space, verdict)
    assert path is not None
    compiled = space.checker.compiled(space.compiled_property)
    kernel, deadlock = Kernel(compiled.program, compiled.goal), Kernel(compiled.program, compiled.goal)
    status = kernel.begin(0, 0)
    for step in path.steps:
        assert status == UNKNOWN
        possible = {vector: edges for vector, _, edges in kernel.choices()}
        assert step.vector in possible
        for pick, way, edges in zip(step.edges, step.ways, possible[step.vector], strict=True):
            assert edges[pick][way] > 0
        assert kernel.go(*step) == UNKNOWN
        status = kernel.look()
        if compiled.goal.is_bounded == 2:  # the kernel looks again only if a variable has changed
            places = [kernel.location(instance) for instance in range(compiled.program.instances)]
            deadlock.restore(places, *kernel.snapshot())
            status = deadlock.look()
    if status == UNKNOWN:
        assert kernel.ended()
        status = kernel.close()
    assert status == verdict
    recording = Recording(SELECTED)
    assert len(list(PathRecorder(space, path).walk(recording))) == len(path.steps)
    assert recording.verdict == verdict


def check(whole: Space, reduced: Space) -> None:
    assert (reduced.problem is None) == (whole.problem is None)
    if whole.problem is not None:
        return
    assert reduced.states <= whole.states
    assert reduced.can_get_stuck == whole.can_get_stuck
    ours, expected = values_of(reduced), values_of(whole)
    for name in ("minimum", "maximum"):
        one, other = getattr(ours, name), getattr(expected, name)
        assert one.lower - TOLERANCE <= other.upper, name
        assert other.lower - TOLERANCE <= one.upper, name
    for verdict in (FALSE, TRUE):
        assert (shortest(reduced, verdict) is None) == (shortest(whole, verdict) is None)
        if shortest(reduced, verdict) is not None:
            replay(reduced, verdict)


def test_reduced_spaces_have_the_same_answers() -> None:
    smaller: list[bool] = []

    @given(networks(), st.booleans())
    @settings(max_examples=examples(300), deadline=None)
    def run(written: Json, is_stuck: bool) -> None:
        spaces = both(*question_of(written, is_stuck=is_stuck))
        if spaces is not None:
            check(*spaces)
            smaller.append(is_smaller(*spaces))

    run()
    assert sum(smaller) > len(smaller) / 2
    assert len(smaller) > examples(300) / 2


def test_reduced_spaces_have_the_same_faults() -> None:
    faulty: list[bool] = []

    @given(networks(has_faults=True))
    @settings(max_examples=examples(150), deadline=None)
    def run(written: Json) -> None:
        spaces = both(*question_of(written))
        if spaces is not None:
            check(*spaces)
            faulty.append(spaces[0].problem is not None)

    run()
    assert sum(faulty) > len(faulty) / 8


@given(entangled_networks())
@settings(max_examples=examples(60), deadline=None)
def test_automata_with_many_shared_variables(written: Json) -> None:
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)


@given(networks())
@settings(max_examples=examples(40), deadline=None)
def test_both_searches_leave_out_the_same(written: Json) -> None:
    ours = both(*question_of(written))
    if ours is None:
        return
    plain = both(*question_of(written), modules=(plain_kernel(), plain_search()))
    assert plain is not None
    for one, other in zip(ours, plain, strict=True):
        assert one.states == other.states
        for state in range(one.states):
            assert one.search.key(state) == other.search.key(state)
            assert one.search.choices_of(state) == other.search.choices_of(state)
