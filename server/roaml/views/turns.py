# SPDX-License-Identifier: Apache-2.0
"""A trace in turns: in each turn, an automaton receives an event and executes all statements that follow from it.

A translated system takes many steps for a turn: each statement is a step, each event is buffered by a separate
automaton between sender and receiver, calls of services go through a handler, and the inner nodes of a behavior tree
pass ticks down and statuses up. A turn is included if one of its steps is relevant, or if it receives an event that a
relevant turn sends. Turns that only pass an event on are omitted.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from roaml.jani.model import VARIABLES, Automaton
from roaml.jani.node import Origin
from roaml.jani.semantics import Value
from roaml.record import Record, field
from roaml.scxml.names import (
    ENTRY_PREFIX,
    NODE_AUTOMATON,
    OPEN,
    PENDING,
    SATISFIED,
    STATUS_NAMES,
    VIOLATED,
    TreeEventKind,
    is_blackboard,
    is_generated,
    is_observer,
    observer_automaton,
    observer_prefix,
    prefix_of_observer,
    read_tree_event,
    received_by,
    sent_by,
    written_entry,
)
from roaml.smc.record import AutomatonStep, RecordedVariable, TraceStep
from roaml.smc.story import Story
from roaml.views.actors import actors_of, message_phrase, names_of
from roaml.views.arrays import ArrayReader, DeclaredChange, DeclaredValue, initial_values
from roaml.views.events import EventReader
from roaml.views.library_nodes import is_library_node
from roaml.views.locations import states_of
from roaml.views.observed import effects, observation, observed_property
from roaml.views.variables import variable_phrases

_ENDS = ("SUCCESS", "FAILURE")


class Turn(Record):
    """The steps of one automaton from one event to the next.

    Attributes:
        number: the number of the first step.
        time: the time after the first step, in s; `None` if the model has no clock.
        heard: the received event with which the turn begins; `None` if there is none.
        action: the action that the automaton executes together with others in the first step; `None` if the step
            receives an event, or no other automaton takes part.
        parts: the part of the automaton in each step.
        changes: the changes of the variables of the automaton, and of variables of the model that do not belong to an
            event. For a node of a library, the changes of the blackboard entries that it writes replace those of its
            copies of entries.
        messages: the events that the automaton has sent, without those that change an entry in `changes`.
        matters: whether one of the steps is relevant for the property.
        last: the number of the last step.
        ends: whether the automaton takes part in a step that ends the trace.
        observed: the name of the observed property if the automaton is an observer; otherwise "".
        observation: what an observer observes.
        phrases: phrases for those variables of the automaton whose names are not those of the user, by their names.
        states: location of the automaton -> the state to which it belongs.
        is_library_node: whether the automaton is a node of the tree whose behaviour is that of a library or of a mock,
            so that its states are not those of a machine of the user.
        constants: the values of the constants of the model.
        options: among how many steps in which the automaton takes part the scheduler chose the first one; 0 if there
            was no choice.
        ready: the time from which on the automaton could have received the event, in s, if that is before `time`;
            otherwise `None`.
        until: the time until which the automaton paused between two steps of the turn, in s; `None` if it did not.
        actor: the phrase of `roaml.views.actors.actors_of` for the automaton.
    """

    instance: int
    number: int
    time: float | None
    heard: Message | None
    action: str | None
    parts: list[AutomatonStep] = field(default_factory=list)
    changes: list[DeclaredChange] = field(default_factory=list)
    messages: list[Message] = field(default_factory=list)
    matters: bool = False
    last: int = 0
    ends: bool = False
    observed: str = ""
    observation: str = ""
    phrases: Mapping[str, str] = field(default_factory=dict)
    states: Mapping[str, str] = field(default_factory=dict)
    is_library_node: bool = False
    actor: str = ""
    constants: Mapping[str, Value] = field(default_factory=dict)
    options: int = 0
    ready: float | None = None
    until: float | None = None

    @property
    def automaton(self) -> str:
        return self.parts[0].automaton

    @property
    def origin(self) -> Origin | None:
        return self.parts[0].edge.origin

    @property
    def source(self) -> str:
        """The state in which the turn begins."""
        return self._state(self.parts[0].source)

    @property
    def destination(self) -> str:
        """The state in which the turn ends; if it ends between two states, the state before it."""
        return self._state(self.parts[-1].destination.location)

    def _state(self, location: str) -> str:
        return self.states.get(location, location)

    @property
    def starts(self) -> bool:
        """Whether the automaton enters its initial state in the turn."""
        first = self.parts[0].source
        return self.heard is None and self._state(first) != first and not self.observed

    @property
    def who(self) -> str:
        """The name of the automaton for users. An observer has the name of its property."""
        return self.observed or self.actor

    @property
    def effects(self) -> tuple[str, ...]:
        """Phrases for what the turn of an observer means for its property, such as `the property is violated`."""
        return tuple(effects(self.changes))

    @property
    def is_ticked(self) -> bool:
        return self._hears(TreeEventKind.TICK)

    @property
    def is_halted(self) -> bool:
        return self._hears(TreeEventKind.HALT)

    @property
    def is_answered(self) -> bool:
        """Whether the turn begins with the answer of a child to an inner node."""
        return self.heard is not None and _kind(self.heard.event) in _ANSWERS

    @property
    def sent(self) -> Iterator[Message]:
        """The events that the automaton sends, except its answers to the tree."""
        return (message for message in self.messages if not self._answers(message))

    @property
    def status(self) -> str:
        """The status that the node returns to the tree; "" if it returns none."""
        given = [message.values.get("status") for message in self.messages if self._answers(message)]
        return next(
            (STATUS_NAMES[number] for number in given if isinstance(number, int) and number in STATUS_NAMES), ""
        )

    @property
    def result(self) -> str:
        """The status that the automaton receives from a node of the tree; "" if it receives none."""
        if self.heard is None or _kind(self.heard.event) is not TreeEventKind.RESPONSE:
            return ""
        status = self.heard.values.get("status")
        return STATUS_NAMES.get(status, "") if isinstance(status, int) else ""

    @property
    def is_calm(self) -> bool:
        """Whether the received event has no effect."""
        has_moved = self.parts[0].source != self.parts[-1].destination.location or bool(self.changes)
        return self.heard is not None and not has_moved and not any(self.sent) and not self.status

    def _answers(self, message: Message) -> bool:
        return self._is_between_tree_and_node(message.event, *_ANSWERS)

    def _hears(self, kind: TreeEventKind) -> bool:
        return self.heard is not None and self._is_between_tree_and_node(self.heard.event, kind)

    def _is_between_tree_and_node(self, event: str, *kinds: TreeEventKind) -> bool:
        """Whether an event is of one of these kinds, and is sent between this node and the tree, or between this node
        and the conditions of its ports."""
        node, read = NODE_AUTOMATON.fullmatch(self.automaton), read_tree_event(event)
        return node is not None and read is not None and read.number == int(node[1]) and read.kind in kinds


class Message(Record, frozen=True):
    """An event with the parameters with which it was sent, by their names.

    Attributes:
        name: a short phrase for the event, such as `/level`, `a request to /adder`, or the name of a plain event.
        sender: the turn that sent the event; `None` if no automaton has sent it.
        time: when it was sent, in s; `None` if that is not known.
    """

    event: str
    name: str
    values: Mapping[str, DeclaredValue]
    sender: Turn | None = None
    time: float | None = None


def turns(story: Story) -> list[Turn]:
    """The turns that are included, in the order in which they begin."""
    reader = _Reader(story)
    for index in range(len(story.steps)):
        reader.read(index)
    prefixes = (observer_prefix(variable, VIOLATED, SATISFIED, PENDING, OPEN) for variable in story.variables)
    own = {observer_automaton(prefix) for prefix in prefixes if prefix}
    return [turn for turn in reader.turns if _is_shown(turn, reader.inner, own)]


def _is_shown(turn: Turn, inner: Collection[int], observers: Collection[str]) -> bool:
    """Whether a turn is included.

    Args:
        inner: see `_Reader`.
        observers: the observers on which the property of the story depends.
    """
    if turn.observed:
        return turn.automaton in observers and bool(turn.effects)
    if turn.ends:
        return True
    if is_generated(turn.automaton):
        return False
    if turn.instance in inner:
        return turn.matters and turn.status in _ENDS
    sender = turn.heard.sender if turn.heard else None
    is_overheard = sender is not None and sender.matters and sender.instance not in inner
    return (turn.matters or is_overheard) and not turn.is_calm


class _Reader:
    """Reads the steps of a trace in their order, and divides them into turns.

    Attributes:
        inner: the nodes of BehaviorTree.CPP that tick children, and the automaton that ticks the root. Their turns are
            omitted; the turns of control nodes that the user has written are included.
        turns: the turns of all automata except those that only buffer an event.
    """

    def __init__(self, story: Story) -> None:
        self._story = story
        self._relevant = frozenset(story.relevant)
        self._automata = names_of(story.automata)
        self._actors = actors_of(story.automata)
        observers = filter(is_observer, self._automata)
        self._observer_prefixes = tuple(f"{prefix_of_observer(name)}__" for name in observers)
        self._events = EventReader(story.automata, story.start)
        self._arrays = ArrayReader(story.automata, story.start)
        self.inner = frozenset(n for n, automaton in enumerate(story.automata) if is_inner(automaton))
        self._library_nodes = frozenset(n for n, automaton in enumerate(story.automata) if is_library_node(automaton))
        boards = (automaton for automaton in story.automata if is_blackboard(automaton.name))
        self._entries = {name: value for board in boards for name, value in initial_values(board).items()}
        self._known_phrases: dict[int, Mapping[str, str]] = {}
        self._known_states: dict[int, Mapping[str, str]] = {}
        self._messages: dict[str, Message] = {}
        self._names: dict[str, str] = {}
        self._current: dict[int, Turn] = {}
        self.turns: list[Turn] = []

    def read(self, index: int) -> None:
        step = self._story.steps[index]
        self._events.read(step)
        changes = self._arrays.read(step)
        actors = self._events.actors(step)
        heard = self._heard(step)
        last = next((part for part in reversed(actors) if not is_observer(part.automaton)), None)
        for part in actors:
            turn = self._current.get(part.instance)
            if turn is None or heard is not None or not self._events.hearing[part.instance]:
                together = step.action if len(actors) > 1 and heard is None else None
                turn = Turn(part.instance, step.number, self._story.clock[index], heard, together)
                turn.phrases, turn.states = self._phrases(part.instance), self._states(part.instance)
                turn.constants = self._story.constants
                turn.actor = self._actors[part.automaton]
                turn.is_library_node = part.instance in self._library_nodes
                turn.options = self._story.options.get(index, {}).get(part.instance, 0)
                turn.ready = self._ready(turn, self._current.get(part.instance))
                if is_observer(part.automaton):
                    turn.observed = observed_property(part.automaton, self._story.property)
                    turn.observation = observation(step.action, self._automata)
                self._current[part.instance] = turn
                self.turns.append(turn)
            elif self._story.clock[turn.last - 1] != self._story.clock[index] and not turn.is_library_node:
                turn.until = self._story.clock[index]
            turn.parts.append(part)
            turn.last = step.number
            if part.instance not in self.inner:
                turn.changes += self._changes(changes, part, is_last=part is last)
            turn.matters |= index in self._relevant
            turn.ends |= index in self._story.ends
        event = sent_by(step.action or "")
        if event:
            self._send(event, self._current[actors[0].instance] if actors else None, self._story.clock[index])

    def _ready(self, turn: Turn, previous: Turn | None) -> float | None:
        """See `Turn.ready`: the event had been sent, and the automaton had ended its previous turn."""
        if turn.heard is None or turn.heard.time is None or turn.time is None or turn.observed:
            return None
        idle = self._story.clock[previous.last - 1] if previous is not None else None
        ready = max(turn.heard.time, idle or 0.0)
        return ready if ready < turn.time else None

    def _phrases(self, instance: int) -> Mapping[str, str]:
        if instance not in self._known_phrases:
            automaton = self._story.automata[instance]
            self._known_phrases[instance] = variable_phrases(automaton, self._events.is_event)
        return self._known_phrases[instance]

    def _states(self, instance: int) -> Mapping[str, str]:
        if instance not in self._known_states:
            self._known_states[instance] = states_of(self._story.automata[instance])
        return self._known_states[instance]

    def _send(self, event: str, sender: Turn | None, time: float | None) -> None:
        message = Message(event, self._name(event), self._events.parameters(event), sender, time)
        self._messages[event] = message
        change = self._written(message, sender)
        if sender is not None and change is not None:
            sender.changes.append(change)
        elif sender is not None:
            sender.messages.append(message)

    def _written(self, message: Message, sender: Turn | None) -> DeclaredChange | None:
        """The change of a blackboard entry that a node of a library causes with a message; `None` if it causes none."""
        entry = written_entry(message.event)
        if not entry:
            return None
        before, after = self._entries.get(entry), message.values.get("value")
        if after is not None:
            self._entries[entry] = after
        if sender is None or not sender.is_library_node or before is None or after is None or before == after:
            return None
        return DeclaredChange(RecordedVariable(sender.instance, f"{ENTRY_PREFIX}{entry}"), before, after)

    def _heard(self, step: TraceStep) -> Message | None:
        event = received_by(step.action or "")
        return self._messages.get(event, Message(event, self._name(event), {})) if event else None

    def _name(self, event: str) -> str:
        if event not in self._names:
            self._names[event] = message_phrase(event, self._automata)
        return self._names[event]

    def _changes(
        self, changes: Sequence[DeclaredChange], part: AutomatonStep, *, is_last: bool
    ) -> Iterator[DeclaredChange]:
        """The changes of the variables of an automaton, and of variables of the model that do not belong to an event.
        A change of a variable of the model is included once: at the observer to which the variable belongs, or at the
        last automaton that takes part and is not an observer."""
        own = f"{prefix_of_observer(part.automaton)}__" if is_observer(part.automaton) else ""
        for change in changes:
            instance, name = change.variable
            if name in self._phrases(part.instance) and name.startswith(ENTRY_PREFIX):
                continue  # a copy: the node that writes the entry has the change
            is_lasting = instance < 0 and (name.startswith(own) if own else is_last and not self._is_others(name))
            if instance == part.instance or is_lasting:
                yield change

    def _is_others(self, name: str) -> bool:
        """Whether a variable of the model belongs to an event, an observer or the reaction time."""
        return self._events.carries_event(name) or name.startswith((*self._observer_prefixes, VARIABLES))


def is_inner(automaton: Automaton) -> bool:
    """Whether an automaton only ticks other nodes: it is a node of BehaviorTree.CPP that has children, or the root of
    the tree."""
    comes_along = (
        is_library_node(automaton) if NODE_AUTOMATON.fullmatch(automaton.name) else is_generated(automaton.name)
    )
    return comes_along and any(_kind(sent_by(edge.action or "")) in _CALLS for edge in automaton.edges)


_ANSWERS = (TreeEventKind.RESPONSE, TreeEventKind.HALT_RESPONSE)
_CALLS = (TreeEventKind.TICK, TreeEventKind.HALT)


def _kind(event: str) -> TreeEventKind | None:
    """The kind of an event of the tree; `None` for other events."""
    read = read_tree_event(event)
    return read.kind if read else None
