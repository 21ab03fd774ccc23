# SPDX-License-Identifier: Apache-2.0
"""Options that a sub-command shares with the form without a sub-command: `check PATH` and `--check PATH`."""

from __future__ import annotations

import argparse

from as2fm_lsp.cli.arguments import WordAction
from as2fm_lsp.cli.formats import Format
from as2fm_lsp.cli.parameters import add_set
from as2fm_lsp.cli.standard_input import add_stdin_filename
from as2fm_lsp.cli.tree_semantics import add_semantics
from as2fm_lsp.outputs import InputPath, OutputPath
from roaml.diagnostics import current_code
from roaml.project.settings import SEVERITIES

DIAGNOSTIC_FORMATS = tuple(format_ for format_ in Format if format_ is not Format.CSV)


def check_options(check: argparse._ActionsContainer) -> None:
    """Add the options of a check."""
    check.add_argument(
        "--fix",
        action="store_true",
        help="first apply all safe fixes: those that do not guess and do not change the behaviour of a model",
    )
    check.add_argument(
        "paths",
        nargs="*",
        type=InputPath,
        metavar="PATH",
        help="system files, other files or folders; - is standard input",
    )
    check.add_argument(
        "--format", action=WordAction, words=DIAGNOSTIC_FORMATS, default=Format.TEXT, help="format of the diagnostics"
    )
    check.add_argument("--output", type=OutputPath, metavar="FILE", help="write to FILE instead of standard output")
    check.add_argument(
        "--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interface packages"
    )
    add_semantics(check)
    add_set(check)
    check.add_argument("--select", action=_Codes, default=[], metavar="CODE,...", help="report only these rules")
    check.add_argument("--ignore", action=_Codes, default=[], metavar="CODE,...", help="do not report these rules")
    check.add_argument("--severity", default="hint", choices=tuple(SEVERITIES), help="the minimum severity to report")
    check.add_argument("--warnings-as-errors", action="store_true", help="exit with 1 on warnings as well")
    check.add_argument("--statistics", action="store_true", help="count the findings of each rule")
    check.add_argument(
        "--baseline",
        type=InputPath,
        metavar="FILE",
        help="do not report the findings in FILE; create it if it does not exist",
    )
    add_stdin_filename(check)


def serve_options(serve: argparse._ActionsContainer) -> None:
    """Add the options that determine how the server is connected to its client."""
    serve.add_argument("--stdio", action="store_true", help="serve on standard input and output (default)")
    serve.add_argument(
        "--tcp",
        metavar="HOST:PORT",
        help="serve one editor on a port of this machine (0: any free port); the editor must send `token` in its "
        "initializationOptions, with the value that is printed, or that the environment variable AS2FM_TOKEN has",
    )
    serve.add_argument(
        "--allow-remote", action="store_true", help="with --tcp: also accept connections from other machines"
    )
    serve.add_argument(
        "--socket", metavar="FILE", help="serve one editor on a socket file that only its owner can open"
    )


class _Codes(argparse.Action):
    """Collects rule codes, which are separated by commas, from all occurrences of an option."""

    def __call__(self, parser, namespace, values, option_string=None):  # type: ignore[no-untyped-def]
        known = getattr(namespace, self.dest) or []
        setattr(
            namespace, self.dest, [*known, *(current_code(code.strip()) for code in values.split(",") if code.strip())]
        )
