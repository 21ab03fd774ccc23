# SPDX-License-Identifier: Apache-2.0
"""The verdicts of a run on several properties, in addition to the property that its session evaluates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from roaml.simulation.intervention import Intervention
from roaml.simulation.run import ByHand
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FAULTY, UNKNOWN
from roaml.smc.record import VERDICTS, TraceVerdict


class Decided(NamedTuple):
    """A property is decided in the state after `position` steps; `verdict` is `PASSED` or `FAILED`.

    Attributes:
        variables: the variables that the property reads.
    """

    name: str
    position: int
    verdict: TraceVerdict
    variables: tuple[str, ...] = ()


class Verdicts:
    """Follows a run, and stores the position at which each property is decided."""

    def __init__(self, checker: ModelChecker, seed: int, trace: int) -> None:
        self._followers = [
            _PropertyFollower(checker, property_, seed, trace) for property_ in checker.compiled_properties
        ]

    def follow(self, decisions: Sequence[ByHand | None], position: int, has_ended: bool) -> list[Decided]:
        """Follow the run up to a position; return the properties that are decided exactly there.

        Args:
            decisions: the decisions of the steps of the run.
            has_ended: whether no further step changes the state at the position.
        """
        for follower in self._followers:
            follower.follow(decisions, position, has_ended)
        return self.at(position)

    @property
    def decided(self) -> list[Decided]:
        """The properties that are decided in the part of the run that has been followed, in the order of their
        positions."""
        decided = (follower.decided for follower in self._followers)
        return sorted((one for one in decided if one is not None), key=lambda one: one.position)

    def at(self, position: int) -> list[Decided]:
        """The properties that are decided exactly at a position. The run must have been followed up to it."""
        return [property_ for property_ in self.decided if property_.position == position]

    def discard(self, position: int) -> None:
        """Discard the run after `position`, because other steps follow."""
        for follower in self._followers:
            follower.discard(position)

    def verdicts(self, position: int) -> dict[str, TraceVerdict]:
        """The verdict of each property at a position. The run must have been followed up to it."""
        return {follower.name: follower.verdict(position) for follower in self._followers}


class _PropertyFollower:
    def __init__(self, checker: ModelChecker, property_: CompiledProperty, seed: int, trace: int) -> None:
        compiled = checker.compiled(property_)
        self.name = property_.question.name
        self._property = property_
        self.decided: Decided | None = None
        self._kernel = Kernel(compiled.program, compiled.goal)
        self._seed, self._trace = seed, trace
        self._begin()

    def _begin(self) -> None:
        self._position = 0
        self.decided = None
        self._note(self._kernel.begin(self._seed, self._trace))

    def discard(self, position: int) -> None:
        if self._position > position and not (self.decided and self.decided.position <= position):
            self._begin()

    def follow(self, decisions: Sequence[ByHand | None], position: int, has_ended: bool) -> None:
        while self.decided is None and self._position < position:
            decision = decisions[self._position]
            if isinstance(decision, Intervention):
                return  # later steps say nothing about the model
            if decision is None:
                until = self._position + 1
                while until < position and decisions[until] is None:
                    until += 1
                status = self._kernel.advance(until)
                self._position = self._kernel.outcome()[0] if status != UNKNOWN else until
            else:
                self._kernel.go(decision.vector, list(decision.picks), list(decision.ways))
                status = self._kernel.look()
                self._position += 1
            self._note(status)
        if has_ended and self.decided is None and self._position == position and self._kernel.ended():
            self._note(self._kernel.close())

    def _note(self, status: int) -> None:
        if status not in (UNKNOWN, FAULTY):
            self.decided = Decided(self.name, self._position, VERDICTS[status], self._property.question.variables)

    def verdict(self, position: int) -> TraceVerdict:
        is_known = self.decided is not None and self.decided.position <= position
        return self.decided.verdict if self.decided is not None and is_known else TraceVerdict.UNDECIDED
