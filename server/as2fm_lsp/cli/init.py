# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp init DIR`: write a small working system as a starting point."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

import as2fm_lsp
from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, USAGE
from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.output import complain, print_text

EXAMPLES = """\
example:
  as2fm-lsp init my_robot

exit status: 0 success, 2 usage error, or a file exists already
"""


def run(arguments: Sequence[str]) -> int:
    folder = parser().parse_args(arguments).folder
    files = dict(template("delivery_robot"))
    for name in files:
        if os.path.exists(os.path.join(folder, name)):
            complain(f"{os.path.join(folder, name)} already exists; nothing was written")
            return USAGE
    try:
        for name, text in files.items():
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            write_file(path, text)
    except OSError as error:
        complain(f"{shown_path(str(error.filename or folder))}: {error.strerror or error}")
        return USAGE
    for name in files:
        print_text(f"wrote {shown_path(os.path.join(folder, name))}\n")
    print_text(f"\nnext: as2fm-lsp --check {shlex.quote(os.path.join(folder, 'main.xml'))}\n")
    return CLEAN


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp init",
        description="Write a small working system as a starting point.",
        epilog=EXAMPLES,
    )
    result.add_argument("folder", metavar="DIR", help="the folder to write into; it is created if it does not exist")
    return result


def template(name: str) -> Iterator[tuple[str, str]]:
    """The files of a template: relative path and text."""
    folder = Path(as2fm_lsp.__file__).parent / "templates" / name
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            yield path.relative_to(folder).as_posix(), path.read_text(encoding="utf-8")
