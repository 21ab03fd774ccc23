# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp migrate PATH...`: migrate systems of an older dialect and trees of an older version."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.diff import unified
from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.output import complain, print_text
from roaml import api
from roaml.project.migrate import Migration

EXAMPLES = """\
examples:
  as2fm-lsp migrate old_models --diff      show what would change
  as2fm-lsp migrate old_models/main.xml    change the files of a system
  as2fm-lsp migrate trees/dock.xml         change a tree for version 3 of BehaviorTree.CPP

exit status with --diff and --check: 0 nothing to migrate, 1 something to migrate, 2 usage error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    try:
        migrations = api.migrate(options.paths, options.ros_path, with_related=options.with_related)
    except api.PathError as error:
        return _fail(str(error))
    except api.SharedFileError as error:
        return _fail(_shared(error))
    if options.diff:
        print_text("".join(_diff(migration) for migration in migrations))
        return FOUND if migrations else CLEAN
    if options.check:
        print_text("".join(f"would migrate {shown_path(migration.path)}\n" for migration in migrations))
        return FOUND if migrations else CLEAN
    for migration in migrations:
        if migration.new_path != migration.path and os.path.exists(migration.new_path):
            return _fail(f"{migration.new_path} already exists; nothing was changed")
    try:
        _write(migrations)
    except OSError as error:
        return _fail(f"{shown_path(str(error.filename))}: {error.strerror or error}")
    for migration in migrations:
        renamed = f" -> {shown_path(migration.new_path)}" if migration.new_path != migration.path else ""
        print_text(f"migrated {shown_path(migration.path)}{renamed}\n")
    if not migrations:
        print_text("nothing to migrate\n")
    return CLEAN


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp migrate",
        description="Migrate systems of an older dialect to the current one, and trees of version 3 of "
        "BehaviorTree.CPP to version 4. Comments and layout are kept.",
        epilog=EXAMPLES,
    )
    result.add_argument("paths", nargs="+", metavar="PATH", help="system files, trees, or folders with these")
    result.add_argument("--diff", action="store_true", help="show the changes and write nothing")
    result.add_argument("--check", action="store_true", help="name the files that would change and write nothing")
    result.add_argument(
        "--with-related",
        action="store_true",
        help="also migrate the systems that would break because they share a file",
    )
    result.add_argument("--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interfaces")
    return result


def _diff(migration: Migration) -> str:
    names = shown_path(migration.path), shown_path(migration.new_path)
    return "".join(unified(migration.before, migration.after, *names)) or f"--- {names[0]}\n+++ {names[1]}\n"


def _write(migrations: Sequence[Migration]) -> None:
    """Write the migrated files. Machines are written before the systems that refer to them, and old files are removed
    last: after any failure, each system refers to existing files."""
    for migration in reversed(migrations):
        write_file(migration.new_path, migration.data)
        shutil.copymode(migration.path, migration.new_path)
    for migration in migrations:
        if migration.new_path != migration.path:
            os.unlink(migration.path)


def _shared(error: api.SharedFileError) -> str:
    """The shared files that prevent a migration of only some systems, and what to do."""
    changes = (
        f"{shown_path(path)} would change, which breaks {', '.join(map(shown_path, systems))}"
        for path, systems in error.shared.items()
    )
    return (
        f"{'; '.join(changes)}; nothing was changed; add --with-related to "
        f"migrate {', '.join(map(shown_path, error.systems))}, too"
    )


def _fail(message: str) -> int:
    complain(message)
    return USAGE
