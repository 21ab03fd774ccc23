# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp format PATH...`: format files."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.diff import unified
from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.output import complain, print_text
from roaml.disk import UnreadableReason
from roaml.ide.formatting import can_format, format_edits, has_formatter
from roaml.language import HL_SCXML
from roaml.model.dialect import dialect_of
from roaml.model.kinds import FileKind
from roaml.model.machine import Dialect
from roaml.project.analysis import Analysis
from roaml.project.configuration import find_settings
from roaml.project.discover import candidates
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import SourceFile, apply_edits

EXAMPLES = """\
examples:
  as2fm-lsp format models                  format all files of a folder
  as2fm-lsp format models --check          list the files that are not formatted
  as2fm-lsp format main.xml --diff         show what would change

exit status: 0 all files are formatted, 1 a file is not well-formed, or (with --check or --diff) not formatted, 2 usage
error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    settings, problems = find_settings(os.path.abspath(options.paths[0]))
    if problems:
        return _fail(problems[0])
    folders = dict.fromkeys(path for path in map(os.path.abspath, options.paths) if os.path.isdir(path))
    analysis = Workspace(folders, settings).snapshot().analysis
    for path in options.paths:
        if not os.path.isdir(path) and (problem := _problem(analysis, os.path.abspath(path))):
            return _fail(f"{path}: {problem}")
    status = CLEAN
    for path in dict.fromkeys(_files(analysis, options.paths, settings)):
        source = analysis.source(path)
        if source is None:
            continue
        if source.undecodable is not None or not can_format(analysis, path):
            complain(f"{shown_path(path)}: not well-formed, so it is not changed")
            status = FOUND
            continue
        text = apply_edits(source.text, format_edits(analysis, path))
        if text == source.text:
            continue
        if options.check or options.diff:
            status = FOUND
        if options.diff:
            print_text("".join(_diff(source, text)))
        elif options.check:
            print_text(f"{shown_path(path)}\n")
        else:
            try:
                write_file(path, source.encode(text))
            except OSError as error:
                return _fail(f"{shown_path(path)}: {error.strerror or error}")
            print_text(f"formatted {shown_path(path)}\n")
    return status


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp format",
        description="Format machines, trees, system files, struct declarations and property files. Only white "
        "space is changed, never the meaning of a file. Plain SCXML, JANI models and files of other tools are "
        "formatted "
        "only if they are named.",
        epilog=EXAMPLES,
    )
    result.add_argument("paths", nargs="+", metavar="PATH", help="files, or folders that are searched for them")
    mode = result.add_mutually_exclusive_group()
    mode.add_argument("--check", action="store_true", help="list the files that would change and write nothing")
    mode.add_argument("--diff", action="store_true", help="show the changes and write nothing")
    return result


def _problem(analysis: Analysis, path: str) -> str:
    """The reason why a given file cannot be formatted; "" if it can be formatted."""
    source = analysis.files.read(path)
    if isinstance(source, UnreadableReason):
        return source.value
    return "" if has_formatter(analysis, path) else "it is neither a model nor a property file"


def _files(analysis: Analysis, paths: Sequence[str], settings: Settings) -> Iterator[str]:
    """The given files, and the source files of supported languages in the given folders."""
    for path in map(os.path.abspath, paths):
        if not os.path.isdir(path):
            yield path
            continue
        for candidate in candidates((path,), settings.exclude):
            if has_formatter(analysis, candidate) and _is_hand_written(analysis, candidate):
                yield candidate


def _is_hand_written(analysis: Analysis, path: str) -> bool:
    """Whether a file is a source, and not the output of a tool: it is not a JANI model, and it is listed by a system or
    is not in a similar format such as plain SCXML."""
    kind, document = analysis.kind(path), analysis.document(path)
    if kind is FileKind.JANI_MODEL or path in analysis.memberships:
        return kind is not FileKind.JANI_MODEL
    if kind is FileKind.STRUCTS:
        return document is not None and document.root is not None and document.root.find("struct") is not None
    if kind is not FileKind.MACHINE:
        return True
    machine = analysis.machine(path)
    if machine is None or document is None or machine.root not in HL_SCXML.roots:
        return False
    return dialect_of(machine, document, None) in (Dialect.CURRENT, Dialect.OLDER)


def _diff(source: SourceFile, text: str) -> Iterator[str]:
    name = shown_path(source.path)
    return unified(source.text, text, name, name)


def _fail(message: str) -> int:
    complain(message)
    return USAGE
