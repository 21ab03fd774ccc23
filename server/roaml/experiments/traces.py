# SPDX-License-Identifier: Apache-2.0
"""What curves read from traces: when and how each trace ends, and the values of a variable over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roaml.record import Record
from roaml.smc.affordable import Affordable, affordable
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.record import Recorder, Recording
from roaml.smc.run import Options
from roaml.suggest import close_names, did_you_mean

NANOSECONDS = 1e-9
LEAST_TRACES = 100
"""The number of traces that are generated even if they have more than `affordable.MAX_STEPS` steps together."""


class TraceEnd(NamedTuple):
    """The end of a trace: the verdict (TRUE, FALSE, or UNKNOWN if it was cut), the time in s or the number of steps,
    and the reward."""

    verdict: int
    time: float
    reward: float


class Trajectories(Record, frozen=True):
    """The traces of a property; see `trajectories`."""

    checker: ModelChecker
    recorder: Recorder
    clock: tuple[Storage, ...]

    def affordable(self, wanted: int, max_steps: int | None = None) -> Affordable:
        """How many traces are generated if nobody has asked for a number.

        Args:
            wanted: the number if traces are short.
            max_steps: the number of steps of all traces together; `None` for that of `affordable`.
        """
        return affordable(wanted, LEAST_TRACES, self._length, max_steps)

    def _length(self, trace: int) -> int:
        """The number of steps of a trace, also of one that fails."""
        self.recorder.rush(Recording(trace))
        return self.recorder.steps_and_reward()[0]

    def ends(self, count: int) -> Iterator[TraceEnd]:
        """The ends of the first traces.

        Raises:
            FaultError: a trace executes an undefined operation.
        """
        for trace in range(count):
            recording = Recording(trace)
            self.recorder.rush(recording)
            self._check(recording)
            steps, reward = self.recorder.steps_and_reward()
            clock = [float(value) for value in self.recorder.values(self.clock) if not isinstance(value, list)]
            yield TraceEnd(recording.verdict, self._time(clock, steps), reward)

    def values(self, variable: Storage, count: int) -> Iterator[tuple[list[tuple[float, float]], bool]]:
        """For each of the first traces: the times at which the variable changes, with its values, ascending, and a last
        entry for the end; and whether the trace was cut.

        Raises:
            FaultError: a trace executes an undefined operation.
        """
        for trace in range(count):
            recording = Recording(trace)
            path: list[tuple[float, float]] = []
            time = 0.0
            for steps, (value, *clock) in enumerate(self.recorder.follow(recording, (variable, *self.clock))):
                time = self._time(clock, steps)
                if path and path[-1][0] == time:
                    path[-1] = (time, value)
                elif not path or path[-1][1] != value:
                    path.append((time, value))
            self._check(recording)
            if path[-1][0] < time:
                path.append((time, path[-1][1]))
            yield path, recording.end is End.CUT

    def _time(self, clock: Sequence[float], steps: int) -> float:
        return clock[0] + clock[1] * NANOSECONDS if self.clock else float(steps)

    def _check(self, recording: Recording) -> None:
        if recording.problem is not None:
            raise self.checker.fault(recording.problem)


def trajectories(
    checker: ModelChecker, property_: CompiledProperty, options: Options, clock: tuple[str, str] | None
) -> Trajectories:
    """The traces of a property with uniform choices.

    Args:
        clock: the variables with the seconds and nanoseconds of the time; `None` to count steps.
    """
    recorder = Recorder(checker, property_, options.seed, options.max_steps)
    shared = {storage.name: storage for storage in recorder.shared}
    return Trajectories(checker, recorder, tuple(shared[name] for name in clock or ()))


def variable_named(checker: ModelChecker, name: str) -> Storage:
    """The scalar variable with a name: `Machine.variable`, or the name of a variable of the model. The members of a
    struct are `Machine.variable.member`.

    Raises:
        ValueError: there is no such variable, or it is an array.
    """
    layout = checker.legend.layout
    known = {storage.name: storage for storage in layout.shared}
    for instance in layout.instances:
        for storage in instance.own:
            known[f"{instance.automaton.name}.{storage.name.replace('__', '.')}"] = storage
    if name not in known:
        raise ValueError(f"there is no variable `{name}`{did_you_mean(close_names(name, known))}")
    storage = known[name]
    if storage.shape:
        raise ValueError(f"`{name}` is an array; only a single number can be drawn over time")
    return storage
