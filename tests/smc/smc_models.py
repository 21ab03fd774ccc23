# SPDX-License-Identifier: Apache-2.0
"""Small JANI models for tests of the model checker, and the kernel as plain Python."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from roaml.jani.model import Model
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.run import Answer, EstimationMethod, Options

Json = dict[str, Any]


def op(symbol: str, *operands: Any) -> Json:
    """An operator with one or two operands."""
    keys = ("exp",) if len(operands) == 1 else ("left", "right")
    return {"op": symbol, **dict(zip(keys, operands, strict=True))}


def at(array: Any, index: Any) -> Json:
    return {"op": "aa", "exp": array, "index": index}


def edge(source: str, *ways: Json | str, action: str | None = None, guard: Any = None) -> Json:
    """An edge. A destination is written as its target or made by `way`."""
    row: Json = {"location": source, "destinations": [w if isinstance(w, dict) else {"location": w} for w in ways]}
    if action is not None:
        row["action"] = action
    if guard is not None:
        row["guard"] = {"exp": guard}
    return row


def way(target: str, probability: Any = None, **assigned: Any) -> Json:
    """A destination; `name=value` are assignments of index 0."""
    return ways(target, [(name, value, 0) for name, value in assigned.items()], probability)


def ways(target: str, assignments: Sequence[tuple[Any, Any, int]], probability: Any = None) -> Json:
    """Destinations, with their assignments as target, value and index."""
    row: Json = {"location": target}
    row["assignments"] = [{"ref": ref, "value": value, "index": index} for ref, value, index in assignments]
    if probability is not None:
        row["probability"] = {"exp": probability}
    return row


def variable(name: str, type_: Any = "int", initial: Any = 0, transient: bool = False) -> Json:
    return {"name": name, "type": type_, "initial-value": initial, "transient": transient}


def automaton(name: str, locations: str, edges: Sequence[Json], variables: Sequence[Json] = ()) -> Json:
    """Locations are separated by spaces; the first one is the initial one."""
    places = locations.split()
    return {
        "name": name,
        "locations": [{"name": place} for place in places],
        "initial-locations": [places[0]],
        "edges": list(edges),
        "variables": list(variables),
    }


def probability(path: Json, operator: str = "Pmin") -> Json:
    value = {"op": operator, "exp": path}
    return {"op": "filter", "fun": "values", "values": value, "states": {"op": "initial"}}


def document(
    *automata: Json,
    variables: Sequence[Json] = (),
    syncs: Sequence[Sequence[str | None]] | None = None,
    type_: str = "mdp",
    properties: dict[str, Json] | None = None,
    **more: Any,
) -> Json:
    """A model. Each vector of `syncs` lists the actions of all automata."""
    named = {e["action"] for a in automata for e in a["edges"] if "action" in e}
    actions = sorted(named | {action for vector in syncs or () for action in vector if action is not None})
    system: Json = {"elements": [{"automaton": a["name"]} for a in automata]}
    if syncs is not None:
        system["syncs"] = [{"synchronise": list(vector)} for vector in syncs]
    listed = [{"name": name, "expression": expression} for name, expression in (properties or {}).items()]
    return {
        "jani-version": 1,
        "name": "test",
        "type": type_,
        "features": ["arrays", "derived-operators", "functions", "trigonometric-functions"],
        "actions": [{"name": name} for name in actions],
        "variables": list(variables),
        "automata": list(automata),
        "system": system,
        "properties": listed,
        **more,
    }


def model(written: Json) -> Model:
    """The model, which must have no errors."""
    value, syntax = parse(json.dumps(written))
    read, findings = read_model(value, "test.jani")
    assert (syntax, [f.message for f in findings]) == ((), [])
    assert read is not None
    return read


def answers(written: Json, traces: int = 1, max_steps: int = 10_000, seed: int = 1) -> dict[str, Answer]:
    """Property -> its answer from a given number of traces."""
    checker = ModelChecker(model(written))
    options = Options(method=EstimationMethod.FIXED, max_traces=traces, max_steps=max_steps, seed=seed)
    with Pool() as pool:
        return {
            property_.question.name: checker.answer(property_, options, pool)
            for property_ in checker.compiled_properties
        }
