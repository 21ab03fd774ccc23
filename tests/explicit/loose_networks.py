# SPDX-License-Identifier: Apache-2.0
"""Random networks whose automata work independently of one another most of the time: with own variables, buffers for
events, shared variables, and chance."""

from __future__ import annotations

from typing import Any

from smc_models import Json, automaton, document, edge, op, probability, variable, way

import kept_strategies as st

SHARED = ("x", "y")
STUCK_AUTOMATON, STUCK_LOCATION = "m0", "m"


@st.composite
def networks(draw: st.DrawFn, *, has_faults: bool = False) -> Json:
    """A model with one property.

    Args:
        has_faults: whether some edges execute an undefined operation.
    """
    count = draw(st.integers(2, 3))
    events = ["e", "f"][: draw(st.integers(0, 2))]
    machines = [draw(_machine(number, events, has_faults=has_faults)) for number in range(count)]
    buffers = [_buffer(event) for event in events]
    elements = [*machines, *buffers]
    syncs: list[list[str | None]] = []
    for k, event in enumerate(events):
        for number, machine in enumerate(machines):
            for verb in ("send", "get"):
                action = f"{verb}_{event}"
                if any(e.get("action") == action for e in machine["edges"]):
                    row: list[str | None] = [None] * len(elements)
                    row[number] = row[count + k] = action
                    syncs.append(row)
    rows = {"syncs": syncs or [[None] * len(elements)]}
    for machine in machines:
        machine["edges"] = [e for e in machine["edges"] if "action" not in e or _is_synchronised(e["action"], syncs)]
    variables = [variable(name) for name in SHARED]
    return document(*elements, variables=variables, properties={"p": draw(_properties())}, **rows)


@st.composite
def messages(draw: st.DrawFn) -> Json:
    """A model whose events have data, which their receivers copy, compare or ignore. So many variables are dead in some
    states."""
    written = draw(networks())
    events = [a["name"].removeprefix("buffer_") for a in written["automata"] if a["name"].startswith("buffer_")]
    for number, machine in enumerate(written["automata"][: len(written["automata"]) - len(events)]):
        own, kept = machine["variables"][0]["name"], f"kept{number}"
        machine["variables"].append(variable(kept))
        for edge_ in machine["edges"]:
            verb, _, event = edge_.get("action", "").partition("_")
            if verb == "get" and draw(st.integers(0, 2)) == 0:
                edge_["guard"] = {"exp": op("<", f"data_{event}", draw(st.integers(1, 2)))}
            elif draw(st.integers(0, 5)) == 0:
                edge_["guard"] = {"exp": op(draw(st.sampled_from(["=", "<"])), kept, draw(st.sampled_from([1, own])))}
            for destination in edge_["destinations"]:
                assigned = {a["ref"]: a for a in destination.get("assignments", ())}
                values: dict[str, Any] = {}
                if verb == "send":
                    values[f"data_{event}"] = draw(st.sampled_from([1, 2, own, kept, "x"]))
                if verb == "get" and draw(st.booleans()):
                    values[kept] = f"data_{event}"
                elif draw(st.integers(0, 3)) == 0:
                    values[kept] = draw(st.sampled_from([0, 1, own, "x"]))
                if draw(st.integers(0, 4)) == 0:
                    values[draw(st.sampled_from(SHARED))] = kept
                for name, value in values.items():
                    assigned[name] = {"ref": name, "value": value, "index": draw(st.sampled_from([0, 0, 1]))}
                destination["assignments"] = list(assigned.values())
    written["variables"] += [variable(f"data_{event}") for event in events]
    return written


def _is_synchronised(action: str, syncs: list[list[str | None]]) -> bool:
    return any(action in row for row in syncs)


def _buffer(event: str) -> Json:
    return automaton(
        f"buffer_{event}",
        "waiting received",
        [
            edge("waiting", "received", action=f"send_{event}"),
            edge("received", "waiting", action=f"get_{event}"),
        ],
    )


@st.composite
def _machine(draw: st.DrawFn, number: int, events: list[str], *, has_faults: bool) -> Json:
    locations = ["l", "m", "n", "o"][: draw(st.integers(2, 4))]
    own = f"own{number}"
    actions = [None, None, None, *(f"{verb}_{event}" for verb in ("send", "get") for event in events)]
    edges = []
    for source, following in zip(locations, locations[1:] + locations[:1], strict=True):
        for target in (following, *draw(st.lists(st.sampled_from(locations), max_size=1))):
            destinations = []
            for share in draw(st.sampled_from([(None,), (None,), (0.25, 0.75)])):
                assigned: dict[str, Any] = {}
                if draw(st.integers(0, 2)) == 0:
                    assigned[own] = op("%", op("+", own, 1), draw(st.integers(2, 3)))
                if draw(st.integers(0, 4)) == 0:
                    assigned[draw(st.sampled_from(SHARED))] = draw(st.sampled_from([1, 2, own, *SHARED]))
                if has_faults and draw(st.integers(0, 5)) == 0:
                    assigned[own] = op("%", 1, op("-", own, draw(st.sampled_from([1, "x"]))))
                destinations.append(
                    way(target if share is None else draw(st.sampled_from(locations)), share, **assigned)
                )
            guards = [None, None, None, op("<", own, 2), op("=", "x", 1), op("≠", own, "y")]
            guard = draw(st.sampled_from(guards))
            if has_faults and draw(st.integers(0, 7)) == 0:
                guard = op("=", op("%", 4, op("-", "x", 1)), 0)
            edges.append(edge(source, *destinations, action=draw(st.sampled_from(actions)), guard=guard))
    return automaton(f"m{number}", " ".join(locations), edges, [variable(own)])


@st.kept
def _properties() -> st.SearchStrategy[Json]:
    condition = st.builds(op, st.sampled_from(["=", ">"]), st.sampled_from(SHARED), st.sampled_from([1, 1, 2]))
    limit = st.builds(op, st.sampled_from(["≠", "<"]), st.sampled_from(SHARED), st.sampled_from([1, 2, 2]))
    reached = st.builds(lambda c: op("F", c), condition)
    kept = st.builds(lambda c: op("G", c), limit)
    until = st.builds(lambda a, b: op("U", a, b), limit, condition)
    deadlock = st.sampled_from([op("F", {"op": "deadlock"}), op("G", op("¬", {"op": "deadlock"}))])
    mixed = st.builds(lambda c: op("F", op("∧", {"op": "deadlock"}, c)), condition)
    lasting = st.builds(lambda c: op("F", op("G", c)), condition | limit)
    several = st.builds(op, st.sampled_from(["∧", "∨"]), reached, kept | reached)
    path = st.one_of(reached, reached, kept, until, deadlock, mixed, lasting, several)
    return st.builds(probability, path, st.sampled_from(["Pmin", "Pmax"]))
