# SPDX-License-Identifier: Apache-2.0
"""Migration of systems to the current dialect, and of trees to the current version."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping

from roaml.api.jani_files import PathError
from roaml.api.reading import read
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.configuration import find_settings
from roaml.project.migrate import Migration
from roaml.project.migrate import migrate as _migrate
from roaml.project.paths import is_below
from roaml.project.settings import Settings, enclosing_root
from roaml.project.workspace import Snapshot, Workspace
from roaml.record import replace


class SharedFileError(ValueError):
    """Raised if systems that are not migrated would break. `shared` maps each file whose change would break systems to
    these systems."""

    def __init__(self, shared: Mapping[str, tuple[str, ...]]) -> None:
        path, systems = next(iter(shared.items()))
        super().__init__(f"{path}: also used by {', '.join(systems)}; migrate them together")
        self.shared = shared

    @property
    def systems(self) -> tuple[str, ...]:
        """The systems that would have to be migrated as well, without duplicates."""
        return tuple(dict.fromkeys(system for systems in self.shared.values() for system in systems))


def migrate(
    paths: Iterable[str],
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    *,
    with_related: bool = False,
) -> tuple[Migration, ...]:
    """The changes that migrate systems to the current dialect, and trees from version 3 of BehaviorTree.CPP to version
    4. Nothing is written.

    Args:
        paths: system files and trees, or folders that are searched for systems and for trees that belong to none.
        ros_paths: folders with ROS interface packages, in addition to the configured ones.
        settings: used instead of the configuration found around the first path.
        with_related: whether to also migrate the systems that would break because they share a file with a migrated
            system, directly or through other systems. They are searched for in the repository around each system, or in
            the folder around its files.

    Raises:
        PathError: a path cannot be read, or is neither a folder nor a system file; or a file is not valid text.
        SharedFileError: another system would break; only if not `with_related`.
    """
    paths = [os.path.abspath(path) for path in paths]
    if settings is None:
        settings, _ = find_settings(paths[0] if paths else os.getcwd())
    # Findings that the user has switched off are needed for the migration as well.
    settings = replace(settings, select=frozenset(), ignore=frozenset())
    found = read(paths, ros_paths, settings)
    analysis = found.snapshot.analysis
    named = {path for path in paths if not os.path.isdir(path)}
    trees = [
        path
        for path in found.files
        if analysis.kind(path) is FileKind.TREE and (path in named or not analysis.memberships.get(path))
    ]
    systems = _systems(paths, found.snapshot)
    for path in named:
        if path not in systems and path not in trees:
            raise PathError(f"{path}: neither a system file nor a tree; name one of these")

    def snapshot_of(texts: Mapping[str, str]) -> Snapshot:
        return read([*systems, *trees], ros_paths, settings, texts).snapshot

    migrations = _migrate(systems, trees, snapshot_of) if systems or trees else ()
    for migration in migrations:
        source = analysis.source(migration.path)
        if source is None or source.undecodable is not None:
            raise PathError(f"{migration.path}: not valid UTF-8; fix the encoding")
    around = _around(systems, trees, analysis, settings) if migrations else None
    shared = {} if around is None else _broken(migrations, frozenset(systems), around)
    if not shared:
        return migrations
    error = SharedFileError(shared)
    if not with_related:
        raise error
    return migrate([*paths, *error.systems], ros_paths, settings, with_related=True)


def _systems(paths: Iterable[str], snapshot: Snapshot) -> tuple[str, ...]:
    """The named systems, and those in named folders. A snapshot also contains the systems around a named tree."""
    named = {path for path in paths if not os.path.isdir(path)}
    folders = [path for path in paths if os.path.isdir(path)]
    known = snapshot.analysis.system_paths
    return tuple(path for path in known if path in named or any(is_below(path, folder) for folder in folders))


def _broken(migrations: Iterable[Migration], migrated: frozenset[str], around: Snapshot) -> dict[str, tuple[str, ...]]:
    """Each file whose change breaks systems that are not migrated, with these systems. A system breaks if a file that
    it uses is renamed, or if the new text of the file causes errors in it."""
    memberships = around.analysis.memberships
    shared: dict[str, tuple[str, ...]] = {}
    for migration in migrations:
        others = [system for system in memberships.get(migration.path, ()) if system not in migrated]
        if others and migration.path == migration.new_path:
            after = around.with_texts({migration.path: migration.after})
            others = [s for s in others if len(after.checker.errors(s)) > len(around.checker.errors(s))]
        if others:
            shared[migration.path] = tuple(others)
    return shared


def _around(systems: Iterable[str], trees: Iterable[str], analysis: Analysis, settings: Settings) -> Snapshot:
    """A snapshot of the files in the configured roots and in the repositories of `systems` and `trees`. For a system
    outside of a repository, the innermost folder with all its files is used instead; for a tree, its folder."""
    roots = dict.fromkeys(settings.roots)
    roots |= dict.fromkeys(enclosing_root(path) or os.path.dirname(path) for path in trees)
    for system in systems:
        folders = {os.path.dirname(path) for path in analysis.files_of(system)}
        roots[enclosing_root(system) or os.path.commonpath(folders)] = None
    return Workspace(roots, settings).snapshot()
