# SPDX-License-Identifier: Apache-2.0
"""Random JANI networks, with one to a hundred automata. Their actions may have more combinations of edges than 64 bits
can represent."""

from __future__ import annotations

import json
from collections.abc import Iterator
from random import Random
from typing import Any

Json = dict[str, Any]

ACTIONS = ("a", "b", "c")
SHARED = ("x", "y", "z")
LARGE = (1 << 63) - 1
OPERATORS = ("+", "-", "*", "%", "max", "min")
COMPARISONS = ("=", "≠", "<", "≤", ">", "≥")


class NetworkCase:
    """A case of a strategy: a random network."""

    def __init__(self, seed: int, written: Json) -> None:
        self.seed, self.written = seed, written

    def description(self) -> Iterator[str]:
        yield f"a network of {len(self.written['automata'])} automata"

    def files(self) -> dict[str, str | bytes]:
        return {"model.jani": json.dumps(self.written, indent=1, ensure_ascii=False)}


def network(random: Random) -> Json:
    """A model with one property."""
    return wide(random, random.randint(2, 80)) if random.random() < 0.2 else small(random)


# ----------------------------------------------------------------------- small


def small(random: Random) -> Json:
    """A few automata with guards, probabilities, arithmetic that may fail, partial synchronisation and edges without
    action."""
    count = random.randint(1, 5)
    automata = [_automaton(random, number) for number in range(count)]
    syncs = []
    for _ in range(random.randint(1, 6)):
        vector = [random.choice((None, *ACTIONS)) for _ in range(count)]
        if any(vector):
            syncs.append(vector)
    return _document(random, automata, syncs)


def _automaton(random: Random, number: int) -> Json:
    locations = ["l", "m", "n"][: random.randint(1, 3)]
    names = (*SHARED, f"own{number}")
    edges = []
    for _ in range(random.randint(1, 8)):
        row: Json = {"location": random.choice(locations), "destinations": _destinations(random, locations, names)}
        if random.random() < 0.8:
            row["action"] = random.choice(ACTIONS)
        if random.random() < 0.4:
            row["guard"] = {"exp": _condition(random, names)}
        edges.append(row)
    return _written(f"m{number}", locations, edges, [f"own{number}"])


def _destinations(random: Random, locations: list[str], names: tuple[str, ...]) -> list[Json]:
    count = random.choice([1, 1, 1, 2, 3])
    branches = []
    for share in {1: (1.0,), 2: (0.25, 0.75), 3: (0.5, 0.125, 0.375)}[count]:
        targets = random.sample([*names, "v"], random.randint(0, 3))
        assignments = []
        for target in targets:
            ref: Any = _cell(_number(random, names)) if target == "v" else target
            value = _number(random, names, 2)
            assignments.append({"ref": ref, "value": value, "index": random.randint(0, 1)})
        way: Json = {"location": random.choice(locations), "assignments": assignments}
        if count > 1:
            way["probability"] = {"exp": share}
        branches.append(way)
    return branches


def _number(random: Random, names: tuple[str, ...], depth: int = 1) -> Any:
    kind = random.random()
    if depth and kind < 0.5:
        left, right = (_number(random, names, depth - 1) for _ in range(2))
        return {"op": random.choice(OPERATORS), "left": left, "right": right}
    if kind < 0.8:
        return random.choice(names)
    if kind < 0.9:
        return _cell(random.choice(names))
    return random.choice([0, 1, 2, 3, -1, LARGE, -LARGE])


def _cell(index: Any) -> Json:
    # Most values are within the bounds.
    return {"op": "aa", "exp": "v", "index": {"op": "%", "left": index, "right": 3}}


def _condition(random: Random, names: tuple[str, ...]) -> Json:
    left, right = _number(random, names), _number(random, names)
    return {"op": random.choice(COMPARISONS), "left": left, "right": right}


# --------------------------------------------------------------------- bounded


def bounded(random: Random) -> Json:
    """Some automata with few states, many chances and choices. Whether the property holds is often open: there are
    locations without exit and bounds on steps."""
    count = random.randint(1, 4)
    automata = [_bounded_automaton(random, number) for number in range(count)]
    syncs = []
    for action in ACTIONS:
        vector = [action if random.random() < 0.6 else None for _ in range(count)]
        if any(vector):
            syncs.append(vector)
    document = _document(random, automata, syncs)
    number = random.randint(1, 3)
    goal: Json = {"op": "=", "left": "x", "right": number}
    never: Json = {"op": "G", "exp": {"op": "≠", "left": "x", "right": number}}
    path: Json = random.choice(({"op": "F", "exp": goal}, never, _until(_small_condition(random, SHARED), goal)))
    if random.random() < 0.5:
        path["step-bounds"] = {"upper": random.randint(3, 30)}
    if random.random() < 0.4:
        path["reward-bounds"] = [_reward_bound(random) for _ in range(random.randint(1, 2))]
    document["properties"][0]["expression"]["values"] = {"op": "Pmin", "exp": path}
    if random.random() < 0.3:
        _open(random, document)
    return document


def _open(random: Random, document: Json) -> None:
    """Let a bounded network begin in several states."""
    names = random.sample(SHARED, random.randint(1, len(SHARED)))
    for variable in document["variables"]:
        if variable["name"] in names:
            del variable["initial-value"]
            variable["type"] = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 3}
    if random.random() < 0.7:
        parts = [_small_condition(random, SHARED) for _ in range(2)]
        document["restrict-initial"] = {"exp": {"op": random.choice("∧∨"), "left": parts[0], "right": parts[1]}}
    if random.random() < 0.4:
        automaton = random.choice(document["automata"])
        automaton["initial-locations"] = random.sample("lmn", 2)


def _reward_bound(random: Random) -> Json:
    """A bound on the accumulated number of steps, or on the accumulated value of a variable."""
    bounds: Json = {}
    if random.random() < 0.7:
        bounds = {"upper": random.randint(0, 12), "upper-exclusive": random.random() < 0.3}
    if random.random() < 0.4:
        bounds |= {"lower": random.randint(0, 6), "lower-exclusive": random.random() < 0.3}
    accumulate = random.choice((["steps"], ["exit"], ["steps", "exit"]))
    return {"exp": random.choice((1, *SHARED)), "accumulate": accumulate, "bounds": bounds}


def _until(left: Json, right: Json) -> Json:
    return {"op": "U", "left": left, "right": right}


def _bounded_automaton(random: Random, number: int) -> Json:
    names = (*SHARED, f"own{number}")
    edges = []
    for location in "lm":  # nothing leads out of n
        for _ in range(random.randint(1, 4)):
            ways = []
            for share in random.choice(((1.0,), (0.25, 0.75), (0.5, 0.125, 0.375), (0.05, 0.95))):
                targets = random.sample(names, random.randint(0, 2))
                assignments = [{"ref": target, "value": _small_number(random, names)} for target in targets]
                way: Json = {"location": random.choice("llmmn"), "assignments": assignments}
                ways.append({**way, "probability": {"exp": share}})
            row: Json = {"location": location, "destinations": ways}
            if random.random() < 0.7:
                row["action"] = random.choice(ACTIONS)
            if random.random() < 0.4:
                row["guard"] = {"exp": _small_condition(random, names)}
            edges.append(row)
    return _written(f"m{number}", ["l", "m", "n"], edges, [f"own{number}"])


def _small_number(random: Random, names: tuple[str, ...]) -> Json:
    total = {"op": "+", "left": random.choice(names), "right": random.choice([*names, 1, 2])}
    return {"op": "%", "left": total, "right": random.randint(2, 4)}


def _small_condition(random: Random, names: tuple[str, ...]) -> Json:
    return {"op": random.choice(COMPARISONS), "left": random.choice(names), "right": random.randint(0, 3)}


# ------------------------------------------------------------------------ wide


def wide(random: Random, count: int) -> Json:
    """A network in which all automata take part in all actions, with up to four edges each, some with guards and
    probabilities."""
    kinds = [random.randint(1, 4) for _ in range(4)]
    automata = []
    for number in range(count):
        own = f"own{number}"
        edges = []
        for action in ACTIONS[:2]:
            for pick in range(kinds[number % len(kinds)]):
                value = {"op": "%", "left": {"op": "+", "left": own, "right": pick}, "right": 5}
                assigned = [{"ref": own, "value": value}]
                ways: list[Json] = [{"location": random.choice("st"), "assignments": assigned}]
                if pick == 1:
                    ways = [
                        {"location": "s", "assignments": assigned, "probability": {"exp": 0.25}},
                        {"location": "t", "probability": {"exp": 0.75}},
                    ]
                first: Json = {"location": "s", "action": action, "destinations": ways}
                if random.random() < 0.1:
                    first["guard"] = {"exp": {"op": "<", "left": "x", "right": pick + 2}}
                edges += [first, {"location": "t", "action": action, "destinations": ways}]
        automata.append(_written(f"m{number}", ["s", "t"], edges, [own]))
    following = {"op": "%", "left": {"op": "+", "left": "x", "right": 1}, "right": 4}
    counting: Json = {
        "location": "l",
        "destinations": [{"location": "l", "assignments": [{"ref": "x", "value": following}]}],
    }
    automata.append(_written("counts", ["l"], [counting], []))
    return _document(random, automata, [[action] * count + [None] for action in ACTIONS[:2]])


# -------------------------------------------------------------------- the text


def _written(name: str, locations: list[str], edges: list[Json], variables: list[str]) -> Json:
    return {
        "name": name,
        "locations": [{"name": location} for location in locations],
        "initial-locations": [locations[0]],
        "edges": edges,
        "variables": [{"name": variable, "type": "int", "initial-value": 0} for variable in variables],
    }


def _document(random: Random, automata: list[Json], syncs: list[list[str | None]]) -> Json:
    array: Json = {
        "name": "v",
        "type": {"kind": "array", "base": "int"},
        "initial-value": {"op": "av", "elements": [0, 1, 2]},
    }
    path: Json = {"op": random.choice("FG"), "exp": _condition(random, SHARED)}
    if random.random() < 0.3:
        path["step-bounds"] = {"upper": random.randint(0, 20)}
    if random.random() < 0.2:
        path["reward-bounds"] = [_reward_bound(random)]
    if random.random() < 0.1:
        path = {"op": "F", "exp": {"op": "deadlock"}}
    values = {"op": "Pmax", "exp": path}
    expression = {"op": "filter", "fun": "values", "values": values, "states": {"op": "initial"}}
    return {
        "jani-version": 1,
        "name": "random",
        "type": "mdp",
        "features": ["arrays", "derived-operators"],
        "actions": [{"name": name} for name in ACTIONS],
        "variables": [*({"name": name, "type": "int", "initial-value": 0} for name in SHARED), array],
        "automata": automata,
        "system": {
            "elements": [{"automaton": automaton["name"]} for automaton in automata],
            "syncs": [{"synchronise": vector} for vector in syncs],
        },
        "properties": [{"name": "p", "expression": expression}],
    }
