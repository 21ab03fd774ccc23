# SPDX-License-Identifier: Apache-2.0
"""Traces of `verify` in the debugger: the same verdict forwards, and the same states backwards.

As a program: `python tests/debug/replay.py [TRACES [NAME]]` replays so many traces (20) of each property of each
conformance system, or only of those whose path contains NAME.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import conformance
from roaml import api
from roaml.debugging.breakpoints import Breakpoint, ExceptionFilter
from roaml.debugging.debugger import Debugger, Stop, Unit
from roaml.debugging.sources import Sources
from roaml.debugging.start import Start, start
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.record import VERDICTS, Recorder, Recording

SEED = 5
MAX_SINGLE_STEPS = 600
MAX_STEPS = 100_000


def sources_of(main: Path) -> Sources:
    system = api.load(str(main), [str(conformance.INTERFACES)])
    return Sources(api.as_target(system), system.analysis)


def replay(
    sources: Sources,
    checker: ModelChecker,
    property_: CompiledProperty,
    trace: int,
    max_single: int = MAX_SINGLE_STEPS,
    max_steps: int = MAX_STEPS,
) -> Iterator[str]:
    """The differences between a trace and its replay.

    Args:
        max_single: the maximum number of steps that are taken one by one; a longer trace is continued to its verdict.
        max_steps: the maximum number of steps of the trace.
    """
    name = property_.question.name
    recording = Recording(trace)
    Recorder(checker, property_, SEED, max_steps).rush(recording)
    debugger = start(sources, Start(name, SEED, trace), lambda *_: None)
    session = debugger.session
    states = [session.state()]
    while not session.is_decided and len(states) <= max_single:
        _move(debugger, Unit.STEP)
        if session.position < len(states):
            break
        states.append(session.state())
    single = session.position
    verdict_filters = (ExceptionFilter.VIOLATED, ExceptionFilter.SATISFIED)
    debugger.breakpoints.filters = {filter_: Breakpoint() for filter_ in verdict_filters}
    debugger.breakpoints_changed()
    while recording.end is not End.CUT and not session.is_decided:
        if _move(debugger, Unit.END).filter is None:
            break
    expected = VERDICTS[recording.verdict]
    if recording.end is not End.CUT and not debugger.verdicts[name] == session.verdict == expected:
        yield f"the verdict is {session.verdict} and {debugger.verdicts[name]}, not {expected}"
    if session.position > single:
        debugger.go_to(single)
    for position in range(single - 1, -1, -1):
        _move(debugger, Unit.STEP, forwards=False)
        if session.position != position or session.state() != states[position]:
            yield f"the state after {position} steps differs"
            break


def _move(debugger: Debugger, unit: Unit, *, forwards: bool = True) -> Stop:
    debugger.begin(unit, forwards=forwards)
    while (stop := debugger.advance()) is None:
        pass
    return stop


def main(traces: int, name: str) -> int:
    replayed, differences = 0, 0
    for path in conformance.systems():
        if name not in str(path):
            continue
        started = time.perf_counter()
        sources = sources_of(path)
        checker = api.checker(sources.target.model)
        for property_ in checker.compiled_properties:
            for trace in range(traces):
                replayed += 1
                for difference in replay(sources, checker, property_, trace):
                    differences += 1
                    print(
                        f"{path.parent.name}: {property_.question.name}, trace {trace}: {difference}",
                        flush=True,
                    )
        spent = time.perf_counter() - started
        print(f"{conformance.label(path)}: {len(checker.compiled_properties)} properties, {spent:.0f} s", flush=True)
    print(f"{replayed} traces, {differences} differences")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 20, sys.argv[2] if len(sys.argv) > 2 else ""))
