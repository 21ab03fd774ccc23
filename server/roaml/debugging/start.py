# SPDX-License-Identifier: Apache-2.0
"""The run that is debugged: a trace given by its seed and number, a saved run, or the n-th trace with a verdict on a
property."""

from __future__ import annotations

from collections.abc import Callable

from roaml.debugging.debugger import Debugger, Log
from roaml.debugging.sources import Sources
from roaml.record import Record
from roaml.simulation.session import SavedSession, Session, default_property
from roaml.simulation.verdicts import Verdicts
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.record import VERDICTS, Recorder, Recording, TraceVerdict
from roaml.verification.verifier import checker_of

MAX_TRACES = 100_000
"""The maximum number of traces that are simulated to find one with a verdict."""
MAX_TRACE_STEPS = 1_000_000


class StartError(ValueError):
    """The run does not exist; the message contains the reason."""


class Start(Record, frozen=True):
    """The run that is debugged.

    Attributes:
        property: the name of the property; "" for the first one.
        nth: the number, from 1, of the trace among those with `verdict`; 0 for the trace with the number `trace`.
        verdict: `FAILED` for traces that contradict the property, `PASSED` for traces that satisfy it.
        saved: the session to continue; it overrides the other attributes.
    """

    property: str = ""
    seed: int = 0
    trace: int = 0
    nth: int = 0
    verdict: TraceVerdict = TraceVerdict.FAILED
    saved: SavedSession | None = None


Watch = Callable[[int], bool]
"""Is called during a search with the number of traces that have been simulated; returns whether the search ends."""


def start(sources: Sources, begin: Start, log: Log, watch: Watch = lambda _: False) -> Debugger:
    """A debugger at the start of a run, or at the position of the saved session.

    Raises:
        StartError: there is no such trace, or `watch` has ended the search for it.
        PropertyError: the model has no such property.
        FaultError: the model cannot be run, or the property cannot be decided.
        RunError: the saved decisions are not possible in the model.
    """
    name = begin.property if begin.saved is None else begin.saved.property
    checker = checker_of(sources.target, None)
    seed, trace = begin.seed, begin.trace
    property_ = _compiled_property(checker, sources, name) if name else default_property(checker, seed, trace)
    if begin.nth and begin.saved is None:
        recorder = Recorder(checker, property_, seed, MAX_TRACE_STEPS)
        trace = _nth(recorder, begin, property_.question.name, watch)
    session = Session(checker, property_, seed, trace, sources.target.clock, begin.saved)
    return Debugger(session, sources, Verdicts(checker, session.seed, session.trace), log)


def _compiled_property(checker: ModelChecker, sources: Sources, name: str) -> CompiledProperty:
    if name in checker.refused:
        raise checker.refused[name]
    property_ = next((property_ for property_ in checker.compiled_properties if property_.question.name == name), None)
    if property_ is not None:
        return property_
    checker_of(sources.target, [name])  # raises an error if there is no such property
    return checker.stuck


def _nth(recorder: Recorder, begin: Start, name: str, watch: Watch) -> int:
    relation = "violate" if begin.verdict is TraceVerdict.FAILED else "satisfy"
    missing = begin.nth
    for trace in range(MAX_TRACES):
        recording = Recording(trace)
        recorder.rush(recording)
        missing -= VERDICTS[recording.verdict] is begin.verdict
        if missing == 0:
            return trace
        if watch(trace + 1):
            counted = f"{begin.nth - missing} of {trace + 1:,} traces {relation} `{name}`"
            raise StartError(f"the search for a trace was cancelled: {counted}")
    count = begin.nth - missing
    counted = f"only {count} of {MAX_TRACES:,} traces with seed {begin.seed} {relation} `{name}`"
    raise StartError(f"{counted}, but trace {begin.nth} of these is requested; use another seed")
