# SPDX-License-Identifier: Apache-2.0
"""A JANI model: automata that share variables and synchronise on actions.

- A model is immutable. Every part has an `origin`, which equality ignores.
- A synchronisation lists only the automata that take part in it. The table of the JSON format, which has an entry for
  each automaton and each synchronisation, is never stored.
"""

from __future__ import annotations

import enum

from roaml.durations import ANY_TIME, ReactionTime
from roaml.jani.expressions import ArrayAccess, Expression, LValue, Name
from roaml.jani.node import CommentedNode, Node
from roaml.jani.properties import Property
from roaml.jani.types import Type


class ModelType(enum.Enum):
    """The kind of transition system that the model describes."""

    LTS = "lts"
    DTMC = "dtmc"
    CTMC = "ctmc"
    MDP = "mdp"
    CTMDP = "ctmdp"
    MA = "ma"
    TA = "ta"
    PTA = "pta"
    STA = "sta"
    HA = "ha"
    PHA = "pha"
    SHA = "sha"


PREFIX, VARIABLES = "__as2fm__", "as2fm__"
"""The beginnings of the names of the actions and variables that express a reaction time (`roaml.jani.reaction`). Storm
rejects variables that begin with `__`."""


class Clock(Node, frozen=True):
    """The automaton that advances the time of a translated system (docs/spec/jani.md#clock-metadata).

    Attributes:
        actions: the actions with which it begins its steps.
        step: the length of a step, in ns.
    """

    automaton: str
    actions: tuple[str, ...]
    step: int


class Metadata(Node, frozen=True):
    """The authors and the purpose of the model; for a translated system with timers, its clock, and the reaction time
    that the model assumes."""

    version: str | None = None
    author: str | None = None
    description: str | None = None
    doi: str | None = None
    url: str | None = None
    clock: Clock | None = None
    reaction_time: ReactionTime = ANY_TIME


class Clause(CommentedNode, frozen=True):
    """An expression for which JANI allows a comment: a guard, a rate, a probability, a time progress condition or a
    restriction of initial states."""

    exp: Expression


class Constant(CommentedNode, frozen=True):
    """A constant. If `value` is `None`, the user of the model chooses the value."""

    name: str
    type: Type
    value: Expression | None = None


class Variable(CommentedNode, frozen=True):
    """A variable. If `initial_value` is `None`, any initial value is possible. A transient variable is reset to its
    initial value in each state."""

    name: str
    type: Type
    initial_value: Expression | None = None
    transient: bool = False


class Action(CommentedNode, frozen=True):
    name: str


class DatatypeMember(CommentedNode, frozen=True):
    name: str
    type: Type


class Datatype(CommentedNode, frozen=True):
    name: str
    members: tuple[DatatypeMember, ...]


class Parameter(CommentedNode, frozen=True):
    name: str
    type: Type


class Function(CommentedNode, frozen=True):
    name: str
    type: Type
    parameters: tuple[Parameter, ...]
    body: Expression


class TransientValue(CommentedNode, frozen=True):
    """The value that a transient variable has in a location."""

    target: LValue
    value: Expression


class Location(CommentedNode, frozen=True):
    name: str
    time_progress: Clause | None = None
    transient_values: tuple[TransientValue, ...] = ()


class Assignment(CommentedNode, frozen=True):
    """The assignment `target := value`. Assignments with equal `index` are simultaneous; assignments with a smaller
    index are executed first."""

    target: LValue
    value: Expression
    index: int = 0

    @property
    def variable(self) -> str:
        """The variable that the assignment writes completely or in part; "" if the target has no name."""
        target: Expression = self.target
        while isinstance(target, ArrayAccess):
            target = target.array
        return target.identifier if isinstance(target, Name) else ""


class Destination(CommentedNode, frozen=True):
    """A target of an edge, with its probability (1 if it is `None`) and its assignments."""

    location: str
    probability: Clause | None = None
    assignments: tuple[Assignment, ...] = ()


class Edge(CommentedNode, frozen=True):
    """An edge from the location `source` to one of `destinations`. An edge without `action` is silent; an edge without
    `guard` is always enabled."""

    source: str
    destinations: tuple[Destination, ...]
    action: str | None = None
    guard: Clause | None = None
    rate: Clause | None = None


class Automaton(CommentedNode, frozen=True):
    """An automaton.

    Attributes:
        thread_of: for an action thread of a translated system, the name of the automaton of its machine; "" for other
            automata. JANI files do not contain it, and equality ignores it.
        thread: the name of this thread for users within its machine, such as `goal thread 0`; otherwise like
            `thread_of`.
    """

    UNCOMPARED = CommentedNode.UNCOMPARED | {"thread_of", "thread"}

    name: str
    locations: tuple[Location, ...]
    initial_locations: tuple[str, ...]
    edges: tuple[Edge, ...] = ()
    variables: tuple[Variable, ...] = ()
    functions: tuple[Function, ...] = ()
    restrict_initial: Clause | None = None
    thread_of: str = ""
    thread: str = ""


class Element(CommentedNode, frozen=True):
    """An automaton as an element of the parallel composition. `input_enable` contains the actions that it can always
    take."""

    automaton: str
    input_enable: tuple[str, ...] = ()


class Sync(CommentedNode, frozen=True):
    """A synchronisation: edges that several automata take together.

    Attributes:
        participants: the index of each element that takes part, with the action of its edge, in the order of the
            elements. All other elements keep their locations.
        result: the action of the whole step; `None` if the step is silent.
    """

    participants: tuple[tuple[int, str], ...]
    result: str | None = None


class System(CommentedNode, frozen=True):
    """The parallel composition of `elements`, with all synchronisations of their actions."""

    elements: tuple[Element, ...]
    syncs: tuple[Sync, ...] = ()


class Model(Node, frozen=True):
    """A whole model. `features` need not contain the features that its parts require, because the writer adds them.

    Attributes:
        holds_clock: whether the clock of the metadata begins a step only if no other step is possible. JANI cannot
            express this, so the writer replaces it by guards (`reaction`).
    """

    type: ModelType
    automata: tuple[Automaton, ...]
    system: System
    name: str = ""
    features: tuple[str, ...] = ()
    metadata: Metadata | None = None
    constants: tuple[Constant, ...] = ()
    variables: tuple[Variable, ...] = ()
    actions: tuple[Action, ...] = ()
    datatypes: tuple[Datatype, ...] = ()
    functions: tuple[Function, ...] = ()
    restrict_initial: Clause | None = None
    properties: tuple[Property, ...] = ()
    holds_clock: bool = False
