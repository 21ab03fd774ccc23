# SPDX-License-Identifier: Apache-2.0
"""Random networks in which messages are sent and received while timers and a clock wait for empty buffers.

In most of them, a message and a tick that waits for its buffer are possible in the same state. Each has up to two
obstacles, which make it harder to leave choices out.
"""

from __future__ import annotations

import json
from typing import Any

from clocked_networks import STEP
from loose_networks import SHARED
from smc_models import Json, automaton, edge, op, probability, variable, way

import kept_strategies as st
from roaml.durations import ANY_TIME
from roaml.jani.model import Clock, Metadata, Model
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.record import replace
from roaml.smc.end import End

MARKS = {("m1", "m"): End.STUCK, ("m2", "m"): End.STUCK}
"""The locations in which machines are stuck if nothing is possible."""
OBSTACLES = (
    "several senders",
    "several receivers",
    "ticks that send",
    "tests of full buffers",
    "tests of machines",
    "conditions of tests",
    "buffers that write",
    "buffers for two messages",
    "choices between edges",
    "choices between steps",
    "chance",
    "conditions on shared variables",
    "conditions on data",
    "visible sends",
    "visible receipts",
    "ticks that write data",
    "machines without rest",
    "receivers that send",
    "late receivers",
)

Row = dict[str, str]
"""The actions of a synchronisation vector, by the names of the automata."""


@st.composite
def messaging(draw: st.DrawFn) -> Model:
    """A model with one property."""
    return _Network(draw).model()


class _Network:
    def __init__(self, draw: st.DrawFn) -> None:
        self.draw = draw
        self.obstacles = draw(st.lists(st.sampled_from(OBSTACLES), max_size=draw(st.sampled_from([0, 1, 2, 2]))))
        self.events = ["e", "f", "g"][: draw(st.sampled_from([1, 1, 2, 2, 3]))]
        self.names = [f"m{number}" for number in range(draw(st.sampled_from([2, 2, 3])))]
        self.rows: list[Row] = []
        self.sends: dict[str, list[str]] = {name: [] for name in self.names}
        self.gets: dict[str, list[str]] = {name: [] for name in self.names}
        for event in self.events:
            sender = draw(st.sampled_from([self.names[0], *self.names[:-1]]))
            receivers = [name for name in self.names if name > sender]
            self._add("send", event, sender, self.names if self._has("several senders", 2) else [])
            receiver = draw(st.sampled_from(receivers))
            self._add("receive", event, receiver, self.names if self._has("several receivers", 2) else [])

    def _has(self, obstacle: str, one_in: int = 3) -> bool:
        """Whether there is an obstacle at a place at which the network may have it."""
        return obstacle in self.obstacles and self.draw(st.integers(1, one_in)) == 1

    def _one_in(self, number: int) -> bool:
        return self.draw(st.integers(1, number)) == 1

    def _one_of(self, values: Any) -> Any:
        return self.draw(st.sampled_from(list(values)))

    def _add(self, verb: str, event: str, usual: str, others: list[str]) -> None:
        for name in sorted({usual, *others[: self.draw(st.integers(0, 3))]}):
            (self.sends if verb == "send" else self.gets)[name].append(event)
            self.rows.append({name: f"{event}_on_{verb}", event: f"{event}_on_{verb}"})

    def model(self) -> Model:
        machines = [self._machine(name) for name in self.names]
        timers = [self._timer(number) for number in range(self.draw(st.integers(1, 2)))]
        self._test_machines(machines, timers)
        later = edge(
            "l", way("l", now=op("+", "now", 1)), action="step", guard=op("<", "now", self.draw(st.integers(1, 2)))
        )
        self.rows.append({"clock": "step", **{event: "calm" for event in self.events if not self._one_in(6)}})
        automata = [*machines, *map(self._buffer, self.events), *timers, automaton("clock", "l", [later])]
        actions = {(a["name"], e.get("action")) for a in automata for e in a["edges"]}
        rows = [row for row in self.rows if actions.issuperset(row.items())]
        for a in automata:
            used = {row[a["name"]] for row in rows if a["name"] in row}
            a["edges"] = [e for e in a["edges"] if e.get("action") is None or e["action"] in used]
        syncs: list[Json] = [{"synchronise": [row.get(a["name"]) for a in automata]} for row in rows]
        for written, row in zip(syncs, rows, strict=True):
            if "clock" in row:
                written["result"] = "step"
        value = {
            "jani-version": 1,
            "name": "test",
            "type": "mdp",
            "features": ["derived-operators"],
            "actions": [{"name": name} for name in sorted({action for row in rows for action in row.values()})],
            "variables": [variable(name) for name in (*SHARED, "now", *(f"data_{event}" for event in self.events))],
            "automata": automata,
            "system": {"elements": [{"automaton": a["name"]} for a in automata], "syncs": syncs},
            "properties": [{"name": "p", "expression": self._property()}],
        }
        model, findings = read_model(parse(json.dumps(value))[0])
        assert not findings, [finding.message for finding in findings]
        assert model is not None
        return replace(model, metadata=Metadata(clock=Clock("clock", ("step",), STEP), reaction_time=ANY_TIME))

    def _buffer(self, event: str) -> Json:
        send, receive = f"{event}_on_send", f"{event}_on_receive"
        written = {self._one_of(SHARED): 1} if self._has("buffers that write") else {}
        guard = op("<", self._one_of([*SHARED, f"data_{event}"]), 1) if self._has("conditions of tests", 2) else None
        edges = [edge("w", way("r", **written), action=send), edge("w", "w", action="calm", guard=guard)]
        if self._has("tests of full buffers", 2):
            edges.append(edge("r", "r", action="calm"))
            if self._one_in(2):
                edges.pop(1)
        edges.append(edge("r", "w", action=receive))
        locations = "w r"
        if self._has("buffers for two messages", 2):
            locations = "w r s"
            edges += [edge("r", "s", action=send), edge("s", self._one_of("rw"), action=receive)]
        return automaton(event, locations, edges)

    def _machine(self, name: str) -> Json:
        """A machine that waits for events, or sends some and comes to an end."""
        own, sends, gets = f"own_{name}", self.sends[name], self.gets[name]
        locations = self._one_of(["lm", "lmn", "lmn"])
        edges: list[Json] = []
        works = locations[:-1] if not gets else ""
        if gets and sends:
            works = self._one_of(locations)
        if gets and self._has("late receivers"):
            works = "l"
        for number, source in enumerate(locations):
            following = (locations * 2)[number + 1]
            waits = source not in works
            if source in works or (not gets and self._has("machines without rest", 2)):
                edges.append(self._step(source, following, sends, own))
                if self._has("choices between steps"):
                    edges.append(self._step(source, self._one_of(locations), sends, own))
            if waits and sends and self._has("receivers that send"):
                edges.append(self._step(source, self._one_of(locations), sends, own))
            for event in gets if waits else ():
                edges.append(self._receipt(source, locations, event, own))
                if self._has("choices between edges"):
                    edges.append(self._receipt(source, locations, event, own))
        return automaton(name, " ".join(locations), edges, [variable(own)])

    def _step(self, source: str, target: str, sends: list[str], own: str) -> Json:
        """An edge that sends an event, or rarely none."""
        event = self._one_of(sends) if sends and not self._one_in(12) else None
        assigned: dict[str, Any] = {}
        if event is not None and self._one_in(2):
            assigned[f"data_{event}"] = self._one_of([1, own, op("-", 1, own)])
        if self._one_in(4):
            assigned[own] = op("-", 1, own)
        if (event is None and self._one_in(2)) or self._has("visible sends"):
            assigned[self._one_of(SHARED)] = self._one_of([1, own, op("-", 1, own)])
        targets = [way(target, **assigned)]
        if self._has("chance"):
            targets = [way(target, 0.25, **assigned), way(source, 0.75)]
        return edge(source, *targets, action=event and f"{event}_on_send", guard=self._condition(own, event))

    def _receipt(self, source: str, locations: str, event: str, own: str) -> Json:
        assigned: dict[str, Any] = {}
        if self._one_in(2):
            assigned[own] = self._one_of([f"data_{event}", op("-", 1, own)])
        if self._has("visible receipts", 2):
            assigned[self._one_of(SHARED)] = self._one_of([1, own, f"data_{event}"])
        targets = [way(self._one_of(locations), **assigned)]
        if self._has("chance"):
            targets = [way(self._one_of(locations), 0.5), way(self._one_of(locations), 0.5, **assigned)]
        return edge(source, *targets, action=f"{event}_on_receive", guard=self._condition(own, event))

    def _condition(self, own: str, event: str | None) -> Json | None:
        names = [own]
        if self._has("conditions on shared variables"):
            names = [*SHARED, "now"]
        elif event is not None and self._has("conditions on data"):
            names = [f"data_{event}"]
        elif not self._one_in(8):
            return None
        return op(self._one_of("=<"), self._one_of(names), 1)

    def _timer(self, number: int) -> Json:
        """A timer whose ticks wait for most buffers."""
        name, tick = f"t{number}", f"tick{number}"
        row: Row = {name: tick}
        for event in self.events:
            if not self._one_in(6):
                row[event] = "calm" if not self._has("ticks that send", 2) else f"{event}_on_send"
        self.rows.append(row)
        assigned: dict[str, Any] = {}
        for shared in SHARED:
            if not self._one_in(4):
                assigned[shared] = self._one_of([0, 1, "now", *SHARED])
        if self._has("ticks that write data", 2):
            assigned[f"data_{self._one_of(self.events)}"] = self._one_of([1, "now"])
        ticks = f"ticks{number}"
        guard = op("<", ticks, self.draw(st.integers(1, 3)))
        if self._one_in(4):
            guard = op("∧", guard, op("≤", ticks, "now"))
        tick_edge = edge("l", way("l", **assigned, **{ticks: op("+", ticks, 1)}), action=tick, guard=guard)
        return automaton(name, "l", [tick_edge], [variable(ticks)])

    def _test_machines(self, machines: list[Json], timers: list[Json]) -> None:
        """Let ticks wait until a machine is in a certain location."""
        for timer in timers:
            if self._has("tests of machines", 1):
                machine = self._one_of(machines)
                place = self._one_of(machine["locations"])["name"]
                guard = op("<", self._one_of(SHARED), 1) if self._one_in(3) else None
                machine["edges"].append(edge(place, place, action="probe", guard=guard))
                next(row for row in self.rows if timer["name"] in row)[machine["name"]] = "probe"

    def _property(self) -> Json:
        """F, G, U, W, R and their combinations, also with the time and with deadlocks. They are undecided at first."""
        reached, kept = op("=", self._one_of(SHARED), 1), op("≠", self._one_of(SHARED), 1)
        late = op("=", "now", self.draw(st.integers(1, 2)))
        goal = self._one_of([reached, reached, op("∧", reached, op("¬", late)), op("∧", reached, late)])
        side, dead = self._one_of([reached, kept]), {"op": "deadlock"}
        paths = [
            op("F", goal),
            op("F", goal),
            op("G", op("∨", kept, late)),
            op("U", kept, goal),
            op("U", op("¬", late), goal),
            op("W", kept, goal),
            op("R", goal, kept),
            op("F", dead),
            op("G", op("¬", dead)),
            op("F", op("G", side)),
            op("G", op("F", side)),
            op("∨", op("G", kept), op("F", goal)),
            op("∧", op("F", goal), op("U", kept, late)),
        ]
        return probability(self._one_of(paths), self._one_of(["Pmin", "Pmax"]))
