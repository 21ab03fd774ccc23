# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify MAIN.xml|MODEL.jani`: compute or estimate the probabilities of the model's properties, and
explain traces."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any

from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats import CheckReport, Format, render
from as2fm_lsp.cli.formats.report import Entry, entry, shown_path
from as2fm_lsp.cli.interrupts import Interrupts
from as2fm_lsp.cli.interval_options import has_intervals, target_over_intervals
from as2fm_lsp.cli.kernel_note import kernel_warning
from as2fm_lsp.cli.mock_options import MESSAGES, declarations_in
from as2fm_lsp.cli.model_arguments import (
    UsageError,
    check_model_arguments,
    error_report,
    read_standard_input,
    read_target,
    report_of,
    settings_of,
    with_reaction_time,
)
from as2fm_lsp.cli.output import complain, flush, is_quiet, is_verbose, note, print_text, takes_color
from as2fm_lsp.cli.progress_bar import ProgressBar
from as2fm_lsp.cli.status_line import StatusLine
from as2fm_lsp.cli.verify_arguments import (
    Scheduler,
    asks_for_traces,
    expectations_in,
    limits_in,
    parser,
    state_limits_in,
)
from as2fm_lsp.cli.workers import cluster
from as2fm_lsp.mocked_models import load_mocked_tree, names_tree
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, outputs_of
from as2fm_lsp.verification import drawn_report, stuck_report
from as2fm_lsp.verification.doubts import can_get_stuck
from as2fm_lsp.verification.node_names import explained
from as2fm_lsp.verification.report import as_brief_text, as_json, as_text
from as2fm_lsp.verification.saved_state import SavedState, StateError
from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.durations import ANY, ANY_TIME, AT_ONCE, INSTANT
from roaml.explicit.space import MAX_STATES, StateLimits
from roaml.record import replace
from roaml.scxml.names import SUCCEEDS
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.pool import Pool, WorkersLostError
from roaml.smc.program import FALSE
from roaml.smc.run import EstimationMethod, Options
from roaml.smc.tally import Tally
from roaml.text import Location, SourceFile, Span
from roaml.verification import stuck
from roaml.verification.exhaustive import ExplorationInterruptedError
from roaml.verification.expectations import Expectation
from roaml.verification.refusal import fault_message
from roaml.verification.results import Computed, CutShort, Exact, Refused, Result, Sampled, Traces
from roaml.verification.small import EXAMPLE_TRACES
from roaml.verification.target import VerificationTarget
from roaml.verification.verifier import NoThresholdError, Verifier

if TYPE_CHECKING:
    from roaml.mocks.network import MockedTree
    from roaml.project.settings import Settings
    from roaml.smc.story import Story
    from roaml.verification.nearest import Nearest
    from roaml.verification.searches import Searches
    from roaml.verification.tree_outcome import TreeOutcome

WIDTH_OF_TREES = 0.05
"""Half the width of the interval that the default number of traces of a tree guarantees for every probability."""
MAX_NAMED = 3
"""The maximum number of properties that a note about the values names."""
MAX_TRACES_IN_ONE_PROCESS = 20_000
"""The maximum number of traces of a tree that are generated in one process, because starting more processes would take
longer than it saves."""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    if slow := kernel_warning():
        note(slow)
    with Interrupts() as interrupts:
        try:
            return _checked(options, interrupts)
        except KeyboardInterrupt:  # before there are results
            return interrupts.status


def _checked(options: argparse.Namespace, interrupts: Interrupts) -> int:
    try:
        return _run(options, interrupts)
    except (UsageError, api.RangeError, api.ConstantError, StateError) as error:
        return _fail(str(error))
    except (api.ParameterError, api.PathError, api.PropertyError, WorkersLostError) as error:
        return _fail(str(error))
    except BrokenPipeError:
        raise
    except OSError as error:
        return _fail(f"{shown_path(str(error.filename or options.main))}: {error.strerror or error}")


def _run(options: argparse.Namespace, interrupts: Interrupts) -> int:
    expectations = expectations_in(options.expect)
    limits = limits_in(options)
    read_standard_input(options)
    check_model_arguments(options)
    settings = settings_of(options.main)
    if names_tree(options.main, options.texts):
        return _run_tree(options, expectations, limits, settings, interrupts)
    only_uniform = settings.only_uniform if options.scheduler is None else options.scheduler is Scheduler.UNIFORM
    names = options.property or None
    try:
        with StatusLine() as status:
            status.stage("reading and translating")
            over_intervals = has_intervals(options)
            target = target_over_intervals(options, settings) if over_intervals else read_target(options, settings)
            only_uniform = only_uniform and not over_intervals
            options.exhaustive = options.exhaustive or over_intervals
            status.stage("compiling")
            verifier = api.verifier(
                target,
                names,
                limits,
                expectations,
                only_uniform=only_uniform,
                exact_if_small=not asks_for_traces(options),
                example_traces=EXAMPLE_TRACES,
                limits=state_limits_in(options),
                uniform=options.uniform or settings.uniform,
            )
    except (api.ModelError, api.JaniError) as error:
        return _errors(options, error_report(error))
    except FaultError as fault:
        return _fault(options, target, fault)
    if not verifier.names:
        raise UsageError(f"{shown_path(options.main)} has no properties; list a file of properties in the system")
    return _Verification(options, verifier, interrupts).run()


def _run_tree(
    options: argparse.Namespace,
    expectations: list[Expectation],
    limits: Options,
    settings: Settings,
    interrupts: Interrupts,
) -> int:
    """Verify a tree without a system, with mocks (docs/spec/mocks.md)."""
    from roaml.experiments.exact_trees import measure_exactly  # noqa: PLC0415
    from roaml.verification.tree_outcome import (  # noqa: PLC0415 - systems start faster without it
        TRACES,
        measure,
    )

    if limits.method is EstimationMethod.ADAPTIVE:  # the number is fixed, because all measurements use the same traces
        epsilon = WIDTH_OF_TREES if limits.epsilon == Options().epsilon else limits.epsilon
        limits = replace(limits, method=EstimationMethod.FIXED, max_traces=limits.max_traces or TRACES, epsilon=epsilon)
    if (limits.max_traces or 0) <= MAX_TRACES_IN_ONE_PROCESS:
        options.jobs = 1
    try:
        with StatusLine() as status:
            status.stage("reading and translating")
            declared = declarations_in(options)
            settings = with_reaction_time(settings, options)
            tree = load_mocked_tree(
                options.main, declared, options.max_time, settings, MESSAGES, counts=True, texts=options.texts
            )
            status.stage("exploring the states")
            outcome = None
            if options.exhaustive or not asks_for_traces(options):
                outcome = measure_exactly(tree.mocked, tree.target, state_limits_in(options))
            status.stage("compiling")
            names = options.property or [SUCCEEDS]
            verifier = api.verifier(
                tree.target,
                names,
                limits,
                expectations,
                only_uniform=True,
                exact_if_small=outcome is not None and not options.exhaustive,
                example_traces=EXAMPLE_TRACES,
                limits=state_limits_in(options),
            )
            if outcome is None and not options.exhaustive:
                status.stage("making traces")
                outcome = measure(tree.mocked, tree.target, limits)
    except api.MockError as error:
        raise UsageError(str(error)) from None
    except api.ModelError as error:
        return _errors(options, error_report(error))
    return _Verification(options, verifier, interrupts, (tree.mocked, outcome)).run()


REACTIONS = {
    INSTANT: "assumed: machines take possible steps at once, before time advances",
    ANY: "assumed: nodes may wait before they take a possible step",
}
"""Reaction time -> the assumption in the words of users."""


class _Verification:
    """One call of the command, after all files have been read. If a tree without a system is verified, `tree` contains
    the tree and its measurements."""

    def __init__(
        self,
        options: argparse.Namespace,
        verifier: Verifier,
        interrupts: Interrupts,
        tree: tuple[MockedTree, TreeOutcome | None] | None = None,
    ) -> None:
        self.tree = tree
        self.options = options
        self.verifier = verifier
        self.interrupts = interrupts
        self.target = verifier.target
        self.limits = verifier.options
        self.outputs = outputs_of(options, self.target.files)
        self.stuck_result: stuck.StuckResult | None = None
        self.partings: dict[str, Nearest] = {}
        self.state = None if options.resume is None else SavedState(options.resume, self.limits)
        self.results: list[Result] = []
        self.faults: list[FaultError] = []
        self.searches: Searches | None = None
        if options.exhaustive:
            most = options.max_states or MAX_STATES
            limits = StateLimits(most, options.max_memory, reduces=not options.no_reductions)
            self.searches = verifier.searches(limits, options.jobs)

    def run(self) -> int:
        checker = self.verifier.checker
        searches = self.searches or nullcontext()
        with cluster(self.options.dask) as (executor, workers), ProgressBar() as bar, searches:
            with Pool(workers or self.options.jobs, executor) as pool:
                shared = self._answer_shared(pool, bar)
            interrupted = any(result.is_interrupted for result in shared.values())
            for name in self.verifier.names:
                if name in shared:
                    self.results.append(shared[name])
                elif not interrupted:
                    with Pool(workers or self.options.jobs, executor) as pool:
                        self.results.append(self._answer_alone(name, pool, bar))
                    interrupted = self.results[-1].is_interrupted
            can_check = self.tree is None and not interrupted and not self.options.exhaustive
            if can_check and stuck.can_be_stuck(checker):
                includes_stuck = any(property_.question.is_stuck for property_ in checker.compiled_properties)
                try:
                    self.stuck_result = self._check_stuck(None if includes_stuck or self.faults else bar)
                except KeyboardInterrupt:
                    self.interrupts.ignore()
                    interrupted = True
        if not interrupted and self.options.quantiles:
            self.results = [self._with_quantiles(result) for result in self.results]
        self._print()
        self._print_faults()
        is_met = all(r.is_met for r in self.results) and (self.stuck_result is None or self.stuck_result.is_met)
        if self.options.stuck is stuck.StuckLevel.ERROR and any(map(can_get_stuck, self.results)):
            is_met = False
        status = self.interrupts.status if interrupted else CLEAN if is_met else FOUND
        if not interrupted and (self.options.traces is not None or self.options.explain):
            self._write_traces()
        if not interrupted and self.options.plot:
            self._write_plots()
        return status

    def _with_quantiles(self, result: Result) -> Result:
        """The result of a reward, with the quantiles that the options ask for."""
        question = result.question
        if question is None or not question.is_reward:
            return result
        from roaml.experiments.quantiles import reward_quantiles  # noqa: PLC0415 - most verifications have none

        property_ = self.verifier.question(result.name)
        shares = self.options.quantiles
        return replace(result, quantiles=reward_quantiles(self.verifier.checker, property_, shares, self.limits))

    def _write_plots(self) -> None:
        from as2fm_lsp.cli.plot_files import write_plots  # noqa: PLC0415 - most verifications draw nothing
        from as2fm_lsp.verification.curve_files import curve_plots  # noqa: PLC0415
        from roaml.figures.themes import AUTOMATIC  # noqa: PLC0415

        with StatusLine() as status:
            status.stage("making traces for the plot")
            try:
                plots = list(curve_plots(self.verifier, self.options.over_time, self.options.band))
            except FaultError as fault:
                raise UsageError(f"the curves cannot be drawn: {fault.message}") from None
            except ValueError as error:
                raise UsageError(str(error)) from None
        title = f"Curves of {os.path.basename(self.options.main)}"
        for path in self.options.plot:
            write_plots(self.outputs, path, plots, AUTOMATIC, title)

    def _answer_shared(self, pool: Pool, bar: ProgressBar) -> dict[str, Result]:
        """The results of the properties that share traces; empty if fewer than two properties can share them, or if the
        options exclude sharing."""
        options, verifier = self.options, self.verifier
        if options.separate or options.exhaustive or options.scheduler is Scheduler.LSS:
            return {}
        properties = verifier.sharing()
        if not properties:
            return {}
        payloads = [verifier.checker.payload(property_) for property_ in properties] if self.state is not None else []
        tallies = [Tally() for _ in properties]
        if self.state is not None:
            tallies = [self.state.tally(e.question, payload) for e, payload in zip(properties, payloads, strict=True)]
        by_name = {property_.question.name: payload for property_, payload in zip(properties, payloads, strict=False)}

        def watch(property_: CompiledProperty, so_far: Tally) -> None:
            shown = next((e for e, tally in zip(properties, tallies, strict=True) if not tally.is_finished), None)
            if property_ is shown:
                bar.together(property_.question, so_far, len(properties))
            if self.state is not None:
                self.state.keep(property_.question.name, by_name[property_.question.name], so_far)

        began = time.monotonic()
        bar.begin(properties[0].question, self.limits, tallies[0])
        try:
            results = verifier.answer_together(properties, pool, tallies, watch, bar.pulse)
        except NoThresholdError as error:
            raise UsageError(str(error)) from None
        except KeyboardInterrupt:
            self.interrupts.ignore()
            seconds = time.monotonic() - began
            results = [verifier.interrupted(e, tally, seconds) for e, tally in zip(properties, tallies, strict=True)]
        if self.state is not None:
            for property_, tally in zip(properties, tallies, strict=True):
                self.state.keep(property_.question.name, by_name[property_.question.name], tally, now=True)
        self.faults += [result.outcome.fault for result in results if isinstance(result.outcome, Refused)]
        return {result.name: self._with_shown_path(result) for result in results}

    def _answer_alone(self, name: str, pool: Pool, bar: ProgressBar) -> Result:
        """The result of a property from traces that it does not share; a refusal if the property cannot be decided."""
        try:
            return self._answer(self.verifier.question(name), pool, bar)
        except FaultError as fault:
            self.faults.append(fault)
            return self._with_shown_path(self.verifier.refused(name, fault))

    def _with_shown_path(self, result: Result) -> Result:
        """The result, with the path in its refusal as `shown_path` returns it."""
        match result.outcome:
            case Refused(reason=reason) as refused if reason.place is not None:
                place = reason.place._replace(path=shown_path(reason.place.path))
                return replace(result, outcome=replace(refused, reason=replace(reason, place=place)))
            case _:
                return result

    def _answer(self, property_: CompiledProperty, pool: Pool, bar: ProgressBar) -> Result:
        began = time.monotonic()
        name = property_.question.name
        if self.options.exhaustive:
            return self._exhaustive(property_, bar, began)
        try:
            self.verifier.check_method(property_)
        except NoThresholdError as error:
            raise UsageError(str(error)) from None
        tally = Tally()
        payload = self.verifier.checker.payload(property_)
        if self.state is not None:
            tally = self.state.tally(property_.question, payload)
        bar.begin(property_.question, self.limits, tally)

        def watch(so_far: Tally) -> None:
            bar.watch(so_far)
            if self.state is not None:
                self.state.keep(name, payload, so_far)

        if self.options.scheduler is Scheduler.LSS:
            return self._search(property_, pool, bar, began)
        try:
            result = self.verifier.answer(property_, pool, tally, watch, bar.pulse)
        except KeyboardInterrupt:
            self.interrupts.ignore()
            result = self.verifier.interrupted(property_, tally, time.monotonic() - began)
        if self.state is not None:
            self.state.keep(name, payload, tally, now=True)
        return result

    def _search(self, property_: CompiledProperty, pool: Pool, bar: ProgressBar, began: float) -> Result:
        """The minimum and the maximum probability over sampled schedulers; a partial result if it is interrupted."""
        search, interrupted = api.Search(), False
        try:
            self.verifier.checker.search(property_, self.limits, pool, search, bar.search, bar.pulse)
        except KeyboardInterrupt:
            self.interrupts.ignore()
            interrupted = True
        return self.verifier.sampled(property_, search, time.monotonic() - began, is_interrupted=interrupted)

    def _check_stuck(self, bar: ProgressBar | None) -> stuck.StuckResult:
        """The result of the check whether the system gets stuck. With a progress bar, traces are generated for this
        check; without one, only the traces of the results are used."""
        level = self.options.stuck
        own = stuck.StuckResult(None, None, level) if bar is None else self.verifier.check_stuck(level, bar.pulse)
        return replace(own, stuck=stuck.shortest([own.stuck, *(result.stuck for result in self.results)]))

    def _exhaustive(self, property_: CompiledProperty, bar: ProgressBar, began: float) -> Result:
        """The exact values from all states."""
        searches = self.searches
        assert searches is not None
        try:
            return self.verifier.exhaustive(
                property_, searches.limits, lambda progress: bar.states(property_.question, progress), searches
            )
        except KeyboardInterrupt as interrupt:
            self.interrupts.ignore()
            outcome = CutShort()
            if isinstance(interrupt, ExplorationInterruptedError):
                outcome = CutShort(interrupt.states, interrupt.growing)
            return Result(property_.question.name, outcome, seconds=time.monotonic() - began)

    def _print(self) -> None:
        text = self._text()
        print_text(text, self.options.format.encoding)
        flush()

    def _text(self) -> str:
        if self.options.format is Format.JSON:
            entries = [_row(finding) for finding in self._fault_entries()]
            row = None if self.stuck_result is None else stuck_report.as_row(self.stuck_result, self._place_row)
            drawn = drawn_report.rows(self.target.drawn, self._place_row)
            parameters = self.target.parameters
            return as_json(self.results, entries, stuck=row, tree=self._tree_row(), parameters=parameters, drawn=drawn)
        if self.options.format is Format.JUNIT:
            from as2fm_lsp.verification.junit_report import as_junit  # noqa: PLC0415 - needs a library for XML

            return as_junit(self.results, shown_path(self.options.main), self._place, self.stuck_result)
        if self.options.format is Format.CSV:
            from as2fm_lsp.verification.csv_report import as_csv  # noqa: PLC0415

            return as_csv(self.results)
        if self.options.format is Format.MARKDOWN:
            from as2fm_lsp.cli.verify_markdown import as_markdown  # noqa: PLC0415

            return as_markdown(self.results, self._report(), self._assumptions())
        if self.options.format is not Format.TEXT:
            return render(self._report(), self.options.format)
        if is_quiet():
            return as_brief_text(self.results, self._place, self.options.stuck)
        # A story of a stuck trace ends with the waiting automata.
        has_story = STANDARD_OUTPUT_PATH in self.options.explain and any(r.answer or r.exact for r in self.results)
        has_story = has_story and not any(result.is_interrupted for result in self.results)
        shown = "in the trace below" if has_story else ""
        text = as_text(self.results, self._place, self.options.stuck, shown, is_whole=is_verbose())
        if self.tree is not None:
            text = self._tree_text(text, has_story)
        else:
            if self.stuck_result is not None:
                where = self._where_shown(has_story)
                text += stuck_report.as_text(self.stuck_result, self._place, where, is_whole=is_verbose())
            text += "" if has_story else explained(text, self.target.model, self._place)
        return text + "".join(f"{line}\n" for line in self._assumptions().splitlines())

    def _report(self) -> CheckReport:
        """The results as findings, and the errors in the model because of which properties could not be decided."""
        from as2fm_lsp.verification.findings import diagnostics  # noqa: PLC0415

        source_of = _source_of(self.target)
        found = diagnostics(self.results, self.target, os.path.abspath(self.options.main))
        entries = [entry(diagnostic, source_of, shown_path) for diagnostic in found]
        return CheckReport([*self._fault_entries(), *entries], len(self.target.files))

    def _tree_row(self) -> dict[str, Any] | None:
        if self.tree is None:
            return None
        from as2fm_lsp.verification.tree_report import as_row  # noqa: PLC0415

        mocked, outcome = self.tree
        return None if outcome is None else as_row(mocked, outcome)

    def _tree_text(self, text: str, has_story: bool) -> str:
        """The results of a tree without a system: those of its properties, its measurements, and a failing trace."""
        from as2fm_lsp.verification import tree_report  # noqa: PLC0415

        assert self.tree is not None
        mocked, outcome = self.tree
        if outcome is None:
            text += tree_report.NOT_MEASURED
        else:
            text += tree_report.as_text(mocked, outcome, self._place, is_whole=is_verbose())
        succeeds = next((result for result in self.results if result.name == SUCCEEDS), None)
        story = None if succeeds is None or has_story else self._unwanted_story(succeeds)
        if story is not None:
            always_fails = outcome is not None and outcome.success.value == 0
            text += tree_report.story_as_text(mocked, story, self._place, has_table=always_fails, is_whole=is_verbose())
        return f"{text}{tree_report.assumptions(mocked)}\n"

    def _unwanted_story(self, result: Result) -> Story | None:
        """The explanation of a trace that contradicts an expectation: the shortest one that the search through all
        states has found, otherwise the shortest random one."""
        from roaml.verification.counterexample import unwanted_trace, unwanted_verdict  # noqa: PLC0415

        found = None if result.exact is None else result.exact.shortest(unwanted_verdict(result))
        if found is not None:
            return found.story(self.target.clock)
        seen = unwanted_trace(result)
        return None if seen is None or result.traces is None else result.traces.story(seen.trace)

    def _where_shown(self, has_story: bool) -> str:
        """The place in the output where the traces of the properties show the automata that wait in the stuck trace; ""
        if they do not."""
        if self.stuck_result is None or self.stuck_result.stuck is None:
            return ""
        same = [
            result for result in self.results if result.stuck and result.stuck.chain == self.stuck_result.stuck.chain
        ]
        if same and has_story:
            return "in the trace below"
        named = next((result.name for result in same if not result.includes_stuck), None)
        return "" if named is None else f"above, below `{named}`"

    def _assumptions(self) -> str:
        """The assumptions of all results, in one line: the confidence and the choices of traces, and the reaction time
        if it is not the default; then the values of parameters. Verbose output begins with the exact computation."""
        metadata = self.target.model.metadata
        reactions = ""
        if metadata is not None and metadata.reaction_time != (ANY_TIME if self.tree is None else AT_ONCE):
            text = metadata.reaction_time.text
            reactions = REACTIONS.get(text, f"assumed: each machine takes a possible step within {text}")
            reactions += " (reaction time)"
        lines = [self._exact_computation(), "; ".join(filter(None, (self._computation(), reactions)))]
        if self.target.parameters:
            values = ", ".join(f"{name} = {value}" for name, value in self.target.parameters.items())
            lines.append(f"parameters: {values}")
        if self.target.has_intervals:
            lines.append(
                "the minimum and maximum enclose the values for all parameters in the intervals; they also allow other "
                "values in each step, and uniform choices draw an end of the interval in each step"
            )
        lines += drawn_report.lines(self.target.drawn, self._place)
        return "\n".join(filter(None, lines))

    def _exact_computation(self) -> str:
        """How exact values were computed; "" unless the output is verbose."""
        if not is_verbose() or self.options.scheduler is Scheduler.LSS:
            return ""
        if self.options.exhaustive:
            return self._exploration("computed", uniform_only=False)
        if all(result.exact is None for result in self.results):
            return ""
        computed = self._exploration("exact values, computed", uniform_only=self.verifier.only_uniform)
        return f"{computed}; use --method adaptive for estimates from traces"

    def _computation(self) -> str:
        """How estimates were computed; "" if there are none."""
        if self.options.exhaustive:
            return ""
        if self.options.scheduler is Scheduler.LSS:
            how = f"with each scheduler found; others may be more extreme; seed {self.limits.seed}"
            return f"{self.limits.confidence:g} confidence {how}"
        has_estimate = self.stuck_result is not None and self.stuck_result.stuck is not None
        has_estimate = has_estimate or any(
            not isinstance(r.outcome, Computed) or r.outcome.has_uniform_estimate for r in self.results
        )
        if not has_estimate:
            return ""
        drawn = "choices were made uniformly at random"
        if (states := self.verifier.checker.initial_states) > 1:
            drawn = f"one of {states:,} initial states and all choices were drawn uniformly at random"
        estimates = "" if all(result.exact is None for result in self.results) else "estimates: "
        return f"{estimates}{self.limits.confidence:g} confidence, seed {self.limits.seed}; {drawn}"

    def _exploration(self, verb: str, *, uniform_only: bool) -> str:
        """Which exact values were computed, and from what.

        Args:
            uniform_only: whether only the values under uniform choices are of interest.
        """
        exact = {result.name: result.exact for result in self.results if result.exact is not None}
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

    def _place(self, origin: Location) -> str:
        path, line, _ = self.target.place(origin) or ("", 0, 0)
        return f"{shown_path(path)}:{line}"

    def _place_row(self, origin: Location) -> dict[str, Any]:
        path, line, column = self.target.place(origin) or ("", 0, 0)
        return {"file": shown_path(path), "line": line, "column": column}

    def _fault_entries(self) -> list[Entry]:
        """The errors in the model because of which properties could not be decided. Errors without a known position are
        omitted."""
        diagnostics = [_diagnostic(self.options, fault) for fault in self.faults]
        return [
            entry(diagnostic, _source_of(self.target), shown_path)
            for diagnostic in diagnostics
            if diagnostic is not None
        ]

    def _print_faults(self) -> None:
        """Report on standard error why properties could not be decided. JSON already contains these errors."""
        if self.faults and self.options.format in (Format.TEXT, Format.JUNIT, Format.CSV):
            entries = self._fault_entries()
            report = CheckReport(entries, len({finding.file for finding in entries}), color=takes_color(sys.stderr))
            if entries:
                print_text(render(report, Format.TEXT), stream=sys.stderr)

    def _write_traces(self) -> None:
        """Write the traces to files, and the explanations of traces to their outputs."""
        from as2fm_lsp.verification.trace_files import write_traces  # noqa: PLC0415

        stories: list[Story] = []
        for result in self.results:
            if isinstance(result.outcome, Computed):
                for story in self._shortest(result, result.outcome.exact):
                    self._compare(result, story)
                    stories.append(story)
                continue
            traces = result.traces
            if result.answer is None or traces is None:
                if isinstance(result.outcome, Sampled) and (self.options.explain or self.options.traces is not None):
                    complain(f"{result.name}: traces of sampled schedulers can be neither explained nor written")
                continue
            if self.options.traces is not None:
                recorder = traces.recorder()
                folder, limit = self.options.traces, self.options.traces_limit
                write_traces(self.outputs, folder, self.target, recorder, result.answer, limit)
            if self.options.explain:
                from roaml.verification.counterexample import unwanted_trace  # noqa: PLC0415

                seen = unwanted_trace(result)
                if seen is None:
                    print_text(f"{result.name}: {self._no_trace(result)}\n", stream=sys.stderr)
                else:
                    stories.append(traces.story(seen.trace))
                    self._compare(result, stories[-1])
        for file in self.options.explain:
            self._write_stories(stories, file)

    def _no_trace(self, result: Result) -> str:
        """Why no random trace is explained, and what to do if a sampled scheduler has other traces, in one sentence."""
        from roaml.verification.counterexample import unwanted_verdict  # noqa: PLC0415

        fails = unwanted_verdict(result) == FALSE
        traces = 0 if result.answer is None else result.answer.tally.traces
        text = f"none of the {traces:,} random traces {'failed' if fails else 'held'}"
        choices = result.choices
        other = None if choices is None else choices.minimum if fails else choices.maximum
        if choices is None or not choices.differ or other is None or not other.scheduler:
            return text
        metadata = self.target.model.metadata
        has_any_time = metadata is not None and metadata.clock is not None and metadata.reaction_time.is_any
        instead = ", or state a reaction time, as with --reaction-time instant" if has_any_time else ""
        which = "fail" if fails else "hold"
        shown = f"some of those of {other.scheduler}, {which}, but cannot be shown"
        return f"{text}; {shown}: use --exhaustive --explain{instead}"

    def _compare(self, result: Result, story: Story) -> None:
        """Keep where a trace parts from the nearest one with the opposite verdict."""
        from roaml.verification.nearest import nearest  # noqa: PLC0415

        near = nearest(result, story, self.target.clock)
        if near is not None:
            self.partings[story.property] = near

    def _shortest(self, result: Result, exact: Exact) -> Iterator[Story]:
        """The explanation of the shortest trace that contradicts an expectation. For a property about a number of
        steps, which states do not contain, it is a random one."""
        if self.options.traces is not None:
            complain(f"{result.name}: --traces writes random traces only, not those of --exhaustive")
        from roaml.verification.counterexample import (  # noqa: PLC0415
            MAX_SEARCHED_TRACES,
            random_trace,
            unwanted_verdict,
        )

        verdict = unwanted_verdict(result)
        trace = exact.shortest(verdict)
        if trace is not None:
            yield trace.story(self.target.clock)
        elif self.options.explain:
            verb = "fails" if verdict == FALSE else "holds"
            is_possible = exact.least < 1 if verdict == FALSE else exact.greatest > 0
            property_ = self.verifier.question(result.name)
            is_reward = property_.question.is_reward
            text = f"there is no trace in which it {verb}"
            if is_possible and property_.goal.is_bounded == 1 and not is_reward:
                traces = Traces(self.target, self.verifier.checker, property_, self.limits)
                number = random_trace(traces, verdict)
                if number is not None:
                    yield traces.story(number)
                    return
                text = f"it {verb} in none of {MAX_SEARCHED_TRACES:,} random traces, and states do not count steps"
            elif is_possible and not is_reward:
                text = f"every trace in which it {verb} repeats some states for ever, so none can be shown to its end"
                if isinstance(result.outcome, Computed) and result.outcome.reason:
                    text += f"; {result.outcome.reason}"
            print_text(f"{result.name}: {text}\n", stream=sys.stderr)

    def _story_texts(self, stories: Sequence[Story]) -> str:
        """The text of all explanations. Parts that several of them share are written once."""
        from roaml.views.parting import parting_text  # noqa: PLC0415
        from roaml.views.story import as_text as story_text  # noqa: PLC0415
        from roaml.views.story import waits_of  # noqa: PLC0415

        texts: list[str] = []
        shown_at: dict[object, str] = {}
        for story in stories:
            chain = stuck.chain_of(waits_of(story))
            where, near = shown_at.get(chain, "") if chain else "", self.partings.get(story.property)
            if near is None:
                texts.append(story_text(story, self._place, where))
            else:
                text = story_text(story, self._place, where, (near.parting, near.story))
                texts.append(text + parting_text(near.parting, near.story, self._place))
            shown_at.setdefault(chain, f"above, at the end of the trace of `{story.property}`")
        text = "\n".join(texts)
        return text + explained(text, self.target.model, self._place)

    def _write_stories(self, stories: Sequence[Story], file: str) -> None:
        from roaml.views.story import as_html, as_mermaid  # noqa: PLC0415

        if file.endswith(".html"):
            near = {name: (near.parting, near.story) for name, near in self.partings.items()}
            text = as_html(stories, self._place, shown_path(self.options.main), near)
        elif file.endswith(".mmd"):
            text = "\n".join(as_mermaid(story, self._place) for story in stories)
        else:
            text = self._story_texts(stories)
        if file == STANDARD_OUTPUT_PATH:
            # With a format for programs, standard output contains only the results.
            print_text(text, stream=sys.stdout if self.options.format is Format.TEXT else sys.stderr)
        else:
            self.outputs.write(file, text)


def _except(names: list[str]) -> str:
    """A note that names the properties to which a statement does not apply; "" if there are none."""
    shown = ", ".join(f"`{name}`" for name in names[:MAX_NAMED])
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    return f" (not of {shown}{more})" if names else ""


def _diagnostic(options: argparse.Namespace, fault: FaultError) -> Diagnostic | None:
    """A diagnostic for an undefined operation of the model, with its position, and the trace that shows it in the
    message; `None` if the position is unknown."""
    if fault.origin is None and not options.main.endswith(".jani"):
        return None
    origin = fault.origin or Location(os.path.abspath(options.main), Span(0, 0))
    return Diagnostic(origin.path, fault.code, Severity.ERROR, origin.span, fault_message(fault, options.seed or 0))


def _source_of(target: VerificationTarget) -> Callable[[str], SourceFile]:
    """A function that returns the text of a file from which a target was read."""

    def source_of(path: str) -> SourceFile:
        source = target.source_of(path)
        assert source is not None
        return source

    return source_of


def _fault(options: argparse.Namespace, target: VerificationTarget, fault: FaultError) -> int:
    """Report a model that cannot be run at all; return the exit status."""
    diagnostic = _diagnostic(options, fault)
    if diagnostic is None:
        complain(f"{shown_path(options.main)}: {fault.message}")
        if options.format is Format.JSON:
            print_text(as_json((), [{"message": fault.message, "code": fault.code}]), "utf-8")
        return FOUND
    return _errors(options, report_of((diagnostic,), _source_of(target), len(target.files)))


def _errors(options: argparse.Namespace, report: CheckReport) -> int:
    if options.format is Format.JSON:
        print_text(as_json((), [_row(finding) for finding in report.entries]), "utf-8")
    elif options.format not in (Format.TEXT, Format.CSV):
        print_text(render(report, options.format), "utf-8")
    else:
        print_text(render(report, Format.TEXT), stream=sys.stderr)
    return FOUND


def _row(finding: Entry) -> dict[str, Any]:
    place = finding.place
    return {
        "file": finding.file,
        "line": place.line,
        "column": place.column,
        "code": finding.code,
        "message": finding.message,
    }


def _fail(message: str) -> int:
    complain(message)
    return USAGE
