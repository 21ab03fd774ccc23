# SPDX-License-Identifier: Apache-2.0
"""A JANI model: automata that share variables and synchronise on actions.

- A model is immutable. Every part has an `origin`, which equality ignores.
- A synchronisation lists only the automata that take part in it. The table of the JSON format, which has an entry for
  each automaton and each synchronisation, is never stored.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from roaml.jani.expressions import Expression, LValue
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


@dataclass(frozen=True, slots=True)
class Metadata(Node):
    """The authors and the purpose of the model."""

    version: str | None = None
    author: str | None = None
    description: str | None = None
    doi: str | None = None
    url: str | None = None


@dataclass(frozen=True, slots=True)
class Clause(CommentedNode):
    """An expression for which JANI allows a comment: a guard, a rate, a probability, a time progress condition or a
    restriction of initial states."""

    exp: Expression


@dataclass(frozen=True, slots=True)
class Constant(CommentedNode):
    """A constant. If `value` is `None`, the user of the model chooses the value."""

    name: str
    type: Type
    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class Variable(CommentedNode):
    """A variable. If `initial_value` is `None`, any initial value is possible. A transient variable is reset to its
    initial value in each state."""

    name: str
    type: Type
    initial_value: Expression | None = None
    transient: bool = False


@dataclass(frozen=True, slots=True)
class Action(CommentedNode):
    name: str


@dataclass(frozen=True, slots=True)
class DatatypeMember(CommentedNode):
    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Datatype(CommentedNode):
    name: str
    members: tuple[DatatypeMember, ...]


@dataclass(frozen=True, slots=True)
class Parameter(CommentedNode):
    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Function(CommentedNode):
    name: str
    type: Type
    parameters: tuple[Parameter, ...]
    body: Expression


@dataclass(frozen=True, slots=True)
class TransientValue(CommentedNode):
    """The value that a transient variable has in a location."""

    target: LValue
    value: Expression


@dataclass(frozen=True, slots=True)
class Location(CommentedNode):
    name: str
    time_progress: Clause | None = None
    transient_values: tuple[TransientValue, ...] = ()


@dataclass(frozen=True, slots=True)
class Assignment(CommentedNode):
    """The assignment `target := value`. Assignments with equal `index` are simultaneous; assignments with a smaller
    index are executed first."""

    target: LValue
    value: Expression
    index: int = 0


@dataclass(frozen=True, slots=True)
class Destination(CommentedNode):
    """A target of an edge, with its probability (1 if it is `None`) and its assignments."""

    location: str
    probability: Clause | None = None
    assignments: tuple[Assignment, ...] = ()


@dataclass(frozen=True, slots=True)
class Edge(CommentedNode):
    """An edge from the location `source` to one of `destinations`. An edge without `action` is silent; an edge without
    `guard` is always enabled."""

    source: str
    destinations: tuple[Destination, ...]
    action: str | None = None
    guard: Clause | None = None
    rate: Clause | None = None


@dataclass(frozen=True, slots=True)
class Automaton(CommentedNode):
    name: str
    locations: tuple[Location, ...]
    initial_locations: tuple[str, ...]
    edges: tuple[Edge, ...] = ()
    variables: tuple[Variable, ...] = ()
    functions: tuple[Function, ...] = ()
    restrict_initial: Clause | None = None


@dataclass(frozen=True, slots=True)
class Element(CommentedNode):
    """An automaton as an element of the parallel composition. `input_enable` contains the actions that it can always
    take."""

    automaton: str
    input_enable: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Sync(CommentedNode):
    """A synchronisation: edges that several automata take together.

    Attributes:
        participants: the index of each element that takes part, with the action of its edge, in the order of the
            elements. All other elements keep their locations.
        result: the action of the whole step; `None` if the step is silent.
    """

    participants: tuple[tuple[int, str], ...]
    result: str | None = None


@dataclass(frozen=True, slots=True)
class System(CommentedNode):
    """The parallel composition of `elements`, with all synchronisations of their actions."""

    elements: tuple[Element, ...]
    syncs: tuple[Sync, ...] = ()


@dataclass(frozen=True, slots=True)
class Model(Node):
    """A whole model. `features` need not contain the features that its parts require, because the writer adds them."""

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
