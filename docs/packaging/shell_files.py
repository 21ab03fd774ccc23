# SPDX-License-Identifier: Apache-2.0
"""`python docs/packaging/shell_files.py FOLDER`: write the man page and the completion of shells, from the parsers.

It needs `shtab` and `argparse-manpage`, and an installed as2fm-lsp. The files are for packages of distributions:
`as2fm-lsp.1`, `as2fm-lsp.bash`, `_as2fm-lsp` for zsh, and `as2fm-lsp.tcsh`.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

import shtab
from build_manpages.manpage import Manpage

from as2fm_lsp.cli.main import COMMANDS, parser

FILES = {"bash": "as2fm-lsp.bash", "tcsh": "as2fm-lsp.tcsh", "zsh": "_as2fm-lsp"}


def whole_parser() -> argparse.ArgumentParser:
    """The command line with all commands as one parser. Paths are completed."""
    whole = parser()
    commands = whole.add_subparsers(metavar="COMMAND", parser_class=argparse.ArgumentParser)
    for name, summary in COMMANDS.items():
        command = importlib.import_module(f"as2fm_lsp.cli.{name}").parser()
        commands.add_parser(name, help=summary, parents=[command], add_help=False, conflict_handler="resolve")
    for one in (whole, *commands.choices.values()):
        for action in one._actions:
            if action.metavar in ("FILE", "PATH", "FOLDER", "TREE", "MAIN.xml", "SYSTEM"):
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return whole


def main(folder: str) -> None:
    whole = whole_parser()
    for shell, name in FILES.items():
        Path(folder, name).write_text(shtab.complete(whole, shell), encoding="utf-8")
    whole._manpage = []  # type: ignore[attr-defined]
    Path(folder, "as2fm-lsp.1").write_text(str(Manpage(whole)), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
