# SPDX-License-Identifier: Apache-2.0
"""Variables that are reset where they are dead: the states are those of the whole model, with all dead variables at
their initial values; choices, labels and values are the same."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import pytest
from hypothesis import given, settings
from smc_models import Json, at, automaton, document, edge, model, op, probability, variable, way, ways
from smc_random import networks

import kept_strategies as st
from roaml.explicit.path import shortest
from roaml.explicit.path_recorder import PathRecorder
from roaml.explicit.plain import plain_kernel, plain_search
from roaml.explicit.preparation import preparation_of
from roaml.explicit.space import Space, StateLimits, _bounds, explore
from roaml.explicit.tables import _cells
from roaml.explicit.uses import bits
from roaml.explicit.values import NoValueError, values_of
from roaml.jani.model import Model
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE
from roaml.smc.record import SHORTEST, Recording

Key = tuple[int, ...]
ALL = StateLimits(reduces=False)


def checker_of(written: Json) -> ModelChecker:
    read = model(written)
    return ModelChecker(read, marks=marks_of(read), includes_stuck=True)


def marks_of(read: Model) -> dict[tuple[str, str], End]:
    """The last location of each automaton is one in which it waits for others."""
    return {(a.name, a.locations[-1].name): End.STUCK for a in read.automata}


def dead_in(space: Space, key: Key) -> set[int]:
    """The cells that are dead in a state."""
    checker, property_ = space.checker, space.compiled_property
    liveness = preparation_of(checker).liveness(checker.observed(property_))
    dead = liveness.unobserved
    for place in key[: checker.program.instances]:
        dead |= liveness.dead[place]
    storages = checker.legend.layout.storages
    return {cell for number in bits(dead) for cell in _cells(storages[number], checker.program)}


def keys_of(space: Space) -> list[Key]:
    return [tuple(space.search.key(state)) for state in range(space.states)]


def behavior(space: Space, keys: list[Key]) -> dict[Key, tuple[int, Any]]:
    """The label and the choices of each state. States are given by `keys`; equal ones must behave in the same way."""
    found: dict[Key, tuple[int, Any]] = {}
    for state in range(space.states):
        choices = [
            (weight, reward, sorted((chance, keys[to]) for chance, to in branches))
            for weight, reward, branches in space.search.choices_of(state)
        ]
        description = (space.search.label_of(state), sorted(choices))
        assert found.setdefault(keys[state], description) == description
    return found


def check(checker: ModelChecker, property_: CompiledProperty) -> tuple[int, int]:
    """Check a property of a model; return the number of all states, and of those that remain."""
    whole, reduced = explore(checker, property_, ALL), explore(checker, property_, StateLimits())
    assert (whole.problem is None) == (reduced.problem is None)
    if whole.problem is not None or reduced.problem is not None:
        return 0, 0
    initial = whole.search.key(0)
    keys = []
    for key in keys_of(whole):
        dead = dead_in(whole, key)
        keys.append(tuple(initial[cell] if cell in dead else value for cell, value in enumerate(key)))
    if _bounds(property_.goal)[2] < 0:  # otherwise, the last layer has no choices
        assert behavior(whole, keys) == behavior(reduced, keys_of(reduced))
    assert whole.search.depth == reduced.search.depth or whole.states > reduced.states
    check_values(whole, reduced)
    for verdict in (FALSE, TRUE):
        paths = [shortest(space, verdict) for space in (whole, reduced)]
        lengths = [None if path is None else len(path.steps) for path in paths]
        assert lengths[0] == lengths[1]
        if paths[1] is not None:
            check_replay(reduced, paths[1])
    return whole.states, reduced.states


def check_replay(space: Space, path: Any) -> None:
    """The steps of a path lead the kernel to a state that differs only in dead variables."""
    recorder = PathRecorder(space.checker, space.compiled_property, path)
    recording = Recording(SHORTEST)
    assert len(list(recorder.walk(recording))) == len(path.steps)
    kernel = recorder._kernel
    ints, reals = kernel.snapshot()
    instances = space.checker.program.instances
    reached = (*(kernel.location(i) for i in range(instances)), *ints)
    key = tuple(space.search.key(path.state))
    dead = dead_in(space, key)
    assert not reals
    assert [value for cell, value in enumerate(reached) if cell not in dead] == [
        value for cell, value in enumerate(key[: len(reached)]) if cell not in dead
    ]


def check_values(whole: Space, reduced: Space) -> None:
    """The bounds of the values overlap, or both have no values, for the same reason."""
    found: list[Any] = []
    for space in (whole, reduced):
        try:
            values = values_of(space)
            found.append((values.minimum, values.maximum, values.uniform))
        except NoValueError as error:
            found.append(str(error))
    if isinstance(found[0], str) or isinstance(found[1], str):
        assert found[0] == found[1]
        return
    for one, other in zip(*found, strict=True):
        assert one.lower <= other.upper
        assert other.lower <= one.upper


# ------------------------------------------------------------ random networks

SHARED = ("x", "y", "z")
ACTIONS = ("a", "b")


@st.kept
def numbers(names: tuple[str, ...]) -> st.SearchStrategy[Any]:
    simple = st.one_of(st.sampled_from(names), st.integers(0, 2))
    return st.one_of(
        simple,
        simple,
        st.builds(lambda a, b: op("max", a, b), simple, simple),
        st.just(at("v", 1)),
        st.builds(lambda a: at("v", a), simple),
        st.builds(lambda a, b: op("%", op("+", a, b), 3), simple, simple),
    )


@st.kept
def conditions(names: tuple[str, ...]) -> st.SearchStrategy[Any]:
    return st.builds(op, st.sampled_from(["=", "<", "≠"]), numbers(names), st.integers(0, 2))


@st.composite
def destinations(draw: st.DrawFn, locations: list[str], names: tuple[str, ...]) -> list[Json]:
    count = draw(st.sampled_from([1, 1, 1, 2]))
    branches = []
    for number in range(count):
        assignments: list[tuple[Any, Any, int]] = []
        for target in draw(st.lists(st.sampled_from([*names, "v", "v[]"]), max_size=3, unique=True)):
            index = draw(st.sampled_from([0, 0, 0, 1]))
            if target == "v[]":
                assignments.append((at("v", draw(st.integers(0, 2))), draw(numbers(names)), index))
            elif target == "v":
                whole = {"op": "av", "elements": [draw(numbers(names)) for _ in range(3)]}
                assignments.append(("v", whole, index))
            else:
                assignments.append((target, draw(numbers(names)), index))
        if sum(reference == "v" or not isinstance(reference, str) for reference, _, _ in assignments) > 1:
            assignments = [item for item in assignments if isinstance(item[0], str) and item[0] != "v"]
        share = 1.0 if count == 1 else (0.25, 0.75)[number]
        branches.append(ways(draw(st.sampled_from(locations)), assignments, share))
    return branches


@st.composite
def automata(draw: st.DrawFn, number: int) -> Json:
    locations = ["l", "m", "n", "o"][: draw(st.integers(2, 4))]
    own = f"own{number}"
    names = (*SHARED, own)
    edges = []
    for source in locations:
        for _ in range(draw(st.integers(1, 2))):
            action = draw(st.sampled_from([None, *ACTIONS]))
            guard = draw(st.one_of(st.none(), st.none(), conditions(names)))
            branches = draw(destinations(locations, names))
            edges.append(edge(source, *branches, action=action, guard=guard))
    type_: Any = "int"
    if draw(st.booleans()):
        type_ = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 2}
    return automaton(f"m{number}", " ".join(locations), edges, [variable(own, type_)])


def path_of(draw: st.DrawFn) -> Json:
    one, other = draw(conditions(SHARED[:1])), draw(conditions(SHARED[:2]))
    kind = draw(st.sampled_from(["F", "G", "U", "FG", "bounded", "deadlock"]))
    match kind:
        case "F" | "G":
            return op(kind, one)
        case "U":
            return op("U", one, other)
        case "FG":
            return op("F", op("G", one))
        case "bounded":
            return {**op("F", one), "step-bounds": {"upper": draw(st.integers(1, 6))}}
        case _:
            return op("F", op("∧", one, one)) if draw(st.booleans()) else op("F", {"op": "deadlock"})


@st.composite
def messages(draw: st.DrawFn) -> Json:
    """A network whose automata often copy variables and overwrite them, with properties of several forms."""
    count = draw(st.integers(1, 3))
    parts = [draw(automata(number)) for number in range(count)]
    vectors = st.lists(st.sampled_from([None, *ACTIONS]), min_size=count, max_size=count).filter(any)
    syncs = draw(st.lists(vectors, min_size=1, max_size=4, unique_by=tuple))
    three = {"kind": "array", "base": "int"}
    elements = {"op": "av", "elements": [0, 1, 2]}
    variables = [*(variable(name) for name in SHARED), variable("v", three, elements)]
    reward = {"op": "Emin", "exp": draw(numbers(SHARED[:1])), "accumulate": ["steps"], "reach": op("=", "x", 2)}
    properties = {"p": probability(path_of(draw)), "r": reward}
    return document(*parts, variables=variables, syncs=syncs, properties=properties)


@given(messages())
@settings(max_examples=80, deadline=None, derandomize=True)
def test_reduced_states_are_those_of_the_model_with_dead_variables_reset(written: Json) -> None:
    checker = checker_of(written)
    for property_ in checker.compiled_properties:
        check(checker, property_)


@given(networks())
@settings(max_examples=30, deadline=None, derandomize=True)
def test_also_with_arithmetic_that_can_fail(written: Json) -> None:
    checker = checker_of(written)
    for property_ in checker.compiled_properties:
        check(checker, property_)


@given(messages())
@settings(max_examples=20, deadline=None, derandomize=True)
def test_both_searches_reset_the_same(written: Json) -> None:
    checker = checker_of(written)
    property_ = checker.compiled_properties[0]
    spaces = [
        explore(checker, property_, StateLimits(), modules=modules)
        for modules in (None, (plain_kernel(), plain_search()))
    ]
    assert keys_of(spaces[0]) == keys_of(spaces[1])


# ------------------------------------------------------------ single cases


def counts(written: Json, name: str = "p") -> tuple[int, int]:
    """The number of all states, and of those that remain."""
    checker = checker_of(written)
    return check(checker, next(p for p in checker.compiled_properties if p.question.name == name))


def delivered(*reads: Json, more: tuple[Json, ...] = ()) -> Json:
    """A sender puts one of three values into a message, which a receiver compares when it is delivered."""
    send = [edge("idle", way("sent", data=value), action="send") for value in (1, 2, 3)]
    buffer = [edge("empty", way("full"), action="send"), edge("full", way("empty"), action="take")]
    sender = automaton("sender", "idle sent", [*send, edge("sent", way("idle"), action="again")])
    receiver = automaton("receiver", "wait got", [*reads, edge("got", way("wait"), action="again")])
    return document(
        sender,
        automaton("buffer", "empty full", buffer),
        receiver,
        variables=[variable("data"), variable("last"), *more],
        syncs=[["send", "send", None], [None, "take", "take"], ["again", None, "again"]],
        properties={"p": probability(op("F", op("=", "last", 3)))},
    )


IS_THREE = (
    edge("wait", way("got", last=3), action="take", guard=op("=", "data", 3)),
    edge("wait", way("got", last=0), action="take", guard=op("≠", "data", 3)),
)


def test_data_of_an_event_are_dead_when_it_was_delivered() -> None:
    """States in which the buffer is empty are equal for all data."""
    assert counts(delivered(*IS_THREE)) == (9, 6)


def test_data_that_nobody_observes_are_dead_everywhere() -> None:
    take = edge("wait", way("got", seen="data"), action="take")
    assert counts(delivered(take, more=(variable("seen"),))) == (19, 3)


@pytest.mark.parametrize("index", [op("-", "data", 3), op("-", "data", 1)])
def test_an_operation_that_can_be_undefined_is_a_read(index: Any) -> None:
    """The element is not observed, but the index is outside of the array for some data, or for those after a reset."""
    take = edge("wait", way("got", seen=at("v", index)), action="take")
    three = {"kind": "array", "base": "int"}
    array = variable("v", three, {"op": "av", "elements": [0, 1, 2]})
    written = delivered(take, more=(variable("seen"), array))
    checker = checker_of(written)
    space = explore(checker, checker.compiled_properties[0], StateLimits())
    assert (space.problem is not None) == (index == op("-", "data", 3))
    check(checker, checker.compiled_properties[0])


def test_guards_that_can_be_undefined_are_reads_wherever_they_are_evaluated() -> None:
    """The kernel evaluates the guard also while the buffer is empty; `data` is 0 there only if it were reset."""
    take = edge("wait", way("got", last=3), action="take", guard=op("=", op("%", 6, "data"), 0))
    written = delivered(take)
    written["variables"][0]["initial-value"] = 1
    checker = checker_of(written)
    for limits in (ALL, StateLimits()):
        assert explore(checker, checker.compiled_properties[0], limits).problem is None
    counts(written)


def test_a_step_that_only_writes_a_variable_is_a_change() -> None:
    """`x` is never read, but as long as it changes the trace has not ended."""
    turn = edge("l", way("l", x=op("max", 0, "y")))
    flip = edge("l", way("l", y=1), way("l", y=0))
    flip["destinations"][0]["probability"] = {"exp": 0.5}
    flip["destinations"][1]["probability"] = {"exp": 0.5}
    for edges in ([turn], [turn, flip]):
        written = document(
            automaton("a", "l", edges),
            variables=[variable("x"), variable("y"), variable("z")],
            properties={"p": probability(op("F", op("=", "z", 1)))},
        )
        whole, reduced = counts(written, "stuck")
        assert whole == reduced == (1 if edges == [turn] else 4)


def test_a_value_that_is_read_later_in_the_same_step_is_live() -> None:
    """`x` is dead between steps, but its value at index 0 becomes that of `y` at index 1."""
    copy = edge("l", ways("m", [("x", "z", 0), ("y", "x", 1)]))
    values = [(1, 7, 0.25), (1, 8, 0.25), (2, 7, 0.5)]
    draw_ = edge("m", *(ways("l", [("z", z, 0), ("x", x, 0)], share) for z, x, share in values))
    written = document(
        automaton("a", "l m", [copy, draw_]),
        variables=[variable("x"), variable("y"), variable("z")],
        properties={"p": probability(op("F", op("=", "y", 2)))},
    )
    whole, reduced = counts(written)
    assert reduced < whole


def test_a_variable_is_live_if_its_copy_is_live() -> None:
    """`x` is read only when it is copied to `y`, which is written as a whole and read in the next step."""
    toss = [way("m", 0.25, x=1), way("m", 0.25, x=2), way("m", 0.5, x=3)]
    edges = [
        edge("l", *toss),
        edge("m", way("n", y="x")),
        edge("n", way("l", z=1), guard=op("=", "y", 1)),
        edge("n", "l", guard=op(">", "y", 1)),
    ]
    written = document(
        automaton("a", "l m n", edges),
        variables=[variable("x"), variable("y"), variable("z")],
        properties={"p": probability(op("F", op("=", "z", 1)))},
    )
    whole, reduced = counts(written)
    assert (whole, reduced) == (16, 8)


def test_without_reductions_all_states_are_explored() -> None:
    checker = checker_of(delivered(*IS_THREE))
    assert explore(checker, checker.compiled_properties[0], ALL).states == 9


def test_the_analyses_of_a_model_serve_all_its_properties() -> None:
    """`x` is live for the property that reads the transient variable `t`, which gets its value, and dead for the other
    one."""
    toss = [way("m", 0.5, x=1), way("m", 0.5, x=2)]
    edges = [edge("l", *toss), edge("m", way("l", t="x")), edge("m", way("n", y=1)), edge("n", "l")]
    written = document(
        automaton("a", "l m n", edges),
        variables=[variable("x"), variable("y"), variable("t", transient=True)],
        properties={name: probability(op("F", op("=", name, 2))) for name in ("y", "t")},
    )
    alone = []
    for number in range(2):
        checker = checker_of(written)
        alone.append(preparation_of(checker).liveness(checker.observed(checker.compiled_properties[number])))
    x = next(number for number, storage in enumerate(checker.legend.layout.storages) if storage.name == "x")
    assert [liveness.unobserved >> x & 1 for liveness in alone] == [1, 0]
    for order in ((0, 1), (1, 0)):
        checker = checker_of(written)
        for number in order:
            observed = checker.observed(checker.compiled_properties[number])
            assert preparation_of(checker).liveness(observed) == alone[number]


def test_the_analyses_end_with_their_model() -> None:
    checker = checker_of(delivered(*IS_THREE))
    preparation = weakref.ref(preparation_of(checker))
    assert preparation_of(checker) is preparation()
    del checker
    gc.collect()
    assert preparation() is None
