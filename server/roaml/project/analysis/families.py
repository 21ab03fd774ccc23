# SPDX-License-Identifier: Apache-2.0
"""Tree files that are not in a system, with the files that are analysed together with them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property

from roaml.forest.forest import Forest
from roaml.forest.settings import TreeSettings
from roaml.model.expand import TreeFileOutline
from roaml.model.kinds import FileKind
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.systems import Systems
from roaml.project.analysis.tree_files import TreeFiles


class Families:
    """The tree files without a system that include each other.

    Args:
        settings: the settings for these trees.
        listed: the paths of the files in the workspace.
    """

    def __init__(
        self,
        sources: SourceFiles,
        tree_files: TreeFiles,
        systems: Systems,
        settings: TreeSettings,
        listed: Iterable[str],
    ) -> None:
        self._sources = sources
        self._tree_files = tree_files
        self._systems = systems
        self._settings = settings
        self._listed_files = tuple(listed)
        self._folder_names: dict[str, frozenset[str]] = {}

    def family(self, path: str) -> tuple[str, ...]:
        """The tree files that are connected with the tree file `path` by includes, in either direction. The files are
        not in a system. A file that no other file includes precedes the files that it includes."""
        return tuple(file.path for file in self.family_outlines(path))

    def family_outlines(self, path: str) -> tuple[TreeFileOutline, ...]:
        """The outlines of the files of `family`."""
        outlines: dict[str, TreeFileOutline] = {}
        for top in self._tops.get(path, (path,)):
            for file in self._tree_files.outlines_from(top):
                outlines.setdefault(file.path, file)
        return tuple(outlines.values())

    def _including(self, path: str) -> tuple[str, ...]:
        """The root files that include a file, directly or indirectly, followed by the file itself. A root file is one
        that no other file includes."""
        tops = self._tops.get(path, ())
        return (path,) if path in tops else (*(top for top in tops if path in self._tree_files.trees_from(top)), path)

    def outlines_around(self, path: str) -> tuple[TreeFileOutline, ...]:
        """The outlines of a tree file that is not in a system, of the files that include it, and of the files that it
        includes."""
        outlines = (outline for top in self._including(path) for outline in self._tree_files.outlines_from(top))
        return tuple({outline.path: outline for outline in outlines}.values())

    @cached_property
    def _tops(self) -> Mapping[str, tuple[str, ...]]:
        """Tree file -> the files of its family that no other file includes; all of them if they include each other."""
        files = [
            p
            for p in self._listed_files
            if self._sources.kind(p) is FileKind.TREE and p not in self._systems.memberships
        ]
        linked: dict[str, set[str]] = {}
        included: set[str] = set()
        for file in files:
            for target in self._tree_files.includes(file):
                linked.setdefault(file, set()).add(target)
                linked.setdefault(target, set()).add(file)
                included.add(target)
        families: dict[str, tuple[str, ...]] = {}
        for file in linked:
            if file not in families:
                members, pending = {file}, [file]
                while pending:
                    new = linked.get(pending.pop(), set()) - members
                    members |= new
                    pending += new
                families.update(dict.fromkeys(members, tuple(sorted(members - included) or sorted(members))))
        return families

    def forest(self, path: str) -> Forest | None:
        """A tree file that is not in a system, with the files that are analysed together with it; `None` if it cannot
        be read. Files that include it come first."""
        if self._sources.tree(path) is None:
            return None
        models = self._tree_files.with_included([p for p in self._settings.models if self._sources.tree(p) is not None])
        paths = tuple(dict.fromkeys(p for top in self._including(path) for p in self._tree_files.trees_from(top)))
        paths = tuple(dict.fromkeys((*paths, *models)))
        files = tuple((p, tree) for p in paths if (tree := self._sources.tree(p)) is not None)
        beside = self._names_in_folder(path)
        targets = (self._tree_files.include_path(p, i) for p, tree in files for i in tree.includes)
        complete = all(target is not None and self._sources.tree(target) is not None for target in targets)
        around = tuple(
            model
            for other in self._trees_in_folder(path)
            if other not in paths and (tree := self._sources.tree(other)) is not None
            for model in tree.models
        )
        key = (files, beside, complete, self._settings, around)
        return self._sources.memo.get(
            "forest", path, key, lambda: Forest(path, files, self._settings, beside, complete, around)
        )

    def _names_in_folder(self, path: str) -> frozenset[str]:
        """The names of the trees in all files in the folder of a file."""
        folder = os.path.dirname(path)
        if folder not in self._folder_names:
            self._folder_names[folder] = frozenset(
                name for p in self._trees_in_folder(path) for name in self._tree_files.tree_names(p)
            )
        return self._folder_names[folder]

    def _trees_in_folder(self, path: str) -> Iterator[str]:
        """The tree files in the folder of a file, and the file itself."""
        return (p for p in (path, *self._sources.files.beside(path, ".xml")) if self._sources.kind(p) is FileKind.TREE)
