# SPDX-License-Identifier: Apache-2.0
"""A JANI model prepared for verification: the public interface of this package."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

from roaml.jani.expressions import Expression
from roaml.jani.model import Model
from roaml.jani.passive import without_passive
from roaml.jani.properties import Property
from roaml.smc.batch import Payload, TraceProblem, pack
from roaml.smc.choices import Choices, look_at_choices
from roaml.smc.compile import Compilation, Legend
from roaml.smc.end import Marks
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, ask, ask_stuck
from roaml.smc.lss import Search, candidates, search
from roaml.smc.opcodes import MESSAGES, FaultCode
from roaml.smc.pool import Pool, Pulse, Runner
from roaml.smc.program import Compiled, Program
from roaml.smc.run import Answer, Options, Tally, TraceFaultError, Watch, answer
from roaml.smc.size import check_size

DEPTH = 15_000
"""Python's recursion limit while expressions are compiled, which may be nested as deeply as JSON allows."""


class ModelChecker:
    """A model, compiled for some of its properties.

    Args:
        marks: the meaning of a trace that ends in a location; see `roaml.smc.end`.
        open_: property -> condition under which it is undecided at the end of time; see `goal.ask`.
        asks_stuck: whether `stuck` is the last question.

    Attributes:
        asked: a question for each property that can be answered.
        refused: the names of the other properties -> the reason.
        stuck: the question whether traces get stuck.

    Raises:
        FaultError: the model cannot be run.
    """

    def __init__(
        self,
        model: Model,
        properties: Iterable[Property] | None = None,
        marks: Marks = MappingProxyType({}),
        *,
        asks_stuck: bool = False,
        open_: Mapping[str, Expression] = MappingProxyType({}),
    ) -> None:
        self.model = model
        self.open_ = open_
        self._marks = marks
        chosen = model.properties if properties is None else tuple(properties)
        self._names = tuple(dict.fromkeys(property_.name for property_ in chosen))
        depth = sys.getrecursionlimit()
        sys.setrecursionlimit(max(depth, DEPTH))
        try:
            check_size(model, chosen)
            self._compilation = Compilation(model, [*(property_.expression for property_ in chosen), *open_.values()])
            self.asked: tuple[CompiledProperty, ...] = ()
            self.refused: dict[str, FaultError] = {}
            for property_ in chosen:
                try:
                    self.asked += (ask(self._compilation, property_, open_.get(property_.name)),)
                except FaultError as fault:
                    self.refused[property_.name] = fault
            self.stuck: CompiledProperty = ask_stuck(self._compilation)
            if asks_stuck:
                self.asked += (self.stuck,)
                self._names += (self.stuck.question.name,)
            self.program: Program = self._compilation.program(marks)
        except RecursionError:
            raise FaultError("an expression of this model is nested too deeply", model.origin) from None
        finally:
            sys.setrecursionlimit(depth)

    @property
    def legend(self) -> Legend:
        return self._compilation.legend

    def compiled(self, asked: CompiledProperty) -> Compiled:
        return Compiled(self.program, asked.goal)

    def reduced(self, asked: CompiledProperty) -> ModelChecker:
        """A model checker for one question, without the automata that only other questions need: the model has fewer
        states and the same probabilities. Its traces have other numbers."""
        model = without_passive(self.model, asked.property.expression, *self._open(asked).values())
        if model is self.model:
            return self
        properties = () if asked.question.is_stuck else (asked.property,)
        model = replace(model, properties=properties)
        return ModelChecker(model, properties, self._marks, asks_stuck=asked.question.is_stuck, open_=self._open(asked))

    def _open(self, asked: CompiledProperty) -> Mapping[str, Expression]:
        name = asked.property.name
        return {name: self.open_[name]} if name in self.open_ else {}

    def payload(self, asked: CompiledProperty) -> Payload:
        """The data that workers need for a question."""
        return pack(self.compiled(asked))

    def answer(
        self,
        asked: CompiledProperty,
        options: Options,
        pool: Runner,
        tally: Tally | None = None,
        watch: Watch | None = None,
        pulse: Pulse | None = None,
    ) -> Answer:
        """Answer a question by traces with uniform choices; see `roaml.smc.run.answer`.

        Raises:
            FaultError: a trace failed.
        """
        try:
            return answer(self.payload(asked), asked.question, options, pool, tally, watch, pulse)
        except TraceFaultError as error:
            raise self.fault(error.problem) from None

    def search(
        self,
        asked: CompiledProperty,
        options: Options,
        pool: Pool,
        state: Search,
        watch: Callable[[Search], None] | None = None,
        pulse: Pulse | None = None,
    ) -> None:
        """Search for schedulers with a small and a great probability; see `roaml.smc.lss.search`.

        Raises:
            FaultError: a trace failed, or the question is about rewards.
        """
        if asked.question.is_reward:
            raise FaultError("schedulers can be sampled only for probabilities", asked.property.origin)
        try:
            schedulers = candidates(len(self.automata))
            search(self.payload(asked), asked.question, options, pool, schedulers, state, watch, pulse)
        except TraceFaultError as error:
            raise self.fault(error.problem) from None

    def choices(self, asked: CompiledProperty, answer: Answer, pool: Pool, pulse: Pulse | None = None) -> Choices:
        """The knowledge about schedulers other than the uniform one, to which an answer refers.

        Raises:
            FaultError: a trace under some scheduler failed.
        """
        reduced = self.reduced(asked)
        compiled = reduced.compiled(asked if reduced is self else reduced.asked[0])
        try:
            return look_at_choices(self.model, compiled, self.payload(asked), answer, self.automata, pool, pulse)
        except TraceFaultError as error:
            raise self.fault(error.problem) from None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all selected properties, supported or not."""
        return self._names

    @property
    def automata(self) -> tuple[str, ...]:
        """The names of the elements of the system."""
        return tuple(element.automaton for element in self.model.system.elements)

    def fault(self, problem: TraceProblem) -> FaultError:
        """A description of the undefined operation in a trace."""
        code = FaultCode(problem.code)
        value: float = problem.value
        if code is FaultCode.DOMAIN or (code is FaultCode.RANGE and problem.value == 0 and problem.real != 0):
            value = problem.real
        message = MESSAGES[code].format(value=value, size=problem.size)
        return FaultError(message, self._compilation.tape.origin_of(problem.at), problem.trace)
