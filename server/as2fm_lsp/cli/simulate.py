# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp simulate MAIN.xml|MODEL.jani`: shows one run, as a whole or interactively on a terminal."""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.check import CLEAN, FOUND, USAGE, takes_color
from as2fm_lsp.cli.formats import FORMATS, CheckReport
from as2fm_lsp.cli.formats.report import entry, shown_path
from as2fm_lsp.cli.numbers import natural, positive
from as2fm_lsp.cli.output import complain, flush, print_text
from as2fm_lsp.cli.times import time_of
from roaml import api
from roaml.model.system_file import Overrides
from roaml.project.configuration import find_settings
from roaml.project.settings import ament_prefixes
from roaml.simulation import RunError, SavedSession, Session, SystemState
from roaml.smc.fault import FaultError
from roaml.text import Location
from roaml.verification.target import VerificationTarget

EXAMPLES = """\
examples:
  as2fm-lsp simulate main.xml                         one run until the first property is decided, as a story
  as2fm-lsp simulate main.xml --seed 7 --for "10 s"   the first 10 s of another run
  as2fm-lsp simulate main.xml --until /arm/command    until a message is sent on this topic
  as2fm-lsp simulate main.xml --property dropped --trace 4 --html run.html
  as2fm-lsp simulate main.xml --interactive           choose on the terminal what happens next, and go back
  as2fm-lsp simulate main.xml --script run.json       the run that --save wrote

The run of seed N and trace M is trace M of `verify --seed N`. A run with a step chosen by hand is not a trace of
`verify`.

exit status: 0 success; 1 the model has errors, or the run fails; 2 usage error; 3 internal error
"""


class UsageError(ValueError):
    """Invalid arguments; the message contains the reason."""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    try:
        return _run(options)
    except (UsageError, RunError, api.ConstantError, api.PathError, api.PropertyError) as error:
        complain(str(error))
        return USAGE
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            raise
        complain(f"{shown_path(str(error.filename or options.main))}: {error.strerror or error}")
        return USAGE


def _run(options: argparse.Namespace) -> int:
    settings, problems = find_settings(os.path.abspath(options.main))
    if problems:
        raise UsageError(problems[0])
    if options.constant and not options.main.endswith(".jani"):
        raise UsageError("--constant needs a JANI model; a system has no constants")
    if options.max_time is not None and options.main.endswith(".jani"):
        raise UsageError("--max-time needs a system; a JANI model has no such parameter")
    settings = replace(settings, ament_prefixes=ament_prefixes())
    overrides = Overrides(options.max_time, None)
    try:
        target = api.target(options.main, options.ros_path, settings, None, overrides, options.constant)
        session = _session(options, target)
        if options.interactive:
            from as2fm_lsp.cli.interactive import Terminal  # noqa: PLC0415

            Terminal(session, target).run(sys.stdin)
        else:
            _advance(options, session, target)
    except api.ModelError as error:
        result = error.result
        entries = [entry(diagnostic, result.source, shown_path) for diagnostic in result.diagnostics]
        report = CheckReport(entries, len(result.files), color=takes_color(sys.stderr))
        print_text(FORMATS["text"](report), stream=sys.stderr)
        return FOUND
    except api.JaniError as error:
        complain(str(error))
        return FOUND
    except FaultError as fault:
        place = target.place(fault.origin)
        where = "" if place is None else f"{shown_path(place.path)}:{place.line}: "
        complain(f"{where}{fault.message}")
        return FOUND
    _write(options, session, target)
    return CLEAN


def _session(options: argparse.Namespace, target: VerificationTarget) -> Session:
    saved = None
    if options.script is not None:
        try:
            saved = SavedSession.from_json(Path(options.script).read_text(encoding="utf-8"))
        except (ValueError, UnicodeDecodeError) as error:
            raise UsageError(f"{options.script}: {error}") from None
    name = saved.property if saved is not None else options.property
    return api.session(target, name, options.seed, options.trace, saved)


def _advance(options: argparse.Namespace, session: Session, target: VerificationTarget) -> None:
    """Take steps up to the end that the options set."""
    if options.script is not None and options.until is None and options.for_ is None:
        return
    properties = {property_.name for property_ in target.model.properties}
    if options.until is not None and options.until not in properties:
        if not session.has_event(options.until):
            known = ", ".join(sorted(properties)) or "none"
            raise UsageError(
                f"--until {options.until}: there is neither a property nor an event of this name; properties: {known}"
            )
        session.until_sent(options.until, options.max_steps)
    elif options.for_ is not None:
        if target.clock is None:
            raise UsageError("--for needs a model with a clock; use --max-steps instead")
        session.until_time(options.for_ / 1e9, options.max_steps)
    else:
        session.until_decided(options.max_steps)


def _write(options: argparse.Namespace, session: Session, target: VerificationTarget) -> None:
    from roaml.views.story import as_html, as_mermaid, as_text  # noqa: PLC0415

    def place_of(origin: Location) -> str:
        place = target.place(origin)
        return "" if place is None else f"{shown_path(place.path)}:{place.line}"

    story = session.story()
    if options.save is not None:
        write_file(options.save, session.save().to_json())
    if options.html is not None:
        write_file(options.html, as_html([story], place_of, shown_path(options.main)))
    if options.mermaid is not None:
        write_file(options.mermaid, as_mermaid(story, place_of))
    if options.csv is not None:
        write_file(options.csv, _csv(session))
    if options.json is not None:
        write_file(options.json, json.dumps(_as_json(session, target), indent=2) + "\n")
    files = (options.html, options.mermaid, options.csv, options.json)
    if not options.interactive and not any(files):
        print_text(as_text(story, place_of) + _summary(session))
        flush()


def _summary(session: Session) -> str:
    saved = session.save()
    time = session.state().time
    parts = [f"seed {saved.seed}, trace {saved.trace}", f"{session.position:,} steps"]
    if time is not None:
        parts.append(f"{time:g} s")
    end = session.end
    if end is not None:
        parts.append(end.text)
    if session.is_by_hand:
        parts.append("some steps were chosen by hand")
    return f"  {', '.join(parts)}\n"


def _csv(session: Session) -> str:
    """CSV with a row for each step: its number, the time, the action, and all variables after it."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for position in range(session.position + 1):
        session.jump(position)
        values = _values(session.state())
        if position == 0:
            writer.writerow(["step", "time", "action", *values])
        time = session.state().time
        action = session.steps[position - 1].action or "" if position else ""
        writer.writerow([position, "" if time is None else f"{time:g}", action, *values.values()])
    return text.getvalue()


def _values(state: SystemState) -> dict[str, Any]:
    """The columns of a state: the variables and states of machines, and the statuses of the nodes of the tree."""
    values: dict[str, Any] = {}
    for machine in state.machines:
        values |= {f"{machine.name}.{name}": value for name, value in machine.variables.items()}
        values[f"{machine.name}.state"] = machine.state
    values |= {f"bt_{node.number}": node.status.value for node in state.nodes}
    values |= {**state.blackboard, **state.shared}
    return {name: str(value).lower() if isinstance(value, bool) else value for name, value in values.items()}


def _as_json(session: Session, target: VerificationTarget) -> dict[str, Any]:
    rows = []
    for number, step in enumerate(session.steps[: session.position]):
        place = target.place(step.parts[0].edge.origin) if step.parts else None
        rows.append(
            {
                "step": number + 1,
                "action": step.action,
                "automata": [part.automaton for part in step.parts],
                "changes": {_name(session, change.variable): change.after for change in step.changes},
                "file": None if place is None else shown_path(place.path),
                "line": None if place is None else place.line,
            }
        )
    saved = session.save()
    end = session.end
    return {
        "model": shown_path(target.path),
        "property": saved.property,
        "verdict": session.verdict,
        "end": None if end is None else end.key,
        "seed": saved.seed,
        "trace": saved.trace,
        "steps": rows,
    }


def _name(session: Session, variable: Any) -> str:
    return variable.name if variable.instance < 0 else f"{session.automaton(variable.instance)}.{variable.name}"


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp simulate",
        description="Make one run of a system or JANI model, and show what happens in it.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = result.add_argument
    add("main", metavar="MAIN.xml|MODEL.jani", help="the system file, or a JANI model")
    add("--property", metavar="NAME", help="the property that is evaluated on the run (the first one)")
    add("--seed", type=natural, default=0, metavar="N", help="seed of the random numbers (0)")
    add("--trace", type=natural, default=0, metavar="N", help="number of the trace (0)")
    add("--for", dest="for_", type=time_of, metavar="TIME", help='end after this time of the model, such as "10 s"')
    add(
        "--until",
        metavar="NAME",
        help="end when this property is decided, or this topic, service, action or event is sent",
    )
    add("--max-steps", type=positive, default=1_000_000, metavar="N", help="end after N steps (1000000)")
    add("--script", metavar="FILE", help="the run that --save wrote")
    add("--save", metavar="FILE", help="write the decisions of the run, which --script takes again")
    add("--interactive", "-i", action="store_true", help="choose what happens next, step by step, and go back")
    add("--csv", metavar="FILE", help="write the state after each step as CSV")
    add("--json", metavar="FILE", help="write the steps as JSON")
    add("--mermaid", metavar="FILE", help="write the run as a Mermaid sequence diagram")
    add("--html", metavar="FILE", help="write the run as a page")
    add("--max-time", type=time_of, metavar="TIME", help='overrides <max_time> of MAIN.xml, for example "100 s"')
    add("--constant", action="append", default=[], metavar="NAME=VALUE", help="sets a constant that "
        "MODEL.jani declares without one; may be repeated")  # fmt: skip
    add("--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interface packages")
    return result
