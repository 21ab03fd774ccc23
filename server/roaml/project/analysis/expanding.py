# SPDX-License-Identifier: Apache-2.0
"""The files of systems whose parameters, instances and channels are expanded (docs/spec/parameters.md#expansion)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Generic, TypeVar

from roaml.distributions import calls_distribution
from roaml.expansion import SystemExpansion, expand, expand_file, has_channels, needs_expansion
from roaml.jani.properties import Property
from roaml.model.kinds import FileKind
from roaml.model.ros import InterfaceType
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.systems import Systems
from roaml.project.files import Files
from roaml.project.memo import Memo
from roaml.project.paths import resolve
from roaml.project.ros_types import Interfaces
from roaml.record import Record
from roaml.text import SourceFile
from roaml.xml_syntax import Document

T = TypeVar("T")


class ExpandedFiles(Record, frozen=True, eq=False):
    """An expanded system, or an expanded file without a system.

    Attributes:
        files: the files of the user, in which the expanded ones have their expanded texts.
        memo: the cache for the analysis of `files`.
        systems: the path of the system; empty for a file without a system.
    """

    expansion: SystemExpansion
    files: Files
    memo: Memo
    systems: tuple[str, ...]


class _Sources:
    """The files of the user, for the expansion."""

    def __init__(self, sources: SourceFiles, interfaces: Interfaces) -> None:
        self._sources = sources
        self._interfaces = interfaces
        self.document: Callable[[str], Document | None] = sources.document
        self.kind: Callable[[str], FileKind] = sources.kind

    def text(self, path: str) -> str | None:
        source = self._sources.source(path)
        return None if source is None else source.text

    def properties(self, path: str) -> tuple[Property, ...]:
        return self._sources.properties(path)[0]

    def interface(self, kind: str, name: str) -> InterfaceType | None:
        interface = self._interfaces.interface(kind, name)
        return interface if isinstance(interface, InterfaceType) else None


class Expanding:
    """Expands systems and files.

    Args:
        given: names and texts of values that replace those in the files.
    """

    def __init__(
        self, sources: SourceFiles, interfaces: Interfaces, systems: Systems, given: tuple[tuple[str, str], ...]
    ) -> None:
        self._sources = sources
        self._interfaces = interfaces
        self._user = _Sources(sources, interfaces)
        self._systems = systems
        self._given = given

    def system(self, system: str, *, varied: bool = False) -> ExpandedFiles | None:
        """An expanded system; `None` if it uses no parameters, instances, channels or distributions, or cannot be read.
        If `varied`, its parameters have other values than the given ones."""
        document = self._sources.document(system)
        if document is None or self._sources.system_file(system) is None:
            return None
        others = self._systems.files_of(system)[1:]
        sources = self._user
        texts = tuple(sources.text(path) or "" for path in others)
        if not needs_expansion(document, iter(texts)):
            return None
        # The machines of channels contain the fields of messages.
        machines = (self._sources.machine(path) for path in others) if has_channels(document) else ()
        types = tuple(self._interfaces.interfaces_of(machine) for machine in machines if machine is not None)
        key = (document.text, others, texts, self._given, types)
        compute = functools.partial(expand, system, others, sources, self._given, resolve, varied=varied)
        expansion = self._remembered("expansion", (system, varied), key, compute)
        return self._expanded(expansion, f"{system} {varied}", (system,))

    def file(self, path: str, *, varied: bool = False) -> ExpandedFiles | None:
        """A machine or property file that is not in a system, with the values of its own parameters; `None` if it
        declares and uses none. For `varied`, see `system`."""
        source = self._sources.source(path)
        if source is None:
            return None
        text = source.text
        if "<parameter" not in text and "$(var" not in text and not calls_distribution(text):
            return None
        if self._sources.kind(path) not in (FileKind.MACHINE, FileKind.XML_PROPERTIES):
            return None
        compute = functools.partial(expand_file, path, self._user, resolve, varied=varied)
        expansion = self._remembered("expansion alone", (path, varied), source.text, compute)
        return self._expanded(expansion, f"alone {path} {varied}", ())

    def _remembered(
        self, name: str, place: object, key: object, compute: Callable[[], SystemExpansion]
    ) -> SystemExpansion:
        """The last expansion with a key, unless the data that it read have changed."""
        memo, sources = self._sources.memo, self._user
        expansion = memo.get(name, place, key, compute)
        data = tuple(sources.text(path) for path, _ in expansion.data)
        if data == tuple(text for _, text in expansion.data):
            return expansion
        return memo.get(f"{name} with changed data", place, (key, data), compute)

    def _expanded(self, expansion: SystemExpansion, name: str, systems: tuple[str, ...]) -> ExpandedFiles:
        texts = {path: SourceFile(path, text.text) for path, text in expansion.texts.items()}
        return ExpandedFiles(expansion, self._sources.files.with_texts(texts), self._sources.memo.inner(name), systems)


class Expansions(Generic[T]):
    """The expanded systems and files, each with its analysis.

    Args:
        expanding: `None` for files that are expanded already.
        analyse: returns the analysis of expanded files.
    """

    def __init__(self, expanding: Expanding | None, analyse: Callable[[ExpandedFiles], T]) -> None:
        self._expanding = expanding
        self._analyse = analyse
        self._known: dict[tuple[str, str, bool], T | None] = {}

    def system(self, system: str, *, varied: bool = False) -> T | None:
        """A system whose parameters and instances are expanded; `None` if it uses neither, or cannot be read. If
        `varied`, its parameters have other values than the given ones, which they could have as well."""
        key = ("system", system, varied)
        if key not in self._known:
            files = self._expanding.system(system, varied=varied) if self._expanding else None
            self._known[key] = None if files is None else self._analyse(files)
        return self._known[key]

    def file(self, path: str, *, varied: bool = False) -> T | None:
        """A machine or property file without a system whose own parameters are expanded; `None` if it declares none.
        For `varied`, see `system`."""
        key = ("file", path, varied)
        if key not in self._known:
            files = self._expanding.file(path, varied=varied) if self._expanding else None
            self._known[key] = None if files is None else self._analyse(files)
        return self._known[key]
