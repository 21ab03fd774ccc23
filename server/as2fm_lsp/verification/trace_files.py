# SPDX-License-Identifier: Apache-2.0
"""Traces as files: CSV for plotting, and JSON with the places from which the steps come.

CSV has a line for each state, including the first one, and columns for its number, the time in s if the model has a
clock, the reason why the trace has ended (in its last line), and each global variable, with its name for users
(`roaml.views.shared_names`); an array has a column for each of its elements; true is 1, false 0.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence

from as2fm_lsp.outputs import OutputFiles
from roaml.jani.model import Automaton
from roaml.jani.node import Origin
from roaml.project.paths import seen_from
from roaml.regex import regex
from roaml.simulation.table import cells_of, suffixes_of
from roaml.smc.end import End
from roaml.smc.record import VERDICTS, Plain, Recorder, Recording, TraceStep, VariableChange
from roaml.smc.run import Answer
from roaml.smc.tally import StoredTrace
from roaml.verification.stuck import time_of
from roaml.verification.target import VerificationTarget
from roaml.views.actors import names_of
from roaml.views.shared_names import shared_names
from roaml.views.waiting import waits

DEFAULT_LIMIT = 10
"""The maximum number of traces of each verdict that are written, in addition to the shortest one."""
_UNSAFE = regex(r"[^\w.-]")


def write_traces(
    outputs: OutputFiles,
    folder: str,
    target: VerificationTarget,
    recorder: Recorder,
    answer: Answer,
    limit: int = DEFAULT_LIMIT,
) -> list[str]:
    """Write the first `limit` traces of each verdict, and the shortest one; return the paths of the files. With the
    limit 0, nothing is written.

    Raises:
        OSError: a file cannot be written; that file does not exist then, and earlier files are complete.
    """
    os.makedirs(folder, exist_ok=True)
    written = []
    for verdict, examples in answer.tally.examples.items():
        chosen = dict.fromkeys(seen.trace for seen in examples[:limit])
        shortest: StoredTrace | None = answer.tally.shortest.get(verdict)
        if shortest is not None and limit:
            chosen[shortest.trace] = None
        for trace in sorted(chosen):
            name = f"{_UNSAFE.sub('_', answer.question.name)}-{trace:07}-{VERDICTS[verdict]}"
            texts = {"csv": csv_lines(recorder, trace, target.clock), "json": json_lines(target, recorder, trace)}
            for extension, lines in texts.items():
                path = os.path.join(folder, f"{name}.{extension}")
                outputs.write(path, lines)
                written.append(path)
    return written


def csv_lines(recorder: Recorder, trace: int, clock: tuple[str, str] | None = None) -> Iterator[str]:
    """The lines of a CSV file with the states of a trace."""
    storages = recorder.shared
    names = [storage.name for storage in storages]
    places = None if clock is None else (names.index(clock[0]), names.index(clock[1]))

    def row(number: int, values: list[Plain], end: str = "") -> str:
        cells: list[int | float | str] = [number]
        if places is not None:
            seconds, nanoseconds = values[places[0]], values[places[1]]
            assert not isinstance(seconds, list)
            assert not isinstance(nanoseconds, list)
            cells.append(seconds + nanoseconds / 1e9)
        return csv_line([*cells, end, *(cell for value in values for cell in cells_of(value))])

    start = recorder.initial(storages, trace)
    header = ["step", *(() if places is None else ("time",)), "end"]
    shown = shared_names(names, names_of(recorder.automata))
    for name, value in zip(names, start, strict=True):
        header += (shown[name] + suffix for suffix in suffixes_of(value))
    yield csv_line(header)
    recording = Recording(trace)
    number, values = 0, start
    for step in recorder.walk(recording):
        yield row(number, values)
        number, values = step.number, recorder.values(storages)
    yield row(number, values, end_of(recording))


def json_lines(target: VerificationTarget, recorder: Recorder, trace: int) -> Iterator[str]:
    """The text of a JSON file with a trace, in parts. Each step is on one line."""
    recording = Recording(trace)
    start = dict(zip((s.name for s in recorder.shared), recorder.initial(recorder.shared, trace), strict=True))
    yield "{\n"
    name = _json(recorder.compiled_property.question.name)
    yield f' "property": {name},\n "trace": {trace},\n "seed": {recorder.seed},\n'
    shown = shared_names(start, names_of(recorder.automata))
    named = {name: text for name, text in shown.items() if text != name}
    yield f' "initial": {_json(start)},\n "names": {_json(named)},\n "steps": ['
    comma = "\n  "
    for step in recorder.walk(recording):
        yield comma + _json(step_row(target, recorder.automata, shown, step))
        comma = ",\n  "
    verdict = VERDICTS[recording.verdict].value
    yield f'\n ],\n "verdict": {_json(verdict)},\n "end": {_json(end_of(recording))}'
    if recording.end is End.STUCK:
        rows = [
            {"who": wait.who, "what": wait.what, **_place(target, wait.origin)}
            for wait in waits(recorder.standstill(), time_of(target, recorder))
        ]
        yield ',\n "waits": [' + "".join(f"\n  {_json(row)}," for row in rows).removesuffix(",") + "\n ]"
    yield "\n}\n"


def end_of(recording: Recording) -> str:
    """The reason why a recorded trace has ended, as a word for CSV and JSON: `fault` after an error in the model,
    otherwise the key of an `End`."""
    return "fault" if recording.problem is not None else recording.end.key


def step_row(
    target: VerificationTarget, automata: Sequence[Automaton], shown: Mapping[str, str], step: TraceStep
) -> dict[str, object]:
    """A step as a value for JSON. A variable has its name in JANI and, if it is another, its name for users.

    Args:
        automata: the automaton of each instance.
        shown: the names of the shared variables for users (`shared_names`).
    """
    return {
        "step": step.number,
        "action": step.action,
        "moves": [
            {
                "automaton": part.automaton,
                "from": part.source,
                "to": part.destination.location,
                "action": part.edge.action,
                **_place(target, part.edge.origin),
            }
            for part in step.parts
        ],
        "changes": [_change(change, automata, shown) for change in step.changes],
    }


def _change(change: VariableChange, automata: Sequence[Automaton], shown: Mapping[str, str]) -> dict[str, object]:
    instance, variable = change.variable
    row: dict[str, object] = {"variable": variable}
    if instance >= 0:
        row["automaton"] = automata[instance].name
    elif shown.get(variable, variable) != variable:
        row["name"] = shown[variable]
    return {**row, "value": change.after}


def _place(target: VerificationTarget, origin: Origin | None) -> dict[str, object]:
    place = target.place(origin)
    if place is None:
        return {}
    path, line, column = place
    return {"file": seen_from(path, os.path.abspath(target.path)), "line": line, "column": column}


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


class _Echo:
    """A file whose `write` returns the text."""

    def write(self, text: str) -> str:
        return text


_CSV = csv.writer(_Echo())
"""The dialect of CSV, with CR LF as line end, because the writer quotes cells that contain a character of the line
end."""


def csv_line(cells: Iterable[int | float | str]) -> str:
    """A line of a CSV file, with LF at its end."""
    line: str = _CSV.writerow(cells)
    return line.removesuffix("\r\n") + "\n"
