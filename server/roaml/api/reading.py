# SPDX-License-Identifier: Apache-2.0
"""Files together with all files that belong to them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping

from roaml.api.jani_files import PathError
from roaml.disk import UnreadableReason
from roaml.model.kinds import FileKind, mocks_path
from roaml.project.configuration import find_settings
from roaml.project.paths import is_below
from roaml.project.settings import Settings, ament_prefixes, enclosing_root
from roaml.project.workspace import Snapshot, Workspace
from roaml.record import Record, replace


class ReadFiles(Record, frozen=True):
    """The result of `read`.

    Attributes:
        files: the files that a check of the named paths would check.
        problems: errors in the configuration, as sentences.
        snapshot: the state of the files.
    """

    files: tuple[str, ...]
    problems: tuple[str, ...]
    snapshot: Snapshot


def read(
    paths: Iterable[str],
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
) -> ReadFiles:
    """Read files together with all files that belong to them, as `check` does, without checking them.

    Whoever only needs the models of the files, or the errors of one system (`RuleRunner.errors`), uses this: it does
    not compute the findings of all files, and it does not explore the states of the systems.

    Args:
        paths, ros_paths, settings, texts: as for `check`.

    Raises:
        PathError: as for `check`.
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
    return ReadFiles(_files(named, snapshot, checked), problems, snapshot)


def _workspace(
    named: list[str], settings: Settings, texts: Mapping[str, str | bytes]
) -> tuple[Workspace, dict[str, FileKind]]:
    """The workspace in which the named paths are checked, and the kinds of the files among them."""
    folders = [path for path in named if os.path.isdir(path)]
    single = Workspace((), settings)
    for path, text in texts.items():
        single.open(path, text)
    analysis = single.snapshot().analysis
    kinds = {path: analysis.kind(path) for path in named if path not in folders}
    for path in kinds:
        problem = analysis.files.read(path)
        if isinstance(problem, UnreadableReason):
            raise PathError(f"{path}: {problem.value}")
    systems = [path for path, kind in kinds.items() if kind is FileKind.SYSTEM]
    roots = list(folders)
    others = [path for path in kinds if path not in systems]
    for path in others:
        if not any(is_below(path, folder) for folder in folders):
            roots.extend(settings.roots or (enclosing_root(path) or os.path.dirname(path),))
    interfaces = [enclosing_root(path) or os.path.dirname(path) for path in systems]
    # A file that is named by a link also uses the packages beside the target of the link.
    interfaces += [os.path.dirname(os.path.realpath(path)) for path in others if os.path.islink(path)]
    workspace = Workspace(dict.fromkeys(roots), settings, systems, packages=dict.fromkeys((*roots, *interfaces)))
    for path, text in texts.items():
        workspace.open(path, text)
    return workspace, kinds


def _files(named: list[str], snapshot: Snapshot, kinds: Mapping[str, FileKind]) -> tuple[str, ...]:
    """The files whose findings are in the result: the configuration, then the files of the named paths."""
    analysis, paths = snapshot.analysis, dict[str, None]()
    if origin := snapshot.checker.settings.origin:  # errors in the configuration affect all files
        paths[origin] = None
    for path in named:
        if path not in kinds:
            inside = [known for known in snapshot.files() if is_below(known, path)]
            systems = [system for system in inside if analysis.kind(system) is FileKind.SYSTEM]
            paths.update(dict.fromkeys(member for system in systems for member in analysis.files_of(system)))
            paths.update(dict.fromkeys(inside))
        elif kinds[path] is FileKind.SYSTEM:
            paths.update(dict.fromkeys((*analysis.files_of(path), *analysis.interface_files_of(path))))
        elif kinds[path] is FileKind.TREE:
            paths.update(dict.fromkeys((path, mocks_path(path))))
        else:
            paths[path] = None
    return tuple(path for path in paths if analysis.source(path) is not None)
