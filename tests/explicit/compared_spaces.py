# SPDX-License-Identifier: Apache-2.0
"""Searches of a model without and with reductions, and the comparison of their answers."""

from __future__ import annotations

from typing import Any

from roaml.explicit.independence import can_be_reduced
from roaml.explicit.path import shortest
from roaml.explicit.path_recorder import PathRecorder
from roaml.explicit.space import Space, StateLimits, explore
from roaml.explicit.values import values_of
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.record import SELECTED, Recording

TOLERANCE = 2e-8
ALL = StateLimits()


def both(
    checker: ModelChecker, property_: CompiledProperty, modules: Any = None, limits: StateLimits = ALL
) -> tuple[Space, Space] | None:
    """The whole space and the reduced one; `None` if the property cannot be reduced."""
    compiled = checker.compiled(property_)
    if not can_be_reduced(compiled.program, compiled.goal):
        return None
    whole = explore(checker, property_, limits, modules=modules)
    return whole, explore(checker, property_, limits, modules=modules, is_reduced=True)


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
        for pick, target, edges in zip(step.edges, step.ways, possible[step.vector], strict=True):
            assert edges[pick][target] > 0
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
    assert len(list(PathRecorder(space.checker, space.compiled_property, path).walk(recording))) == len(path.steps)
    assert recording.verdict == verdict


def check(whole: Space, reduced: Space) -> None:
    """Check that both spaces have the same answers, and that the reduced one is not larger."""
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
