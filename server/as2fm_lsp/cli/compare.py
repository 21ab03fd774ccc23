# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp compare OLD NEW`: what changed between two versions of a model, and how the values of its properties
differ (docs/comparison.md)."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack

from as2fm_lsp.cli.arguments import ArgumentParser, WordAction
from as2fm_lsp.cli.compare_report import ComparedSide, CompareFormat, ComparisonReport, as_report
from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.experiment_arguments import computed_options
from as2fm_lsp.cli.formats import CheckReport, Format, render
from as2fm_lsp.cli.formats.report import entry, shown_path
from as2fm_lsp.cli.interrupts import Interrupts
from as2fm_lsp.cli.kernel_note import kernel_warning
from as2fm_lsp.cli.mock_options import declarations_in
from as2fm_lsp.cli.model_arguments import (
    UsageError,
    add_model_arguments,
    check_model_arguments,
    read_target,
    settings_of,
)
from as2fm_lsp.cli.numbers import positive
from as2fm_lsp.cli.output import complain, print_text, takes_color
from as2fm_lsp.cli.status_line import StatusLine
from as2fm_lsp.cli.verify_arguments import add_sampling
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, OutputFiles, OutputFolder, OutputPath, outputs_of
from as2fm_lsp.revisions import ModelVersion, RevisionError, model_version
from roaml import api
from roaml.api.comparing import ComparedVersion, StructuralChanges, compare_structure, compare_values
from roaml.diagnostics import Diagnostic
from roaml.exhaustive import Vocabulary, assert_never
from roaml.experiments.changes import ValueChange
from roaml.jani.property_text import PropertyTextError
from roaml.mocks.mock import MockError
from roaml.text import SourceFile
from roaml.verification.target import VerificationTarget

EXAMPLES = """\
examples:
  as2fm-lsp compare old/main.xml new/main.xml
  as2fm-lsp compare HEAD:main.xml                       the working tree with the last commit
  as2fm-lsp compare origin/main:robot/main.xml HEAD:robot/main.xml --format markdown -o change.md --pictures pictures
  as2fm-lsp compare old.xml new.xml --format html -o change.html
  as2fm-lsp compare main:tree.xml tree.xml --mock "*: 0.9 in 1 s"
  as2fm-lsp compare HEAD:main.xml --property delivered --method adaptive --epsilon 0.001

exit status: 0 no difference of the kind that --fail-on names; 1 there is one, or NEW has errors; 2 usage error; 3
internal error; 130 interrupted (143 by SIGTERM)
"""


class FailOn(Vocabulary):
    """The differences that make the exit status 1."""

    EXPECTATION = "expectation"
    VALUE = "value"
    ANY = "any"


def run(arguments: Sequence[str]) -> int:
    print_text(kernel_warning(), stream=sys.stderr)
    with Interrupts() as interrupts:
        try:
            return _run(parser().parse_args(arguments))
        except (UsageError, RevisionError, PropertyTextError, MockError, api.ConstantError) as error:
            complain(str(error))
        except (api.PathError, api.PropertyError, api.ParameterError) as error:
            complain(str(error))
        except BrokenPipeError:
            raise
        except OSError as error:
            complain(f"{shown_path(str(error.filename or ''))}: {error.strerror or error}")
        except KeyboardInterrupt:
            return interrupts.without_results()
    return USAGE


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp compare",
        description="Compare two versions of a model: pictures of what changed, and the difference of each property's "
        "value with its significance.",
        epilog=EXAMPLES,
    )
    add = result.add_argument
    add("old", metavar="OLD", help="a system, tree, machine or JANI model; REVISION:PATH is a file as in a revision of "
        "the git repository")  # fmt: skip
    add("new", nargs="?", metavar="NEW", help="the new version (default: the file of OLD in the working tree)")
    add("--property", action="append", default=[], metavar="NAME", help="compare only this property; may be repeated")
    add("--structure", action="store_true", help="compare no values")
    add("--scheduler", choices=("uniform",), help="the values under uniform choices, instead of the minimum or "
        "maximum over all schedulers")  # fmt: skip
    add("--exhaustive", "--exact", action="store_true", help="only exact values, however many states there are")
    add("--max-states", type=positive, metavar="N", help="explore at most N states for each property")
    add("--max-transitions", type=positive, metavar="N", help="without --exhaustive: explore at most N transitions for "
        "each property (8000000)")  # fmt: skip
    add_sampling(result, has_jobs=False)
    add_model_arguments(result, reads_input=False)
    add("--fail-on", action=WordAction, words=FailOn, default=FailOn.VALUE, help="the differences with exit status 1: "
        "an expectation that is no longer met; also a value that changed, exactly or significantly, appeared or "
        "disappeared (default); or any")  # fmt: skip
    add("--format", action=WordAction, words=CompareFormat, default=CompareFormat.TEXT, help="format of the report")
    add("-o", "--output", type=OutputPath, metavar="FILE", help="write the report into a file")
    add("--pictures", type=OutputFolder, metavar="DIR", help="write the pictures as SVG files into this folder")
    return result


def _run(options: argparse.Namespace) -> int:
    computed = computed_options(options)
    new = _new_of(options.old) if options.new is None else options.new
    with ExitStack() as stack, StatusLine() as status:
        versions = [stack.enter_context(model_version(text)) for text in (options.old, new)]
        status.stage("comparing the structure")
        structure = _structure(options, versions)
        targets: list[VerificationTarget | None] = [None, None]
        if not options.structure:
            status.stage("translating")
            targets = [_target(options, version) for version in versions]
        values: tuple[ValueChange, ...] = ()
        before, after = targets
        if after is not None:
            status.stage("computing the values")
            values = compare_values(before, after, options.property or None, computed)
        files = [file for version in versions for file in (version.path,)]
        outputs = outputs_of(options, [*files, *(f for target in targets if target for f in target.files)])
    report = ComparisonReport(
        ComparedSide(versions[0].name, None if options.structure else before is not None),
        ComparedSide(versions[1].name, None if options.structure else after is not None),
        structure,
        values,
        computed.sampling.confidence,
        computed.only_uniform,
    )
    _write(options, outputs, report)
    has_errors = not options.structure and _has_values(versions[1]) and after is None
    return FOUND if has_errors or _fails(options.fail_on, report) else CLEAN


def _new_of(old: str) -> str:
    """The file of the working tree that `REVISION:PATH` names."""
    _, colon, path = old.partition(":")
    if not colon or os.path.exists(old):
        raise UsageError(f"name the new version, too: as2fm-lsp compare {old} NEW")
    if not os.path.exists(path):
        raise UsageError(f"there is no file `{path}` in the current folder; name the new version, too")
    return path


def _structure(options: argparse.Namespace, versions: Sequence[ModelVersion]) -> StructuralChanges:
    declared = declarations_in(options)
    mocks = declared.mocks() if declared.has_mocks else None
    old, new = (ComparedVersion(version.path, settings_of(version.path), None, mocks) for version in versions)
    return compare_structure(old, new, options.ros_path)


def _has_values(version: ModelVersion) -> bool:
    """Whether a model has values: systems, trees and JANI models have, single machines have none."""
    return not version.path.endswith((".ascxml", ".scxml"))


def _target(options: argparse.Namespace, version: ModelVersion) -> VerificationTarget | None:
    """The model of a version; `None` if it has errors, which are reported, or is a single machine."""
    if not _has_values(version):
        return None
    asked = argparse.Namespace(**{**vars(options), "main": version.path, "texts": {}})
    check_model_arguments(asked)
    try:
        return read_target(asked, settings_of(version.path))
    except api.ModelError as error:
        _complain(version, error.result.diagnostics, error.result.source)
    except api.JaniError as error:
        source = error.source
        _complain(version, error.diagnostics, lambda _: source)
    return None


def _complain(version: ModelVersion, diagnostics: Iterable[Diagnostic], source_of: Callable[[str], SourceFile]) -> None:
    """Report the errors of a version on standard error."""
    shown = version.shown if version.root else shown_path
    entries = [entry(diagnostic, source_of, shown) for diagnostic in diagnostics]
    report = CheckReport(entries, 0, color=takes_color(sys.stderr), has_summary=False)
    print_text(render(report, Format.TEXT), stream=sys.stderr)


def _write(options: argparse.Namespace, outputs: OutputFiles, report: ComparisonReport) -> None:
    links: dict[str, str] = {}
    if options.pictures is not None:
        os.makedirs(options.pictures, exist_ok=True)
        folder = os.path.dirname(options.output or "") or "."
        for picture in report.structure.pictures:
            name = "".join(c if c.isalnum() else "_" for c in picture.title.removeprefix("state machine ")) + ".svg"
            path = os.path.join(options.pictures, name)
            outputs.write(path, picture.svg())
            links[picture.title] = os.path.relpath(path, folder).replace(os.sep, "/")
    text = as_report(report, options.format, links)
    if options.output is None or options.output == STANDARD_OUTPUT_PATH:
        print_text(text, encoding=None if options.format is CompareFormat.TEXT else "utf-8")
    else:
        outputs.write(options.output, text)


def _fails(fail_on: FailOn, report: ComparisonReport) -> bool:
    """Whether the new version fails. If the old one has errors, its missing values are no difference: the new version
    repairs them."""
    is_missed = any(value.is_newly_missed or value.lacks_expected for value in report.values)
    differs = report.old.has_values is True and any(value.differs for value in report.values)
    match fail_on:
        case FailOn.EXPECTATION:
            return is_missed
        case FailOn.VALUE:
            return is_missed or differs
        case FailOn.ANY:
            return is_missed or differs or not report.structure.is_empty
    return assert_never(fail_on)
