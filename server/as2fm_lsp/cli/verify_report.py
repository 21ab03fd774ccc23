# SPDX-License-Identifier: Apache-2.0
"""The report of a verification: the results in the requested format, and the assumptions of all of them."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from as2fm_lsp.cli.exit_status import CLEAN
from as2fm_lsp.cli.formats import CheckReport, Format, render
from as2fm_lsp.cli.formats.report import entry, shown_path
from as2fm_lsp.cli.output import is_quiet, is_verbose, print_text, takes_color
from as2fm_lsp.cli.verify_arguments import Scheduler
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH
from as2fm_lsp.verification import stuck_report
from as2fm_lsp.verification.node_names import explained
from as2fm_lsp.verification.report import as_brief_text, as_json, as_text
from as2fm_lsp.verification.scheduler_report import A_SCHEDULER, UNIFORM_CHOICES
from roaml.durations import ANY, ANY_TIME, AT_ONCE, INSTANT, ReactionTime, duration_text
from roaml.jani.model import Clock, ModelType
from roaml.record import Record
from roaml.scxml.names import SUCCEEDS
from roaml.smc.fault import FaultError
from roaml.text import Location
from roaml.verification import stuck
from roaml.verification.results import Computed, Result
from roaml.verification.target import VerificationTarget
from roaml.verification.verifier import Verifier

if TYPE_CHECKING:
    from roaml.mocks.network import MockedTree
    from roaml.smc.story import Story
    from roaml.verification.tree_outcome import TreeOutcome

MAX_NAMED = 3
"""The maximum number of properties that a note about the values names."""
REACTIONS = {
    INSTANT: "assumed: machines take possible steps at once, before time advances",
    ANY: "assumed: nodes may wait before they take a possible step",
}
"""Reaction time -> the assumption in the words of users."""


class Answered(Record, frozen=True):
    """What a verification has found.

    Attributes:
        options: those of the command line.
        faults: the errors in the model because of which properties could not be decided.
        stuck_result: the result of the check whether the system gets stuck; `None` if that was not checked.
        tree: a tree without a system, and its measurements, or the reason why there are none.
        status: the exit status that follows.
    """

    options: argparse.Namespace
    verifier: Verifier
    results: tuple[Result, ...]
    faults: tuple[FaultError, ...] = ()
    stuck_result: stuck.StuckResult | None = None
    tree: tuple[MockedTree, TreeOutcome | str] | None = None
    status: int = CLEAN

    @property
    def target(self) -> VerificationTarget:
        return self.verifier.target

    def place(self, origin: Location) -> str:
        """The path and the line of a place in a model."""
        path, line, _ = self.target.place(origin) or ("", 0, 0)
        return f"{shown_path(path)}:{line}"

    def place_row(self, origin: Location) -> dict[str, Any]:
        """The same with the column, for JSON."""
        path, line, column = self.target.place(origin) or ("", 0, 0)
        return {"file": shown_path(path), "line": line, "column": column}


def report_text(answered: Answered) -> str:
    """The results in the format that the options ask for."""
    if answered.options.format is Format.JSON:
        return _json(answered)
    if answered.options.format is Format.JUNIT:
        from as2fm_lsp.verification.junit_report import as_junit  # noqa: PLC0415 - needs a library for XML

        return as_junit(answered.results, shown_path(answered.options.main), answered.place, answered.stuck_result)
    if answered.options.format is Format.CSV:
        from as2fm_lsp.verification.csv_report import as_csv  # noqa: PLC0415

        return as_csv(answered.results)
    if answered.options.format is Format.MARKDOWN:
        from as2fm_lsp.cli.verify_markdown import as_markdown  # noqa: PLC0415

        return as_markdown(answered.results, _findings(answered), _assumptions(answered))
    if answered.options.format is not Format.TEXT:
        return render(_findings(answered), answered.options.format)
    if is_quiet():
        return as_brief_text(answered.results, answered.place, answered.options.stuck)
    # A story of a stuck trace ends with the waiting automata.
    has_story = STANDARD_OUTPUT_PATH in answered.options.explain and any(r.answer or r.exact for r in answered.results)
    has_story = has_story and not any(result.is_interrupted for result in answered.results)
    shown = "in the trace below" if has_story else ""
    text = as_text(answered.results, answered.place, answered.options.stuck, shown, is_whole=is_verbose())
    if answered.tree is not None:
        text = _tree_text(answered, text, has_story)
    else:
        if answered.stuck_result is not None:
            where = _where_shown(answered, has_story)
            text += stuck_report.as_text(answered.stuck_result, answered.place, where, is_whole=is_verbose())
        text += "" if has_story else explained(text, answered.target.model, answered.place)
    return text + "".join(f"{line}\n" for line in _assumptions(answered).splitlines()) + _exit_reason(answered)


def _exit_reason(answered: Answered) -> str:
    """The last line of the report: which exit status follows, and why, if the results do not explain it."""
    if not any(result.verdicts or not result.has_answer for result in answered.results):
        return ""
    from as2fm_lsp.verification.exit_reason import exit_reason  # noqa: PLC0415 - many calls expect nothing

    return "".join(f"{line}\n" for line in exit_reason(answered.results, answered.status))


def _json(answered: Answered) -> str:
    from as2fm_lsp.cli.verify_faults import entries_of, row_of  # noqa: PLC0415
    from as2fm_lsp.verification import drawn_report  # noqa: PLC0415

    entries = [row_of(finding) for finding in entries_of(answered.options, answered.target, answered.faults)]
    row = None if answered.stuck_result is None else stuck_report.as_row(answered.stuck_result, answered.place_row)
    drawn = drawn_report.rows(answered.target.drawn, answered.place_row)
    tree, parameters = _tree_row(answered), answered.target.parameters
    return as_json(answered.results, entries, stuck=row, tree=tree, parameters=parameters, drawn=drawn)


def _findings(answered: Answered) -> CheckReport:
    """The results as findings, and the errors in the model because of which properties could not be decided."""
    from as2fm_lsp.cli.verify_faults import entries_of, source_of  # noqa: PLC0415
    from as2fm_lsp.verification.findings import diagnostics  # noqa: PLC0415

    source = source_of(answered.target)
    found = diagnostics(answered.results, answered.target, os.path.abspath(answered.options.main))
    entries = [entry(diagnostic, source, shown_path) for diagnostic in found]
    faults = entries_of(answered.options, answered.target, answered.faults)
    return CheckReport([*faults, *entries], len(answered.target.files))


def _tree_row(answered: Answered) -> dict[str, Any] | None:
    if answered.tree is None:
        return None
    from as2fm_lsp.verification.tree_report import as_row  # noqa: PLC0415

    mocked, outcome = answered.tree
    return None if isinstance(outcome, str) else as_row(mocked, outcome)


def _tree_text(answered: Answered, text: str, has_story: bool) -> str:
    """The results of a tree without a system: those of its properties, its measurements, and a failing trace."""
    from as2fm_lsp.verification import tree_report  # noqa: PLC0415

    assert answered.tree is not None
    mocked, outcome = answered.tree
    if isinstance(outcome, str):
        text += tree_report.not_measured(outcome)
    else:
        text += tree_report.as_text(mocked, outcome, answered.place, is_whole=is_verbose())
    succeeds = next((result for result in answered.results if result.name == SUCCEEDS), None)
    story = None if succeeds is None or has_story else _unwanted_story(answered, succeeds)
    if story is not None:
        always_fails = not isinstance(outcome, str) and outcome.success.value == 0
        text += tree_report.story_as_text(mocked, story, answered.place, has_table=always_fails, is_whole=is_verbose())
    return f"{text}{tree_report.assumptions(mocked)}\n"


def _unwanted_story(answered: Answered, result: Result) -> Story | None:
    """The explanation of a trace that contradicts an expectation: the shortest one that the search through all
    states has found, otherwise the shortest random one."""
    from roaml.verification.counterexample import unwanted_trace, unwanted_verdict  # noqa: PLC0415

    found = None if result.exact is None else result.exact.shortest(unwanted_verdict(result))
    if found is not None:
        return found.story(answered.target.clock)
    seen = unwanted_trace(result)
    return None if seen is None or result.traces is None else result.traces.story(seen.trace)


def _where_shown(answered: Answered, has_story: bool) -> str:
    """The place in the output where the traces of the properties show the automata that wait in the stuck trace; ""
    if they do not."""
    if answered.stuck_result is None or answered.stuck_result.stuck is None:
        return ""
    same = [
        result
        for result in answered.results
        if result.stuck and result.stuck.chain == answered.stuck_result.stuck.chain
    ]
    if same and has_story:
        return "in the trace below"
    named = next((result.name for result in same if not result.includes_stuck), None)
    return "" if named is None else f"above, below `{named}`"


def _assumptions(answered: Answered) -> str:
    """The assumptions of all results, in one line: the confidence and the choices of traces, and the reaction time
    if it is not the default; then the values of parameters. Verbose output begins with the exact computation."""
    metadata = answered.target.model.metadata
    reactions = ""
    if metadata is not None and metadata.reaction_time != (ANY_TIME if answered.tree is None else AT_ONCE):
        reactions = REACTIONS.get(metadata.reaction_time.text) or _within(metadata.reaction_time, metadata.clock)
        reactions += " (reaction time)"
    lines = [_exact_computation(answered), "; ".join(filter(None, (_computation(answered), reactions)))]
    if answered.target.parameters:
        values = ", ".join(f"{name} = {value}" for name, value in answered.target.parameters.items())
        lines.append(f"parameters: {values}")
    if answered.target.has_intervals:
        lines.append(
            "the minimum and maximum enclose the values for all parameters in the intervals, and may be wider, because "
            "a parameter may change within its interval during a run; uniform choices draw an end of it in each step"
        )
    if answered.target.drawn:
        from as2fm_lsp.verification import drawn_report  # noqa: PLC0415 - few models draw numbers

        lines += drawn_report.lines(answered.target.drawn, answered.place)
    return "\n".join(filter(None, lines))


def _within(time: ReactionTime, clock: Clock | None) -> str:
    """The assumption of a reaction time that is a duration, and to which time it is rounded up."""
    text = f"assumed: each machine takes a possible step within {time.text}"
    if clock is None or not time.nanoseconds or time.nanoseconds % clock.step == 0:
        return text
    rounded = duration_text(time.steps(clock.step) * clock.step)
    return f"{text}, rounded up to {rounded}, because a step of the clock takes {duration_text(clock.step)}"


def _exact_computation(answered: Answered) -> str:
    """How exact values were computed; "" unless the output is verbose."""
    if not is_verbose() or answered.options.scheduler is Scheduler.LSS:
        return ""
    if answered.options.exhaustive:
        return _exploration(answered, "computed", uniform_only=False)
    if all(result.exact is None for result in answered.results):
        return ""
    computed = _exploration(answered, "exact values, computed", uniform_only=answered.verifier.only_uniform)
    return f"{computed}; use --method adaptive for estimates from traces"


def _computation(answered: Answered) -> str:
    """How estimates were computed; "" if there are none."""
    if answered.options.exhaustive:
        return _explained(answered.results)
    options = answered.verifier.options
    if answered.options.scheduler is Scheduler.LSS:
        return f"{options.confidence:g} confidence with each scheduler found; seed {options.seed}; {A_SCHEDULER}"
    has_estimate = answered.stuck_result is not None and answered.stuck_result.stuck is not None
    has_estimate = has_estimate or any(
        not isinstance(r.outcome, Computed) or r.outcome.has_uniform_estimate for r in answered.results
    )
    if not has_estimate:
        return _explained(answered.results)
    drawn = UNIFORM_CHOICES if answered.verifier.only_uniform else f"{UNIFORM_CHOICES}; {A_SCHEDULER}"
    if (states := answered.verifier.checker.initial_states) > 1:
        of_states = f"each of {states:,} initial states is equally probable"
        is_only_choice = answered.target.model.type is ModelType.DTMC
        drawn = of_states if is_only_choice else f"{of_states}; {drawn}"
    estimates = "" if all(result.exact is None for result in answered.results) else "estimates: "
    return f"{estimates}{options.confidence:g} confidence, seed {options.seed}; {drawn}"


def _explained(results: Sequence[Result]) -> str:
    """What the words of exact values mean if these depend on the scheduler; "" if none does."""
    differing = [
        result.exact
        for result in results
        if result.exact is not None
        and not result.exact.agrees
        and result.question
        and not result.question.is_deterministic
    ]
    if not differing:
        return ""
    return f"{UNIFORM_CHOICES}; {A_SCHEDULER}" if any(exact.uniform for exact in differing) else A_SCHEDULER


def _exploration(answered: Answered, verb: str, *, uniform_only: bool) -> str:
    """Which exact values were computed, and from what.

    Args:
        uniform_only: whether only the values under uniform choices are of interest.
    """
    exact = {result.name: result.exact for result in answered.results if result.exact is not None}
    if not exact:
        return "no value was computed"
    values = []
    if not uniform_only:
        values.append("minimum and maximum over all schedulers")
    elif all(computed.agrees for computed in exact.values()):
        values.append("minimum and maximum over all schedulers, which are equal")
    else:
        also = any(computed.agrees for computed in exact.values())
        same = ", which is that of all schedulers where a result says so" if also else ""
        values.append(f"value under uniform choices{same}")
    uniform = [name for name, computed in exact.items() if computed.uniform is not None]
    if uniform and not uniform_only:
        values.append(f"value under uniform choices{_except([name for name in exact if name not in uniform])}")
    end = ""
    if any(computed.is_reduced for computed in exact.values()):
        end = "; reductions left out choices that do not change these values"
    return f"{verb} from all reachable states: {', '.join(values)}{end}"


def _except(names: list[str]) -> str:
    """A note that names the properties to which a statement does not apply; "" if there are none."""
    shown = ", ".join(f"`{name}`" for name in names[:MAX_NAMED])
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    return f" (not of {shown}{more})" if names else ""


def print_faults(answered: Answered) -> None:
    """Report on standard error why properties could not be decided. JSON already contains these errors."""
    if not answered.faults or answered.options.format not in (Format.TEXT, Format.JUNIT, Format.CSV):
        return
    from as2fm_lsp.cli.verify_faults import entries_of  # noqa: PLC0415 - most properties are decided

    entries = entries_of(answered.options, answered.target, answered.faults)
    report = CheckReport(entries, len({finding.file for finding in entries}), color=takes_color(sys.stderr))
    if entries:
        print_text(render(report, Format.TEXT), stream=sys.stderr)
