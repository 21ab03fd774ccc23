# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp simulate MAIN.xml|MODEL.jani`: shows one run, as a whole or step by step on a terminal."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats import Format, render
from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.model_arguments import (
    UsageError,
    add_model_arguments,
    check_model_arguments,
    error_report,
    fault_text,
    line_of,
    read_standard_input,
    read_target,
    settings_of,
)
from as2fm_lsp.cli.numbers import natural, positive
from as2fm_lsp.cli.output import complain, flush, print_text, write_output
from as2fm_lsp.cli.times import time_of
from as2fm_lsp.outputs import InputPath, OutputFiles, OutputPath, outputs_of
from as2fm_lsp.verification.run_files import csv_lines, json_text, timeline_svg
from roaml import api
from roaml.disk import MAX_DATA, required
from roaml.durations import short_moment
from roaml.figures.themes import THEMES
from roaml.jani.node import Origin
from roaml.simulation import RunError, SavedSession, Session
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.story import Story
from roaml.verification.target import VerificationTarget

EXAMPLES = """\
examples:
  as2fm-lsp simulate main.xml                         the steps of one run until the first property is decided
  as2fm-lsp simulate main.xml --seed 7 --for "10 s"   the first 10 s of another run
  as2fm-lsp simulate main.xml --until /arm/command    until a message is sent on this topic
  as2fm-lsp simulate main.xml --property dropped --trace 4 --html run.html
  as2fm-lsp simulate main.xml --svg run.svg           a timeline of the run, as a picture
  as2fm-lsp simulate main.xml --csv - | head          the state after each step
  as2fm-lsp simulate main.xml --interactive           choose on the terminal what happens next, and go back
  as2fm-lsp simulate main.xml --script run.json       repeat a run that --save has written

The run of seed N and trace M is trace M of `verify --seed N`. A run in which the user has chosen a step is not a
trace of `verify`.

exit status: 0 success; 1 the model has errors, or the run fails; 2 usage error; 3 internal error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    try:
        return _run(options)
    except (UsageError, RunError, api.ConstantError, api.ParameterError, api.PathError, api.PropertyError) as error:
        complain(str(error))
        return USAGE
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            raise
        complain(f"{shown_path(str(error.filename or options.main))}: {error.strerror or error}")
        return USAGE


def _run(options: argparse.Namespace) -> int:
    read_standard_input(options)
    check_model_arguments(options)
    settings = settings_of(options.main)
    status = CLEAN
    try:
        target = read_target(options, settings)
        outputs = outputs_of(options, target.files)
        session = api.session(target, _property(options, target), options.seed, options.trace, _saved(options))
    except (api.ModelError, api.JaniError) as error:
        print_text(render(error_report(error), Format.TEXT), stream=sys.stderr)
        return FOUND
    except FaultError as fault:
        complain(fault_text(target, fault))
        return FOUND
    if options.interactive:
        from as2fm_lsp.cli.interactive import Terminal  # noqa: PLC0415

        Terminal(session, target, outputs).run(sys.stdin)
    else:
        try:
            _advance(options, session, target)
        except FaultError as fault:
            complain(f"the run fails after step {session.position}: {fault_text(target, fault)}")
            status = FOUND
    _write(options, outputs, session, target)
    return status


def _saved(options: argparse.Namespace) -> SavedSession | None:
    if options.script is None:
        return None
    try:
        return SavedSession.from_json(required(options.script, MAX_DATA).decode("utf-8"))
    except ValueError as error:
        raise UsageError(f"{options.script}: {error}") from None


def _property(options: argparse.Namespace, target: VerificationTarget) -> str | None:
    """The name of the property that is evaluated on the run: that of `--property`, or of `--until` if it names a
    property."""
    names = {property_.name for property_ in target.properties}
    if options.until not in names:
        return options.property  # type: ignore[no-any-return]
    if options.property not in (None, options.until):
        both = f"--until {options.until} and --property {options.property}"
        raise UsageError(f"{both} name two properties; give only one of them")
    if options.script is not None:
        raise UsageError(f"--until {options.until}: the saved run determines the property; omit --until or --script")
    return str(options.until)


def _advance(options: argparse.Namespace, session: Session, target: VerificationTarget) -> None:
    """Take steps up to the end that the options set."""
    watched = session.save().property
    if options.until is not None and options.until != watched:
        if not session.has_event(options.until):
            known = ", ".join(sorted(property_.name for property_ in target.properties)) or "none"
            raise UsageError(
                f"--until {options.until}: there is neither a property nor an event of this name; properties: {known}"
            )
        session.until_sent(options.until, options.max_steps)
    elif options.for_ is not None:
        if target.clock is None:
            raise UsageError("--for needs a model with a clock; use --max-steps instead")
        session.until_time(options.for_ / 1e9, options.max_steps)
    elif options.script is None:
        session.until_decided(options.max_steps)


def _write(options: argparse.Namespace, outputs: OutputFiles, session: Session, target: VerificationTarget) -> None:
    from as2fm_lsp.cli.story_page import story_page  # noqa: PLC0415
    from roaml.views.story import as_mermaid, as_text  # noqa: PLC0415

    def place_of(origin: Origin) -> str:
        return line_of(target, origin)

    story = session.story()
    if options.save is not None:
        write_output(outputs, options.save, session.save().to_json())
    if options.html is not None:
        write_output(outputs, options.html, story_page([story], target, options.main))
    if options.mermaid is not None:
        write_output(outputs, options.mermaid, as_mermaid(story, place_of))
    if options.svg is not None:
        write_output(outputs, options.svg, timeline_svg(session, shown_path(options.main), options.theme))
    if options.csv is not None:
        write_output(outputs, options.csv, csv_lines(session))
    if options.json is not None:
        write_output(outputs, options.json, json_text(session, target))
    if not options.interactive and not any((options.html, options.mermaid, options.svg, options.csv, options.json)):
        print_text(as_text(story, place_of) + _summary(session, story))
        flush()


def _summary(session: Session, story: Story) -> str:
    saved = session.save()
    time = story.clock[story.ends[-1]] if story.steps else session.state().time
    parts = [f"seed {saved.seed}, trace {saved.trace}", f"{session.position:,} steps"]
    if time is not None:
        parts.append(short_moment(time))
    end = session.end
    if end is not None:
        parts.append(end.text)
    elif stopped := session.stopped():
        at, names = stopped
        who = " and ".join(f"`{name}`" for name in names) or "machines"
        verb = "takes" if len(names) == 1 else "take"
        parts.append(f"time stops at {short_moment(at)}: {who} {verb} steps for ever, so no timer ticks any more")
    elif session.repeats():
        parts.append(End.ROUND.text)
    if session.is_changed:
        parts.append("the state was changed by the user, so the run does not show the behaviour of the model")
    elif session.is_by_hand:
        parts.append("some steps were chosen by the user")
    return f"  {', '.join(parts)}\n"


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp simulate",
        description="Simulate one run of a system or JANI model, and show its steps.",
        epilog=EXAMPLES,
    )
    add = result.add_argument
    add("main", type=InputPath, metavar="MAIN.xml|MODEL.jani", help="the system file, or a JANI model")
    add("--property", metavar="NAME", help="the property that is evaluated on the run (the first one)")
    add("--seed", type=natural, default=0, metavar="N", help="seed of the random numbers (0)")
    add("--trace", type=natural, default=0, metavar="N", help="number of the trace (0)")
    add("--for", dest="for_", type=time_of, metavar="TIME", help='end after this time of the model, such as "10 s"')
    add(
        "--until",
        metavar="NAME",
        help="end when this property is decided, or this event or a message of this topic, service or action is sent",
    )
    add("--max-steps", type=positive, default=1_000_000, metavar="N", help="end after N steps (1000000)")
    add("--script", type=InputPath, metavar="FILE", help="repeat a run that --save has written")
    add(
        "--save",
        type=OutputPath,
        metavar="FILE",
        help="write the decisions of the run, for --script",
    )
    add("--interactive", "-i", action="store_true", help="choose each next step on the terminal, and go back")
    add(
        "--csv",
        type=OutputPath,
        metavar="FILE",
        help="write the state after each step as CSV; - is standard output, also for the options below",
    )
    add("--json", type=OutputPath, metavar="FILE", help="write the steps as JSON")
    add("--mermaid", type=OutputPath, metavar="FILE", help="write the run as a Mermaid sequence diagram")
    add(
        "--svg",
        type=OutputPath,
        metavar="FILE",
        help="write the run as a timeline: states, statuses, messages and variables",
    )
    add("--theme", choices=tuple(THEMES), default="light", help="the colors of the timeline (light)")
    add("--html", type=OutputPath, metavar="FILE", help="write the run as an HTML page")
    add_model_arguments(result)
    return result
