# SPDX-License-Identifier: Apache-2.0
"""Arguments of the sub-commands that run a model, and functions that read the named model."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Mapping

from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.formats import CheckReport
from as2fm_lsp.cli.formats.report import entry, shown_path
from as2fm_lsp.cli.mock_options import MESSAGES, add_mock_options, declarations_in
from as2fm_lsp.cli.output import takes_color
from as2fm_lsp.cli.parameters import ParameterFileError, add_set, with_parameter_files
from as2fm_lsp.cli.standard_input import add_stdin_filename, named_input
from as2fm_lsp.cli.times import add_reaction_time, time_of
from as2fm_lsp.cli.tree_semantics import add_semantics, semantics_of
from as2fm_lsp.mocked_models import check_declarations, load_mocked_tree, mocked_system_texts, names_tree
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.jani.node import Origin
from roaml.mocks.mock import MockError
from roaml.model.parameters import Overrides
from roaml.project.configuration import find_settings
from roaml.project.settings import Settings, ament_prefixes
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.text import SourceFile
from roaml.verification.target import VerificationTarget


class UsageError(ValueError):
    """Wrong arguments; the message contains the reason."""


def add_model_arguments(parser: ArgumentParser, *, reads_input: bool = True) -> None:
    """Add the options that determine the model, except `main`. `reads_input` states whether it may be standard
    input."""
    add = parser.add_argument
    add("--max-time", type=time_of, metavar="TIME", help='overrides <max_time> of MAIN.xml, for example "100 s"')
    add_reaction_time(parser)
    add("--constant", action="append", default=[], metavar="NAME=VALUE", help="sets a constant of "
        "MODEL.jani, also one that has a value there; may be repeated")  # fmt: skip
    add("--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interface packages")
    add_semantics(parser)
    if reads_input:
        add_stdin_filename(parser)
    add_set(parser)
    add_mock_options(parser)


def read_standard_input(options: argparse.Namespace) -> None:
    """If the model is `-`, read it, and set `main` to the name by which it is known. `texts` then contains its text."""
    options.main, options.texts = named_input(options.main, options)


def settings_of(path: str) -> Settings:
    """The settings for a file.

    Raises:
        UsageError: the configuration has errors.
    """
    settings, problems = find_settings(os.path.abspath(path))
    if problems:
        raise UsageError(problems[0])
    return replace(settings, ament_prefixes=ament_prefixes())


def check_model_arguments(options: argparse.Namespace) -> None:
    """Check that the options fit the kind of the model.

    Raises:
        UsageError: an option does not fit the kind of the model.
    """
    if options.main.endswith(".jani"):
        if options.max_time is not None:
            raise UsageError("--max-time needs a system; a JANI model has no such parameter")
        if options.set or options.params_file:
            raise UsageError("--set and --params-file need a system; a JANI model has constants, which --constant sets")
    elif options.constant:
        raise UsageError("--constant needs a JANI model; a system has no constants")
    try:
        check_declarations(options.main, declarations_in(options), options.texts)
    except MockError as error:
        raise UsageError(str(error)) from None


def read_target(options: argparse.Namespace, settings: Settings) -> VerificationTarget:
    """The model that the arguments name.

    Raises:
        api.PathError, api.ConstantError, api.ModelError, api.JaniError: as `api.target`.
        UsageError: leaves of a tree have no mock, or mocks are not valid.
    """
    texts: Mapping[str, str | bytes] = options.texts
    try:
        declared = declarations_in(options)
        if names_tree(options.main, options.texts):
            if options.set or options.params_file:
                raise UsageError("--set and --params-file need a system; a tree without one declares no parameters")
            settings = with_reaction_time(settings, options)
            return load_mocked_tree(
                options.main, declared, options.max_time, settings, MESSAGES, counts=False, texts=options.texts
            ).target
        settings = with_parameter_files(settings, options.params_file)
        overrides = Overrides(
            options.max_time, None, options.reaction_time, semantics=semantics_of(options), values=tuple(options.set)
        )
        if not declared.is_empty:
            around = replace(settings, overrides=overrides)
            texts = mocked_system_texts(options.main, declared, options.ros_path, around, MESSAGES, options.texts)
    except (MockError, ParameterFileError) as error:
        raise UsageError(str(error)) from None
    return api.target(options.main, options.ros_path, settings, texts, overrides, options.constant)


def with_reaction_time(settings: Settings, options: argparse.Namespace) -> Settings:
    """The settings with the reaction time of the command line, for a tree, whose file states none."""
    return settings if options.reaction_time is None else replace(settings, reaction_time=options.reaction_time)


def error_report(error: api.ModelError | api.JaniError) -> CheckReport:
    """The diagnostics of a model with errors, for standard error."""
    if isinstance(error, api.ModelError):
        diagnostics = error.result.diagnostics
        if error.unset:
            diagnostics = tuple(
                replace(d, message=f"{d.message}, with `--entry {name}=VALUE`") if name else d
                for d, name in zip(diagnostics, error.unset, strict=True)
            )
        return report_of(diagnostics, error.result.source, len(error.result.files))
    source = error.source
    return report_of(error.diagnostics, lambda _: source, 1)


def report_of(diagnostics: Iterable[Diagnostic], source_of: Callable[[str], SourceFile], count: int) -> CheckReport:
    """A report with the diagnostics of `count` files, for standard error."""
    entries = [entry(diagnostic, source_of, shown_path) for diagnostic in diagnostics]
    return CheckReport(entries, count, color=takes_color(sys.stderr))


def line_of(target: VerificationTarget, origin: Origin | None, folder: str = os.curdir) -> str:
    """File and line of an origin; "" if they are not known. The path is relative to `folder`."""
    place = target.place(origin)
    return "" if place is None else f"{shown_path(place.path, folder)}:{place.line}"


def fault_text(target: VerificationTarget, fault: FaultError) -> str:
    """A message for a run that cannot continue: the error in the model, with its position."""
    place = line_of(target, fault.origin)
    return f"{place}: {fault.message}" if place else fault.message
