# SPDX-License-Identifier: Apache-2.0
"""A JANI model prepared for verification: the public interface of this package."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from roaml.jani.model import Model, ModelType
from roaml.jani.passive import without_passive
from roaml.jani.properties import Formula, Property
from roaml.smc.batch import Payload, TraceProblem, pack
from roaml.smc.choices import Choices, look_at_choices
from roaml.smc.compile import Compilation, Legend
from roaml.smc.end import Marks
from roaml.smc.fault import FaultError
from roaml.smc.goal import NO_OUTPUTS, CompiledProperty, ObserverOutputs, ask, ask_stuck, given
from roaml.smc.lss import Search, candidates, search
from roaml.smc.opcodes import MESSAGES, FaultCode
from roaml.smc.pool import Pool, Pulse, Runner
from roaml.smc.program import Compiled, Program, merged
from roaml.smc.run import (
    Answer,
    Inquiry,
    Options,
    Tally,
    TraceFaultError,
    Watch,
    answer,
    answer_together,
    columns_of,
    summary,
)
from roaml.smc.size import check_size

RECURSION_LIMIT = 15_000
"""Python's recursion limit during compilation, because expressions may be nested as deeply as JSON allows."""


class ModelChecker:
    """A model, compiled for some of its properties.

    Args:
        marks: why a trace that stays in a location ends; see `roaml.smc.end`.
        outputs: property -> the outputs of its observer, if it has one.
        assumptions: property -> the property that its assumptions hold, if it has any; both are in `model`.
        asks_stuck: whether `stuck` is the last question.

    Attributes:
        asked: a question for each property that can be answered.
        refused: the names of the other properties -> the reason.
        stuck: the question about traces that get stuck.

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
        outputs: Mapping[str, ObserverOutputs] = MappingProxyType({}),
        assumptions: Mapping[str, Property] = MappingProxyType({}),
    ) -> None:
        self.model = model
        self.outputs = outputs
        self._marks = marks
        chosen = model.properties if properties is None else tuple(properties)
        self._names = tuple(dict.fromkeys(property_.name for property_ in chosen))
        depth = sys.getrecursionlimit()
        sys.setrecursionlimit(max(depth, RECURSION_LIMIT))
        try:
            check_size(model, chosen)
            read: list[Formula] = [expression for output in outputs.values() for expression in output.expressions]
            read += [property_.expression for property_ in (*chosen, *assumptions.values())]
            self._compilation = Compilation(model, read)
            self.asked: tuple[CompiledProperty, ...] = ()
            self.refused: dict[str, FaultError] = {}
            for property_ in chosen:
                try:
                    asked = self._ask(property_)
                    assumed = assumptions.get(property_.name)
                    self.asked += (asked if assumed is None else given(asked, self._ask(assumed)),)
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

    def _ask(self, property_: Property) -> CompiledProperty:
        return ask(self._compilation, property_, self.outputs.get(property_.name, NO_OUTPUTS))

    @property
    def is_deterministic(self) -> bool:
        """Whether the type of the model excludes nondeterminism."""
        return self.model.type is ModelType.DTMC

    @property
    def legend(self) -> Legend:
        return self._compilation.legend

    def compiled(self, asked: CompiledProperty) -> Compiled:
        """The compiled model with the goal of `asked`. Assumptions are left out."""
        return Compiled(self.program, asked.goal)

    def reduced(self, asked: CompiledProperty) -> ModelChecker:
        """A model checker for one question, without the automata that only other questions need. The model has fewer
        states and the same probabilities, but its traces have other numbers."""
        model = without_passive(self.model, *self._read(asked))
        if model is self.model:
            return self
        properties = () if asked.question.is_stuck else (asked.property,)
        model = replace(model, properties=properties)
        return ModelChecker(
            model, properties, self._marks, asks_stuck=asked.question.is_stuck, outputs=self._outputs(asked)
        )

    def _read(self, asked: CompiledProperty) -> tuple[Formula, ...]:
        """All formulas on which the probability of a question depends."""
        outputs = self.outputs.get(asked.property.name, NO_OUTPUTS)
        return (asked.property.expression, *(expression for _, expression in outputs.open))

    def _outputs(self, asked: CompiledProperty) -> Mapping[str, ObserverOutputs]:
        name = asked.property.name
        return {name: ObserverOutputs(open=self.outputs[name].open)} if name in self.outputs else {}

    def payload(self, *asked: CompiledProperty) -> Payload:
        """The data that workers need to answer questions."""
        goals = [goal for question in asked for goal in (question.goal, question.assumptions) if goal is not None]
        return pack(Compiled(self.program, merged(goals)))

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

    def answer_together(
        self,
        asked: Sequence[CompiledProperty],
        options: Options,
        pool: Runner,
        tallies: Sequence[Tally],
        watch: Callable[[CompiledProperty, Tally], None],
        pulse: Pulse | None = None,
    ) -> list[Answer | FaultError]:
        """Answer several questions with the same traces. Each answer is exactly the one that separate traces would
        give; see `roaml.smc.run.answer_together`.

        Args:
            tallies: the states to continue from; they are updated after each batch.
            watch: called for each question after each of its batches.
        """
        questions = [property_.question for property_ in asked]
        inquiries = [Inquiry(*parts) for parts in zip(questions, tallies, columns_of(questions), strict=True)]
        names = {property_.question.name: property_ for property_ in asked}
        answer_together(
            self.payload(*asked), inquiries, options, pool, lambda i: watch(names[i.question.name], i.tally), pulse
        )
        return [
            summary(inquiry.question, options, inquiry.tally)
            if inquiry.problem is None
            else self.fault(inquiry.problem)
            for inquiry in inquiries
        ]

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
        if asked.question.is_conditional:
            message = "schedulers cannot be sampled for a probability given assumptions; use --scheduler uniform"
            raise FaultError(message, asked.property.origin)
        try:
            schedulers = candidates(len(self.automata))
            search(self.payload(asked), asked.question, options, pool, schedulers, state, watch, pulse)
        except TraceFaultError as error:
            raise self.fault(error.problem) from None

    def choices(self, asked: CompiledProperty, answer: Answer, pool: Pool, pulse: Pulse | None = None) -> Choices:
        """What is known about schedulers other than the uniform one, in relation to an answer.

        Raises:
            FaultError: a trace under some scheduler failed.
        """
        try:
            return look_at_choices(self.model, self.program, self.payload(asked), answer, self.automata, pool, pulse)
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
