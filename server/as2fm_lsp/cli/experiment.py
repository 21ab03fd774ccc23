# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp experiment MAIN.xml|MODEL.jani|FILE.experiment.toml`: compute properties for many values of parameters."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor

from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.experiment_arguments import (
    TableFormat,
    beside_in,
    computed_options,
    expectation_in,
    mocks_in,
    parsed,
    parser,
    units_in,
)
from as2fm_lsp.cli.formats import Format, render
from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.interrupts import Interrupts
from as2fm_lsp.cli.kernel_note import kernel_warning
from as2fm_lsp.cli.live_experiment import LiveExperiment
from as2fm_lsp.cli.model_arguments import UsageError, error_report, settings_of
from as2fm_lsp.cli.output import complain, print_text
from as2fm_lsp.cli.parameters import ParameterFileError, with_parameter_files
from as2fm_lsp.cli.plot_files import write_plots
from as2fm_lsp.cli.status_line import StatusLine
from as2fm_lsp.cli.tree_semantics import semantics_of
from as2fm_lsp.cli.workers import cluster
from as2fm_lsp.kept_points import KeptPoints, KeptPointsError
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, OutputFiles, outputs_of
from roaml import api
from roaml.exhaustive import assert_never
from roaml.experiments.beside import BesideValue
from roaml.experiments.enough import Enough, Met
from roaml.experiments.grid import Grid, Key
from roaml.experiments.points import ExperimentPoint, PointKind
from roaml.experiments.results import ExperimentResult
from roaml.experiments.sweeps import SweepError
from roaml.figures.plot import with_guide
from roaml.jani.property_text import PropertyTextError
from roaml.mocks.mock import MockError
from roaml.model.parameters import Overrides
from roaml.project.settings import Settings
from roaml.record import replace
from roaml.verification.expectations import Expectation

__all__ = ["parser", "run"]


def run(arguments: Sequence[str]) -> int:
    print_text(kernel_warning(), stream=sys.stderr)
    with Interrupts() as interrupts:
        try:
            return _run(parsed(arguments), interrupts)
        except (UsageError, SweepError, KeptPointsError, PropertyTextError, api.ConstantError) as error:
            complain(str(error))
        except (api.PathError, api.PropertyError, api.ParameterError, MockError) as error:
            complain(str(error))
        except (api.ModelError, api.JaniError) as error:
            print_text(render(error_report(error), Format.TEXT), stream=sys.stderr)
            return FOUND
        except BrokenPipeError:
            raise
        except OSError as error:
            complain(f"{shown_path(str(error.filename or ''))}: {error.strerror or error}")
        except KeyboardInterrupt:
            return interrupts.without_results()
    return USAGE


def _run(options: argparse.Namespace, interrupts: Interrupts) -> int:
    units = units_in(options)
    computed = computed_options(options)
    expectation = expectation_in(options)
    is_interrupted = False
    with StatusLine() as status, cluster(options.dask) as (executor, workers):
        status.stage("reading and translating")
        overrides = Overrides(options.max_time, None, options.reaction_time, semantics=semantics_of(options))
        grid = api.grid_of(
            options.main,
            options.set,
            [expectation.name] if expectation is not None else options.property or None,
            computed,
            ros_paths=options.ros_path,
            settings=_settings(options),
            overrides=overrides,
            mocks=mocks_in(options),
        )
        beside = beside_in(options, grid)
        jobs = workers or options.jobs
        if options.live:
            return _show_live(options, grid, beside, expectation, units, jobs, executor)
        outputs = outputs_of(options, grid.files)
        if expectation is not None:
            return _find(options, grid, beside, expectation, outputs, jobs, executor)
        kept = KeptPoints(options.resume, grid.digest)
        keys = grid.keys
        points = {key: kept.points[key] for key in keys if key in kept.points}
        status.stage("computing the points")
        try:
            for point in grid.points(points, jobs, executor):
                points[point.setting, point.name] = point
                kept.keep(point)
                if status.is_due:
                    status.show(f"{len(points):,} of {len(keys):,} points")
        except KeyboardInterrupt:
            interrupts.ignore()
            is_interrupted = True
        kept.write()
    known = tuple(points[key] for key in keys if key in points)
    result = ExperimentResult(os.path.basename(options.main), grid.sweeps, grid.properties, known, grid.options, beside)
    _write_table(options, outputs, _table(result, options.format))
    for path in options.plot:
        write_plots(outputs, path, result.plots(units), options.theme, result.page_title, result.to_html_table())
    if is_interrupted:
        complain(f"interrupted: {len(known):,} of {len(keys):,} points are known")
        return interrupts.status
    return CLEAN if all(point.has_value for point in known) else FOUND


def _settings(options: argparse.Namespace) -> Settings:
    try:
        return with_parameter_files(settings_of(options.main), options.params_file)
    except ParameterFileError as error:
        raise UsageError(str(error)) from None


def _find(
    options: argparse.Namespace,
    grid: Grid,
    beside: tuple[BesideValue, ...],
    expectation: Expectation,
    outputs: OutputFiles,
    jobs: int,
    executor: Executor | None,
) -> int:
    """Print which values of a parameter are enough, below the points."""
    answers, result = api.find_enough(
        grid, options.find, expectation, is_assumed=options.assume_monotone, jobs=jobs, executor=executor
    )
    result = replace(result, path=os.path.basename(options.main), beside=beside)
    sentences = _sentences(answers, expectation, result, grid)
    table = _table(result, options.format)
    if options.format is TableFormat.TEXT:
        table += "".join(f"{sentence}\n" for sentence in sentences)
    elif options.format is TableFormat.MARKDOWN:
        table += "".join(f"\n{sentence}.\n" for sentence in sentences)
    elif options.format is TableFormat.JSON:
        found = [
            {"setting": dict(a.others), "values": {value: met.value for value, met in a.verdicts}} for a in answers
        ]
        table = json.dumps({**result.as_json(), "found": found, "assumed monotone": options.assume_monotone}, indent=2)
        table += "\n"
    _write_table(options, outputs, table)
    for path in options.plot:
        plots = with_guide(result.plots(units_in(options)), expectation.threshold.number, expectation.text)
        write_plots(outputs, path, plots, options.theme, result.page_title, result.to_html_table())
    return CLEAN if any(met is Met.YES for answer in answers for _, met in answer.verdicts) else FOUND


def _sentences(answers: Sequence[Enough], expectation: Expectation, result: ExperimentResult, grid: Grid) -> list[str]:
    """Which values are enough, as sentences without a full stop."""
    sentences = [answer.text(f"{expectation.name} {expectation.text}") for answer in answers]
    if any(point.kind is PointKind.ESTIMATE for point in result.points):
        confidence = grid.options.sampling.confidence
        sentences.append(f"the intervals of all points are right together with {confidence:g} confidence")
    return sentences


def _show_live(
    options: argparse.Namespace,
    grid: Grid,
    beside: tuple[BesideValue, ...],
    expectation: Expectation | None,
    units: Mapping[str, str],
    jobs: int,
    executor: Executor | None,
) -> int:
    """Write the state of the experiment for an editor while it runs. An editor cancels it by ending this process."""
    keys = grid.keys
    live = LiveExperiment(os.path.abspath(options.main), options.mock, len(keys), units)
    points: dict[Key, ExperimentPoint] = {}
    guide = None if expectation is None else (expectation.threshold.number, expectation.text)

    def result() -> ExperimentResult:
        known = tuple(points[key] for key in keys if key in points)
        return ExperimentResult(options.main, grid.sweeps, grid.properties, known, grid.options, beside)

    def keep(point: ExperimentPoint, *_: int) -> None:
        points[point.setting, point.name] = point
        if live.is_due:
            live.write(result(), guide)

    live.write(result(), guide)
    sentences: list[str] = []
    if expectation is None:
        for point in grid.points((), jobs, executor):
            keep(point)
    else:
        answers, found = api.find_enough(
            grid,
            options.find,
            expectation,
            is_assumed=options.assume_monotone,
            jobs=jobs,
            executor=executor,
            watch=keep,
        )
        sentences = _sentences(answers, expectation, found, grid)
    live.write(result(), guide, sentences)
    return CLEAN if all(point.has_value for point in points.values()) else FOUND


def _write_table(options: argparse.Namespace, outputs: OutputFiles, table: str) -> None:
    if options.output is None or options.output == STANDARD_OUTPUT_PATH:
        print_text(table)
    else:
        outputs.write(options.output, table)


def _table(result: ExperimentResult, format_: TableFormat) -> str:
    match format_:
        case TableFormat.TEXT:
            return result.to_text()
        case TableFormat.CSV:
            return result.to_csv()
        case TableFormat.JSON:
            return json.dumps(result.as_json(), ensure_ascii=False, indent=2) + "\n"
        case TableFormat.MARKDOWN:
            return result.to_markdown()
        case _:
            return assert_never(format_)
