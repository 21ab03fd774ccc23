# SPDX-License-Identifier: Apache-2.0
"""The commands of the command line, and the modules that run them.

Without a command, the language server runs on standard input and output.
"""

from __future__ import annotations

import argparse
import importlib
import logging
import os
import sys
import traceback
from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.check import CLEAN, FAILURE, USAGE
from as2fm_lsp.cli.output import STANDARD_OUTPUT, complain, flush, print_text
from roaml import __version__
from roaml.project.settings import SEVERITIES
from roaml.rules.rule import close_names, did_you_mean, listing

EXAMPLES = """\
examples:
  as2fm-lsp --check main.xml              check a system and all of its files
  as2fm-lsp --check models --ros-path msgs --format github
  as2fm-lsp --check . --warnings-as-errors --baseline .as2fm-baseline.json
  as2fm-lsp --check models --fix          make all safe fixes, report the rest
  as2fm-lsp --explain late-event-data     what a rule means
  as2fm-lsp init my_robot                 write a small working system
  as2fm-lsp format models --check         format files, or list those that are not formatted
  as2fm-lsp migrate old_models --diff     show how to move to the current dialect
  as2fm-lsp translate main.xml            write main.jani; see translate --help
  as2fm-lsp verify main.xml               probabilities of its properties; see verify --help
  as2fm-lsp                               language server on standard input and output

exit status: 0 no errors, 1 errors found, 2 usage error, 3 internal error
"""


INTERRUPTED, PIPE_CLOSED = 130, 141
"""Exit statuses of programs that were ended by a signal, as in shells: 128 + SIGINT, 128 + SIGPIPE."""


def run(arguments: Sequence[str]) -> int:
    """Run the command line; return the exit status."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115 - None if it was closed, as by `>&-`
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115
    try:
        status = _status(arguments)
        flush()
        return status
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # the reader has closed the pipe
        return PIPE_CLOSED
    except Exception as error:
        return _failed(error)


def _status(arguments: Sequence[str]) -> int:
    try:
        return _dispatch(arguments)
    except SystemExit as end:  # argparse exits this way; its output is not flushed yet
        return end.code if isinstance(end.code, int) else CLEAN


def _failed(error: Exception) -> int:
    """Report the error that has ended the command; return the exit status."""
    if isinstance(error, OSError) and error.filename == STANDARD_OUTPUT:
        complain(f"{STANDARD_OUTPUT}: {error.strerror or error}")
        return USAGE
    print_text("".join(traceback.format_exception(error)), stream=sys.stderr)
    complain("internal error; please report it")
    return FAILURE


COMMANDS = ("format", "init", "migrate", "translate", "verify")
"""Each is the `run` of a module of `as2fm_lsp.cli`, which is imported only when needed."""


def _dispatch(arguments: Sequence[str]) -> int:
    command = arguments[0] if arguments else ""
    if command in COMMANDS:
        module = importlib.import_module(f"as2fm_lsp.cli.{command}")
        status = module.run(arguments[1:])
        assert isinstance(status, int)
        return status
    if command and not command.startswith("-") and not any(len(a) > 2 and "--check".startswith(a) for a in arguments):
        complain(_misused(command))
        return USAGE
    options = parser().parse_args(arguments)
    if options.explain is not None:
        from as2fm_lsp.cli import explain  # noqa: PLC0415

        return explain.run(options.explain)
    if options.check:
        logging.basicConfig(level=logging.WARNING, format="as2fm-lsp: %(message)s")
        from as2fm_lsp.cli import check  # noqa: PLC0415

        return check.run(options)
    defaults = vars(parser().parse_args([]))
    if any(value != defaults[name] for name, value in vars(options).items() if name not in _SERVING):
        complain(_misused(command))
        return USAGE
    from as2fm_lsp.cli import serve  # noqa: PLC0415

    return serve.run(options.tcp, options.socket, options.allow_remote)


_SERVING = ("explain", "stdio", "tcp", "socket", "allow_remote")
_ALONE = ("check", "explain", "help", "version")
"""Options that users mistake for commands."""


def _misused(first: str) -> str:
    """The error for arguments that begin with `first`, which is not a command, and do not request a check."""
    if first.startswith("-") or os.path.exists(first):
        return "PATH and the options for checking need --check; see --help"
    meant = close_names(first, COMMANDS, 1) or tuple(f"--{name}" for name in close_names(first, _ALONE, 1))
    if meant:
        return f"there is no command `{first}`{did_you_mean(meant)}"
    return f"there is no command or file `{first}`; the commands are {listing(COMMANDS)}; see --help"


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp",
        description="Check HL-SCXML models of ROS 2 robots, or serve an editor.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    result.add_argument("--version", action="version", version=f"as2fm-lsp {__version__}")
    result.add_argument("--explain", metavar="CODE", help="print the document of a rule and exit")
    serve = result.add_argument_group("language server")
    serve.add_argument("--stdio", action="store_true", help="serve on standard input and output (default)")
    serve.add_argument(
        "--tcp",
        metavar="HOST:PORT",
        help="serve one editor on a port of this machine (0: any); it must send the token that is printed, or "
        "that AS2FM_TOKEN holds, as `token` in its initializationOptions",
    )
    serve.add_argument(
        "--allow-remote", action="store_true", help="with --tcp: also accept connections from other machines"
    )
    serve.add_argument(
        "--socket", metavar="FILE", help="serve one editor on a socket file that only its owner can open"
    )
    check = result.add_argument_group("checking")
    check.add_argument("--check", action="store_true", help="check files and exit")
    check.add_argument(
        "--fix",
        action="store_true",
        help="first apply all safe fixes: those that guess nothing and do not change the behaviour of a model",
    )
    check.add_argument("paths", nargs="*", metavar="PATH", help="system files, other files or folders")
    formats = ("text", "json", "github", "gitlab", "sarif", "junit")
    check.add_argument("--format", default="text", choices=formats, help="format of the diagnostics")
    check.add_argument("--output", metavar="FILE", help="write to FILE instead of standard output")
    check.add_argument(
        "--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interface packages"
    )
    check.add_argument("--select", action=_Codes, default=[], metavar="CODE,...", help="report only these rules")
    check.add_argument("--ignore", action=_Codes, default=[], metavar="CODE,...", help="do not report these rules")
    check.add_argument("--severity", default="hint", choices=tuple(SEVERITIES), help="the minimum severity to report")
    check.add_argument("--warnings-as-errors", action="store_true", help="exit with 1 on warnings as well")
    check.add_argument("--statistics", action="store_true", help="count the findings of each rule")
    check.add_argument(
        "--baseline", metavar="FILE", help="do not report the findings in FILE; create it if it does not exist"
    )
    check.add_argument("--stdin-filename", metavar="FILE", help="read the text of FILE from standard input")
    return result


class _Codes(argparse.Action):
    """Rule codes, separated by commas, given once or several times."""

    def __call__(self, parser, namespace, values, option_string=None):  # type: ignore[no-untyped-def]
        known = getattr(namespace, self.dest) or []
        setattr(namespace, self.dest, [*known, *(code.strip() for code in values.split(",") if code.strip())])
