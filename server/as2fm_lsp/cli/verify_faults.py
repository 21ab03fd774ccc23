# SPDX-License-Identifier: Apache-2.0
"""Errors of a model that is verified: undefined operations, and files that cannot be read."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from typing import Any

from as2fm_lsp.cli.exit_status import FOUND
from as2fm_lsp.cli.formats import CheckReport, Format, render
from as2fm_lsp.cli.formats.report import Entry, entry, shown_path
from as2fm_lsp.cli.model_arguments import report_of
from as2fm_lsp.cli.output import complain, print_text
from as2fm_lsp.verification.report import as_json
from roaml.diagnostics import Diagnostic, Severity
from roaml.smc.fault import FaultError
from roaml.text import Location, SourceFile, Span
from roaml.verification.refusal import fault_message
from roaml.verification.target import VerificationTarget


def entries_of(options: argparse.Namespace, target: VerificationTarget, faults: Iterable[FaultError]) -> list[Entry]:
    """Errors in a model because of which properties could not be decided. Errors without a known position are
    omitted."""
    diagnostics = [_diagnostic(options, fault) for fault in faults]
    return [entry(diagnostic, source_of(target), shown_path) for diagnostic in diagnostics if diagnostic is not None]


def _diagnostic(options: argparse.Namespace, fault: FaultError) -> Diagnostic | None:
    """A diagnostic for an undefined operation of the model, with its position, and the trace that shows it in the
    message; `None` if the position is unknown."""
    if fault.origin is None and not options.main.endswith(".jani"):
        return None
    origin = fault.origin or Location(os.path.abspath(options.main), Span(0, 0))
    return Diagnostic(origin.path, fault.code, Severity.ERROR, origin.span, fault_message(fault, options.seed or 0))


def source_of(target: VerificationTarget) -> Callable[[str], SourceFile]:
    """A function that returns the text of a file from which a target was read."""

    def source(path: str) -> SourceFile:
        found = target.source_of(path)
        assert found is not None
        return found

    return source


def report_fault(options: argparse.Namespace, target: VerificationTarget, fault: FaultError) -> int:
    """Report a model that cannot be run at all; return the exit status."""
    diagnostic = _diagnostic(options, fault)
    if diagnostic is None:
        complain(f"{shown_path(options.main)}: {fault.message}")
        if options.format is Format.JSON:
            print_text(as_json((), [{"message": fault.message, "code": fault.code}]), "utf-8")
        return FOUND
    return report_errors(options, report_of((diagnostic,), source_of(target), len(target.files)))


def report_errors(options: argparse.Namespace, report: CheckReport) -> int:
    if options.format is Format.JSON:
        print_text(as_json((), [row_of(finding) for finding in report.entries]), "utf-8")
    elif options.format not in (Format.TEXT, Format.CSV):
        print_text(render(report, options.format), "utf-8")
    else:
        print_text(render(report, Format.TEXT), stream=sys.stderr)
    return FOUND


def row_of(finding: Entry) -> dict[str, Any]:
    place = finding.place
    return {
        "file": finding.file,
        "line": place.line,
        "column": place.column,
        "code": finding.code,
        "message": finding.message,
    }
