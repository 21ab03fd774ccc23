# SPDX-License-Identifier: Apache-2.0
"""What is asked for on the command line, and who does it.

Without a command the language server runs on standard input and output.
"""

from __future__ import annotations

import argparse
import logging
import os
import sys
import traceback
from collections.abc import Sequence

from as2fm_lsp.cli.check import FAILURE, USAGE
from roaml import __version__
from roaml.project.settings import SEVERITIES

EXAMPLES = """\
examples:
  as2fm-lsp --check main.xml              check a system and all of its files
  as2fm-lsp --check models --ros-path msgs --format github
  as2fm-lsp --check . --warnings-as-errors --baseline .as2fm-baseline.json
  as2fm-lsp --check models --fix          mend what can be mended safely, tell the rest
  as2fm-lsp --explain late-event-data     what a rule means
  as2fm-lsp init my_robot                 write a small working system
  as2fm-lsp format models --check         lay files out, or tell which ones are not
  as2fm-lsp migrate old_models --diff     show how to move to the current dialect
  as2fm-lsp translate main.xml            write main.jani; translate --help tells more
  as2fm-lsp verify main.xml               how probable its properties are; verify --help tells more
  as2fm-lsp                               language server on standard input and output

exit status: 0 nothing found, 1 errors found, 2 wrong use, 3 a failure of the tool itself
"""


INTERRUPTED, PIPE_CLOSED = 130, 141
"""As shells count what a signal has ended: 128 + SIGINT, 128 + SIGPIPE."""


def run(arguments: Sequence[str]) -> int:
    """Do what the command line says; the exit status."""
    try:
        status = _dispatch(arguments)
        if not sys.stdout.closed:  # as the server does to say that it has ended
            sys.stdout.flush()
        return status
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has seen enough. What Python still holds goes nowhere, or it would complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED
    except Exception:
        traceback.print_exc()
        print("as2fm-lsp: this is a mistake of the tool itself; please report it", file=sys.stderr)
        return FAILURE


def _dispatch(arguments: Sequence[str]) -> int:
    command = arguments[0] if arguments else ""
    if command == "init":
        from as2fm_lsp.cli import init  # noqa: PLC0415 - each command imports only what it needs

        return init.run(arguments[1:])
    if command == "format":
        from as2fm_lsp.cli import format  # noqa: A004, PLC0415

        return format.run(arguments[1:])
    if command == "migrate":
        from as2fm_lsp.cli import migrate  # noqa: PLC0415

        return migrate.run(arguments[1:])
    if command == "translate":
        from as2fm_lsp.cli import translate  # noqa: PLC0415

        return translate.run(arguments[1:])
    if command == "verify":
        from as2fm_lsp.cli import verify  # noqa: PLC0415

        return verify.run(arguments[1:])
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
        print("as2fm-lsp: PATH and the options for checking are used with --check only; see --help", file=sys.stderr)
        return USAGE
    from as2fm_lsp.cli import serve  # noqa: PLC0415

    return serve.run(options.tcp, options.socket, options.allow_remote)


_SERVING = ("explain", "stdio", "tcp", "socket", "allow_remote")


def parser() -> argparse.ArgumentParser:
    result = argparse.ArgumentParser(
        prog="as2fm-lsp",
        description="Check HL-SCXML models of ROS 2 robots, or serve an editor.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    result.add_argument("--version", action="version", version=f"as2fm-lsp {__version__}")
    result.add_argument("--explain", metavar="CODE", help="print what a rule means and exit")
    serve = result.add_argument_group("serving an editor")
    serve.add_argument("--stdio", action="store_true", help="serve on standard input and output, as without it")
    serve.add_argument(
        "--tcp",
        metavar="HOST:PORT",
        help="serve one editor on a port of this machine (0: any) instead; it must send the token that is printed, or "
        "that AS2FM_TOKEN holds, as `token` in its initializationOptions",
    )
    serve.add_argument("--allow-remote", action="store_true", help="with --tcp: let other machines connect, too")
    serve.add_argument(
        "--socket", metavar="FILE", help="serve one editor on a socket file instead, which only you can connect to"
    )
    check = result.add_argument_group("checking")
    check.add_argument("--check", action="store_true", help="check files and exit")
    check.add_argument("--fix", action="store_true", help="make all safe fixes first: none guesses or changes a model")
    check.add_argument("paths", nargs="*", metavar="PATH", help="system files, other files or folders")
    formats = ("text", "json", "github", "gitlab", "sarif", "junit")
    check.add_argument("--format", default="text", choices=formats, help="how diagnostics are written")
    check.add_argument("--output", metavar="FILE", help="write there instead of standard output")
    check.add_argument(
        "--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interface packages"
    )
    check.add_argument("--select", action=_Codes, default=[], metavar="CODE,...", help="report these rules only")
    check.add_argument("--ignore", action=_Codes, default=[], metavar="CODE,...", help="do not report these rules")
    check.add_argument("--severity", default="hint", choices=tuple(SEVERITIES), help="the least severity to report")
    check.add_argument("--warnings-as-errors", action="store_true", help="exit with status 1 on warnings, too")
    check.add_argument("--statistics", action="store_true", help="count how often each rule is broken")
    check.add_argument(
        "--baseline", metavar="FILE", help="do not report what this file knows; written if it is missing"
    )
    check.add_argument("--stdin-filename", metavar="FILE", help="read the text of FILE from standard input")
    return result


class _Codes(argparse.Action):
    """Rule codes, separated by commas, given once or several times."""

    def __call__(self, parser, namespace, values, option_string=None):  # type: ignore[no-untyped-def]
        known = getattr(namespace, self.dest) or []
        setattr(namespace, self.dest, [*known, *(code.strip() for code in values.split(",") if code.strip())])
