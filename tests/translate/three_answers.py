# SPDX-License-Identifier: Apache-2.0
"""One property, three answers: from Storm on the translated observer, from the search through all states, and from
traces."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from storm import Exact, exact

from roaml import api
from roaml.record import replace

TOLERANCE = 1e-5
SAMPLING = api.Options(method=api.EstimationMethod.FIXED, max_traces=200, max_steps=20_000, seed=1, confidence=0.9999)


@dataclass(frozen=True)
class Answers:
    """
    Attributes:
        storm: minimum and maximum; `None` if there are too many states.
        states: of Storm's model.
        searched_states: of the search; 0 if it does not end.
        searched: minimum and maximum; `None` if the search does not answer, for the reason `undecided`.
        uniform: the value under uniform choices, if the search computed it.
        bounds: of the estimate; 0 and 1 if there are too many states.
        open: the traces that the end of time left undecided; Storm takes them for satisfied.
    """

    storm: tuple[float, float] | None
    states: int
    searched_states: int
    searched: tuple[float, float] | None
    uniform: float | None
    undecided: str
    bounds: api.Bounds
    open: int

    @property
    def is_certain(self) -> bool:
        return self.storm is not None and self.storm[0] == self.storm[1] and self.storm[0] in (0, 1)

    def differences(self) -> Iterator[str]:
        if self.storm is None:
            return
        least, greatest = self.storm
        if self.searched is not None and any(
            abs(one - other) > TOLERANCE for one, other in zip(self.searched, self.storm, strict=True)
        ):
            yield f"the search says {self.searched}, Storm says {self.storm}"
        if self.bounds.lower > greatest + TOLERANCE or self.bounds.upper < least - TOLERANCE:
            yield f"the estimate is in {self.bounds}, Storm says {self.storm}"
        if self.uniform is not None and not self.bounds.lower <= self.uniform <= self.bounds.upper:
            yield f"the estimate is in {self.bounds}, the search says {self.uniform} for uniform choices"


def answers(
    source: api.LoadedSystem | api.Model,
    name: str,
    max_states: int,
    storms_answer: Callable[[api.Model, str], Exact | None] = exact,
) -> Answers:
    """
    Args:
        max_states: of a state space that is searched, and then built by Storm.
        storms_answer: `None` if Storm does not answer.
    """
    verifier = api.verifier(source, [name])
    result = verifier.exhaustive(verifier.checker.compiled_properties[0], api.StateLimits(max_states))
    undecided = result.outcome.reason if isinstance(result.outcome, api.Undecided) else ""
    if undecided.startswith("stopped"):
        return Answers(None, 0, 0, None, None, undecided, api.Bounds(0.0, 1.0), 0)
    (sampled,) = api.verify(source, [name], SAMPLING, only_uniform=True)
    assert sampled.answer is not None, sampled.outcome
    exact = result.exact
    storm = storms_answer(_model(source, name), name)
    return Answers(
        None if storm is None else (storm.least, storm.greatest),
        0 if storm is None else storm.states,
        0 if exact is None else exact.states,
        None if exact is None else (exact.minimum.lower, exact.maximum.upper),
        None if exact is None or exact.uniform is None else exact.uniform.lower,
        undecided,
        sampled.answer.bounds,
        sampled.answer.tally.undecided,
    )


def _model(source: api.LoadedSystem | api.Model, name: str) -> api.Model:
    if not isinstance(source, api.Model):
        return api.to_jani(source, [name])
    return replace(source, properties=tuple(p for p in source.properties if p.name == name))
