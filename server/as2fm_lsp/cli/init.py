# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp init DIR`: write a small working system as a starting point. `as2fm-lsp init --mocks TREE.xml`: write
proposed mocks for a tree without a system."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import as2fm_lsp
from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.output import complain, note, print_text
from as2fm_lsp.outputs import InputPath

EXAMPLES = """\
examples:
  as2fm-lsp init my_robot
  as2fm-lsp init --mocks tree.xml      write tree.mocks: a proposal for each leaf of the tree, to be reviewed

exit status: 0 success; 1 the tree has errors; 2 usage error, or a file exists already
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    if options.mocks is not None:
        return _write_mocks(options.mocks)
    return _write_system(options.folder)


def _write_mocks(tree: str) -> int:
    """Write the proposed mocks of a tree beside it, or add those that are missing there; return the exit status."""
    from as2fm_lsp.cli.formats import Format, render  # noqa: PLC0415 - a new system needs none of these
    from as2fm_lsp.cli.model_arguments import UsageError, error_report, settings_of  # noqa: PLC0415
    from as2fm_lsp.mocked_models import keep_proposal  # noqa: PLC0415
    from roaml import api  # noqa: PLC0415
    from roaml.model.kinds import mocks_path  # noqa: PLC0415

    beside = shown_path(mocks_path(tree))
    try:
        count = keep_proposal(tree, api.propose_mocks(tree, settings_of(tree)))
    except api.ModelError as error:
        print_text(render(error_report(error), Format.TEXT), stream=sys.stderr)
        return FOUND
    except (UsageError, api.PathError) as error:
        complain(str(error))
        return USAGE
    except OSError as error:
        complain(f"{beside}: {error.strerror or error}")
        return USAGE
    if not count:
        note(f"{beside}: every node that needs a mock has one already")
        return CLEAN
    print_text(f"wrote {beside} with proposed mocks for {count}\n")
    print_text(f"\nnext: review the values, then as2fm-lsp verify {shlex.quote(tree)}\n")
    return CLEAN


def _write_system(folder: str) -> int:
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
        description="Write a small working system as a starting point, or mocks for a tree.",
        epilog=EXAMPLES,
    )
    what = result.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "folder", nargs="?", metavar="DIR", help="the folder to write into; it is created if it does not exist"
    )
    what.add_argument(
        "--mocks",
        type=InputPath,
        metavar="TREE.xml",
        help="write proposed mocks for the leaves of this tree into TREE.mocks, or add those that are missing there",
    )
    return result


def template(name: str) -> Iterator[tuple[str, str]]:
    """The files of a template: relative path and text."""
    folder = Path(as2fm_lsp.__file__).parent / "templates" / name
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            yield path.relative_to(folder).as_posix(), path.read_text(encoding="utf-8")
