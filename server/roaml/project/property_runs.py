# SPDX-License-Identifier: Apache-2.0
"""Simulated runs that judge properties of systems with too many states to explore all of them.

A few runs come first: they refute most doubts. What happens in no run may be rare. So the runs are repeated in a copy
of the model in which all random outcomes are equally probable.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from roaml.interruption import checkpoint
from roaml.jani.equal_probabilities import is_random, with_equal_probabilities
from roaml.jani.model import Model
from roaml.jani.properties import Property
from roaml.record import Record
from roaml.scxml.names import sent_by
from roaml.scxml.observed import ObservedPort, PortEvent
from roaml.smc.batch import Simulator, Task, run_on
from roaml.smc.fault import FaultError
from roaml.smc.goal import Activity, CompiledProperty, ObserverOutputs
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.program import FALSE, TRUE
from roaml.smc.record import Recorder, Recording
from roaml.views.ends import marks

BATCHES = (3, 22, 75)
"""The numbers of runs after which the properties that are no longer in doubt are left out."""
RUNS = sum(BATCHES)
MAX_STEPS_OF_RUN, MAX_STEPS = 150_000, 2_000_000
"""The maximum numbers of steps of one run, and of all runs of one model. These take 0.2 s."""
RUNS_OF_MESSAGES = 25
"""The number of runs in which messages are counted."""
MIN_MESSAGES = 50
"""The number of messages from which on it is notable that none of them has a value."""


class RunOutcome(Record, frozen=True):
    """What a number of runs says about a property.

    Attributes:
        passed, failed: the numbers of runs that satisfy it and of those that violate it; the others are undecided.
        tested: the number of runs that satisfy it although they exercise it completely.
        activity: how far the most advanced run has exercised it.
    """

    runs: int
    passed: int
    failed: int
    tested: int
    activity: Activity

    @property
    def undecided(self) -> int:
        return self.runs - self.passed - self.failed


NO_OUTCOME = RunOutcome(0, 0, 0, 0, Activity.CLOSED)


def outcomes(
    model: Model,
    properties: Mapping[str, Property],
    outputs: Mapping[str, ObserverOutputs],
    is_doubted: Callable[[CompiledProperty, RunOutcome], bool],
) -> Mapping[str, tuple[CompiledProperty, RunOutcome]]:
    """The properties that remain in doubt after all runs, with their outcomes, by name. There are none if the runs are
    too long, or if one of them executes an undefined operation."""
    try:
        checker = ModelChecker(model, properties.values(), marks(model), outputs=outputs)
    except FaultError:
        return {}
    compiled = checker.compiled_properties
    known = dict.fromkeys(range(len(compiled)), NO_OUTCOME)
    payload = checker.payload(*compiled)
    simulator = Simulator(payload.compiled)
    first, steps = 0, 0
    for size in BATCHES if compiled else ():
        if first and steps / first * size > MAX_STEPS:
            return {}
        checkpoint()
        batch = run_on(simulator, Task(payload, 0, first, size, MAX_STEPS_OF_RUN, questions=tuple(known)))
        if batch.problem is not None:
            return {}
        first += size
        steps += sum(max(each) for each in zip(*(rows.steps for rows in batch.questions), strict=True))
        for (number, before), rows in zip(list(known.items()), batch.questions, strict=True):
            passed, failed = before.passed + rows.verdicts.count(TRUE), before.failed + rows.verdicts.count(FALSE)
            activity = max(before.activity, *map(Activity, rows.activities))
            complete = zip(rows.verdicts, rows.activities, strict=True)
            tested = before.tested + sum(v == TRUE and a == Activity.TRIGGERED for v, a in complete)
            outcome = RunOutcome(first, passed, failed, tested, activity)
            if is_doubted(compiled[number], outcome):
                known[number] = outcome
            else:
                del known[number]
        if not known:
            return {}
    return {compiled[number].property.name: (compiled[number], outcome) for number, outcome in known.items()}


def varied(model: Model) -> Iterator[Model]:
    """The model, and if it is random, its copy with equal probabilities."""
    yield model
    if is_random(model):
        yield with_equal_probabilities(model)


class PropertyRuns:
    """Answers about simulated runs of models of one system.

    Args:
        owners: automaton of an action thread -> the automaton of its machine.
    """

    simulated = RUNS

    def __init__(self, owners: Mapping[str, str]) -> None:
        self._owners = owners

    def never(
        self, checker: ModelChecker, ports: Sequence[ObservedPort], *, is_notable: bool
    ) -> Mapping[str, set[float]] | None:
        """See `roaml.project.property_causes.Evidence`."""
        asked = checker.compiled_properties[0].property
        for variant in varied(checker.model):
            if not outcomes(variant, {asked.name: asked}, {}, lambda _, outcome: outcome.failed == outcome.runs):
                return None
        heard = Heard(ports, self._owners)
        for run in range(RUNS_OF_MESSAGES):
            heard.listen(checker, run)
            checkpoint()
        is_frequent = min(heard.messages, default=0) >= MIN_MESSAGES
        return heard.values if is_frequent or not is_notable else None

    def always(self, checker: ModelChecker) -> bool:
        """See `roaml.project.property_causes.Evidence`."""
        asked = checker.compiled_properties[0].property
        return bool(
            outcomes(
                checker.model, {asked.name: asked}, checker.outputs, lambda _, outcome: outcome.passed == outcome.runs
            )
        )


class Heard:
    """The messages that arrive at ports in simulated runs.

    Attributes:
        messages: for each port, the number of messages.
        values: variable of a port -> the numbers and truth values that it has after a message.
    """

    def __init__(self, ports: Sequence[ObservedPort], owners: Mapping[str, str]) -> None:
        self._owners = owners
        self._listeners: dict[str, list[tuple[int, PortEvent, ObservedPort]]] = {}
        for number, port in enumerate(ports):
            for event in port.events:
                self._listeners.setdefault(event.name, []).append((number, event, port))
        self.messages = [0] * len(ports)
        self.values: dict[str, set[float]] = {}

    def listen(self, checker: ModelChecker, run: int) -> None:
        """Add the messages of a run."""
        recorder = Recorder(checker, checker.compiled_properties[0], 0, MAX_STEPS_OF_RUN)
        storages = {storage.name: storage for storage in recorder.shared if not storage.shape}
        names = [automaton.name for automaton in recorder.automata]
        for vector, taken in recorder.taken(Recording(run)):
            _, action = recorder.legend.vectors[vector]
            listeners = self._listeners.get(sent_by(action or ""))
            if listeners is None:
                continue
            senders = {self._owners.get(names[instance], names[instance]) for instance, _ in taken}
            for number, event, port in listeners:
                if not event.sender or event.sender in senders:
                    self.messages[number] += 1
                    self._add(recorder, storages, event, port)

    def _add(self, recorder: Recorder, storages: Mapping[str, Storage], event: PortEvent, port: ObservedPort) -> None:
        for variable in port.variables:
            storage = storages.get(f"{event.name}__{variable.parameter}")
            if variable.initial is not None and storage is not None:
                [value] = recorder.values([storage])
                if isinstance(value, int | float):
                    self.values.setdefault(variable.id, set()).add(value)
