# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify MAIN.xml|MODEL.jani`: compute or estimate the probabilities of the model's properties, and
explain traces."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from contextlib import nullcontext
from typing import TYPE_CHECKING

from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats.report import shown_path
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
    settings_of,
    with_reaction_time,
)
from as2fm_lsp.cli.output import complain, flush, note, print_text
from as2fm_lsp.cli.progress_bar import ProgressBar
from as2fm_lsp.cli.status_line import StatusLine
from as2fm_lsp.cli.verify_arguments import (
    Scheduler,
    asks_for_traces,
    expectations_in,
    has_state_limits,
    limits_in,
    parser,
    state_limits_in,
)
from as2fm_lsp.cli.verify_report import Answered, print_faults, report_text
from as2fm_lsp.cli.workers import cluster
from as2fm_lsp.mocked_models import load_mocked_tree, names_tree
from as2fm_lsp.outputs import outputs_of
from as2fm_lsp.verification.doubts import can_get_stuck
from as2fm_lsp.verification.saved_state import SavedState, StateError
from roaml import api
from roaml.explicit.space import MAX_STATES, StateLimits
from roaml.record import replace
from roaml.scxml.names import SUCCEEDS
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.pool import Pool, WorkersLostError
from roaml.smc.run import EstimationMethod, Options
from roaml.smc.tally import Tally
from roaml.verification import stuck
from roaml.verification.exhaustive import ExplorationInterruptedError
from roaml.verification.expectations import Expectation
from roaml.verification.results import CutShort, Refused, Result
from roaml.verification.small import EXAMPLE_TRACES
from roaml.verification.verifier import NoThresholdError, Verifier

if TYPE_CHECKING:
    from roaml.mocks.network import MockedTree
    from roaml.project.settings import Settings
    from roaml.verification.searches import Searches
    from roaml.verification.tree_outcome import TreeOutcome

WIDTH_OF_TREES = 0.05
"""Half the width of the interval that the default number of traces of a tree guarantees for every probability."""
MAX_TRACES_IN_ONE_PROCESS = 20_000
"""The maximum number of traces of a tree that are generated in one process, because starting more processes would take
longer than it saves."""
NO_QUANTILES = (
    "--quantiles has no effect: it is about expected values, and no property asks for one; ask for one, for example "
    "with --property 'R{\"time\"}=? [ F CONDITION ]'"
)
NO_QUANTILES_OF_TREE = (
    "--quantiles has no effect: it is about expected values of systems; the line `time until success` of a tree has "
    "quantiles"
)
INTERRUPTED_QUANTILES = (
    "quantiles are missing, because their traces were interrupted; --max-traces asks for fewer traces"
)
NO_CURVES = (
    "--plot draws nothing: a property with an assumption (`||`) has no curve; ask for the property without it, or draw "
    "a variable with --over-time"
)
NO_CLOCK = "no time passes in this model, because it has no timer and no delay"
"""Why options have no effect, and what to do."""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    if slow := kernel_warning():
        note(slow)
    with Interrupts() as interrupts:
        try:
            return _checked(options, interrupts)
        except KeyboardInterrupt:
            return interrupts.without_results()


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
                limits=state_limits_in(options) if has_state_limits(options) else None,
                uniform=options.uniform or settings.uniform,
            )
    except (api.ModelError, api.JaniError) as error:
        from as2fm_lsp.cli.verify_faults import report_errors  # noqa: PLC0415

        return report_errors(options, error_report(error))
    except FaultError as fault:
        from as2fm_lsp.cli.verify_faults import report_fault  # noqa: PLC0415

        return report_fault(options, target, fault)
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
    from roaml.experiments.exact_trees import NotMeasuredError, measure_exactly  # noqa: PLC0415
    from roaml.verification.tree_outcome import (  # noqa: PLC0415 - systems start faster without it
        TRACES,
        affordable_traces,
        measure,
    )

    has_default = limits.max_traces is None
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
            outcome: TreeOutcome | str = ""  # a reason why there is none
            if options.exhaustive or not asks_for_traces(options):
                try:
                    outcome = measure_exactly(tree.mocked, tree.target, state_limits_in(options))
                except NotMeasuredError as error:
                    outcome = str(error)
            is_exact = not isinstance(outcome, str)
            if has_default and not is_exact:
                limits = replace(limits, max_traces=affordable_traces(tree.mocked, tree.target, limits))
            status.stage("compiling")
            names = options.property or [SUCCEEDS]
            verifier = api.verifier(
                tree.target,
                names,
                limits,
                expectations,
                only_uniform=True,
                exact_if_small=is_exact and not options.exhaustive,
                example_traces=EXAMPLE_TRACES,
                limits=state_limits_in(options),
            )
            if not is_exact and not options.exhaustive:
                status.stage("making traces")
                reason = outcome if isinstance(outcome, str) else ""
                outcome = replace(measure(tree.mocked, tree.target, limits), reason=reason)
    except api.MockError as error:
        raise UsageError(str(error)) from None
    except api.ModelError as error:
        from as2fm_lsp.cli.verify_faults import report_errors  # noqa: PLC0415

        return report_errors(options, error_report(error))
    return _Verification(options, verifier, interrupts, (tree.mocked, outcome)).run()


class _Verification:
    """One call of the command, after all files have been read. If a tree without a system is verified, `tree` contains
    the tree and its measurements, or the reason why there are none."""

    def __init__(
        self,
        options: argparse.Namespace,
        verifier: Verifier,
        interrupts: Interrupts,
        tree: tuple[MockedTree, TreeOutcome | str] | None = None,
    ) -> None:
        self.tree = tree
        self.options = options
        self.verifier = verifier
        self.interrupts = interrupts
        self.target = verifier.target
        self.limits = verifier.options
        self.outputs = outputs_of(options, self.target.files)
        self.stuck_result: stuck.StuckResult | None = None
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
            if not any(result.question is not None and result.question.is_reward for result in self.results):
                note(NO_QUANTILES if self.tree is None else NO_QUANTILES_OF_TREE)
            interrupted = not self._add_quantiles()
        status = self.interrupts.status if interrupted else CLEAN if self._is_met() else FOUND
        answered = Answered(
            self.options, self.verifier, tuple(self.results), tuple(self.faults), self.stuck_result, self.tree, status
        )
        print_text(report_text(answered), self.options.format.encoding)
        flush()
        print_faults(answered)
        self._note_unused_times()
        if not interrupted and (self.options.traces is not None or self.options.explain):
            from as2fm_lsp.cli.verify_stories import Explanations  # noqa: PLC0415 - most verifications explain nothing

            Explanations(answered, self.outputs).write()
        if not interrupted and self.options.plot:
            self._write_plots()
        return status

    def _is_met(self) -> bool:
        """Whether all properties have values, all expectations are met, and the check for stuck traces found no
        error."""
        if self.options.stuck is stuck.StuckLevel.ERROR and any(map(can_get_stuck, self.results)):
            return False
        return all(r.is_met for r in self.results) and (self.stuck_result is None or self.stuck_result.is_met)

    def _note_unused_times(self) -> None:
        """Say that options about times have no effect, because the model has no clock."""
        metadata = self.target.model.metadata
        given = {"--reaction-time": self.options.reaction_time, "--max-time": self.options.max_time}
        names = [name for name, value in given.items() if value is not None]
        if names and (metadata is None or metadata.clock is None):
            note(f"{' and '.join(names)} {'has' if len(names) == 1 else 'have'} no effect: {NO_CLOCK}")

    def _add_quantiles(self) -> bool:
        """Add the quantiles of rewards to the results. Return whether all were computed: an interruption leaves out the
        others, and no value."""
        try:
            for number, result in enumerate(self.results):
                self.results[number] = self._with_quantiles(result)
        except KeyboardInterrupt:
            self.interrupts.ignore()
            note(INTERRUPTED_QUANTILES)
            return False
        return True

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
        if not plots:
            note(NO_CURVES)
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


def _fail(message: str) -> int:
    complain(message)
    return USAGE
