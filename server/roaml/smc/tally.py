# SPDX-License-Identifier: Apache-2.0
"""The results of traces in a few numbers, for a batch or for all traces so far."""

from __future__ import annotations

from typing import NamedTuple

from roaml.record import Record, field
from roaml.smc.end import End
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.statistics import Mean

REJECTED = 4
"""The verdict on a trace that violates the assumptions of a question."""
MAX_KEPT_TRACES = 1000
"""The maximum number of stored trace numbers for each verdict."""


class StoredTrace(NamedTuple):
    """A stored trace: its number, and the number of its steps."""

    trace: int
    steps: int


class Ended(Record):
    """The traces that have ended for one reason: their number, and the shortest one."""

    count: int
    shortest: StoredTrace


class Tally(Record):
    """The results of the traces so far. They are sufficient to continue.

    Attributes:
        traces: the number of traces; for a question with assumptions, only the accepted ones.
        steps: the number of steps of all traces.
        rejected: the number of traces that violate the assumptions.
        closed, idle: the numbers of traces with these activities; see `goal.Activity`.
        late: the number of traces that failed because the time ended before an event that the property requires.
        mean: the mean of the rewards, for a question about rewards.
        accepted: the decision of the sequential test: whether the value meets the threshold; `None` if undecided.
        is_finished: whether no further traces are needed.
        is_revised: whether the options were changed after results were known: then the number of traces depends on
            earlier results.
        examples: for each verdict, the first traces; shortest: for each verdict, the shortest trace.
        ends: reason -> the traces that have ended for it.
    """

    traces: int = 0
    successes: int = 0
    undecided: int = 0
    steps: int = 0
    rejected: int = 0
    closed: int = 0
    idle: int = 0
    late: int = 0
    mean: Mean = field(default_factory=Mean)
    accepted: bool | None = None
    is_finished: bool = False
    is_revised: bool = False
    examples: dict[int, list[StoredTrace]] = field(default_factory=lambda: {FALSE: [], TRUE: [], UNKNOWN: []})
    shortest: dict[int, StoredTrace] = field(default_factory=dict)
    ends: dict[End, Ended] = field(default_factory=dict)

    @property
    def simulated(self) -> int:
        """The number of all traces, rejected or not."""
        return self.traces + self.rejected

    def ended(self, *reasons: End) -> int:
        """The number of traces that have ended for one of these reasons."""
        return sum(self.ends[reason].count for reason in reasons if reason in self.ends)

    def room(self) -> tuple[int, int, int]:
        """The number of traces that can still be stored as examples for the verdicts FALSE, TRUE and UNKNOWN."""
        stored = self.examples
        false, true, unknown = (MAX_KEPT_TRACES - len(stored[verdict]) for verdict in (FALSE, TRUE, UNKNOWN))
        return false, true, unknown

    def add(self, later: Tally) -> None:
        """Add the results of traces whose numbers are greater. The decision of a test is not changed."""
        self.traces += later.traces
        self.successes += later.successes
        self.undecided += later.undecided
        self.steps += later.steps
        self.rejected += later.rejected
        self.closed += later.closed
        self.idle += later.idle
        self.late += later.late
        self.mean = self.mean.joined(later.mean)
        for verdict, room in zip((FALSE, TRUE, UNKNOWN), self.room(), strict=True):
            self.examples[verdict] += later.examples[verdict][:room]
        for verdict, trace in later.shortest.items():
            if verdict not in self.shortest or trace.steps < self.shortest[verdict].steps:
                self.shortest[verdict] = trace
        for reason, ended in later.ends.items():
            known = self.ends.get(reason)
            if known is None:
                self.ends[reason] = Ended(ended.count, ended.shortest)
                continue
            known.count += ended.count
            if ended.shortest.steps < known.shortest.steps:
                known.shortest = ended.shortest

    def to_json(self) -> dict[str, object]:
        """The tally as a value for JSON."""
        return {
            "traces": self.traces,
            "successes": self.successes,
            "undecided": self.undecided,
            "steps": self.steps,
            "rejected": self.rejected,
            "closed": self.closed,
            "idle": self.idle,
            "late": self.late,
            "mean": [self.mean.number, *(number.hex() for number in self.mean[1:])],
            "accepted": self.accepted,
            "finished": self.is_finished,
            "revised": self.is_revised,
            "examples": {str(verdict): seen for verdict, seen in self.examples.items()},
            "shortest": {str(verdict): seen for verdict, seen in self.shortest.items()},
            "ends": {end.name.lower(): [ended.count, *ended.shortest] for end, ended in self.ends.items()},
        }

    @staticmethod
    def from_json(value: dict) -> Tally:  # type: ignore[type-arg]
        """The inverse of `to_json`.

        Raises:
            KeyError, TypeError, ValueError, AttributeError: the value was not written by `to_json`.
        """
        count, *moments = value["mean"]
        mean, squares, least, greatest = map(float.fromhex, moments)
        return Tally(
            traces=int(value["traces"]),
            successes=int(value["successes"]),
            undecided=int(value["undecided"]),
            steps=int(value["steps"]),
            rejected=int(value["rejected"]),
            closed=int(value["closed"]),
            idle=int(value["idle"]),
            late=int(value["late"]),
            mean=Mean(int(count), mean, squares, least, greatest),
            accepted=value["accepted"],
            is_finished=bool(value["finished"]),
            is_revised=bool(value["revised"]),
            examples={int(v): [StoredTrace(*example) for example in seen] for v, seen in value["examples"].items()},
            shortest={int(v): StoredTrace(*example) for v, example in value["shortest"].items()},
            ends={
                End[name.upper()]: Ended(int(count), StoredTrace(int(trace), int(steps)))
                for name, (count, trace, steps) in value["ends"].items()
            },
        )
