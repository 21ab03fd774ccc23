# SPDX-License-Identifier: Apache-2.0
"""The findings of the rules in one file, as a part of each of its systems.

Findings are cached by all values on which they depend. The contexts of the rules are read only if these have changed.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Generic, TypeAlias, TypeVar

from roaml.diagnostics import Finding, Symbol
from roaml.disk import UnreadableReason
from roaml.forest.forest import Forest
from roaml.interfaces.parse import parse as parse_interface
from roaml.interfaces.registry import NotFound, Reason
from roaml.interfaces.report import CODE as INTERFACE_SYNTAX
from roaml.interfaces.types import Definition, Kind
from roaml.language import HL_SCXML, PLAIN_SCXML, Grammar
from roaml.model.dialect import dialect_of
from roaml.model.expand import TreeFileOutline
from roaml.model.gaps import PlacedGap
from roaml.model.json_schema import structs_in_json
from roaml.model.kinds import GRAMMARS, PROJECT_EXTENSION, FileKind, mocks_path
from roaml.model.machine import Dialect, Machine
from roaml.model.property_links import LinkedFile
from roaml.model.size import Limits
from roaml.model.system import System
from roaml.model.tree import Include, TreeFile, TreeNode
from roaml.project.analysis.families import Families
from roaml.project.analysis.gaps import Gaps
from roaml.project.analysis.linking import Linking
from roaml.project.analysis.machines import NO_STRUCTS, Machines
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.symbols import symbol_name
from roaml.project.analysis.systems import Systems
from roaml.project.analysis.tree_files import TreeFiles
from roaml.project.analysis.values import ReachedValues
from roaml.project.configuration import missing_folders, unknown_expectations, vacuous_expectations
from roaml.project.files import MAX_CHARACTERS
from roaml.project.paths import folder_of, slashed
from roaml.project.ros_types import Interfaces
from roaml.record import Record
from roaml.rules.rule import (
    FileContext,
    MachineContext,
    PropertiesContext,
    StructsContext,
    SystemContext,
    TreeContext,
    UntranslatablePart,
    replacements,
)
from roaml.text import Location, SourceFile
from roaml.xml_syntax import Document

if TYPE_CHECKING:
    from roaml.project.experiment_file import AskedModel

E = TypeVar("E")
"""The analysis of expanded texts."""

OwnContext: TypeAlias = (
    "MachineContext | TreeContext | SystemContext | StructsContext | PropertiesContext | LinkedFile | None"
)
"""The context of the rules about files of one kind; `None` if there are no such rules, or the file has no model."""

_XML_KINDS = (*GRAMMARS, FileKind.SPECIFICATION, FileKind.UNKNOWN)


class FileInSystem(Record, Generic[E], frozen=True, eq=False):
    """A file as a part of a system.

    Attributes:
        system_path: the system file; `None` if the file is not in a system.
        system: the linked system; `None` if there is none, or it cannot be read.
        kind: the kind of the file in the system.
        findings: the findings of the rules; empty if the file is too large or its text is expanded.
        expanded: the analysis of the expanded texts, which is checked instead; `None` if nothing is expanded.
        failure: the internal error that prevents a check; `None` if there was none.
    """

    path: str
    source: SourceFile
    kind: FileKind
    system_path: str | None
    system: System | None = None
    findings: tuple[Finding, ...] = ()
    expanded: E | None = None
    failure: Exception | None = None


class CheckedFile(Record, Generic[E], frozen=True, eq=False):
    """A file that is checked.

    Attributes:
        document: the XML tree; `None` if the file is not XML.
        subjects: the file in each of its systems, or without a system.
    """

    source: SourceFile
    document: Document | None
    subjects: tuple[FileInSystem[E], ...]


class Contexts(Record, frozen=True, eq=False):
    """The contexts in which the rules check a file.

    Attributes:
        own: the context of the rules about files of this kind.
        failure: the internal error that prevented `own` from being made; `None` if there was none.
    """

    file: FileContext
    own: OwnContext = None
    failure: Exception | None = None


class Inspection(Record, frozen=True, eq=False):
    """How files are checked.

    Attributes:
        limits: the greatest sizes of systems, which the rules report.
        found: the rules: a path and the contexts of its file -> the findings.
    """

    limits: Limits
    found: Callable[[str, Contexts], tuple[Finding, ...]]


class Rooms(Record, frozen=True, eq=False):
    """The parts of an analysis. `asked` returns the names that an experiment with a system can use; `None` if the path
    is not that of a system."""

    sources: SourceFiles
    interfaces: Interfaces
    tree_files: TreeFiles
    systems: Systems
    families: Families
    machines: Machines
    gaps: Gaps
    linking: Linking
    values: ReachedValues
    asked: Callable[[str], AskedModel | None]


class Subjects(Generic[E]):
    """The files of an analysis as the rules check them.

    Args:
        expanded, expanded_file: return the expanded texts of a system, and of a file without a system; `None` if
            nothing is expanded.
    """

    def __init__(
        self,
        rooms: Rooms,
        expanded: Callable[[str], E | None],
        expanded_file: Callable[[str], E | None],
    ) -> None:
        self._rooms = rooms
        self._expanded = expanded
        self._expanded_file = expanded_file

    def present(self, paths: tuple[str, ...], unchecked: tuple[FileKind, ...]) -> tuple[str, ...]:
        """The files of all systems, and those of `paths` that are not of one of the kinds `unchecked`, without
        duplicates. Files that cannot be read are left out."""
        systems = self._rooms.systems
        files = dict.fromkeys(path for system in systems.paths for path in systems.files_of(system))
        sources = self._rooms.sources
        files.update((path, None) for path in paths if path not in files and sources.kind(path) not in unchecked)
        return tuple(path for path in files if sources.source(path) is not None)

    def checked_file(self, path: str, inspection: Inspection) -> CheckedFile[E] | None:
        """A file with its findings in all of its systems; `None` if it cannot be read."""
        source = self._rooms.sources.source(path)
        if source is None:
            return None
        subjects = (self.subject(path, system, inspection) for system in self._rooms.systems.systems_of(path))
        is_xml = self._rooms.sources.kind(path) in _XML_KINDS
        document = self._rooms.sources.document(path) if is_xml else None
        return CheckedFile(source, document, tuple(subject for subject in subjects if subject is not None))

    def subject(self, path: str, system: str | None, inspection: Inspection) -> FileInSystem[E] | None:
        """A file with its findings as a part of a system; `None` if it cannot be read."""
        rooms, source = self._rooms, self._rooms.sources.source(path)
        if source is None:
            return None
        linked = rooms.linking.system(system) if system else None
        if len(source.text) > MAX_CHARACTERS:
            return FileInSystem(path, source, FileKind.UNKNOWN, system, linked)
        expanded = self._expanded_file(path) if system is None else self._expanded(system)
        if expanded is not None:
            return FileInSystem(path, source, FileKind.UNKNOWN, system, linked, expanded=expanded)
        kind = rooms.systems.kind_in(path, system)
        reader = _Reader(rooms, path, source, kind, system, linked)
        try:
            findings = rooms.sources.memo.get(
                *("findings", (path, system), reader.key()),
                lambda: inspection.found(path, reader.contexts(inspection.limits)),
            )
        except Exception as error:  # an internal error in one file must not prevent the check of the others
            return FileInSystem(path, source, kind, system, linked, failure=error)
        return FileInSystem(path, source, kind, system, linked, findings)

    def contexts(self, subject: FileInSystem[E], limits: Limits) -> Contexts:
        """The contexts in which the rules check a file."""
        path, source, kind = subject.path, subject.source, subject.kind
        return _Reader(self._rooms, path, source, kind, subject.system_path, subject.system).contexts(limits)

    def file_context(self, subject: FileInSystem[E]) -> FileContext:
        """The context of the rules about files of any kind, in the text of the user, also if it is expanded."""
        kind = self._rooms.systems.kind_in(subject.path, subject.system_path)
        reader = _Reader(self._rooms, subject.path, subject.source, kind, subject.system_path, subject.system)
        return reader.file_context()

    def places(self, symbols: Iterable[Symbol]) -> Mapping[Symbol, tuple[Location, SourceFile]]:
        """The positions where symbols are defined, with the texts of their files. Symbols that no longer exist are left
        out."""
        sources = self._rooms.sources
        found = {symbol: (symbol_name(sources, symbol), sources.source(symbol.path)) for symbol in symbols}
        return {
            symbol: (Location(symbol.path, name.span), source)
            for symbol, (name, source) in found.items()
            if name is not None and source is not None
        }


class _Reader:
    """Reads what the rules need of one file in one system."""

    def __init__(
        self,
        rooms: Rooms,
        path: str,
        source: SourceFile,
        kind: FileKind,
        system_path: str | None,
        system: System | None,
    ) -> None:
        self.rooms = rooms
        self.path = path
        self.source = source
        self.kind = kind
        self.system_path = system_path
        self.system = system

    def key(self) -> object:
        """All values on which the findings depend, as a key for the cache."""
        parts: tuple[object, ...] = (self.source.text, self.source.ignored_encoding, self.kind, self.system)
        match self.kind:
            case FileKind.MACHINE if self.rooms.sources.machine(self.path) is not None:
                machine = self.rooms.sources.machine(self.path)
                assert machine is not None
                typed = self.rooms.linking.typed_in(self.path, self.system_path)
                lookups = tuple(self.rooms.interfaces.interfaces_of(machine))
                repeated = self.rooms.interfaces.repeated_types(machine)
                arriving = self.rooms.values.arriving_at(self.path, self.system_path)
                return (
                    *parts,
                    typed,
                    lookups,
                    repeated,
                    self.rooms.machines.structs(self.system_path).complete,
                    arriving,
                )
            case FileKind.SYSTEM:
                listed = tuple((f.path, f.problem, f.kind) for f in self.rooms.systems.listed(self.path))
                return (
                    *parts,
                    listed,
                    self.rooms.linking.system(self.path),
                    self.rooms.linking.size_of_translation(self.path),
                    self.rooms.systems.unlisted_properties(self.path),
                )
            case FileKind.TREE:
                includes = (tuple(self._missing_includes().items()), tuple(self._found_includes().items()))
                return (*parts, self._tree_outlines(), includes, self.rooms.linking.forest(self.path, self.system_path))
            case FileKind.PROPERTIES if self.system_path:
                names = tuple(self.rooms.systems.names_before(self.path, self.system_path))
                return (*parts, names, self.rooms.values.of_globals(self.system_path))
            case FileKind.XML_PROPERTIES if self.system_path:
                return (*parts, self.rooms.values.observed(self.path, self.system_path))
            case FileKind.STRUCTS | FileKind.JSON_STRUCTS:
                structs = self.rooms.machines.structs(self.system_path)
                return (*parts, structs.outlines, structs.complete)
            case FileKind.CONFIGURATION:
                return (*parts, self._configuration_findings())
            case FileKind.INTERFACE:
                return (*parts, self._interface_findings())
            case FileKind.MOCKS:
                return (*parts, self._mock_findings())
            case FileKind.EXPERIMENT:
                return (*parts, self._experiment_findings())
        return parts

    # -------------------------------------------------------------- contexts

    def contexts(self, limits: Limits) -> Contexts:
        """The contexts in which the rules check the file."""
        file = self.file_context()
        try:
            return Contexts(file, self.own_context(limits))
        except Exception as error:  # after an internal error, the findings of the parsers are still useful
            return Contexts(file, failure=error)

    def file_context(self) -> FileContext:
        """The context of the rules about files of any kind."""
        match self.kind:
            case FileKind.PROPERTIES:
                _, findings = self.rooms.sources.json(self.path) or (None, ())
                broken = any(finding.code == "json-syntax" for finding in findings)
                more = () if broken else self.rooms.sources.properties(self.path)[1]
                return FileContext(self.source, (*findings, *more))
            case FileKind.JSON_STRUCTS:
                value, findings = self.rooms.sources.json(self.path) or (None, ())
                broken = any(finding.code == "json-syntax" for finding in findings)
                problems = () if value is None or broken else structs_in_json(value)[1]
                return FileContext(self.source, (*findings, *problems))
            case FileKind.JANI_MODEL:
                _, findings = self.rooms.sources.json(self.path) or (None, ())
                return FileContext(self.source, findings)
            case FileKind.INTERFACE:
                return FileContext(self.source, self._interface_findings())
            case FileKind.MOCKS:
                return FileContext(self.source, self._mock_findings())
            case FileKind.EXPERIMENT:
                return FileContext(self.source, self._experiment_findings())
            case FileKind.CONFIGURATION:
                return FileContext(self.source, self._configuration_findings())
        document = self.rooms.sources.document(self.path)
        assert document is not None
        grammar = self._grammar()
        violations = () if grammar is None else self.rooms.sources.violations(self.path, grammar)
        lone = self.kind is FileKind.TREE and self.system_path is None
        return FileContext(self.source, document.findings, document, grammar, violations, self._older(), lone)

    def own_context(self, limits: Limits) -> OwnContext:
        """The context of the rules about files of the kind of this file."""
        match self.kind:
            case FileKind.MACHINE:
                return self.machine_context()
            case FileKind.TREE:
                return self._tree_context()
            case FileKind.SYSTEM:
                return self._system_context(limits)
            case FileKind.STRUCTS | FileKind.JSON_STRUCTS:
                return self._structs_context()
            case FileKind.XML_PROPERTIES:
                return self.rooms.values.observed(self.path, self.system_path) if self.system_path else None
            case FileKind.PROPERTIES:
                return self._properties_context()
        return None

    def _interface_findings(self) -> tuple[Finding, ...]:
        name, _, extension = self.path.replace("\\", "/").rpartition("/")[2].rpartition(".")
        kind: Kind = "msg" if extension == "msg" else "srv" if extension == "srv" else "action"
        package = self.path.replace("\\", "/").split("/")[-3:-2]
        definition, findings = parse_interface(self.source.text, package[0] if package else "package", name, kind)
        from roaml.project.repeated_constants import repeated_constants  # noqa: PLC0415 - only for interfaces

        repeated = repeated_constants(self.source.text, definition)
        misspelled = self._misspelled_fields(definition, findings)
        return (*findings, *misspelled, *repeated, *self._exchanged_sections(definition))

    def _exchanged_sections(self, definition: Definition) -> Iterator[Finding]:
        """The finding that the request and the response of a service are exchanged."""
        if definition.kind != "srv":
            return
        end = f"/{definition.name}"
        for user in self.rooms.systems.paths:
            system = self.rooms.linking.system(user)
            listed = (*system.nodes, *system.plugins) if system is not None else ()
            paths = dict.fromkeys(p for p, outline in listed if any(u.type.endswith(end) for u in outline.interfaces))
            machines = [machine for path in paths if (machine := self.rooms.sources.machine(path)) is not None]
            if not machines:
                continue
            from roaml.project.exchanged_sections import exchanged_sections  # noqa: PLC0415 - only for services

            findings = tuple(exchanged_sections(self.source.text, definition, machines))
            if findings and self.path in self.rooms.machines.interface_files_of(user):
                yield from findings
                return

    def _misspelled_fields(self, definition: Definition, findings: tuple[Finding, ...]) -> Iterator[Finding]:
        """The types of fields that do not exist in a known package, or whose package resembles a known one. Other
        unknown packages may be in folders that are not searched; the machines that use their types report them."""
        known = {finding.span for finding in findings}
        for section in definition.sections:
            for field in section.fields:
                if field.type.is_primitive or field.type_span in known:
                    continue
                problem = self.rooms.interfaces.registry.resolve("msg", field.type.name)
                if isinstance(problem, NotFound) and (problem.meant or problem.reason is Reason.UNKNOWN_TYPE):
                    fixes = replacements(field.type_span, problem.meant)
                    yield Finding(INTERFACE_SYNTAX, field.type_span, problem.message, None, tuple(fixes))

    def _mock_findings(self) -> tuple[Finding, ...]:
        from roaml.project.mock_findings import mock_findings  # noqa: PLC0415 - few projects have mocks

        files = self.rooms.sources.files
        return tuple(mock_findings(self.source, files.beside, self.rooms.linking.forest, files.text, self._has_plugin))

    def _has_plugin(self, tree: str, type_: str) -> bool:
        linked = (self.rooms.linking.system(s) for s in self.rooms.systems.systems_of(tree) if s is not None)
        return any(system.plugin(type_)[1] is not None for system in linked if system is not None)

    def _experiment_findings(self) -> tuple[Finding, ...]:
        from roaml.project.experiment_file import experiment_findings  # noqa: PLC0415 - few projects have experiments

        return tuple(experiment_findings(self.source, self.rooms.sources.files.text, self.rooms.asked))

    def _configuration_findings(self) -> tuple[Finding, ...]:
        configuration = self.rooms.sources.configuration(self.path)
        if configuration is None:
            return ()
        names = self.rooms.systems.property_names_below(folder_of(self.path)) if configuration.expected else ()
        unknown = unknown_expectations(self.source, configuration, names)
        probabilities = (
            self.rooms.systems.probabilities_below(folder_of(self.path)) if configuration.expected else frozenset()
        )
        vacuous = vacuous_expectations(configuration, probabilities)
        return (*configuration.findings, *missing_folders(configuration), *unknown, *vacuous)

    def _grammar(self) -> Grammar | None:
        if self.kind is FileKind.MACHINE:
            if self.rooms.sources.machine(self.path) is None:
                return None
            return PLAIN_SCXML if self._dialect() in (Dialect.PLAIN, Dialect.FOREIGN) else HL_SCXML
        return GRAMMARS.get(self.kind)

    def _older(self) -> bool:
        if self.kind is FileKind.MACHINE and self.rooms.sources.machine(self.path) is not None:
            return self._dialect() is Dialect.OLDER
        if self.kind is FileKind.SYSTEM:
            file = self.rooms.sources.system_file(self.path)
            return file is not None and file.older
        return self.system is not None and self.system.older

    def _dialect(self) -> Dialect:
        machine, document = self.rooms.sources.machine(self.path), self.rooms.sources.document(self.path)
        assert machine is not None
        assert document is not None
        return dialect_of(machine, document, self.system.older if self.system else None)

    def machine_context(self) -> MachineContext | None:
        """The context of the rules about machines; `None` if the file is not a machine."""
        machine, document = self.rooms.sources.machine(self.path), self.rooms.sources.document(self.path)
        if machine is None or document is None:
            return None
        structs = self.rooms.machines.structs(self.system_path)
        listed = self.rooms.systems.listed(self.system_path) if self.system_path else ()
        events = self.system.event_data if self.system else {}
        return MachineContext(
            self.source,
            document,
            machine,
            self.rooms.linking.typed_in(self.path, self.system_path),
            self._dialect(),
            self.system,
            self.system.automata_of(self.path) if self.system else (),
            frozenset(f.input.section for f in listed if f.path == self.path),
            structs.types.get,
            tuple(structs.types),
            structs.complete,
            self.rooms.interfaces.interface,
            events.get,
            self._machine_gaps(machine),
            self.rooms.interfaces.repeated_types(machine),
            self.rooms.values.local_values(self.path, self.system_path),
            self.rooms.values.values_in(self.path, self.system_path),
        )

    def _machine_gaps(self, machine: Machine) -> tuple[PlacedGap, ...]:
        automata = self.system.automata_of(self.path) if self.system else ()
        if not any(automaton.outline.gaps for automaton in automata):
            return ()
        return self.rooms.machines.machine_gaps(
            self.path, machine, self.rooms.linking.typed_in(self.path, self.system_path)
        )

    def _gaps(self) -> tuple[PlacedGap, ...]:
        """The gaps of the system that are caused by this file."""
        gaps = self.rooms.gaps.gaps(self.system_path) if self.system_path else ()
        return tuple(placed for path, placed in gaps if path == self.path)

    def _tree_context(self) -> TreeContext | None:
        file, document = self.rooms.sources.tree(self.path), self.rooms.sources.document(self.path)
        if file is None or document is None:
            return None
        older = self.system is not None and self.system.older
        outlines = self._tree_outlines()
        missing, interface = self._missing_includes(), self.rooms.interfaces.interface
        trees = self.rooms.linking.forest(self.path, self.system_path)
        system = self.system.seen_from(self.path) if self.system is not None else None
        return TreeContext(
            *(self.source, document, file, system, outlines, missing, interface, self._gaps(), older, trees),
            self._unknown_packages(),
            self._refusals(),
            self._found_includes(),
            self._mocked_durations(file) if self.system_path is None else {},
            self._mock_patterns(trees) if self.system_path is None and trees is not None else frozenset(),
        )

    def _mocked_durations(self, file: TreeFile) -> Mapping[TreeNode, Fraction]:
        """The times, in ns, that the leaves of a tree take to succeed according to the mocks beside it."""
        mocks = self.rooms.sources.source(mocks_path(self.path))
        if mocks is None:
            return {}
        from roaml.project.mock_findings import mocked_durations  # noqa: PLC0415 - few projects have mocks

        return mocked_durations(file, mocks.text)

    def _mock_patterns(self, trees: Forest) -> frozenset[str]:
        """What the mocks beside the trees that are checked together name."""
        sources = (self.rooms.sources.source(mocks_path(path)) for path, _ in trees.files)
        texts = [source.text for source in sources if source is not None]
        if not texts:
            return frozenset()
        from roaml.project.mock_findings import mock_patterns  # noqa: PLC0415 - few projects have mocks

        return frozenset(pattern for text in texts for pattern in mock_patterns(text))

    def _refusals(self) -> tuple[UntranslatablePart, ...]:
        """The nodes of this file that cannot be translated, with the reasons, if the tree is executed as
        BehaviorTree.CPP executes it. Reasons that other rules report are left out."""
        tree = self.rooms.linking.library_tree(self.system_path) if self.system_path else None
        refusals = () if tree is None else tree.refusals
        own = [refusal for refusal in refusals if refusal.origin.path == self.path and not refusal.is_reported]
        if not own:
            return ()
        from roaml.lower.programs.refusal import place_in  # noqa: PLC0415 - most trees can be translated

        text = self.source.text
        return tuple(UntranslatablePart(place_in(text, refusal), refusal.reason, refusal.unset) for refusal in own)

    def _tree_outlines(self) -> tuple[TreeFileOutline, ...]:
        """The outlines of the tree files with which this file is checked: those of its system; without a system, those
        that it includes or that include it."""
        if self.system_path:
            return self.rooms.systems.tree_outlines(self.system_path, self.path)
        return self.rooms.families.outlines_around(self.path)

    def _unknown_packages(self) -> frozenset[str]:
        """The names of the ROS packages in `<include>` elements that are not found."""
        file = self.rooms.sources.tree(self.path)
        return frozenset(
            include.package.value
            for include in (file.includes if file else ())
            if include.package is not None and self.rooms.tree_files.include_path(self.path, include) is None
        )

    def _missing_includes(self) -> dict[str, str]:
        """Path in an `<include>` that cannot be used -> the reason."""
        file = self.rooms.sources.tree(self.path)
        problems: dict[str, str] = {}
        for include in file.includes if file else ():
            target = self.rooms.tree_files.include_path(self.path, include)
            if include.path is None:
                continue
            if target is None:
                if self.system_path and include.package is not None:
                    problems[include.path.value] = (
                        f"no folder around this file contains the ROS package `{include.package.value}`"
                    )
                continue
            source = self.rooms.sources.files.read(target)
            named = self.rooms.tree_files.named_path(self.path, include)
            if self.system_path and named is not None and target != named:
                problems[include.path.value] = UnreadableReason.MISSING.value
            elif isinstance(source, UnreadableReason):
                problems[include.path.value] = self._missing(source, include)
            elif self.rooms.sources.tree(target) is None:
                problems[include.path.value] = "it is not a file of behavior trees"
            elif self.path in self.rooms.tree_files.trees_from(target) and not self.path.endswith(PROJECT_EXTENSION):
                problems[include.path.value] = (
                    "it includes this file itself" if target != self.path else "it is this file"
                )
        return problems

    def _missing(self, reason: UnreadableReason, include: Include) -> str:
        """Why a file cannot be included, with the other places where it was looked for."""
        places = self.rooms.tree_files.include_places(self.path, include)
        if reason is not UnreadableReason.MISSING or not places or self.system_path:
            return reason.value
        folder = os.path.dirname(self.path)
        shown = ", ".join(f"`{slashed(os.path.relpath(place, folder))}`" for place in places)
        return f"{reason.value}, nor {shown} relative to this file"

    def _found_includes(self) -> dict[str, str]:
        """Path in an `<include>` that names no file -> the path, relative to this file, of the file that is read
        instead."""
        file = self.rooms.sources.tree(self.path)
        found: dict[str, str] = {}
        for include in file.includes if file and not self.system_path else ():
            target = self.rooms.tree_files.include_path(self.path, include)
            is_named = target is None or target == self.rooms.tree_files.named_path(self.path, include)
            if include.path is not None and target is not None and not is_named:
                found[include.path.value] = slashed(os.path.relpath(target, os.path.dirname(self.path)))
        return found

    def _system_context(self, limits: Limits) -> SystemContext | None:
        file, document = self.rooms.sources.system_file(self.path), self.rooms.sources.document(self.path)
        system = self.rooms.linking.system(self.path)
        if file is None or document is None or system is None:
            return None
        size = self.rooms.linking.size_of_translation(self.path)
        assert size is not None
        files, gaps = self.rooms.systems.listed(self.path), self._gaps()
        interface = self.rooms.interfaces.interface
        unlisted = self.rooms.systems.unlisted_properties(self.path)
        return SystemContext(self.source, document, file, files, system, interface, gaps, size, limits, unlisted)

    def _structs_context(self) -> StructsContext:
        declarations = self.rooms.sources.struct_declarations(self.path)
        structs = self.rooms.machines.structs(self.system_path)
        if structs is NO_STRUCTS:
            own = tuple(outline for d in declarations if (outline := d.outline) is not None)
            return StructsContext(self.source, declarations, own, len(own) == len(declarations))
        return StructsContext(self.source, declarations, structs.outlines, structs.complete)

    def _properties_context(self) -> PropertiesContext | None:
        json = self.rooms.sources.json(self.path)
        if json is None:
            return None
        properties, _ = self.rooms.sources.properties(self.path)
        variables = self.rooms.linking.globals(self.system_path) if self.system_path else None
        taken = dict(self.rooms.systems.names_before(self.path, self.system_path)) if self.system_path else {}
        values = self.rooms.values.of_globals(self.system_path) if self.system_path else {}
        return PropertiesContext(self.source, json[0], properties, self.system, variables, taken, values)
