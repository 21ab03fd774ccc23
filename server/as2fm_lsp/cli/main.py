# SPDX-License-Identifier: Apache-2.0
"""The entry point of the command line: reads the arguments and calls the requested command.

The options `--check` and `--explain` do what the commands `check` and `explain` do. Without a command and without these
options, the language server runs.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, FAILURE, USAGE
from as2fm_lsp.cli.output import STANDARD_OUTPUT, complain, flush, print_text
from as2fm_lsp.cli.tree_semantics import OPTION as TREE_SEMANTICS
from roaml import __version__

COMMANDS = {
    "check": "report what is wrong in systems, other files and folders",
    "explain": "print the document of a rule",
    "serve": "run the language server for an editor",
    "format": "format files",
    "migrate": "migrate systems to the current dialect",
    "translate": "translate a system to JANI and plain SCXML",
    "verify": "compute or estimate the probabilities of properties",
    "experiment": "compute properties for many values of parameters",
    "compare": "compare two versions of a model",
    "draw": "draw a state machine, a tree or a ROS graph",
    "simulate": "run a system step by step",
    "debug": "run the debug adapter for an editor",
    "init": "write a small working system",
}
"""Each command with its description. It is implemented by the function `run` of the module of the same name in
`as2fm_lsp.cli`, which is imported only if the command is called."""

USAGE_LINE = f"""as2fm-lsp {{{",".join(COMMANDS)}}} ...
       as2fm-lsp --check PATH ... | --explain CODE | --version | --help
       as2fm-lsp [--stdio | --tcp HOST:PORT | --socket FILE]"""

EXAMPLES = """\
examples:
  as2fm-lsp --check main.xml              check a system and all of its files
  as2fm-lsp --check models --ros-path msgs --format github
  as2fm-lsp --check . --warnings-as-errors --baseline .as2fm-baseline.json
  as2fm-lsp --check models --fix          make all safe fixes, report the remaining findings
  as2fm-lsp --explain late-event-data     the document of a rule
  as2fm-lsp init my_robot                 write a small working system
  as2fm-lsp format models --check         format files, or list those that are not formatted
  as2fm-lsp migrate old_models --diff     show how to move to the current dialect
  as2fm-lsp draw main.xml                 the ROS graph as SVG; see draw --help
  as2fm-lsp simulate main.xml             the steps of one run; see simulate --help
  as2fm-lsp translate main.xml            write main.jani; see translate --help
  as2fm-lsp verify main.xml               probabilities of its properties; see verify --help
  as2fm-lsp compare HEAD:main.xml main.xml
                                          what changed, and by how much the properties; see compare --help
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
        from roaml.json_syntax.brackets import deep_recursion  # noqa: PLC0415 - an interrupt prints no traceback

        with deep_recursion():
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
    import traceback  # noqa: PLC0415 - a command without errors does not need it

    print_text("".join(traceback.format_exception(error)), stream=sys.stderr)
    complain("internal error; please report it")
    return FAILURE


def _dispatch(arguments: Sequence[str]) -> int:
    arguments = _behind(arguments)
    command = arguments[0] if arguments else ""
    asks_for_check = any(len(a) > 2 and "--check".startswith(a) for a in arguments)
    is_path = asks_for_check and command in _ALSO_OPTIONS and os.path.exists(command)
    if command in COMMANDS and not is_path:
        module = importlib.import_module(f"as2fm_lsp.cli.{command}")
        status = module.run(arguments[1:])
        assert isinstance(status, int)
        return status
    if command and not command.startswith("-") and not asks_for_check:
        complain(_misused(command))
        return USAGE
    options = parser().parse_args(arguments)
    if options.explain is not None:
        from as2fm_lsp.cli import explain  # noqa: PLC0415

        return explain.explain(options.explain)
    if options.check:
        from as2fm_lsp.cli import check  # noqa: PLC0415

        return check.check(options)
    defaults = vars(parser().parse_args([]))
    if any(value != defaults[name] for name, value in vars(options).items() if name not in _SERVING):
        complain(_misused(command))
        return USAGE
    from as2fm_lsp.cli import serve  # noqa: PLC0415

    return serve.serve(options.tcp, options.socket, options.allow_remote)


_FIRST = {TREE_SEMANTICS: 2, "-q": 1, "--quiet": 1, "-v": 1, "--verbose": 1}
"""Options of the commands that may also precede the command -> the number of their arguments, with themselves."""


def _behind(arguments: Sequence[str]) -> list[str]:
    """The arguments, with the options that precede the command behind them."""
    start = 0
    while start < len(arguments):
        first = arguments[start]
        count = 1 if first.startswith(f"{TREE_SEMANTICS}=") else _FIRST.get(first, 0)
        if count == 0:
            break
        start += count
    return [*arguments[start:], *arguments[:start]]


_ALSO_OPTIONS = ("check", "explain", "serve")
"""Commands whose names are paths if `--check` is given and a file or folder with the name exists."""
_SERVING = ("explain", "stdio", "tcp", "socket", "allow_remote")
_ALONE = ("help", "version")
"""Options that users mistake for commands."""


def _misused(first: str) -> str:
    """The error for arguments that begin with `first`, which is not a command, and do not request a check."""
    if first.startswith("-") or os.path.exists(first):
        return "PATH and the options for checking need --check; see --help"
    from roaml.suggest import close_names, did_you_mean, listing  # noqa: PLC0415 - only mistakes need it

    meant = close_names(first, COMMANDS, 1) or tuple(f"--{name}" for name in close_names(first, _ALONE, 1))
    if meant:
        return f"there is no command `{first}`{did_you_mean(meant)}"
    return f"there is no command or file `{first}`; the commands are {listing(tuple(COMMANDS))}; see --help"


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from as2fm_lsp.cli.kernel_note import version_line  # noqa: PLC0415

        print_text(f"as2fm-lsp {__version__}\n{version_line()}\n")
        parser.exit()


def _listed() -> str:
    """The commands, as the help shows them."""
    lines = (f"  {name:<10} {summary}\n" for name, summary in COMMANDS.items())
    return f"commands (as2fm-lsp COMMAND --help shows the options of each, with examples):\n{''.join(lines)}"


def parser() -> ArgumentParser:
    from as2fm_lsp.cli.options import check_options, serve_options  # noqa: PLC0415 - the commands have their own parsers

    result = ArgumentParser(
        prog="as2fm-lsp",
        usage=USAGE_LINE,
        description="Check HL-SCXML models of ROS 2 robots, or serve an editor.",
        epilog=f"{_listed()}\n{EXAMPLES}",
    )
    result.add_argument(
        "--version", action=_Version, nargs=0, help="print the version and whether the kernel is compiled"
    )
    result.add_argument("--explain", metavar="CODE", help="print the document of a rule and exit")
    serve_options(result.add_argument_group("language server"))
    checking = result.add_argument_group("checking")
    checking.add_argument("--check", action="store_true", help="check files and exit")
    check_options(checking)
    return result
