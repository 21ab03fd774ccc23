# SPDX-License-Identifier: Apache-2.0
"""A JANI model prepared for verification: the public interface of this package."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType

from roaml.jani.expressions import Call, Name
from roaml.jani.model import Model, ModelType
from roaml.jani.passive import without_passive
from roaml.jani.properties import Formula, Property, identifiers, walk
from roaml.json_syntax.brackets import deep_recursion
from roaml.record import replace
from roaml.smc.batch import Payload, TraceProblem
from roaml.smc.choices import Choices, check_choices
from roaml.smc.compile import Compilation, Legend
from roaml.smc.end import Marks
from roaml.smc.fault import MESSAGES, FaultCode, FaultError
from roaml.smc.goal import (
    NO_OUTPUTS,
    CompiledProperty,
    ObserverOutputs,
    compile_property,
    compile_stuck,
    conditional,
)
from roaml.smc.lss import Search, candidates, search
from roaml.smc.names import variables_in
from roaml.smc.pool import Pool, Pulse, Runner
from roaml.smc.program import Compiled, Program, merged
from roaml.smc.run import Answer, Inquiry, Options, TraceFaultError, Watch, answer, answer_together, columns_of, summary
from roaml.smc.size import check_size
from roaml.smc.sums import sum_names, with_sums
from roaml.smc.tally import Tally


class ModelChecker:
    """A model, compiled for some of its properties.

    Args:
        properties: the properties to compile; `None` for all properties of the model.
        marks: why a trace that stays in a location ends; see `roaml.smc.end`.
        outputs: name of a property -> the outputs of its observer. Properties without an observer are left out.
        assumptions: name of a property -> the property of `model` which states that the assumptions of the first
            property hold. Properties without assumptions are left out.
        actors: automaton -> a noun phrase for users; an automaton without a phrase is named in backquotes.
        includes_stuck: whether `stuck` is added to `compiled_properties`, as the last one.

    Attributes:
        compiled_properties: the properties that can be answered.
        refused: name of a property that cannot be answered -> the reason.
        stuck: the property that asks for the probability that a trace gets stuck.
        initial_states: the number of initial states.

    Raises:
        FaultError: the model cannot be run.
    """

    def __init__(
        self,
        model: Model,
        properties: Iterable[Property] | None = None,
        marks: Marks = MappingProxyType({}),
        *,
        includes_stuck: bool = False,
        outputs: Mapping[str, ObserverOutputs] = MappingProxyType({}),
        assumptions: Mapping[str, Property] = MappingProxyType({}),
        actors: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.model = model
        self.outputs = outputs
        self._marks = marks
        self._actors = actors
        chosen = model.properties if properties is None else tuple(properties)
        self._names = tuple(dict.fromkeys(property_.name for property_ in chosen))
        try:
            with deep_recursion():
                self._prepare(chosen, assumptions, includes_stuck=includes_stuck)
        except RecursionError:
            raise FaultError("an expression of this model is nested too deeply", model.origin) from None

    def _prepare(
        self, chosen: Sequence[Property], assumptions: Mapping[str, Property], *, includes_stuck: bool
    ) -> None:
        model, outputs, marks = self.model, self.outputs, self._marks
        check_size(model, chosen)
        read: list[Formula] = [expression for output in outputs.values() for expression in output.expressions]
        read += [property_.expression for property_ in (*chosen, *assumptions.values())]
        sums = [Name(name) for property_ in chosen for name in sum_names(property_).values()]
        self._compilation = Compilation(with_sums(model, chosen), [*read, *sums])
        self.compiled_properties: tuple[CompiledProperty, ...] = ()
        self.refused: dict[str, FaultError] = {}
        for property_ in chosen:
            try:
                compiled = self._compile(property_)
                assumed = assumptions.get(property_.name)
                self.compiled_properties += (
                    compiled if assumed is None else conditional(compiled, self._compile(assumed)),
                )
            except FaultError as fault:
                self.refused[property_.name] = fault
        self.stuck: CompiledProperty = compile_stuck(self._compilation)
        if includes_stuck:
            self.compiled_properties += (self.stuck,)
            self._names += (self.stuck.question.name,)
        self.program: Program = self._compilation.program(marks)
        self.initial_states = self._compilation.initial_states

    def _compile(self, property_: Property) -> CompiledProperty:
        return compile_property(self._compilation, property_, self.outputs.get(property_.name, NO_OUTPUTS))

    @property
    def is_deterministic(self) -> bool:
        """Whether nothing is nondeterministic: the type of the model excludes it, and there is one initial state."""
        return self.model.type is ModelType.DTMC and self.initial_states == 1

    @property
    def legend(self) -> Legend:
        return self._compilation.legend

    def compiled(self, property_: CompiledProperty) -> Compiled:
        """The compiled model with the goal of `property_`. Assumptions are left out."""
        return Compiled(self.program, property_.goal)

    def asking(self, property_: Property) -> ModelChecker:
        """A model checker for another property without observers of the same model.

        Raises:
            FaultError: the property cannot be answered.
        """
        other = ModelChecker(self.model, [property_], self._marks, actors=self._actors)
        if other.refused:
            raise other.refused[property_.name]
        return other

    def reduced(self, property_: CompiledProperty) -> ModelChecker:
        """A model checker for one property, without the automata that only other properties need; `self` if there are
        none. The reduced model has fewer states and the same probabilities, but different traces for the same
        numbers."""
        model = without_passive(self.model, *self._read(property_))
        if model is self.model:
            return self
        properties = () if property_.question.is_stuck else (property_.property,)
        model = replace(model, properties=properties)
        return ModelChecker(
            model,
            properties,
            self._marks,
            includes_stuck=property_.question.is_stuck,
            outputs=self._outputs(property_),
            actors=self._actors,
        )

    def _read(self, property_: CompiledProperty) -> tuple[Formula, ...]:
        """All formulas on which the probability of a property depends."""
        outputs = self.outputs.get(property_.property.name, NO_OUTPUTS)
        return (property_.property.expression, *(expression for _, expression in outputs.open))

    def observed(self, property_: CompiledProperty) -> frozenset[str]:
        """The names of the variables of the model on which the probability or reward of a property depends directly."""
        names: set[str] = set()
        for formula in self._read(property_):
            names.update(name for name, _ in identifiers(formula))
            for part in walk(formula):
                if isinstance(part, Call):
                    names |= variables_in(part, self.legend.layout.names.functions)
        return frozenset(names)

    def _outputs(self, property_: CompiledProperty) -> Mapping[str, ObserverOutputs]:
        name = property_.property.name
        return {name: ObserverOutputs(open=self.outputs[name].open)} if name in self.outputs else {}

    def payload(self, *properties: CompiledProperty) -> Payload:
        """The data that workers need to answer questions."""
        goals = [goal for question in properties for goal in (question.goal, question.assumptions) if goal is not None]
        return Payload(Compiled(self.program, merged(goals)))

    def answer(
        self,
        property_: CompiledProperty,
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
            return answer(self.payload(property_), property_.question, options, pool, tally, watch, pulse)
        except TraceFaultError as error:
            raise self.fault(error.problem) from None

    def answer_together(
        self,
        properties: Sequence[CompiledProperty],
        options: Options,
        pool: Runner,
        tallies: Sequence[Tally],
        watch: Callable[[CompiledProperty, Tally], None],
        pulse: Pulse | None = None,
    ) -> list[Answer | FaultError]:
        """Answer several questions with the same traces. Each answer is exactly the one that separate traces would
        give; see `roaml.smc.run.answer_together`.

        Args:
            tallies: the states to continue from, in the order of `properties`; they are updated after each batch.
            watch: called for each property after each batch of its traces.

        Returns:
            For each property its answer, or the error of a trace that failed.
        """
        questions = [property_.question for property_ in properties]
        inquiries = [Inquiry(*parts) for parts in zip(questions, tallies, columns_of(questions), strict=True)]
        names = {property_.question.name: property_ for property_ in properties}
        answer_together(
            self.payload(*properties),
            inquiries,
            options,
            pool,
            lambda i: watch(names[i.question.name], i.tally),
            pulse,
        )
        return [
            summary(inquiry.question, options, inquiry.tally)
            if inquiry.problem is None
            else self.fault(inquiry.problem)
            for inquiry in inquiries
        ]

    def search(
        self,
        property_: CompiledProperty,
        options: Options,
        pool: Pool,
        state: Search,
        watch: Callable[[Search], None] | None = None,
        pulse: Pulse | None = None,
    ) -> None:
        """Search for schedulers that minimise and maximise the probability; see `roaml.smc.lss.search`.

        Raises:
            FaultError: a trace failed, or the property is about rewards or has assumptions.
        """
        if property_.question.is_reward:
            raise FaultError(
                "schedulers can be sampled only for probabilities, not for rewards; use uniform choices",
                property_.property.origin,
            )
        if property_.question.is_conditional:
            message = "schedulers cannot be sampled for a probability given assumptions; use uniform choices"
            raise FaultError(message, property_.property.origin)
        if property_.question.asks_for_extreme_state:
            message = (
                "schedulers cannot be sampled for the minimum or maximum over several initial states; explore "
                "all states, or use the filter `avg`"
            )
            raise FaultError(message, property_.property.origin)
        try:
            schedulers = candidates(len(self.automata))
            search(
                self.payload(property_),
                property_.question,
                options,
                pool,
                schedulers,
                state,
                watch,
                pulse,
            )
        except TraceFaultError as error:
            raise self.fault(error.problem) from None

    def choices(self, property_: CompiledProperty, answer: Answer, pool: Pool, pulse: Pulse | None = None) -> Choices:
        """What is known about schedulers other than the uniform one, in relation to an answer.

        Raises:
            FaultError: a trace under some scheduler failed.
        """
        try:
            return check_choices(self.model, self.program, self.payload(property_), answer, self.actors, pool, pulse)
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

    @property
    def actors(self) -> tuple[str, ...]:
        """A noun phrase for each element of the system."""
        return tuple(self._actors.get(name, f"`{name}`") for name in self.automata)

    def fault(self, problem: TraceProblem) -> FaultError:
        """The error that describes the undefined operation in a trace."""
        code = FaultCode(problem.code)
        value: float = problem.value
        if code is FaultCode.DOMAIN or (code is FaultCode.RANGE and problem.value == 0 and problem.real != 0):
            value = problem.real
        message = MESSAGES[code].format(value=value, size=problem.size)
        return FaultError(message, self._compilation.tape.origin_of(problem.at), problem.trace)
