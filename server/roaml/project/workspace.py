# SPDX-License-Identifier: Apache-2.0
"""The folders, open buffers and settings of a session, which change over time. `snapshot` returns the state of one
moment.

- An open buffer takes precedence over the disk until it is closed, even for a file outside of the folders.
- The folders are listed once, and again after `refresh`. Every snapshot checks whether the content of files has
  changed.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterable, Mapping

from roaml.disk import Roots
from roaml.durations import ANY_TIME
from roaml.interfaces.registry import Registry
from roaml.interfaces.search import SearchPath
from roaml.interruption import go_on
from roaml.model.config_files import CONFIG_FILE
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.checking import RuleRunner
from roaml.project.discover import SystemIndex, candidates, is_candidate
from roaml.project.files import DiskFiles, Files
from roaml.project.memo import Memo
from roaml.project.paths import folder_of, full, is_below
from roaml.project.settings import Settings
from roaml.record import replace
from roaml.text import SourceFile, decode

_NOT_BY_THEMSELVES = (FileKind.UNKNOWN, FileKind.JSON_STRUCTS, FileKind.JANI_MODEL)
"""The kinds of files that are checked only if a system lists them or the user names them."""


class Snapshot:
    """The state of a workspace at one moment: the models (`analysis`) and the diagnostics (`checker`).

    Args:
        roots: the open folders.
        listed: the files in the open folders whose names are those of supported files.
        opened: the open buffers that are in these folders and have a name of this kind.
        again: returns a snapshot in which some files have other texts.
    """

    def __init__(
        self,
        analysis: Analysis,
        checker: RuleRunner,
        roots: tuple[str, ...],
        listed: tuple[str, ...],
        opened: Iterable[str],
        again: Callable[[Mapping[str, SourceFile]], Snapshot],
    ) -> None:
        self.analysis = analysis
        self.checker = checker
        self.roots = roots
        self.listed = tuple(dict.fromkeys((*listed, *opened)))
        self._listed = listed
        self._again = again

    @functools.cached_property
    def memberships(self) -> Mapping[str, tuple[str, ...]]:
        """File -> its systems."""
        return self.analysis.memberships

    def with_texts(self, texts: Mapping[str, str]) -> Snapshot:
        """A copy of this snapshot in which some files have other texts: path -> text."""
        return self._again({path: SourceFile(path, text) for path, text in texts.items()}) if texts else self

    def files(self) -> tuple[str, ...]:
        """All files of the workspace that are checked, without duplicates: those of systems, and other supported
        files."""
        origin = self.checker.settings.origin  # the configuration may be outside of the folders
        return self.analysis.present((*self._listed, *((origin,) if origin else ())), _NOT_BY_THEMSELVES)

    def configuration_of(self, system: str) -> str:
        """The configuration file that applies to a system; it need not exist."""
        around = [root for root in self.roots if is_below(system, root)]
        return self.checker.settings.origin or full(max(around, key=len, default=folder_of(system)), CONFIG_FILE)

    def candidates(self) -> tuple[str, ...]:
        """The files of the workspace whose names are those of supported files, the files of systems, and the open
        files, without duplicates."""
        analysis = self.analysis
        of_systems = (path for system in analysis.system_paths for path in analysis.files_of(system))
        return tuple(dict.fromkeys((*self._listed, *of_systems, *analysis.files.open_files)))


class Workspace:
    """The files of a session.

    Args:
        roots: the open folders, which are searched for systems and other files.
        settings: the user's settings.
        systems: the paths of further system files to analyse.
        packages: the folders that are searched for ROS packages; by default `roots`.
        checkpoint: is called before each computation; it may raise `Interrupted` to abandon the work.
    """

    def __init__(
        self,
        roots: Iterable[str],
        settings: Settings,
        systems: Iterable[str] = (),
        packages: Iterable[str] | None = None,
        checkpoint: Callable[[], None] = go_on,
    ) -> None:
        self.roots = tuple(os.path.abspath(root) for root in roots)
        self.settings = settings
        self._named = tuple(os.path.abspath(path) for path in systems)
        self._packages = None if packages is None else tuple(os.path.abspath(folder) for folder in packages)
        self._open: dict[str, SourceFile] = {}
        self._disk = self._new_disk()
        self._memo = Memo(checkpoint)
        self._index = SystemIndex()
        self._listed: tuple[str, ...] | None = None
        self._registry = self._new_registry()

    def open(self, path: str, text: str | bytes) -> None:
        """Use the text of an editor's buffer, or the bytes of a file, instead of the file on the disk until it is
        closed."""
        source = decode(path, text) if isinstance(text, bytes) else SourceFile(path, text)
        self._open = {**self._open, path: source}

    def close(self, path: str) -> None:
        self._open = {known: source for known, source in self._open.items() if known != path}

    def refresh(self) -> None:
        """List the folders again, because files were created or deleted."""
        self._listed = None
        self._registry.search_path.refresh()

    def configure(self, settings: Settings, roots: Iterable[str] | None = None) -> None:
        """Set new settings or folders. All files are checked again."""
        self.settings = settings
        if roots is not None:
            self.roots = tuple(os.path.abspath(root) for root in roots)
        self._listed = None
        self._memo.clear()
        self._disk = self._new_disk()
        self._registry = self._new_registry()

    def set_package_folders(self, folders: Iterable[str]) -> None:
        """Replace the folders that are searched for ROS packages."""
        self._packages = tuple(os.path.abspath(folder) for folder in folders)
        self._disk = self._new_disk()
        self._registry = self._new_registry()

    def snapshot(self) -> Snapshot:
        return self._snapshot(self._open, self._memo)

    def _snapshot(self, opened: Mapping[str, SourceFile], memo: Memo) -> Snapshot:
        def again(texts: Mapping[str, SourceFile]) -> Snapshot:
            """A snapshot with other texts. It has a separate cache, so that it does not replace current results."""
            return self._snapshot({**opened, **texts}, memo.copy())

        files = Files(self._disk, opened)
        if self._listed is None:
            self._listed = tuple(candidates(self.roots, self.settings.exclude, self._disk.roots))
        new = [path for path in opened if is_candidate(path, self.roots, self.settings.exclude)]
        shown = [path for path in opened if is_candidate(path, self.roots, self.settings.exclude, any_name=True)]
        systems = (*self._named, *self._index.systems(dict.fromkeys((*self._listed, *shown)), files))
        registry = self._registry.reading(files.text)
        listed, settings = (*self._listed, *new), self.settings
        overrides = replace(
            settings.overrides,
            default_reaction_time=settings.reaction_time or ANY_TIME,
            default_semantics=settings.trees.semantics,
            values=(*settings.parameters, *settings.overrides.values),
        )
        analysis = Analysis(files, registry, memo, systems, overrides, settings.trees, listed)
        return Snapshot(analysis, RuleRunner(analysis, self.settings), self.roots, self._listed, new, again)

    def _new_disk(self) -> DiskFiles:
        """A new view of the disk. The folder of each named system is part of the workspace, and so is the folder
        to which its symbolic links lead."""
        settings = self.settings
        named = (folder for path in self._named for folder in (os.path.dirname(path), _real_folder(path)))
        return DiskFiles(
            Roots(
                (*self.roots, *(self._packages or ()), *settings.roots, *named),
                (*settings.ros_paths, *settings.ament_prefixes),
            )
        )

    def _new_registry(self) -> Registry:
        settings = self.settings
        search = SearchPath(self._packages or self.roots, settings.ros_paths, settings.ament_prefixes)
        return Registry(search, Files(self._disk, {}).text)


def _real_folder(path: str) -> str:
    return os.path.dirname(os.path.realpath(path))
