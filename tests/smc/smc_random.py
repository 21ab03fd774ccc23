# SPDX-License-Identifier: Apache-2.0
"""Random small networks of automata: with guards, probabilities, simultaneous and ordered assignments, arrays."""

from __future__ import annotations

from typing import Any

from smc_models import Json, at, automaton, document, edge, op, probability, variable, ways

import kept_strategies as st

SHARED = ("x", "y")
ACTIONS = ("a", "b")


@st.kept
def numbers(names: tuple[str, ...]) -> st.SearchStrategy[Any]:
    """Expressions with small integers as values."""
    simple = st.one_of(st.sampled_from(names), st.integers(0, 3), st.just(at("v", 1)))
    return st.one_of(
        simple,
        st.builds(lambda a, b: op("%", op("+", a, b), 4), simple, simple),
        st.builds(lambda a, b: op("max", a, b), simple, simple),
        st.builds(lambda a: at("v", op("%", a, 3)), simple),
    )


@st.kept
def conditions(names: tuple[str, ...]) -> st.SearchStrategy[Any]:
    compared = st.builds(op, st.sampled_from(["=", "<", "≤", "≠", ">"]), numbers(names), numbers(names))
    return st.one_of(compared, st.builds(op, st.sampled_from(["∧", "∨"]), compared, compared))


@st.composite
def destinations(draw: st.DrawFn, locations: list[str], names: tuple[str, ...]) -> list[Json]:
    count = draw(st.integers(1, 2))
    branches = []
    for number in range(count):
        targets = draw(st.lists(st.sampled_from([*names, "v"]), max_size=3, unique=True))
        assignments = []
        for target in targets:
            ref: Any = at("v", op("%", draw(st.sampled_from(names)), 3)) if target == "v" else target
            assignments.append((ref, draw(numbers(names)), draw(st.integers(0, 1))))
        share = 1.0 if count == 1 else (0.25, 0.75)[number]
        branches.append(ways(draw(st.sampled_from(locations)), assignments, share))
    return branches


@st.composite
def automata(draw: st.DrawFn, number: int) -> Json:
    locations = ["l", "m", "n"][: draw(st.integers(1, 3))]
    own = f"own{number}"
    names = (*SHARED, own)
    edges = []
    for _ in range(draw(st.integers(1, 5))):
        action = draw(st.sampled_from([None, *ACTIONS, *ACTIONS]))
        guard = draw(st.one_of(st.none(), conditions(names)))
        branches = draw(destinations(locations, names))
        edges.append(edge(draw(st.sampled_from(locations)), *branches, action=action, guard=guard))
    return automaton(f"m{number}", " ".join(locations), edges, [variable(own)])


@st.composite
def networks(draw: st.DrawFn) -> Json:
    """A model with a property. Synchronised automata that write one variable use different indexes or the same
    value."""
    count = draw(st.integers(1, 3))
    parts = [draw(automata(number)) for number in range(count)]
    vectors = st.lists(st.sampled_from([None, *ACTIONS]), min_size=count, max_size=count).filter(any)
    syncs = draw(st.lists(vectors, min_size=1, max_size=4, unique_by=tuple))
    three = {"kind": "array", "base": "int"}
    values = {"op": "av", "elements": [0, 1, 2]}
    variables = [*(variable(name) for name in SHARED), variable("v", three, values)]
    goal = probability(op("F", draw(conditions(SHARED))))
    return document(*parts, variables=variables, syncs=syncs, properties={"p": goal})
