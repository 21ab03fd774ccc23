# SPDX-License-Identifier: Apache-2.0
"""A position in a run of a system that can be moved forwards and backwards."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from roaml.jani.model import Automaton
from roaml.record import Record, replace
from roaml.scxml.names import TREE_ROOT_PREFIX, is_observer, received_by, sent_by
from roaml.simulation.choices import Choice, Outcome, choices, is_of_translation
from roaml.simulation.follow import Follower
from roaml.simulation.intervention import Intervention, WrongNumberError, whole_number
from roaml.simulation.run import SNAPSHOT_INTERVAL, ByHand, Decision, Run
from roaml.simulation.state import SystemState
from roaml.simulation.words import resting
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN
from roaml.smc.record import VERDICTS, AutomatonStep, Plain, RecordedVariable, Recording, TraceStep, TraceVerdict
from roaml.smc.rounds import FIRST_CHECK, limits
from roaml.smc.story import Story, clock_times, last_steps
from roaml.views.arrays import DeclaredValue
from roaml.views.variables import variable_phrases

FORMAT_VERSION = 1
ENGINE_VERSION = 1
"""The version of the random number generator: with another version, a saved session takes different steps."""


class SavedSession(Record, frozen=True):
    """Everything that determines a run, except for the model, and a position in the run.

    Attributes:
        property: the name of the property that is evaluated on the run.
        decisions: the decisions of all steps; `None` where the seed decides.
        position: the position in the run, as a number of steps.
    """

    property: str
    seed: int
    trace: int
    position: int
    decisions: tuple[ByHand | None, ...] = ()

    def to_json(self) -> str:
        """The session as JSON text. Consecutive steps that the seed decides are written as their number."""
        rows: list[Any] = []
        for decision in self.decisions:
            if isinstance(decision, Intervention):
                rows.append(decision.to_json())
            elif decision is not None:
                rows.append({"vector": decision.vector, "picks": decision.picks, "ways": decision.ways})
            elif rows and isinstance(rows[-1], int):
                rows[-1] += 1
            else:
                rows.append(1)
        value = {
            "format": FORMAT_VERSION,
            "engine": ENGINE_VERSION,
            "property": self.property,
            "seed": self.seed,
            "trace": self.trace,
            "position": self.position,
            "decisions": rows,
        }
        return json.dumps(value, indent=2) + "\n"

    @staticmethod
    def from_json(text: str) -> SavedSession:
        """The session in a text that `to_json` returned.

        Raises:
            ValueError: the text is not a saved session, or it has another version.
        """
        try:
            value = json.loads(text)
            if value["format"] != FORMAT_VERSION or value["engine"] != ENGINE_VERSION:
                raise ValueError(
                    f"this session was saved in format {value['format']} by engine {value['engine']}, and this program "
                    f"repeats sessions of format {FORMAT_VERSION} and engine {ENGINE_VERSION}; use the version of the "
                    "program that saved it, or save a new session"
                )
            decisions: list[ByHand | None] = []
            for row in value["decisions"]:
                if isinstance(row, (int, float)):
                    count = whole_number(row, MAX_STEPS - len(decisions))
                    decisions += [None] * count
                elif "event" in row:
                    decisions.append(Intervention.from_json(row))
                else:
                    picks, ways = (tuple(map(whole_number, row[name])) for name in ("picks", "ways"))
                    decisions.append(Decision(whole_number(row["vector"]), picks, ways))
            if not isinstance(value["property"], str):
                raise TypeError("the name of the property is not a string")
            return SavedSession(
                value["property"],
                whole_number(value["seed"], MAX_SEED),
                whole_number(value["trace"], MAX_SEED),
                whole_number(value["position"], len(decisions)),
                tuple(decisions),
            )
        except (KeyError, TypeError, AttributeError, RecursionError, json.JSONDecodeError) as error:
            raise ValueError(f"this is not a saved session: {error}") from None
        except WrongNumberError as error:
            raise ValueError(f"this saved session is damaged: {error}") from None


RECENT_INTERVAL = 16
"""The number of steps between two snapshots that are kept for going back step by step."""
MAX_SEED = (1 << 63) - 1
"""The maximum of a seed and of the number of a trace."""
MAX_STEPS = 10_000_000
"""The maximum number of steps of a run."""


def default_property(checker: ModelChecker, seed: int, trace: int) -> CompiledProperty:
    """The property that a run evaluates if the user names none: the first one that its initial state does not decide,
    because another one would end the run before its first step; the first one if there is none; `stuck` if the model
    has no properties."""
    properties = checker.compiled_properties or (checker.stuck,)
    return next(
        (property_ for property_ in properties if Run(checker, property_, seed, trace).status == UNKNOWN), properties[0]
    )


class Session:
    """A position in a run.

    Args:
        property_: the property that is evaluated on the run, one of those of `checker`.
        clock: the names of the variables that contain the time of the model in s and the rest in ns.
        saved: the session to continue; it overrides `seed` and `trace`.

    Attributes:
        is_interrupted: a function that a caller may set; movements of several steps end when it returns true.

    Raises:
        RunError: the saved decisions are not possible in this model.
        FaultError: the model executes an undefined operation in one of the saved steps.
    """

    def __init__(
        self,
        checker: ModelChecker,
        property_: CompiledProperty,
        seed: int = 0,
        trace: int = 0,
        clock: tuple[str, str] | None = None,
        saved: SavedSession | None = None,
    ) -> None:
        if saved is not None:
            seed, trace = saved.seed, saved.trace
        self._run = Run(checker, property_, seed, trace, saved.decisions if saved is not None else ())
        self._clock = clock
        self.is_interrupted: Callable[[], bool] = lambda: False
        self._phrases: dict[str, Mapping[str, str]] = {}
        self._automata = tuple(instance.automaton for instance in self._run.legend.layout.instances)
        self._resting = [resting(automaton) for automaton in self._automata]
        self._follower = Follower(self._automata, self._run.start, clock)
        self._followers: dict[int, Follower] = {0: self._follower.copied()}
        self._recent: dict[int, Follower] = {}
        self.jump(len(self._run.steps) if saved is None else saved.position)

    # ------------------------------------------------------------ the position

    @property
    def position(self) -> int:
        """The number of steps before the current state."""
        return self._run.position

    @property
    def steps(self) -> Sequence[TraceStep]:
        """All steps taken, including those after the position."""
        return self._run.steps

    @property
    def end(self) -> End | None:
        """The reason why no further step changes the state; `None` if a step changes it."""
        return self._run.end

    @property
    def verdict(self) -> TraceVerdict:
        """The verdict on the property at the position."""
        return VERDICTS[self._run.status]

    @property
    def time(self) -> float | None:
        """The time of the clock in s; `None` if the model has no clock."""
        return self._follower.time

    @property
    def is_decided(self) -> bool:
        """Whether the property is decided at the position or before, so that the trace of `verify` has ended."""
        return self._run.status != UNKNOWN

    @property
    def is_by_hand(self) -> bool:
        """Whether the user has decided a step up to the position, so that the run is not a trace of `verify`."""
        return self._run.is_by_hand

    @property
    def is_changed(self) -> bool:
        """Whether the user has changed the state up to the position, so that the run does not show the behaviour of the
        model."""
        return self._run.is_changed

    @property
    def seed(self) -> int:
        return self._run.seed

    @property
    def trace(self) -> int:
        return self._run.trace

    @property
    def compiled_property(self) -> CompiledProperty:
        """The property that is evaluated on the run."""
        return self._run.compiled_property

    @property
    def clock(self) -> tuple[str, ...]:
        """The variables with the time of the model; empty if it has no clock."""
        return self._clock or ()

    @property
    def decisions(self) -> Sequence[ByHand | None]:
        """The decision of each of `steps`; `None` where the seed decides."""
        return self._run.decisions

    @property
    def start(self) -> Mapping[str, Plain]:
        """The variables of the model before the first step."""
        return self._run.start

    @property
    def first_locations(self) -> tuple[str, ...]:
        """The location of each instance before the first step."""
        return self._run.first_locations

    def locations(self) -> tuple[str, ...]:
        """The name of the current location of each instance."""
        return self._run.locations()

    def parameters(self, event: str) -> dict[str, DeclaredValue]:
        """The parameters with which an event was last sent."""
        return self._follower.events.parameters(event)

    def event_variables(self, event: str) -> Sequence[str]:
        """The variables of the model that contain the parameters of an event and their lengths."""
        return self._follower.events.variables(event)

    @property
    def names(self) -> Mapping[str, str]:
        """The name of each automaton -> its name in texts for users."""
        return self._follower.names

    def phrases(self, automaton: str) -> Mapping[str, str]:
        """Phrases for those variables of an automaton whose names are not those of the user, by their names: members of
        structs, and variables that the translation has added."""
        if automaton not in self._phrases:
            known = next((known for known in self._automata if known.name == automaton), None)
            is_event = self._follower.events.is_event
            self._phrases[automaton] = {} if known is None else variable_phrases(known, is_event)
        return self._phrases[automaton]

    def actors(self, step: TraceStep) -> list[AutomatonStep]:
        """The parts of a step, except those of automata that only buffer an event."""
        return self._follower.events.actors(step)

    @property
    def actions(self) -> list[str | None]:
        """The action of each synchronisation vector of the model; `None` for a vector without an action."""
        return [action for _, action in self._run.legend.vectors]

    @property
    def automata_of_model(self) -> Sequence[Automaton]:
        """The automaton of each instance."""
        return self._automata

    def state_of(self, instance: int, location: str) -> str:
        """The state of a machine to which a location of an instance belongs: while the instance executes a handler, the
        state in which it has received the event."""
        return self._follower.state_of(instance, location)

    def is_state(self, instance: int, location: str) -> bool:
        """Whether a location of an instance is a state of its machine, not a place between two statements."""
        return self._follower.state_of(instance, location) == location

    def is_resting(self, instance: int, location: str) -> bool:
        """Whether an instance waits for an event in a location, or never leaves it."""
        return location in self._resting[instance]

    def values(self) -> list[tuple[RecordedVariable, Plain]]:
        """The values of all variables of the network, lengths of arrays included."""
        return self._run.values()

    def choices(self) -> tuple[Choice, ...]:
        """The possible next steps, at most `MAX_CHOICES`."""
        return tuple(choices(self._run, self._follower.events, self.phrases, self.names, self.clock, self.is_machine))

    def state(self) -> SystemState:
        """The state of the system."""
        return self._follower.state(self.position, self._run.locations(), self._run.values(), self._resting)

    def save(self) -> SavedSession:
        """The run and the position in it."""
        run = self._run
        return SavedSession(
            run.compiled_property.question.name, run.seed, run.trace, self.position, tuple(run.decisions)
        )

    def fork(self) -> Session:
        """An independent session with the same run up to the position."""
        run, saved = self._run, self.save()
        saved = replace(saved, decisions=saved.decisions[: self.position])
        return Session(run.checker, run.compiled_property, clock=self._clock, saved=saved)

    def ends(self) -> tuple[int, ...]:
        """The indices of the steps that ended the run up to the position: those that finished the trees, or the last
        one. After the former, the clock may advance the time once more."""
        finished = self._run.causes_of(End.FINISHED) if self.end is End.FINISHED else []
        steps = self._run.steps[: self.position]
        return tuple(last_steps(steps, finished)) or (len(steps) - 1,)

    def story(self) -> Story:
        """An explanation of the run up to the position, with all turns."""
        steps = tuple(self._run.steps[: self.position])
        question = self._run.compiled_property.question
        end = End.DECIDED if self.is_decided else self.end or End.CUT
        standstill = self._run.standstill() if end is End.STUCK else None
        return Story(
            question.name,
            Recording(self._run.trace, self._run.status, end),
            steps,
            tuple(clock_times(steps, self._clock)),
            tuple(range(len(steps))),
            self.ends(),
            question.variables,
            self._automata,
            self._run.start,
            standstill,
            is_whole=True,
        )

    # ------------------------------------------------------------ moving

    def step(self, choice: Choice | None = None, outcome: Outcome | None = None) -> TraceStep | None:
        """Take one step of the network of automata.

        Args:
            choice: the step to take; `None` repeats the step taken here before or, if there is none, lets the seed
                decide.
            outcome: the outcome of the choice; `None` if a hash of the seed, the trace and the position decides.

        Returns:
            The step; `None` if no step changes anything.
        """
        if choice is not None:
            return self._advance((outcome or self._drawn(choice)).decision)
        return self._advance(self._run.decisions[self.position] if self.position < len(self._run.steps) else None)

    def intervene(self, change: Intervention) -> None:
        """Change the state as the user requests, as a step of the run. From then on, no property is decided.

        Raises:
            RunError: the model has no such event or variable, or the previous event of this name has not been received.
            FaultError: a guard has no value in the new state.
        """
        self._advance(change)

    def is_free(self, event: str) -> bool:
        """Whether the user can send an event: the previous event with its name has been received."""
        return self._run.is_free(event)

    def _advance(self, decision: ByHand | None) -> TraceStep | None:
        position = self.position
        before = self._run.steps[position] if position < len(self._run.steps) else None
        step = self._run.advance(decision)
        if before is not None and step is not before:
            self._followers = {at: follower for at, follower in self._followers.items() if at <= position}
            self._recent = {}
        if step is not None:
            self._read(step)
        return step

    def upcoming(self) -> TraceStep | None:
        """The step that is taken next unless the user chooses another one. The position does not change.

        Returns:
            The step; `None` if no step changes anything.

        Raises:
            FaultError: the model executes an undefined operation in this step.
        """
        position = self.position
        if position < len(self._run.steps):
            return self._run.steps[position]
        step = self._run.advance()
        self._run.go_to(position)
        return step

    def _read(self, step: TraceStep) -> None:
        self._follower.read(step)
        if step.number % SNAPSHOT_INTERVAL == 0 and step.number not in self._followers:
            self._followers[step.number] = self._follower.copied()

    def _drawn(self, choice: Choice) -> Outcome:
        chance = random.Random(f"{self._run.seed}:{self._run.trace}:{self.position}")
        weights = [outcome.probability for outcome in choice.outcomes]
        return chance.choices(choice.outcomes, weights)[0]

    def go_on(self, is_reached: Callable[[TraceStep], bool], limit: int = MAX_STEPS) -> bool:
        """Take steps up to the first one for which `is_reached` is true.

        Returns:
            Whether such a step was taken. False if no further step changes the state, after `limit` other steps, or
            after an interruption.
        """
        for _ in range(limit):
            step = None if self.is_interrupted() else self.step()
            if step is None:
                return False
            if is_reached(step):
                return True
        return False

    def has_event(self, name: str) -> bool:
        """Whether the system has an event with this name, or of a topic, service or action with this name."""
        return bool(self.events_named(name))

    def events_named(self, name: str) -> frozenset[str]:
        """The events with this name, or of a topic, service or action with this name."""
        events = {sent_by(action or "") for _, action in self._run.legend.vectors} - {""}
        return frozenset(event for event in events if self._follower.is_named(event, name))

    def is_machine(self, instance: int) -> bool:
        """Whether an instance is a state machine or a plugin, not an automaton added by the translation or an
        observer."""
        return self._follower.is_machine(instance)

    def is_of_translation(self, step: TraceStep) -> bool:
        """Whether only automata that the translation has added do something in a step."""
        actors = [part for part in self.actors(step) if not is_observer(part.automaton)]
        has_machine = any(self.is_machine(part.instance) for part in actors)
        return is_of_translation(step.action or "", [part.automaton for part in actors], has_machine=has_machine)

    @property
    def automata(self) -> Sequence[str]:
        """The name of the automaton of each instance."""
        return [automaton.name for automaton in self._automata]

    def turn(self) -> bool:
        """Take steps until a state machine has handled an event completely; return whether one has.

        Automata added by the translation, and nodes of the tree that only tick other nodes, have no turns.
        """
        return self.go_on(self.ends_turn)

    def ends_turn(self, step: TraceStep) -> bool:
        """Whether a state machine has completed the handling of an event with a step."""
        return any(
            self._follower.is_machine(part.instance) and part.destination.location in self._resting[part.instance]
            for part in step.parts
        )

    def tick(self) -> bool:
        """Take steps until the root of the tree has answered a tick; return whether it has."""
        return self.go_on(ends_tick)

    def until_time(self, seconds: float, limit: int = MAX_STEPS) -> bool:
        """Take steps until the time of the clock is at least `seconds`; return whether this time was reached."""
        return self.go_on(lambda _: (self._follower.time or 0.0) >= seconds, limit)

    def until_sent(self, event: str, limit: int = MAX_STEPS) -> bool:
        """Take steps until an event is sent; return whether it was sent.

        Args:
            event: its name in plain SCXML, or the name of its topic, service or action.
        """
        events = self.events_named(event)
        return self.go_on(lambda step: sent_by(step.action or "") in events, limit)

    def until_decided(self, limit: int = MAX_STEPS) -> bool:
        """Take steps until the property is decided, or until the same states are known to repeat for ever (`repeats`);
        return whether it was decided."""
        begin = self.position
        for end in limits(limit):
            if self.is_decided or self.go_on(lambda _: self.is_decided, begin + end - self.position):
                return True
            if self.position < begin + end or self.repeats():
                break
        return False

    def repeats(self) -> bool:
        """Whether the seed leads to some states again and again, which do not decide the property. It is found after
        many steps (`roaml.smc.rounds`)."""
        return self.position >= FIRST_CHECK and self._run.repeats()

    def stopped(self) -> tuple[float, list[str]] | None:
        """The time at which time stops, in s, and the machines that take steps for ever; `None` if the states of the
        run do not repeat, or time passes among them."""
        if self.time is None or not self.repeats():
            return None
        times = clock_times(self.steps[: self.position], self._clock)
        last = [step for step, time in zip(self.steps, times, strict=False) if time == self.time]
        if len(last) <= self.position // 2:
            return None
        actors = (part for step in last[len(last) // 2 :] for part in self.actors(step))
        return self.time, list(dict.fromkeys(part.automaton for part in actors if self.is_machine(part.instance)))

    def back(self, steps: int = 1) -> None:
        """Go back by `steps` steps, at most to the start."""
        self.jump(max(0, self.position - steps))

    def jump(self, position: int) -> None:
        """Go to the state after `position` steps, and take new steps if there are fewer."""
        self._run.go_to(min(position, len(self._run.steps)))
        followers = {**self._followers, **self._recent}
        nearest = max(at for at in followers if at <= self.position)
        if not nearest <= self._follower.position <= self.position:
            self._follower = followers[nearest].copied()
            self._recent = {at: follower for at, follower in self._recent.items() if at <= nearest}
        for step in self._run.steps[self._follower.position : self.position]:
            self._read(step)
            if step.number % RECENT_INTERVAL == 0 and self.position - step.number < SNAPSHOT_INTERVAL:
                self._recent[step.number] = self._follower.copied()
        while self.position < position and not self.is_interrupted() and self.step() is not None:
            pass


def ends_tick(step: TraceStep) -> bool:
    """Whether the root of the tree receives the answer to its tick."""
    has_answer = received_by(step.action or "").endswith("response")
    return has_answer and any(part.automaton.startswith(TREE_ROOT_PREFIX) for part in step.parts)
