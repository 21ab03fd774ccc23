# SPDX-License-Identifier: Apache-2.0
"""Tree files, the files that they include, and the ROS packages and Groot2 projects in which these are found."""

from __future__ import annotations

import functools
import os

from roaml.model.expand import TreeFileOutline, tree_file_outline
from roaml.model.kinds import PROJECT_EXTENSION
from roaml.model.tree import Include, nodes
from roaml.project.analysis.sources import SourceFiles
from roaml.project.paths import resolve
from roaml.project.settings import folders_above
from roaml.record import replace


class TreeFiles:
    """Which files define the trees of a tree file."""

    def __init__(self, sources: SourceFiles) -> None:
        self._sources = sources
        self._trees: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {}

    def trees_from(self, path: str) -> tuple[str, ...]:
        """The files that define the trees of a tree file, without duplicates.

        They are the file itself, the files that it includes directly or indirectly, the Groot2 projects in its
        directory that list it, and the files of these projects that define missing subtrees.
        """
        if path not in self._trees:
            own = self.with_included([path])
            self._trees[path] = (own, self._from_projects(path, own))
        own, more = self._trees[path]
        return (*own, *more)

    def outlines_from(self, path: str) -> tuple[TreeFileOutline, ...]:
        """The outlines of the files of `trees_from`. If a file of a Groot2 project defines a tree with a name that is
        already used, that tree is left out."""
        paths = self.trees_from(path)
        own = len(self._trees[path][0])
        outlines = [self.tree_outline(tree_path) for tree_path in paths[:own]]
        for tree_path in paths[own:]:
            known = {tree.id for outline in outlines for tree in outline.trees}
            outline = self.tree_outline(tree_path)
            trees = tuple(tree for tree in outline.trees if tree.id not in known)
            outlines.append(replace(outline, trees=trees, from_project=True))
        return tuple(outlines)

    def tree_outline(self, path: str) -> TreeFileOutline:
        file = self._sources.tree(path)
        assert file is not None
        return self._sources.memo.get("tree outline", path, file, lambda: tree_file_outline(path, file))

    def includes(self, path: str) -> tuple[str, ...]:
        """The paths of the files that a tree file includes directly."""
        tree = self._sources.tree(path)
        return tuple(filter(None, map(functools.partial(self.include_path, path), tree.includes))) if tree else ()

    def include_path(self, base: str, include: Include) -> str | None:
        """The path to which an `<include>` refers; `None` if it has no path, or if its ROS package is not found. If
        there is no such file, the first of `include_places` that is a tree file is used.

        Args:
            base: the path of the file that contains the `<include>`.
        """
        meant = self.named_path(base, include)
        if include.path is None or (meant is not None and self._sources.files.text(meant) is not None):
            return meant
        return next(
            (place for place in self.include_places(base, include) if self._sources.tree(place) is not None), meant
        )

    def named_path(self, base: str, include: Include) -> str | None:
        """The path that an `<include>` names; `None` if it has no path, or if its ROS package is not found."""
        if include.path is None:
            return None
        package = include.package.value.strip() if include.package else ""
        if not package or os.path.isabs(include.path.value):
            return resolve(base, include.path.value)
        folder = self._package_folder(base, package)
        return None if folder is None else os.path.normpath(os.path.join(folder, include.path.value))

    def include_places(self, base: str, include: Include) -> tuple[str, ...]:
        """The places where an included file can be in the sources if its path is that of an installed file: in the
        ROS package that the path names as `share/PACKAGE`, and the ends of the path in the folder of the file `base`,
        the longest first."""
        if include.path is None:
            return ()
        parts = [part for part in include.path.value.replace("\\", "/").split("/") if part not in ("", ".")]
        places = []
        for index, part in enumerate(parts[:-2]):
            folder = self._package_folder(base, parts[index + 1]) if part == "share" else None
            if folder is not None:
                places.append(os.path.normpath(os.path.join(folder, *parts[index + 2 :])))
        ends = ("/".join(parts[index:]) for index in range(1, len(parts)))
        places += [resolve(base, end) for end in ends if not end.startswith("..")]
        return tuple(place for place in dict.fromkeys(places) if place != base)

    def _package_folder(self, base: str, package: str) -> str | None:
        """The source folder of a ROS package; `None` if it is not found.

        It is the nearest folder with the name of the package that contains a `package.xml`. Folders that enclose the
        file `base`, and their direct subfolders, are searched.
        """
        if os.path.basename(package) != package:
            return None
        for folder in folders_above(os.path.dirname(base)):
            places: list[str] = [os.path.join(folder, package)]
            if os.path.basename(folder) == package:
                places.insert(0, folder)
            for place in places:
                if self._sources.files.text(os.path.join(place, "package.xml")) is not None:
                    return place
        return None

    def with_included(self, paths: list[str]) -> tuple[str, ...]:
        trees = [path for path in paths if self._sources.tree(path) is not None]
        known = set(trees)
        for tree_path in trees:
            new = [
                p
                for p in dict.fromkeys(self.includes(tree_path))
                if p not in known and self._sources.tree(p) is not None
            ]
            known.update(new)
            trees += new
        return tuple(trees)

    def _from_projects(self, path: str, own: tuple[str, ...]) -> tuple[str, ...]:
        """The Groot2 projects that list a tree file, and the files of these projects that define missing subtrees.

        Args:
            own: the tree file and the files that it includes.
        """
        if not own or path.endswith(PROJECT_EXTENSION):
            return ()
        projects = [p for p in self._sources.files.beside(path, PROJECT_EXTENSION) if path in self.includes(p)]
        listed = dict.fromkeys(p for project in projects for p in self.includes(project))
        more: list[str] = list(projects)
        while True:
            known = {name for tree_path in (*own, *more) for name in self.tree_names(tree_path)}
            missing = {name for tree_path in (*own, *more) for name in self._subtrees(tree_path)} - known
            new = next((p for p in listed if p not in (*own, *more) and missing & self.tree_names(p)), None)
            if new is None:
                return tuple(more)
            more += [p for p in self.with_included([new]) if p not in (*own, *more)]

    def tree_names(self, path: str) -> set[str]:
        tree = self._sources.tree(path)
        return {behavior_tree.id.value for behavior_tree in tree.trees if behavior_tree.id} if tree else set()

    def _subtrees(self, path: str) -> set[str]:
        """The names of the trees that a file uses as subtrees."""
        tree = self._sources.tree(path)
        used = (node for behavior_tree in tree.trees for node in nodes(behavior_tree)) if tree else ()
        return {node.plugin.value for node in used if node.is_subtree and node.plugin}
