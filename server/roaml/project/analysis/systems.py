# SPDX-License-Identifier: Apache-2.0
"""The files of each system, and the systems of each file."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property

from roaml.disk import UnreadableReason
from roaml.jani.properties import Filter, Probability
from roaml.model.expand import ListedTree, TreeFileOutline
from roaml.model.kinds import EXTENSIONS, FileKind
from roaml.model.system_file import ListedFile, SystemInput, SystemSection, required_kind
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.tree_files import TreeFiles
from roaml.project.files import MAX_CHARACTERS
from roaml.project.paths import is_below, resolve

_PROPERTIES = (FileKind.PROPERTIES, FileKind.XML_PROPERTIES)


class Systems:
    """Which files a system consists of.

    Args:
        paths: the paths of the system files that are analysed.
    """

    def __init__(self, sources: SourceFiles, tree_files: TreeFiles, paths: Iterable[str]) -> None:
        self._sources = sources
        self._tree_files = tree_files
        self.paths = tuple(dict.fromkeys(paths))
        self._listed: dict[str, tuple[ListedFile, ...]] = {}

    def listed(self, path: str) -> tuple[ListedFile, ...]:
        """The files that a system file lists, in order; empty if it cannot be read."""
        if path not in self._listed:
            file = self._sources.system_file(path)
            self._listed[path] = tuple(self._listed_file(path, entry) for entry in file.inputs) if file else ()
        return self._listed[path]

    def unlisted_properties(self, path: str) -> tuple[str, ...]:
        """The property files beside a system file, or beside the property files below its folder that it lists, that
        neither it nor another system file in its folder lists: their paths relative to the folder. Files with
        parameters are left out: a system may list them under other names, one for each instance."""
        folder = os.path.dirname(path)
        own = [file.path for file in self.listed(path)]
        places = [path, *(p for p in own if self._sources.kind(p) in _PROPERTIES and is_below(p, folder))]
        beside = {p for place in places for end in (".jani", ".xml") for p in self._sources.files.beside(place, end)}
        unlisted = {p for p in beside.difference(own) if self._has_properties(p) and not self._varies(p)}
        if unlisted:
            for other in self._sources.files.beside(path, ".xml"):
                if self._sources.kind(other) is FileKind.SYSTEM:
                    unlisted -= {file.path for file in self.listed(other)}
        return tuple(sorted(os.path.relpath(p, folder).replace(os.sep, "/") for p in unlisted))

    def _has_properties(self, path: str) -> bool:
        """Whether a file is a property file with at least one property."""
        if self._sources.kind(path) is FileKind.PROPERTIES:
            return bool(self._sources.properties(path)[0])
        file = self._sources.property_file(path) if self._sources.kind(path) is FileKind.XML_PROPERTIES else None
        return file is not None and bool(file.properties)

    def _varies(self, path: str) -> bool:
        """Whether a file has parameters, or uses those of the system."""
        source = self._sources.source(path)
        return source is not None and ("<parameter" in source.text or "$(" in source.text)

    def lists_all(self, system: str, section: SystemSection) -> bool:
        """Whether all files that a system lists in the section `section` are known and can be used."""
        file = self._sources.system_file(system)
        if file is None or section in file.unread:
            return False
        return all(listed.usable for listed in self.listed(system) if listed.input.section is section)

    def kind_in(self, path: str, system: str | None) -> FileKind:
        """The kind of a file, from its name and its content. If they do not identify the kind, and `system` lists the
        file as struct declarations in JSON, it is this kind."""
        kind = self._sources.kind(path)
        if kind is not FileKind.UNKNOWN or system is None:
            return kind
        listed = (file.kind for file in self.listed(system) if file.path == path)
        return FileKind.JSON_STRUCTS if FileKind.JSON_STRUCTS in listed else kind

    def _listed_file(self, base: str, entry: SystemInput) -> ListedFile:
        kind_required = required_kind(entry)
        if entry.src is None:
            return ListedFile(entry, "", None, kind_required, FileKind.UNKNOWN)
        path = resolve(base, entry.src.value)
        source = self._sources.files.read(path)
        if isinstance(source, UnreadableReason):
            return ListedFile(entry, path, source, kind_required, FileKind.UNKNOWN)
        if len(source.text) > MAX_CHARACTERS:
            return ListedFile(entry, path, UnreadableReason.TOO_LONG, kind_required, self._sources.kind(path))
        kind = self._sources.kind(path)
        if kind is FileKind.MACHINE and self._sources.machine(path) is None:
            kind = FileKind.UNKNOWN
        if kind_required is FileKind.JSON_STRUCTS and kind is FileKind.UNKNOWN and path.endswith(".json"):
            kind = FileKind.JSON_STRUCTS
        return ListedFile(entry, path, None, kind_required, kind)

    def listed_trees(self, path: str) -> tuple[ListedFile, ...]:
        """The listed tree files of a system that can be used."""
        return tuple(f for f in self.listed(path) if f.required_kind is FileKind.TREE and f.usable)

    def tree_paths(self, path: str) -> tuple[str, ...]:
        """The tree files of a system without duplicates: those of `trees_from` for each listed tree file that can be
        used; empty if there is none."""
        listed = dict.fromkeys(f.path for f in self.listed_trees(path))
        return tuple(dict.fromkeys(found for tree in listed for found in self._tree_files.trees_from(tree)))

    def tree_outlines(self, system: str, file: str | None = None) -> tuple[TreeFileOutline, ...]:
        """The outlines of the tree files with which a tree file of a system is read: those of the first listed tree
        that contains it.

        Args:
            file: the tree file; `None` for the first listed one.
        """
        listed = tuple(dict.fromkeys(f.path for f in self.listed_trees(system)))
        containing = (tree for tree in listed if file is None or file in self._tree_files.trees_from(tree))
        first = next(containing, None)
        return self._tree_files.outlines_from(first) if first else ()

    def executed_trees(self, system: str) -> tuple[ListedTree, ...]:
        """The trees that a system executes."""
        trees = self.listed_trees(system)
        return tuple(ListedTree(f.input.tree, self._tree_files.outlines_from(f.path)) for f in trees)

    def files_of(self, system: str) -> tuple[str, ...]:
        """The system file and all files of the system, without duplicates.

        A listed file is left out if neither its name nor its content is that of a supported file.
        """
        listed = (f.path for f in self.listed(system) if f.path and (f.usable or f.path.lower().endswith(EXTENSIONS)))
        return tuple(dict.fromkeys((system, *listed, *self.tree_paths(system))))

    def systems_of(self, path: str) -> tuple[str | None, ...]:
        """The systems in which a file is analysed; `(None,)` if it is in none."""
        return self.memberships.get(path, ()) or (None,)

    @cached_property
    def memberships(self) -> Mapping[str, tuple[str, ...]]:
        """File -> its systems."""
        systems_by_file: dict[str, list[str]] = {}
        for system in self.paths:
            for path in self.files_of(system):
                systems_by_file.setdefault(path, []).append(system)
        return {path: tuple(systems) for path, systems in systems_by_file.items()}

    def property_names(self, system: str) -> tuple[str, ...]:
        """The names of the properties of a system that is not expanded."""
        return tuple(name for name, _ in self.names_before("", system))

    def names_before(self, path: str, system: str) -> Iterator[tuple[str, str]]:
        """The names of the properties in the files that `system` lists before the file `path`, each with the name of
        its file for messages."""
        for listed in self.listed(system):
            if listed.path == path:
                return
            if not listed.usable:
                continue
            file = f"`{listed.input.src.value}`" if listed.input.src else "another file"
            if listed.required_kind is FileKind.PROPERTIES:
                yield from ((property_.name, file) for property_ in self._sources.properties(listed.path)[0])
            elif (
                listed.required_kind is FileKind.XML_PROPERTIES
                and (before := self._sources.property_file(listed.path)) is not None
            ):
                yield from ((written.id.value, file) for written in before.properties if written.id is not None)

    def probabilities(self, system: str) -> frozenset[str]:
        """The names of the properties of a system whose results are probabilities."""
        kinds: dict[str, bool] = {}
        for listed in self.listed(system):
            if not listed.usable:
                continue
            if listed.required_kind is FileKind.PROPERTIES:
                for property_ in self._sources.properties(listed.path)[0]:
                    expression = property_.expression
                    inner = expression.values if isinstance(expression, Filter) else expression
                    kinds[property_.name] = isinstance(inner, Probability) and kinds.get(property_.name, True)
            elif (
                listed.required_kind is FileKind.XML_PROPERTIES
                and (file := self._sources.property_file(listed.path)) is not None
            ):
                for written in file.properties:
                    if written.id is not None:
                        kinds.setdefault(written.id.value, True)
        return frozenset(name for name, is_probability in kinds.items() if is_probability)

    def probabilities_below(self, folder: str) -> frozenset[str]:
        """The names of the properties in a folder whose results are probabilities in all systems that have them."""
        inside = [system for system in self.paths if is_below(system, folder)]
        of_systems = [(self.probabilities(system), self.property_names(system)) for system in inside]
        others = {name for known, names in of_systems for name in names if name not in known}
        return frozenset().union(*(known for known, _ in of_systems)) - others

    def property_names_below(self, folder: str) -> frozenset[str]:
        """The names of the properties of all systems in a folder."""
        inside = (system for system in self.paths if is_below(system, folder))
        return frozenset(name for system in inside for name, _ in self.names_before("", system))
