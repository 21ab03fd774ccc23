# SPDX-License-Identifier: Apache-2.0
"""What other programs import.

    from roaml import api

    result = api.check(["main.xml"], ros_paths=["interfaces"])
    for diagnostic in result.diagnostics:
        print(diagnostic.path, diagnostic.message)

Nothing here prints or raises for what stands in a user's files; a path that does not exist is a `PathError`.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from roaml.diagnostics import Diagnostic
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.discover import is_inside
from roaml.project.files import Problem
from roaml.project.migrate import Migration
from roaml.project.migrate import migrate as _migrate
from roaml.project.settings import Settings, ament_prefixes, enclosing_root, find_settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.text import SourceFile


class PathError(ValueError):
    """A path was named that cannot be checked; the message says why."""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """What `check` found.

    Attributes:
        diagnostics: sorted by file, in the order in which files were checked, then by place.
        files: the files that were checked.
        problems: what is wrong with the configuration, in sentences.
        snapshot: the models behind the diagnostics.
    """

    diagnostics: tuple[Diagnostic, ...]
    files: tuple[str, ...]
    problems: tuple[str, ...]
    snapshot: Snapshot

    def source(self, path: str) -> SourceFile:
        """The text of a checked file."""
        source = self.snapshot.analysis.source(path)
        assert source is not None
        return source


def check(
    paths: Iterable[str],
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
) -> CheckResult:
    """Check system files, single files and folders.

    A system file is checked with all files that it names; a folder with all systems and files in it. Any other file is
    checked as a part of the systems that name it, which are looked for in the configured roots, else in the enclosing
    repository, else in its folder.

    Args:
        paths: what to check.
        ros_paths: folders with ROS interface packages, besides those configured.
        settings: in place of the configuration found around the first path.
        texts: path -> text, or the bytes of a file, that is taken in place of what the file holds.

    Raises:
        PathError: a path does not exist or cannot be read, and no text is given for it.
    """
    named = [os.path.abspath(path) for path in paths]
    texts = {os.path.abspath(path): text for path, text in (texts or {}).items()}
    for path in named:
        if not os.path.exists(path) and path not in texts:
            raise PathError(f"{path}: there is no such file or folder")
    problems: tuple[str, ...] = ()
    if settings is None:
        settings, problems = find_settings(named[0] if named else os.getcwd())
        settings = replace(settings, ament_prefixes=ament_prefixes())
    settings = replace(settings, ros_paths=(*settings.ros_paths, *map(os.path.abspath, ros_paths)))
    workspace, checked = _workspace(named, settings, texts)
    snapshot = workspace.snapshot()
    files = _files(named, snapshot, checked)
    diagnostics = tuple(d for path in files for d in snapshot.checker.diagnostics(path))
    return CheckResult(diagnostics, files, problems, snapshot)


def migrate(
    paths: Iterable[str], ros_paths: Iterable[str] = (), settings: Settings | None = None
) -> tuple[Migration, ...]:
    """What becomes of systems when they are moved to the current dialect. Nothing is written.

    Args:
        paths: system files, or folders in which they are looked for.
        ros_paths: folders with ROS interface packages, besides those configured.
        settings: in place of the configuration found around the first path.

    Raises:
        PathError: a path cannot be read, or is neither a folder nor a system file; a file is no proper text; or a
            system that is not moved names a file that would be renamed.
    """
    paths = [os.path.abspath(path) for path in paths]
    if settings is None:
        settings, _ = find_settings(paths[0] if paths else os.getcwd())
    # What is not to be reported is moved all the same.
    settings = replace(settings, select=frozenset(), ignore=frozenset())
    result = check(paths, ros_paths, settings)
    systems = result.snapshot.analysis.system_paths
    for path in paths:
        if not os.path.isdir(path) and path not in systems:
            raise PathError(f"{path}: only systems are migrated; name their system file")

    def snapshot_of(texts: Mapping[str, str]) -> Snapshot:
        return check(systems, ros_paths, settings, texts).snapshot

    migrations = _migrate(systems, snapshot_of) if systems else ()
    for migration in migrations:
        if result.source(migration.path).undecodable is not None:
            raise PathError(f"{migration.path}: it holds bytes that are no text; mend it first")
    renamed = [migration.path for migration in migrations if migration.path != migration.new_path]
    memberships = _around(systems, settings).memberships if renamed else {}
    for path in renamed:
        for system in memberships.get(path, ()):
            if system not in systems:
                raise PathError(f"{path}: it belongs to {system}, too; name that as well")
    return migrations


def _around(paths: Iterable[str], settings: Settings) -> Analysis:
    """All that lies in the repositories, or else the folders, of some files."""
    roots = dict.fromkeys(enclosing_root(path) or os.path.dirname(path) for path in paths)
    return Workspace(roots, settings).snapshot().analysis


def _workspace(
    named: list[str], settings: Settings, texts: Mapping[str, str | bytes]
) -> tuple[Workspace, dict[str, FileKind]]:
    """The workspace in which the named paths are checked, and what kinds of files they are (folders left out)."""
    folders = [path for path in named if os.path.isdir(path)]
    single = Workspace((), settings)
    for path, text in texts.items():
        single.open(path, text)
    analysis = single.snapshot().analysis
    kinds = {path: analysis.kind(path) for path in named if path not in folders}
    for path in kinds:
        problem = analysis.files.read(path)
        if isinstance(problem, Problem):
            raise PathError(f"{path}: {problem.value}")
    systems = [path for path, kind in kinds.items() if kind is FileKind.SYSTEM]
    roots = list(folders)
    others = [path for path in kinds if path not in systems]
    for path in others:
        if not any(is_inside(path, folder) for folder in folders):
            roots.extend(settings.roots or (enclosing_root(path) or os.path.dirname(path),))
    interfaces = [enclosing_root(path) or os.path.dirname(path) for path in systems]
    workspace = Workspace(dict.fromkeys(roots), settings, systems, packages=dict.fromkeys((*roots, *interfaces)))
    for path, text in texts.items():
        workspace.open(path, text)
    return workspace, kinds


def _files(named: list[str], snapshot: Snapshot, kinds: Mapping[str, FileKind]) -> tuple[str, ...]:
    """The files that are reported on, in the order in which they were named."""
    analysis, found = snapshot.analysis, dict[str, None]()
    for path in named:
        if path not in kinds:
            inside = [each for each in snapshot.files() if is_inside(each, path)]
            systems = [each for each in inside if analysis.kind(each) is FileKind.SYSTEM]
            found.update(dict.fromkeys(each for system in systems for each in analysis.files_of(system)))
            found.update(dict.fromkeys(inside))
        elif kinds[path] is FileKind.SYSTEM:
            found.update(dict.fromkeys(analysis.files_of(path)))
        else:
            found[path] = None
    return tuple(path for path in found if analysis.source(path) is not None)
