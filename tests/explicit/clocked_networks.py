# SPDX-License-Identifier: Apache-2.0
"""Random networks with a clock, which waits for some of the buffers of events, and with the metadata that name it."""

from __future__ import annotations

import json

from loose_networks import networks
from smc_models import Json, automaton, edge, op, probability, variable, way

import kept_strategies as st
from roaml.durations import ANY_TIME
from roaml.jani.expressions import Name, walk
from roaml.jani.model import Clock, Metadata, Model
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.record import replace

STEP = 10**9
"""The length of a step of the clock in ns."""


@st.composite
def clocked(draw: st.DrawFn) -> Model:
    """A network of `loose_networks` with a clock of up to three steps. Its property asks whether a variable reaches a
    value before the time is over."""
    text = json.dumps(draw(networks()))
    for event in ("e", "f"):
        text = text.replace(f"send_{event}", f"{event}_on_send").replace(f"get_{event}", f"{event}_on_receive")
        text = text.replace(f"buffer_{event}", event)
    written: Json = json.loads(text)
    elements = written["system"]["elements"]
    buffers = [i for i, a in enumerate(written["automata"]) if len(a["locations"]) == 2 and a["name"] in ("e", "f")]
    joined = [i for i in buffers if draw(st.integers(0, 3)) > 0]
    for i in joined:
        written["automata"][i]["edges"].append(edge("waiting", "waiting", action="calm"))
    ticks = [edge("l", way("l", now=op("+", "now", 1)), action="step", guard=op("<", "now", 3))]
    written["automata"].append(automaton("clock", "l", ticks))
    written["variables"].append(variable("now"))
    elements.append({"automaton": "clock"})
    rows = written["system"].setdefault("syncs", [])
    for row in rows:
        row["synchronise"].append(None)
    row = [None] * len(elements)
    row[-1] = "step"
    for i in joined:
        row[i] = "calm"
    rows.append({"synchronise": row, "result": "step"})
    written["actions"] = [{"name": name} for name in {*(a["name"] for a in written.get("actions", ())), "calm", "step"}]
    limit = op("=", draw(st.sampled_from(["x", "y"])), draw(st.sampled_from([1, 2])))
    reached = op("∧", limit, op(draw(st.sampled_from(["<", "≥"])), "now", draw(st.sampled_from([1, 2, 3]))))
    written["properties"] = [{"name": "p", "expression": probability(op("F", reached), "Pmax")}]
    model, findings = read_model(parse(json.dumps(written))[0])
    assert not findings
    assert model is not None
    return replace(model, metadata=Metadata(clock=Clock("clock", ("step",), STEP), reaction_time=ANY_TIME))


def is_local(model: Model) -> bool:
    """Whether the guards of each automaton read only its own variables, as in translated systems."""
    names = {variable.name for variable in model.variables}
    guards = [
        edge.guard.exp for a in model.automata for edge in a.edges if edge.guard is not None and a.name != "clock"
    ]
    return names.isdisjoint(part.identifier for guard in guards for part in walk(guard) if isinstance(part, Name))
