# SPDX-License-Identifier: Apache-2.0
"""The models and systems in the user's files at one moment.

- An `Analysis` never changes: all its results are functions of the content of the files at one moment.
- Results are cached by content (`Memo`), so a later analysis recomputes only what differs. Parsed files and models are
  cached by the digest of the file, types and outlines by the digest and the declarations, a system by the outlines of
  its files.
- An analysis reports no findings; `roaml.project.checking` runs the rules.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from roaml.diagnostics import Finding
from roaml.disk import UnreadableReason
from roaml.expr.types import Struct, Type
from roaml.forest.forest import Forest
from roaml.forest.settings import NEWEST, TreeSettings
from roaml.interfaces.registry import NotFound, Reason, Registry
from roaml.interfaces.types import Definition, Kind
from roaml.jani.properties import Property, identifiers
from roaml.jani.reader import read_properties
from roaml.json_syntax import JsonValue
from roaml.json_syntax import parse as parse_json
from roaml.language import BEHAVIOR_TREE, Grammar
from roaml.language.validate import Misfit, Violation, misfits, validate
from roaml.model.build_machine import build_machine
from roaml.model.expand import TreeFileOutline, expand, is_whole, node_at, stray_remaps, tree_file_outline
from roaml.model.gaps import Gap, GapAct, InterfaceAct, PlacedGap, machine_gaps
from roaml.model.globals import GlobalVariable, event_parameters, global_variables
from roaml.model.json_schema import structs_in_json
from roaml.model.kinds import EXTENSIONS, MACHINE_EXTENSIONS, PROJECT_EXTENSION, FileKind, kind_of
from roaml.model.machine import Machine
from roaml.model.nesting import MAX_DEPTH, MAX_FIELDS
from roaml.model.outline import MachineOutline, outline
from roaml.model.parameters import NO_OVERRIDES, Overrides
from roaml.model.property_file import PropertyFile, build_property_file
from roaml.model.property_links import LinkedFile, link
from roaml.model.property_ports import observed_names
from roaml.model.ros import InterfaceType, RepeatedType, extent_of, interface_type
from roaml.model.structs import StructDeclaration, StructOutline, resolve_structs, structs_in_xml
from roaml.model.syntax import Name
from roaml.model.system import System
from roaml.model.system_file import ListedFile, SystemFile, SystemInput, SystemSection, build_system_file, required_kind
from roaml.model.tree import Include, TreeFile, blackboard_variable, build_tree_file, nodes
from roaml.model.value_types import INTERFACE_KINDS, Environment, TypedMachine, type_machine
from roaml.project.configuration import Configuration, read_configuration
from roaml.project.files import MAX_CHARACTERS, Files
from roaml.project.memo import Memo
from roaml.project.paths import resolve
from roaml.project.settings import folders_above
from roaml.record import Record, replace
from roaml.roles import SymbolKind
from roaml.scxml.event_data import Round, infer_in_rounds
from roaml.scxml.names import sanitise
from roaml.suggest import close_names
from roaml.text import SourceFile, Span
from roaml.xml_syntax import Document
from roaml.xml_syntax import parse as parse_xml

if TYPE_CHECKING:
    from roaml.lower.library_tree import LibraryTree

T = TypeVar("T")


class Structs(Record, frozen=True, eq=False):
    """The structs of a system.

    Attributes:
        outlines: the declarations without positions. Equal outlines mean equal structs.
        complete: whether the names of all structs are known.
    """

    outlines: tuple[StructOutline, ...]
    types: Mapping[str, Type]
    complete: bool


BROKEN = ("xml-syntax", "json-syntax", "nesting-too-deep")
"""The codes of findings that mean that a parsed tree may not contain the whole text."""

NO_STRUCTS = Structs((), {}, complete=True)


class _MachineEnvironment:
    """An implementation of `roaml.model.value_types.Environment` for one machine."""

    def __init__(
        self,
        analysis: Analysis,
        structs: Structs,
        events: Mapping[str, Struct],
        published: Mapping[str, tuple[InterfaceType, ...]],
    ) -> None:
        self.struct = structs.types.get
        self.event_data = events.get
        self._analysis = analysis
        self._published = published

    def published(self, topic: str) -> tuple[InterfaceType, ...]:
        return self._published.get(sanitise(topic), ())

    def interface(self, kind: str, name: str) -> InterfaceType | None:
        definition = self._analysis.interface(kind, name)
        return definition if isinstance(definition, InterfaceType) else None


class Analysis:
    """The models and systems in the files of one moment.

    Args:
        files: the files at this moment.
        registry: resolves ROS types.
        memo: the results of earlier analyses.
        systems: the paths of the system files that are analysed.
        overrides: parameters that replace those in system files.
        trees: the settings for trees that are not in a system.
        listed: the paths of the files in the workspace.
    """

    def __init__(
        self,
        files: Files,
        registry: Registry,
        memo: Memo,
        systems: Iterable[str],
        overrides: Overrides = NO_OVERRIDES,
        trees: TreeSettings = NEWEST,
        listed: Iterable[str] = (),
    ) -> None:
        self._listed_files = tuple(listed)
        self._folder_names: dict[str, frozenset[str]] = {}
        self.overrides = overrides
        self.tree_settings = trees
        self.files = files
        self.registry = registry
        self.memo = memo
        self.system_paths = tuple(dict.fromkeys(systems))
        self._interfaces: dict[tuple[str, str], InterfaceType | NotFound] = {}
        self._systems: dict[str, System | None] = {}
        self._listed: dict[str, tuple[ListedFile, ...]] = {}
        self._structs: dict[str, Structs] = {}
        self._published_types: dict[str, Mapping[str, tuple[str, ...]]] = {}
        self._trees: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {}
        self._gaps: dict[str, tuple[tuple[str, PlacedGap], ...]] = {}

    # ---------------------------------------------------------- single files

    def source(self, path: str) -> SourceFile | None:
        return self.files.text(path)

    def kind(self, path: str) -> FileKind:
        """The kind of the file, from its name and its content."""
        source = self.source(path)
        if source is None:
            return FileKind.UNKNOWN
        return self.memo.get("kind", path, source.digest, lambda: kind_of(path, source.text))

    def kind_in(self, path: str, system: str | None) -> FileKind:
        """The kind of a file, from its name and its content. If they do not identify the kind, and `system` lists the
        file as struct declarations in JSON, it is this kind."""
        kind = self.kind(path)
        if kind is not FileKind.UNKNOWN or system is None:
            return kind
        listed = (file.kind for file in self.listed(system) if file.path == path)
        return FileKind.JSON_STRUCTS if FileKind.JSON_STRUCTS in listed else kind

    def document(self, path: str) -> Document | None:
        return self._of("document", path, lambda source: parse_xml(source.text))

    def json(self, path: str) -> tuple[JsonValue, tuple[Finding, ...]] | None:
        return self._of("json", path, lambda source: parse_json(source.text))

    def configuration(self, path: str) -> Configuration | None:
        return self._of("configuration", path, read_configuration)

    def properties(self, path: str) -> tuple[tuple[Property, ...], tuple[Finding, ...]]:
        """The properties in a JANI property file, and their syntax errors."""
        value = self.json(path)
        if value is None:
            return (), ()
        return self._of("properties", path, lambda _: read_properties(value[0], path)) or ((), ())

    def violations(self, path: str, grammar: Grammar) -> tuple[Violation, ...]:
        """The places where a file violates a grammar."""
        violations = self._of_document(
            f"violations {grammar.schema}", path, lambda document: validate(document, grammar)
        )
        return violations or ()

    def misfits(self, path: str, grammar: Grammar) -> tuple[Misfit, ...]:
        """The elements of a file that the grammar does not define, or does not allow in their place."""

        def find(document: Document) -> tuple[Misfit, ...]:
            return tuple(misfits(document.root, document.namespaces, grammar))

        return self._of_document(f"misfits {grammar.schema}", path, find) or ()

    def machine(self, path: str) -> Machine | None:
        return self._of_document("machine", path, build_machine)

    def tree(self, path: str) -> TreeFile | None:
        return self._of_document("tree", path, build_tree_file)

    def property_file(self, path: str) -> PropertyFile | None:
        return self._of_document("property file", path, build_property_file)

    def linked_properties(self, path: str, system: str) -> LinkedFile | None:
        """The properties in an XML file, linked to a system that lists the file; `None` if the file or the system
        cannot be read."""
        file, linked = self.property_file(path), self.system(system)
        if file is None or linked is None:
            return None
        taken = tuple(self.names_before(path, system))
        variables = self.globals(system)
        compute = functools.partial(link, file, linked, self.interface, variables, dict(taken), path)
        return self.memo.get("linked properties", (path, system), (file, linked, taken), compute)

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
                yield from ((property_.name, file) for property_ in self.properties(listed.path)[0])
            elif (
                listed.required_kind is FileKind.XML_PROPERTIES
                and (before := self.property_file(listed.path)) is not None
            ):
                yield from ((written.id.value, file) for written in before.properties if written.id is not None)

    def system_file(self, path: str) -> SystemFile | None:
        return self._of_document("system file", path, lambda document: build_system_file(document, self.overrides))

    def struct_declarations(self, path: str) -> tuple[StructDeclaration, ...]:
        """The structs that a file declares, in XML or in JSON."""
        if self.kind(path) is FileKind.STRUCTS:
            return self._of_document("structs", path, structs_in_xml) or ()
        value = self.json(path)
        if value is None:
            return ()
        return self._of("structs", path, lambda _: structs_in_json(value[0])[0]) or ()

    def _of(self, computation: str, path: str, compute: Callable[[SourceFile], T]) -> T | None:
        """The cached result of `compute` for a file; `None` if the file cannot be read or is too large."""
        source = self.source(path)
        if source is None or len(source.text) > MAX_CHARACTERS:
            return None
        return self.memo.get(computation, path, source.digest, lambda: compute(source))

    def _of_document(self, computation: str, path: str, compute: Callable[[Document], T]) -> T | None:
        document = self.document(path)
        if document is None:
            return None
        return self._of(computation, path, lambda _: compute(document))

    # ------------------------------------------------------------- ROS types

    def interface(self, kind: str, name: str) -> InterfaceType | NotFound:
        """The ROS type `name`, as written, of the kind msg, srv or action, with HL-SCXML types; `NotFound` with the
        reason if it cannot be used."""
        key = (kind, name)
        if key not in self._interfaces:
            self._interfaces[key] = self._find_interface(kind, name)
        return self._interfaces[key]

    def _find_interface(self, kind: str, name: str) -> InterfaceType | NotFound:
        assert kind in ("msg", "srv", "action")
        key: tuple[Kind, str] = (kind, name)  # type: ignore[assignment]
        definition = self.registry.resolve(*key)
        if isinstance(definition, NotFound):
            return definition
        parts = tuple(self._closure(definition))
        extent = self.memo.get("interface extent", key, parts, lambda: extent_of(parts))
        if extent.is_too_large:
            fields = f"{extent.fields:,} fields (at most {MAX_FIELDS:,} are read)"
            deep = f"{extent.depth} levels of nested messages (at most {MAX_DEPTH} are read)"
            size = fields if extent.fields > MAX_FIELDS else deep
            return NotFound(Reason.TOO_LARGE, key[0], name, size=size)
        return self.memo.get(
            "interface",
            key,
            parts,
            lambda: interface_type(definition, lambda n: self.registry.resolve("msg", n)),
        )

    def repeated_types(self, machine: Machine) -> tuple[RepeatedType, ...]:
        """The ROS types that a machine uses, directly or in fields, and that another file defines differently."""
        repeated_types: dict[tuple[str, str], RepeatedType] = {}
        for declaration in machine.declarations:
            if declaration.type is None or declaration.kind not in INTERFACE_KINDS:
                continue
            written = declaration.type.value
            definition = self.registry.resolve(INTERFACE_KINDS[declaration.kind], written)
            for part in () if isinstance(definition, NotFound) else self._closure(definition):
                other = self.registry.other_definition(part.kind, part.package, part.name)
                if other is not None:
                    repeated = RepeatedType(written, part.package, part.name, part.path, other.path)
                    repeated_types.setdefault((written, part.full_name), repeated)
        return tuple(repeated_types.values())

    def _closure(self, definition: Definition) -> list[Definition]:
        """A definition and the definitions of all messages nested in it."""
        definitions = [definition]
        names = {definition.full_name}
        for outer in definitions:
            for section in outer.sections:
                for field in section.fields:
                    if not field.type.is_primitive and field.type.name not in names:
                        names.add(field.type.name)
                        nested = self.registry.resolve("msg", field.type.name)
                        if not isinstance(nested, NotFound):
                            definitions.append(nested)
        return definitions

    # --------------------------------------------------------------- systems

    def listed(self, path: str) -> tuple[ListedFile, ...]:
        """The files that a system file lists, in order; empty if it cannot be read."""
        if path not in self._listed:
            file = self.system_file(path)
            self._listed[path] = tuple(self._listed_file(path, entry) for entry in file.inputs) if file else ()
        return self._listed[path]

    def lists_all(self, system: str, section: SystemSection) -> bool:
        """Whether all files that a system lists in the section `section` are known and can be used."""
        file = self.system_file(system)
        if file is None or section in file.unread:
            return False
        return all(listed.usable for listed in self.listed(system) if listed.input.section is section)

    def _listed_file(self, base: str, entry: SystemInput) -> ListedFile:
        kind_required = required_kind(entry)
        if entry.src is None:
            return ListedFile(entry, "", None, kind_required, FileKind.UNKNOWN)
        path = resolve(base, entry.src.value)
        source = self.files.read(path)
        if isinstance(source, UnreadableReason):
            return ListedFile(entry, path, source, kind_required, FileKind.UNKNOWN)
        if len(source.text) > MAX_CHARACTERS:
            return ListedFile(entry, path, UnreadableReason.TOO_LONG, kind_required, self.kind(path))
        kind = self.kind(path)
        if kind is FileKind.MACHINE and self.machine(path) is None:
            kind = FileKind.UNKNOWN
        if kind_required is FileKind.JSON_STRUCTS and kind is FileKind.UNKNOWN and path.endswith(".json"):
            kind = FileKind.JSON_STRUCTS
        return ListedFile(entry, path, None, kind_required, kind)

    def tree_paths(self, path: str) -> tuple[str, ...]:
        """The tree files of a system without duplicates: those of `trees_from` for the first listed tree file that can
        be used; empty if there is none."""
        first = next((f.path for f in self.listed(path) if f.required_kind is FileKind.TREE and f.usable), None)
        return self.trees_from(first) if first else ()

    def trees_from(self, path: str) -> tuple[str, ...]:
        """The files that define the trees of a tree file, without duplicates.

        They are the file itself, the files that it includes directly or indirectly, the Groot2 projects in its
        directory that list it, and the files of these projects that define missing subtrees.
        """
        if path not in self._trees:
            own = self._with_included([path])
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

    def tree_outlines(self, system: str) -> tuple[TreeFileOutline, ...]:
        """The outlines of the tree files of a system."""
        first = next(iter(self.tree_paths(system)), None)
        return self.outlines_from(first) if first else ()

    def _with_included(self, paths: list[str]) -> tuple[str, ...]:
        trees = [path for path in paths if self.tree(path) is not None]
        known = set(trees)
        for tree_path in trees:
            new = [p for p in dict.fromkeys(self.includes(tree_path)) if p not in known and self.tree(p) is not None]
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
        projects = [p for p in self.files.beside(path, PROJECT_EXTENSION) if path in self.includes(p)]
        listed = dict.fromkeys(p for project in projects for p in self.includes(project))
        more: list[str] = list(projects)
        while True:
            known = {name for tree_path in (*own, *more) for name in self._tree_names(tree_path)}
            missing = {name for tree_path in (*own, *more) for name in self._subtrees(tree_path)} - known
            new = next((p for p in listed if p not in (*own, *more) and missing & self._tree_names(p)), None)
            if new is None:
                return tuple(more)
            more += [p for p in self._with_included([new]) if p not in (*own, *more)]

    def _names_in_folder(self, path: str) -> frozenset[str]:
        """The names of the trees in all files in the folder of a file."""
        folder = os.path.dirname(path)
        if folder not in self._folder_names:
            files = (p for p in (path, *self.files.beside(path, ".xml")) if self.kind(p) is FileKind.TREE)
            self._folder_names[folder] = frozenset(name for p in files for name in self._tree_names(p))
        return self._folder_names[folder]

    def _tree_names(self, path: str) -> set[str]:
        tree = self.tree(path)
        return {behavior_tree.id.value for behavior_tree in tree.trees if behavior_tree.id} if tree else set()

    def _subtrees(self, path: str) -> set[str]:
        """The names of the trees that a file uses as subtrees."""
        tree = self.tree(path)
        used = (node for behavior_tree in tree.trees for node in nodes(behavior_tree)) if tree else ()
        return {node.plugin.value for node in used if node.is_subtree and node.plugin}

    def includes(self, path: str) -> tuple[str, ...]:
        """The paths of the files that a tree file includes directly."""
        tree = self.tree(path)
        return tuple(filter(None, map(functools.partial(self.include_path, path), tree.includes))) if tree else ()

    def include_path(self, base: str, include: Include) -> str | None:
        """The path to which an `<include>` refers; `None` if it has no path, or if its ROS package is not found.

        Args:
            base: the path of the file that contains the `<include>`.
        """
        if include.path is None:
            return None
        package = include.package.value.strip() if include.package else ""
        if not package or os.path.isabs(include.path.value):
            return resolve(base, include.path.value)
        folder = self._package_folder(base, package)
        return None if folder is None else os.path.normpath(os.path.join(folder, include.path.value))

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
                if self.files.text(os.path.join(place, "package.xml")) is not None:
                    return place
        return None

    def family(self, path: str) -> tuple[str, ...]:
        """The tree files that are connected with the tree file `path` by includes, in either direction. The files are
        not in a system. A file that no other file includes precedes the files that it includes."""
        return tuple(file.path for file in self.family_outlines(path))

    def family_outlines(self, path: str) -> tuple[TreeFileOutline, ...]:
        """The outlines of the files of `family`."""
        outlines: dict[str, TreeFileOutline] = {}
        for top in self._tops.get(path, (path,)):
            for file in self.outlines_from(top):
                outlines.setdefault(file.path, file)
        return tuple(outlines.values())

    def _including(self, path: str) -> tuple[str, ...]:
        """The root files that include a file, directly or indirectly, followed by the file itself. A root file is one
        that no other file includes."""
        tops = self._tops.get(path, ())
        return (path,) if path in tops else (*(top for top in tops if path in self.trees_from(top)), path)

    def outlines_around(self, path: str) -> tuple[TreeFileOutline, ...]:
        """The outlines of a tree file that is not in a system, of the files that include it, and of the files that it
        includes."""
        outlines = (outline for top in self._including(path) for outline in self.outlines_from(top))
        return tuple({outline.path: outline for outline in outlines}.values())

    @cached_property
    def _tops(self) -> Mapping[str, tuple[str, ...]]:
        """Tree file -> the files of its family that no other file includes; all of them if they include each other."""
        files = [p for p in self._listed_files if self.kind(p) is FileKind.TREE and p not in self.memberships]
        linked: dict[str, set[str]] = {}
        included: set[str] = set()
        for file in files:
            for target in self.includes(file):
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
        if self.tree(path) is None:
            return None
        models = self._with_included([p for p in self.tree_settings.models if self.tree(p) is not None])
        paths = tuple(dict.fromkeys(p for top in self._including(path) for p in self.trees_from(top)))
        paths = tuple(dict.fromkeys((*paths, *models)))
        files = tuple((p, tree) for p in paths if (tree := self.tree(p)) is not None)
        beside = self._names_in_folder(path)
        targets = (self.include_path(p, i) for p, tree in files for i in tree.includes)
        complete = all(target is not None and self.tree(target) is not None for target in targets)
        key = (files, beside, complete, self.tree_settings)
        return self.memo.get("forest", path, key, lambda: Forest(path, files, self.tree_settings, beside, complete))

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
        for system in self.system_paths:
            for path in self.files_of(system):
                systems_by_file.setdefault(path, []).append(system)
        return {path: tuple(systems) for path, systems in systems_by_file.items()}

    def structs(self, system: str | None) -> Structs:
        """The structs that a system declares; without a system, none."""
        if system is None:
            return NO_STRUCTS
        if system not in self._structs:
            self._structs[system] = self._resolve_structs(system)
        return self._structs[system]

    def _resolve_structs(self, system: str) -> Structs:
        section = SystemSection.DATA_DECLARATIONS
        files = [f.path for f in self.listed(system) if f.usable and f.input.section is section]
        declared = [declaration.outline for path in files for declaration in self.struct_declarations(path)]
        outlines = tuple(outline for outline in declared if outline is not None)
        complete = self.lists_all(system, section) and None not in declared and all(map(self._is_well_formed, files))
        make = functools.partial(self._make_structs, outlines, complete)
        return self.memo.get("struct types", system, (outlines, complete), make)

    def _make_structs(self, outlines: tuple[StructOutline, ...], complete: bool) -> Structs:
        return Structs(outlines, resolve_structs(outlines), complete)

    def system(self, path: str) -> System | None:
        """The linked system of a system file; `None` if the file cannot be read, or is not a system file."""
        if path not in self._systems:
            self._systems[path] = self._link(path)
        return self._systems[path]

    def _link(self, path: str) -> System | None:
        file = self.system_file(path)
        if file is None:
            return None
        listed = self.listed(path)
        structs = self.structs(path)
        trees = self.tree_outlines(path)
        machines = [f for f in listed if f.required_kind is FileKind.MACHINE and f.usable]
        gaps = frozenset(placed.gap for _, placed in self.gaps(path))
        plugins_known = self._knows_plugins(path, listed)
        observed = self._observed(listed)

        def link_with(events: Mapping[str, Struct]) -> Round[System, Struct]:
            outlines = [(f, self.outline(f.path, path, structs, events)) for f in machines]
            nodes = tuple((f.path, o) for f, o in outlines if f.input.section is SystemSection.NODE_MODELS)
            plugins = tuple((f.path, o) for f, o in outlines if f.input.section is SystemSection.BEHAVIOR_TREE)
            known = (gaps, plugins_known, observed)
            key = (file.parameters, file.older, nodes, plugins, trees, structs.outlines, known)
            make = functools.partial(self._make, path, file, nodes, plugins, trees, structs, known)
            system = self.memo.get("system", path, key, make)
            received = (received for _, o in outlines for received in o.received)
            return Round(system, system.event_data, frozenset(r.event for r in received if r.forwarded))

        return infer_in_rounds(link_with)

    def _make(
        self,
        path: str,
        file: SystemFile,
        nodes: tuple[tuple[str, MachineOutline], ...],
        plugins: tuple[tuple[str, MachineOutline], ...],
        trees: tuple[TreeFileOutline, ...],
        structs: Structs,
        known: tuple[frozenset[Gap], bool, frozenset[str]],
    ) -> System:
        paths = tuple(tree.path for tree in trees)
        expansion = expand(trees)
        instances, uses = expansion.instances, expansion.uses
        system = System(
            path, file.older, file.parameters, nodes, plugins, instances, uses, paths, structs.types, *known
        )
        if not system.is_library_tree:
            return system
        from roaml.lower.library_tree import LibraryTreeBuilder  # noqa: PLC0415 - most trees do not need it

        files = self._tree_files(system)
        builder = LibraryTreeBuilder(system, files)
        completed = replace(system, entries=builder.entries())
        self.memo.get("library tree builder", path, (completed, tuple(files.values())), lambda: builder)
        return completed

    def _tree_files(self, system: System) -> dict[str, TreeFile]:
        return {path: file for path in system.tree_paths if (file := self.tree(path)) is not None}

    def library_tree(self, path: str) -> LibraryTree | None:
        """The translated tree of a system if it is executed as BehaviorTree.CPP executes it (`System.is_library_tree`);
        `None` for other trees."""
        system = self.system(path)
        if system is None or not system.is_library_tree:
            return None
        from roaml.lower.library_tree import LibraryTreeBuilder  # noqa: PLC0415 - most trees do not need it

        files = self._tree_files(system)
        key = (system, tuple(files.values()))
        builder = self.memo.get("library tree builder", path, key, lambda: LibraryTreeBuilder(system, files))
        return self.memo.get("library tree", path, key, builder.tree)

    def _observed(self, listed: tuple[ListedFile, ...]) -> frozenset[str]:
        """The variables that the properties of a system use."""
        paths = [f.path for f in listed if f.required_kind is FileKind.PROPERTIES and f.usable]
        properties = [declared for path in paths for declared in self.properties(path)[0]]
        names = {name for declared in properties for name, _ in identifiers(declared.expression)}
        xml_paths = [f.path for f in listed if f.required_kind is FileKind.XML_PROPERTIES and f.usable]
        files = [file for path in xml_paths if (file := self.property_file(path)) is not None]
        return frozenset(names.union(*(observed_names(file) for file in files)))

    def gaps(self, path: str) -> tuple[tuple[str, PlacedGap], ...]:
        """The facts that a system file, its trees and the unreadable files may contain. Each one has the path of its
        cause."""
        if path not in self._gaps:
            file = self.system_file(path)
            self._gaps[path] = tuple(self._find_gaps(path, file, self.listed(path))) if file else ()
        return self._gaps[path]

    def _find_gaps(
        self, path: str, file: SystemFile, listed: tuple[ListedFile, ...]
    ) -> Iterator[tuple[str, PlacedGap]]:
        root = file.element.name_span
        broken = self._broken(path)
        if broken is not None:
            yield path, PlacedGap(Gap(GapAct.ANYTHING), broken)
        if SystemSection.NODE_MODELS in file.unread:
            yield path, PlacedGap(Gap(GapAct.ANYTHING), root)
        if SystemSection.BEHAVIOR_TREE in file.unread:
            yield path, PlacedGap(Gap(GapAct.NODE), root)
        for entry in listed:
            if entry.input.section is SystemSection.NODE_MODELS and not entry.usable:
                yield from ((path, PlacedGap(gap, entry.span)) for gap in self._of_missing_node(path, entry, listed))
        yield from ((place, PlacedGap(Gap(GapAct.NODE), span)) for place, span in self._tree_gaps(path, file, listed))
        outlines = self.tree_outlines(path)
        for stray in self.memo.get("stray remaps", path, outlines, lambda: tuple(stray_remaps(outlines))):
            tree = self.tree(stray.source.path)
            node = node_at(tree, stray.source) if tree else None
            key = next((s.key.span for s in node.ports if s.key.value == stray.key), None) if node else None
            outer = blackboard_variable(stray.outer)
            for name in (*stray.meant[:1], *((outer,) if outer and stray.meant else ())):
                if key is not None:
                    yield stray.source.path, PlacedGap(Gap(GapAct.REMAP, name), key)

    def _of_missing_node(self, system: str, missing: ListedFile, listed: tuple[ListedFile, ...]) -> Iterator[Gap]:
        """The facts of a ROS node whose file cannot be used: those of the file with the most similar name in the same
        folder; any fact if there is no such file."""
        taken = {file.path for file in listed}
        beside = [p for end in MACHINE_EXTENSIONS for p in self.files.beside(missing.path, end) if p not in taken]
        by_name = {_stem(p): p for p in beside}
        close = close_names(_stem(missing.path), by_name, 1) if missing.path else ()
        similar = by_name[close[0]] if close else ""
        if not similar or self.machine(similar) is None:
            yield Gap(GapAct.ANYTHING)
            return
        outline = self.outline(similar, system, self.structs(system), {})
        yield from outline.gaps
        yield from (Gap(InterfaceAct(use.kind), use.name or None) for use in outline.interfaces)
        yield from (Gap(GapAct.SENDS, sent.event) for sent in outline.sent)
        yield from (Gap(GapAct.RECEIVES, received.event) for received in outline.received)

    def _tree_gaps(self, path: str, file: SystemFile, listed: tuple[ListedFile, ...]) -> Iterator[tuple[str, Span]]:
        """The positions (path and span) of the errors because of which some nodes of the executed tree are unknown."""
        listed_trees = [f for f in listed if f.required_kind is FileKind.TREE]
        section = file.element.find(SystemSection.BEHAVIOR_TREE.value)
        if not listed_trees:
            if section is not None:
                yield path, section.name_span
            return
        yield from ((path, file.span) for file in listed_trees if not file.usable)
        paths = self.tree_paths(path)
        clear = True
        for tree_path in paths:
            tree, broken = self.tree(tree_path), self._broken(tree_path)
            assert tree is not None
            spans = [] if broken is None else [broken]
            spans += [misfit.element.name_span for misfit in self.misfits(tree_path, BEHAVIOR_TREE)]
            spans += [behavior_tree.element.name_span for behavior_tree in tree.trees if len(behavior_tree.roots) != 1]
            for include in () if tree_path.endswith(PROJECT_EXTENSION) else tree.includes:
                target = self.include_path(tree_path, include)
                if include.path and (target is None or self.tree(target) is None):
                    spans.append(include.path.span)
            clear = clear and not spans
            yield from ((tree_path, span) for span in spans)
        if clear and paths:
            outlines = self.tree_outlines(path)
            if not self.memo.get("whole tree", path, outlines, lambda: is_whole(outlines)):
                first = self.tree(paths[0])
                assert first is not None
                yield paths[0], first.element.name_span

    def _broken(self, path: str) -> Span | None:
        """The position of the first error because of which a file is not well-formed; `None` if there is none."""
        document = self.document(path)
        findings = document.findings if document else ()
        return next((finding.span for finding in findings if finding.code in BROKEN), None)

    def _is_well_formed(self, path: str) -> bool:
        """Whether a file can be parsed completely."""
        if self.kind(path) is FileKind.JSON_STRUCTS:
            _, findings = self.json(path) or (None, None)
        else:
            document = self.document(path)
            findings = document.findings if document else None
        return findings is not None and not any(f.code in BROKEN for f in findings)

    def _knows_plugins(self, path: str, listed: tuple[ListedFile, ...]) -> bool:
        """Whether the names of all plugins of the system are known: no error hides a plugin or its name."""
        file = self.system_file(path)
        if file is None or SystemSection.BEHAVIOR_TREE in file.unread or not self._is_well_formed(path):
            return False
        for entry in listed:
            if entry.input.section is SystemSection.BEHAVIOR_TREE and entry.required_kind is not FileKind.TREE:
                machine = self.machine(entry.path) if entry.required_kind is FileKind.MACHINE and entry.usable else None
                if machine is None or machine.name is None or not self._is_well_formed(entry.path):
                    return False
        return True

    def tree_outline(self, path: str) -> TreeFileOutline:
        file = self.tree(path)
        assert file is not None
        return self.memo.get("tree outline", path, file, lambda: tree_file_outline(path, file))

    # ----------------------------------------------- machines in their system

    def outline(self, path: str, system: str, structs: Structs, events: Mapping[str, Struct]) -> MachineOutline:
        """The outline of the machine in the file `path`, as a part of `system`; see `typed`."""
        machine = self.machine(path)
        assert machine is not None
        typed = self.typed(path, system, structs, events)
        make = functools.partial(self._make_outline, path, machine, typed)
        return self.memo.get("outline", (path, system), typed, make)

    def _make_outline(self, path: str, machine: Machine, typed: TypedMachine) -> MachineOutline:
        return outline(machine, typed, self.machine_gaps(path, machine, typed))

    def machine_gaps(self, path: str, machine: Machine, typed: TypedMachine) -> tuple[PlacedGap, ...]:
        """The facts that the unreadable parts of a machine may contain, with their positions."""
        document = self.document(path)
        assert document is not None
        gaps = machine_gaps(machine, typed, document.namespaces, self._has_type)
        broken = self._broken(path)
        return gaps if broken is None else (*gaps, PlacedGap(Gap(GapAct.ANYTHING), broken))

    def _has_type(self, kind: str, name: str) -> bool:
        return isinstance(self.interface(kind, name), InterfaceType)

    def typed(self, path: str, system: str | None, structs: Structs, events: Mapping[str, Struct]) -> TypedMachine:
        """The machine in the file `path` with its types. `events` contains the known data of plain events."""
        machine = self.machine(path)
        assert machine is not None
        known = {name: events[name] for name in _received(machine) if name in events}
        # The key contains the machine instead of its text, because the result refers to parts of the machine.
        published = self._published_for(machine, system)
        key = (machine, structs.outlines, self.interfaces_of(machine), published, known)
        environment = _MachineEnvironment(self, structs, known, published)
        if not known:
            return self.memo.get("typed", (path, system), key, lambda: type_machine(machine, environment))
        # The result without events is needed to link the system, so it has its own slot in the cache.
        before = self.typed(path, system, structs, {})
        compute = functools.partial(type_machine, machine, environment, before)
        return self.memo.get("typed with events", (path, system), key, compute)

    def _published(self, system: str) -> Mapping[str, tuple[str, ...]]:
        """Topic -> the types, as written, with which the machines of a system publish on it."""
        if system not in self._published_types:
            types_by_topic: dict[str, dict[str, None]] = {}
            for listed in self.listed(system):
                machine = (
                    self.machine(listed.path) if listed.required_kind is FileKind.MACHINE and listed.usable else None
                )
                for declaration in machine.declarations if machine else ():
                    topic, type_ = declaration.interface, declaration.type
                    if declaration.kind is SymbolKind.PUBLISHER and isinstance(topic, Name) and type_ is not None:
                        types_by_topic.setdefault(sanitise(topic.value), {})[type_.value] = None
            self._published_types[system] = {topic: tuple(types) for topic, types in types_by_topic.items()}
        return self._published_types[system]

    def _published_for(self, machine: Machine, system: str | None) -> dict[str, tuple[InterfaceType, ...]]:
        """Topic to which a machine subscribes -> the other types with which machines of the system publish on it.
        Topics without such types are left out."""
        if system is None:
            return {}
        types_by_topic: dict[str, tuple[InterfaceType, ...]] = {}
        for declaration in machine.declarations:
            if (
                declaration.kind is SymbolKind.SUBSCRIBER
                and isinstance(declaration.interface, Name)
                and declaration.type
            ):
                topic = sanitise(declaration.interface.value)
                types = self._published(system).get(topic, ())
                if others := self._messages(t for t in types if t != declaration.type.value):
                    types_by_topic[topic] = others
        return types_by_topic

    def _messages(self, names: Iterable[str]) -> tuple[InterfaceType, ...]:
        """The message types with these names, without those that are not found."""
        definitions = (self.interface("msg", name) for name in names)
        return tuple(type_ for type_ in definitions if isinstance(type_, InterfaceType))

    def interfaces_of(self, machine: Machine) -> tuple[InterfaceType | NotFound, ...]:
        """The ROS types in the declarations of a machine, in order."""
        return tuple(
            self.interface(INTERFACE_KINDS[d.kind], d.type.value)
            for d in machine.declarations
            if d.type and d.kind in INTERFACE_KINDS
        )

    def typed_in(self, path: str, system: str | None) -> TypedMachine:
        """The machine in the file `path` with its types, as a part of `system`. If `system` is `None`, the machine is
        not in a system."""
        linked = self.system(system) if system else None
        return self.typed(path, system, self.structs(system), linked.event_data if linked else {})

    def environment(self, system: str | None) -> Environment:
        """The types that the machines of a system can use. A machine without a system can use only ROS types."""
        linked = self.system(system) if system else None
        published = {topic: self._messages(types) for topic, types in self._published(system).items()} if system else {}
        return _MachineEnvironment(self, self.structs(system), linked.event_data if linked else {}, published)

    def globals(self, system: str) -> Mapping[str, GlobalVariable]:
        """The global variables of the translated system, by name."""
        linked = self.system(system)
        if linked is None:
            return {}
        environment = _MachineEnvironment(self, NO_STRUCTS, {}, {})
        return self.memo.get("globals", system, linked, lambda: global_variables(linked, environment.interface))

    def event_parameters(self, system: str) -> Mapping[str, Mapping[str, Type]]:
        """The parameters of each event of the translated system, with the types of the models."""
        linked = self.system(system)
        environment = _MachineEnvironment(self, NO_STRUCTS, {}, {})
        return {} if linked is None else event_parameters(linked, environment.interface)


def _stem(path: str) -> str:
    """The name of a file without its extension."""
    return path.replace("\\", "/").rpartition("/")[2].rpartition(".")[0]


def _received(machine: Machine) -> set[str]:
    """The names of the plain events for which a machine has transitions."""
    handlers = (h for chart in machine.charts for state in chart.states for h in state.handlers)
    return {handler.event.value for handler in handlers if handler.event}
