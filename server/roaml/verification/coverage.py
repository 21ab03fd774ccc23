# SPDX-License-Identifier: Apache-2.0
"""What the traces of results execute: transitions, states, and nodes of the tree with the statuses that they return.

The first traces of each result are read, equally many of all results that have enough. They are simulated again, which
takes less than 2 µs of CPU time for each step. A trace that several results share, although it ends at another step for
each of them, is one trace.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Mapping
from itertools import zip_longest
from typing import NamedTuple, TypeAlias

from roaml.jani.node import Origin
from roaml.record import Record
from roaml.scxml.names import STATUS_NAMES, TreeEventKind, read_tree_event, sent_by, tree_event_name
from roaml.smc.record import Recording
from roaml.verification.results import Result, Traces

MAX_TRACES = 1000
"""The maximum number of traces of a result that are read."""
MAX_STEPS = 1_000_000
"""The maximum number of steps of all traces that are read; the first trace of each result may have more."""
STATUS = "status"
"""The parameter of the answer of a node."""


class Taken(NamedTuple):
    """A transition, or a target of a transition, at a place in the models."""

    place: Origin


class Entered(NamedTuple):
    """A location of an automaton, by their names. Some locations are states."""

    automaton: str
    location: str


class Ticked(NamedTuple):
    """A node of the tree that was ticked, by its number."""

    node: int


class Returned(NamedTuple):
    """A status that a node of the tree has returned."""

    node: int
    status: str


Covered: TypeAlias = Taken | Entered | Ticked | Returned


class Coverage(Record, frozen=True):
    """What traces execute.

    Attributes:
        traces: the number of traces that were read.
        simulated: the number of traces of the result that has most.
        counts: the number of traces that execute something; what none of them executes is missing.
    """

    traces: int
    simulated: int
    counts: Mapping[Covered, int]

    def statuses(self, node: int) -> Mapping[str, int]:
        """The statuses that a node of the tree has returned -> the number of traces in which it did."""
        names = dict.fromkeys(STATUS_NAMES.values())
        return {name: count for name in names if (count := self.counts.get(Returned(node, name), 0))}


def coverage(results: Collection[Result], checkpoint: Callable[[], None] = lambda: None) -> Coverage | None:
    """What the first traces of results of one model execute; `None` if none has traces that can be simulated again.

    Args:
        checkpoint: called after each trace; an exception that it raises ends the work.
    """
    known = [(r.traces, r.answer.tally) for r in results if r.traces is not None and r.answer is not None]
    first = [sorted(seen for kept in tally.examples.values() for seen in kept)[:MAX_TRACES] for _, tally in known]
    readers = [_Reader(traces) for traces, _ in known]
    executed: dict[tuple[int, int], set[Covered]] = {}
    steps = 0
    for row in zip_longest(*first):
        steps += sum(seen.steps for seen in row if seen is not None)
        if steps > MAX_STEPS and executed:
            break
        for reader, seen in zip(readers, row, strict=True):
            if seen is not None:
                executed.setdefault((reader.seed, seen.trace), set()).update(reader.read(seen.trace))
                checkpoint()
    if not executed:
        return None
    counts = Counter(part for parts in executed.values() for part in parts)
    return Coverage(len(executed), max(tally.simulated for _, tally in known), counts)


class _Reader:
    """Reads what traces execute."""

    def __init__(self, traces: Traces) -> None:
        self.seed = traces.options.seed
        self._recorder = traces.recorder()
        legend = self._recorder.legend
        self._automata = [instance.automaton for instance in legend.layout.instances]
        self._ways: dict[tuple[int, int], frozenset[Covered]] = {}
        registers = {storage.name: storage for storage in legend.layout.shared}
        self._events = {}
        for number, (_, action) in enumerate(legend.vectors):
            event = sent_by(action or "")
            tree = read_tree_event(event)
            # A node with conditions has an inner one, whose events have other names.
            is_outer = tree is not None and event == tree_event_name(*tree)
            if tree is not None and is_outer and tree.kind in (TreeEventKind.TICK, TreeEventKind.RESPONSE):
                self._events[number] = tree.number, registers.get(f"{event}__{STATUS}")

    def read(self, trace: int) -> set[Covered]:
        """What a trace executes."""
        ways: set[tuple[int, int]] = set()
        found: set[Covered] = {
            Entered(automaton.name, location)
            for automaton in self._automata
            for location in automaton.initial_locations
            if len(automaton.initial_locations) == 1
        }
        for vector, taken in self._recorder.taken(Recording(trace)):
            ways.update(taken)
            event = self._events.get(vector)
            if event is None:
                continue
            node, register = event
            if register is None:
                found.add(Ticked(node))
            else:
                found.add(Returned(node, STATUS_NAMES.get(self._recorder.integer(register), "")))
        return found.union(*(self._of_way(*way) for way in ways))

    def _of_way(self, instance: int, way: int) -> frozenset[Covered]:
        known = self._ways.get((instance, way))
        if known is None:
            edge, destination = self._recorder.legend.ways[way]
            origins = (origin for origin in (edge.origin, destination.origin) if origin is not None)
            known = frozenset((*map(Taken, origins), Entered(self._automata[instance].name, destination.location)))
            self._ways[instance, way] = known
        return known
