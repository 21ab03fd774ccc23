# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp check PATH...`, or `as2fm-lsp --check PATH...`"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli import baseline
from as2fm_lsp.cli.arguments import ArgumentParser, unknown_rule
from as2fm_lsp.cli.exit_status import CLEAN, FAILURE, FOUND, USAGE
from as2fm_lsp.cli.formats import CheckReport, render
from as2fm_lsp.cli.formats.report import Entry, entry, shown_path
from as2fm_lsp.cli.options import check_options
from as2fm_lsp.cli.output import complain, detail, is_quiet, note, print_text, takes_color
from as2fm_lsp.cli.parameters import ParameterFileError, with_parameter_files
from as2fm_lsp.cli.standard_input import STANDARD_INPUT_PATH, named_input
from as2fm_lsp.cli.tree_semantics import semantics_of
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, OutputFiles, outputs_of
from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.project.configuration import find_settings
from roaml.project.explored_findings import CODES
from roaml.project.settings import SEVERITIES, Settings, ament_prefixes
from roaml.record import replace
from roaml.rules import BY_CODE
from roaml.rules.files import internal_error

_CRASH = internal_error.RULE.code

EXAMPLES = """\
examples:
  as2fm-lsp check main.xml                 check a system and all of its files
  as2fm-lsp check models --ros-path msgs --format github
  as2fm-lsp check . --warnings-as-errors --baseline .as2fm-baseline.json
  as2fm-lsp check - < main.xml             check a text; --stdin-filename gives it a name
  as2fm-lsp check models --fix             make all safe fixes, report the remaining findings

exit status: 0 no errors, 1 errors found, 2 usage error, 3 internal error
"""


def run(arguments: Sequence[str]) -> int:
    return check(parser().parse_args(arguments), "check")


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp check",
        description="Report what is wrong in systems, other files and folders. as2fm-lsp --check does the same.",
        epilog=EXAMPLES,
    )
    check_options(result)
    return result


def check(options: argparse.Namespace, name: str = "--check") -> int:
    """Run a check with parsed options; return the exit status. `name` is the name of the command, for error
    messages."""
    misuse = _misuse(options, name)
    if misuse:
        return _usage(*misuse)
    stdin = options.stdin_filename
    paths = [path for path in options.paths if path != STANDARD_INPUT_PATH]
    texts: Mapping[str, bytes] | None = None
    if _reads_input(options):
        stdin, texts = named_input(STANDARD_INPUT_PATH, options)
        paths.append(stdin)
    settings, problems = find_settings(os.path.abspath(stdin or paths[0]))
    if problems and not settings.origin:  # errors in a configuration file are reported as diagnostics
        for problem in problems:
            complain(problem)
        return USAGE
    settings = replace(
        settings,
        ament_prefixes=ament_prefixes(),
        overrides=replace(settings.overrides, semantics=semantics_of(options), values=tuple(options.set)),
        select=frozenset(options.select) or settings.select,
        ignore=(settings.ignore - set(options.select)) | set(options.ignore),
    )
    began = time.monotonic()
    try:
        result = _result(paths, options, with_parameter_files(settings, options.params_file), texts)
        outputs = outputs_of(options, result.files)
        if options.fix and (fixed := api.fix(result)):
            for path, data in fixed.items():
                write_file(path, data)
                note(f"fixed {shown_path(path)}")
            result = _result(paths, options, with_parameter_files(settings, options.params_file), None)
    except (api.PathError, api.ParameterError, ParameterFileError) as error:
        return _usage(str(error))
    except OSError as error:
        return _usage(f"{shown_path(str(error.filename))}: {error.strerror or error}")
    _write_details(result, settings, time.monotonic() - began)
    return _reported(options, result, outputs, strict=options.warnings_as_errors or settings.warnings_as_errors)


def _reads_input(options: argparse.Namespace) -> bool:
    """Whether one of the files is standard input."""
    return options.stdin_filename is not None or STANDARD_INPUT_PATH in options.paths


def _misuse(options: argparse.Namespace, name: str) -> list[str]:
    """The errors in the options, as messages."""
    if not options.paths and options.stdin_filename is None:
        return [f"{name} needs at least one PATH"]
    if options.stdin_filename is not None and os.path.isdir(options.stdin_filename):
        return [f"{options.stdin_filename}: --stdin-filename needs the name of a file"]
    if options.fix and _reads_input(options):
        return ["--fix changes files; it cannot be used with standard input"]
    return [unknown_rule(code) for code in sorted({*options.select, *options.ignore} - BY_CODE.keys())]


def _reported(options: argparse.Namespace, result: api.CheckResult, outputs: OutputFiles, *, strict: bool) -> int:
    """Write the report, and return the exit status."""
    lowest = SEVERITIES[options.severity]
    failed = any(d.code == _CRASH for d in result.diagnostics)
    shown = [d for d in result.diagnostics if d.severity >= lowest or d.code == _CRASH]
    if options.fix and (more := _unsafe(shown)):
        note(more)
    entries = [entry(d, result.source, shown_path) for d in shown]
    if options.baseline is not None:
        try:
            entries = baseline.apply(options.baseline, entries)
        except baseline.BaselineError as error:
            return _usage(str(error))
    color = options.output is None and takes_color(sys.stdout)
    limit = Severity.WARNING if strict else Severity.ERROR
    report = CheckReport(entries, len(result.files), limit, color, not is_quiet(), len(result.ignored))
    try:
        _write(options, outputs, report)
    except OSError as error:
        if options.output is None:
            raise
        return _usage(f"{options.output}: {error.strerror or error}")
    if failed:
        return FAILURE
    return FOUND if any(e.diagnostic.severity >= report.limit for e in entries) else CLEAN


def _write_details(result: api.CheckResult, settings: Settings, seconds: float) -> None:
    """What `--verbose` shows: the settings, the checked files, the systems whose states were not explored, and how long
    it took."""
    detail(f"settings: {shown_path(settings.origin) if settings.origin else 'the defaults'}")
    for path in result.files:
        detail(f"checked {shown_path(path)}")
    for path in filter(result.files.__contains__, result.snapshot.analysis.system_paths):
        if result.snapshot.checker.has_too_many_states(path):
            codes = ", ".join(sorted(CODES))
            detail(f"{shown_path(path)} is too large to be explored, so these rules did not check it: {codes}")
    detail(f"{len(result.files)} files in {seconds:.2f} s")


def _result(
    paths: Sequence[str], options: argparse.Namespace, settings: Settings, texts: Mapping[str, bytes] | None
) -> api.CheckResult:
    """The result of the check.

    Raises:
        api.PathError: as `api.check`.
        api.ParameterError: no system declares a parameter that `--set` names.
    """
    result = api.check(paths, options.ros_path, settings, texts)
    if settings.overrides.values:
        from roaml.api.systems import unknown_parameter  # noqa: PLC0415 - imports the translation

        analysis = result.snapshot.analysis
        if undeclared := unknown_parameter(analysis, analysis.system_paths, settings.overrides):
            raise api.ParameterError(f"--set: {undeclared}")
    return result


def _unsafe(diagnostics: Sequence[Diagnostic]) -> str:
    """A line that states how many findings have only fixes that need a review; "" if there are none."""
    counts = Counter(
        diagnostic.code for diagnostic in diagnostics if diagnostic.fixes and not any(f.safe for f in diagnostic.fixes)
    )
    if not counts:
        return ""
    total = sum(counts.values())
    have = "finding has a fix that is" if total == 1 else "findings have fixes that are"
    names = ", ".join(f"{code} ({count})" if count > 1 else code for code, count in sorted(counts.items()))
    return f"{total} more {have} not safe to apply without a review; an editor offers them: {names}"


def _write(options: argparse.Namespace, outputs: OutputFiles, report: CheckReport) -> None:
    text = _statistics(report.entries) if options.statistics else render(report, options.format)
    if options.output not in (None, STANDARD_OUTPUT_PATH):
        outputs.write(options.output, text)
    else:
        print_text(text, options.format.encoding)


def _statistics(entries: Sequence[Entry]) -> str:
    """The number of findings of each rule, the most frequent first."""
    counts = Counter((e.code, e.severity) for e in entries)
    rows = sorted(counts.items(), key=lambda row: (-row[1], row[0]))
    return "".join(f"{count:6} {severity:<12} {code}\n" for (code, severity), count in rows)


def _usage(*messages: str) -> int:
    for message in messages:
        complain(message)
    return USAGE
