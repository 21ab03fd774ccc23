# SPDX-License-Identifier: Apache-2.0
"""What the traces of results execute."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from roaml import api
from roaml.smc.record import TraceStep
from roaml.verification.coverage import Covered, Entered, Taken, Ticked, coverage

ROBOT = Path(__file__).parents[2] / "examples" / "assembly_robot" / "main_with_bug.xml"
OPTIONS = api.Options(epsilon=0.2)


def executed(steps: Iterator[TraceStep]) -> set[Covered]:
    """The transitions, locations and ticks in recorded steps."""
    found: set[Covered] = set()
    for step in steps:
        if step.action is not None and step.action.startswith("bt_") and step.action.endswith("_tick_on_send"):
            found.add(Ticked(int(step.action.split("_")[1])))
        for part in step.parts:
            found.add(Entered(part.automaton, part.destination.location))
            found |= {Taken(place) for place in (part.edge.origin, part.destination.origin) if place is not None}
    return found


def test_the_counts_are_those_of_the_recorded_steps() -> None:
    (result,) = api.verify(api.target(str(ROBOT)), ["block_placed"], OPTIONS)
    read = coverage([result])
    assert read is not None
    assert result.traces is not None
    assert 1 < read.traces <= read.simulated
    first: set[Covered] = {
        Entered(automaton.name, location)
        for automaton in result.traces.recorder().automata
        for location in automaton.initial_locations
    }
    expected = Counter(part for trace in range(read.traces) for part in first | executed(result.traces.steps(trace)))
    assert {part: read.counts[part] for part in expected} == expected
    never_taken = {part for part in read.counts if isinstance(part, (Taken, Ticked))} - expected.keys()
    assert not never_taken


def test_properties_share_their_traces() -> None:
    results = list(api.verify(api.target(str(ROBOT)), options=OPTIONS))
    alone = [coverage([result]) for result in results]
    together = coverage(results)
    assert together is not None
    assert together.traces == max(read.traces for read in alone if read is not None)
    # The nodes have only the statuses that they return in this system.
    assert set(together.statuses(1005)) == {"SUCCESS"}
    assert set(together.statuses(1006)) == {"SUCCESS", "RUNNING"}
    assert coverage([]) is None
