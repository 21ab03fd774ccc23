# SPDX-License-Identifier: Apache-2.0
"""The public interface of the library.

    from roaml import api
    result = api.check(["main.xml"], ros_paths=["interfaces"])
    for diagnostic in result.diagnostics:
        print(diagnostic.path, diagnostic.message)
    system = api.load("main.xml")
    network = api.to_scxml(system)
    model = api.to_jani(system)
    for answer in api.verify(model, jobs=2):
        print(answer.question.name, answer.value, answer.bounds)

No function prints, or raises for the content of a user's files; a path that does not exist is a `PathError`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from roaml.diagnostics import Diagnostic, Severity
from roaml.disk import MAX_DATA, NotReadableError, Problem, required
from roaml.jani.model import Model
from roaml.jani.properties import Property
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.lower import lower
from roaml.model.kinds import FileKind
from roaml.model.system_file import NO_OVERRIDES, Overrides
from roaml.project.analysis import Analysis
from roaml.project.configuration import find_settings
from roaml.project.discover import is_inside
from roaml.project.fixing import fix_all, safe_fix
from roaml.project.migrate import Migration
from roaml.project.migrate import migrate as _migrate
from roaml.project.settings import Settings, ament_prefixes, enclosing_root
from roaml.project.source_map import SourceMap
from roaml.project.source_map import source_map as _source_map
from roaml.project.translation import program_of, properties_of
from roaml.project.workspace import Snapshot, Workspace
from roaml.scxml.model import Network
from roaml.text import SourceFile, decode
from roaml.to_jani import translate

if TYPE_CHECKING:
    from roaml.smc.model import Checker
    from roaml.smc.run import Answer, Options


class PathError(ValueError):
    """A given path cannot be checked; the message contains the reason."""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The result of `check`.

    Attributes:
        diagnostics: sorted by file, in the order in which files were checked, then by position.
        files: the files that were checked.
        problems: errors in the configuration, as sentences.
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
    checked as a part of the systems that name it. They are searched for in the configured roots, otherwise in the
    enclosing repository, otherwise in the folder of the file.

    Args:
        paths: the files and folders to check.
        ros_paths: folders with ROS interface packages, in addition to the configured ones.
        settings: used instead of the configuration found around the first path.
        texts: path -> text, or the bytes of a file, used instead of the content of the file.

    Raises:
        PathError: a path does not exist or cannot be read, and `texts` has no text for it.
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


def fix(result: CheckResult) -> dict[str, bytes]:
    """The texts of the checked files after all safe fixes have been applied. Nothing is written.

    A safe fix removes nothing that has an effect and guesses nothing. Unchanged files and files that are not valid text
    are left out.
    """
    sources = {path: result.source(path) for path in result.files}
    mendable = (path for path, source in sources.items() if source.undecodable is None and _is_text(source.text))
    texts = fix_all(result.snapshot, mendable, safe_fix, careful=True)
    return {path: sources[path].encode(text) for path, text in texts.items()}


_HALF = re.compile("[\ud800-\udfff]")


def _is_text(text: str) -> bool:
    """Whether a text that was not read from a file can be encoded: lone surrogates cannot."""
    return _HALF.search(text) is None


class ModelError(ValueError):
    """A system has errors and cannot be translated. `result` contains only these errors."""

    def __init__(self, result: CheckResult) -> None:
        first = result.diagnostics[0]
        more = f", and {len(result.diagnostics) - 1} more" if len(result.diagnostics) > 1 else ""
        super().__init__(f"{first.path}: {first.message}{more}")
        self.result = result


class PropertyError(ValueError):
    """The system has no property with a given name; the message lists those that it has."""


@dataclass(frozen=True, slots=True)
class LoadedSystem:
    """A system without errors, with its files as they were when it was loaded.

    Attributes:
        path: the system file.
        properties: those in its property files, in their order.
        analysis: the models behind it.
    """

    path: str
    properties: tuple[Property, ...]
    analysis: Analysis

    @property
    def files(self) -> tuple[str, ...]:
        """All files of the system, the system file first."""
        return self.analysis.files_of(self.path)


def load(
    path: str,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
    overrides: Overrides = NO_OVERRIDES,
) -> LoadedSystem:
    """Read and check a system, to translate it.

    Args:
        path: the system file.
        ros_paths, settings, texts: as for `check`.
        overrides: parameters that replace those in the system file.

    Raises:
        PathError: the path cannot be read, or is not a system file.
        ModelError: the system has errors.
    """
    if settings is None:
        settings, _ = find_settings(os.path.abspath(path))
        settings = replace(settings, ament_prefixes=ament_prefixes())
    snapshot = check([path], ros_paths, replace(settings, overrides=overrides), texts).snapshot
    return loaded(snapshot, os.path.abspath(path))


def loaded(snapshot: Snapshot, path: str) -> LoadedSystem:
    """A system of a workspace.

    Args:
        path: the absolute path of the system file.

    Raises:
        PathError: the path is not a system file.
        ModelError: the system has errors.
    """
    analysis = snapshot.analysis
    if analysis.kind(path) is not FileKind.SYSTEM or analysis.system(path) is None:
        raise PathError(f"{path}: not a system file")
    errors = snapshot.checker.errors(path)
    if errors:
        raise ModelError(CheckResult(errors, analysis.files_of(path), (), snapshot))
    return LoadedSystem(path, properties_of(analysis, path), analysis)


def to_scxml(system: LoadedSystem) -> Network:
    """The system as plain SCXML: flat state machines that exchange events. `roaml.scxml.write` creates the files."""
    return lower(program_of(system.analysis, system.path))


def to_jani(system: LoadedSystem, properties: Iterable[str] | None = None) -> Model:
    """The system as a network of Markov decision processes. `roaml.jani.write` creates the text.

    Args:
        properties: the names of the properties to include; `None` for all.

    Raises:
        PropertyError: the system has no property with one of the names.
    """
    found = system.properties
    if properties is not None:
        by_name = {each.name: each for each in found}
        for name in (properties := tuple(properties)):
            if name not in by_name:
                known = ", ".join(by_name) or "none"
                raise PropertyError(f"there is no property {name}; the system has: {known}")
        found = tuple(by_name[name] for name in properties)
    return translate(to_scxml(system), found)


class JaniError(ValueError):
    """A JANI file has errors: `diagnostics`, with positions in `source`."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...], source: SourceFile) -> None:
        super().__init__(f"{diagnostics[0].path}: {diagnostics[0].message}")
        self.diagnostics = diagnostics
        self.source = source


def read_jani(path: str) -> tuple[Model, SourceFile]:
    """Read a JANI model; its positions are those in the file.

    Raises:
        PathError: the file cannot be read.
        JaniError: it is not a JANI model, or has errors.
    """
    path = os.path.abspath(path)
    try:
        source = decode(path, required(path, MAX_DATA))
    except NotReadableError as error:
        raise PathError(str(error)) from None
    if source.undecodable is not None:
        raise PathError(f"{path}: not valid UTF-8; fix the encoding")
    value, syntax = parse(source.text)
    model, findings = (None, ()) if syntax else read_model(value, path)
    diagnostics = tuple(
        Diagnostic(path, found.code, found.severity or Severity.ERROR, found.span, found.message)
        for found in (*syntax, *findings)
    )
    errors = tuple(diagnostic for diagnostic in diagnostics if diagnostic.severity is Severity.ERROR)
    if errors or model is None:
        raise JaniError(errors or diagnostics, source)
    return model, source


def checker(model: Model, properties: Iterable[str] | None = None) -> Checker:
    """A model prepared for verification.

    Args:
        properties: the names of those to verify; `None` for all. `stuck` asks whether traces get stuck
            (`roaml.smc.end.End.STUCK`), which is possible for every translated system.

    Raises:
        PropertyError: the model has no property with one of the names.
        FaultError: the model is of an unsupported kind; see `roaml.smc.fault`. Properties that cannot be decided are in
            `refused`.
    """
    from roaml.smc.goal import STUCK_PROPERTY  # noqa: PLC0415 - checking and translating start faster without it
    from roaml.smc.model import Checker  # noqa: PLC0415
    from roaml.views.ends import marks  # noqa: PLC0415

    found, ends = model.properties, marks(model)
    asks_stuck = False
    if properties is not None:
        by_name = {each.name: each for each in found}
        names = list(dict.fromkeys(properties))
        if STUCK_PROPERTY in names and STUCK_PROPERTY not in by_name and ends:
            asks_stuck = True
            names.remove(STUCK_PROPERTY)
        for name in names:
            if name not in by_name:
                known = ", ".join([*by_name, *([STUCK_PROPERTY] if ends else [])]) or "none"
                raise PropertyError(f"there is no property {name}; the model has: {known}")
        found = tuple(by_name[name] for name in names)
    return Checker(model, found, ends, asks_stuck=asks_stuck)


def verify(
    model: Model,
    properties: Iterable[str] | None = None,
    options: Options | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
) -> Iterator[Answer]:
    """Estimate the probabilities of properties, by random traces with uniform choices. Yields the answers one by one.

    Args:
        properties: their names; `None` for all.
        options: confidence, width of the interval, seed and limits.
        jobs: the number of processes; has no influence on the answers.
        executor: runs batches of traces, instead of `jobs` processes.

    Raises:
        PropertyError: the model has no property with one of the names.
        FaultError: the model cannot be run, or executed an undefined operation; or a property cannot be decided.
        ValueError: an option is not valid.
    """
    from roaml.smc.pool import Pool  # noqa: PLC0415
    from roaml.smc.run import Options as _Options  # noqa: PLC0415

    ready = checker(model, properties)
    for fault in ready.refused.values():
        raise fault
    with Pool(jobs, executor) as pool:
        for asked in ready.asked:
            yield ready.answer(asked, options or _Options(), pool)


def source_map(system: LoadedSystem, model: Model) -> SourceMap:
    """The sources of every automaton, edge and variable of a translated model, as a value for JSON."""
    return _source_map(model, system.analysis, system.path)


class SharedFileError(ValueError):
    """Systems that are not migrated would break. `shared` are the files that they use and that would change."""

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
    """The changes that migrate systems to the current dialect. Nothing is written.

    Args:
        paths: system files, or folders that are searched for them.
        ros_paths: folders with ROS interface packages, in addition to the configured ones.
        settings: used instead of the configuration found around the first path.
        with_related: whether to also migrate the systems that would break because they share a file, and so on. They
            are searched for in the repository around each system, or in the folder around its files.

    Raises:
        PathError: a path cannot be read, or is neither a folder nor a system file; or a file is not valid text.
        SharedFileError: another system would break; only if not `with_related`.
    """
    paths = [os.path.abspath(path) for path in paths]
    if settings is None:
        settings, _ = find_settings(paths[0] if paths else os.getcwd())
    # Files that are not reported are migrated as well.
    settings = replace(settings, select=frozenset(), ignore=frozenset())
    result = check(paths, ros_paths, settings)
    systems = result.snapshot.analysis.system_paths
    for path in paths:
        if not os.path.isdir(path) and path not in systems:
            raise PathError(f"{path}: not a system file; only systems can be migrated, so name the system file")

    def snapshot_of(texts: Mapping[str, str]) -> Snapshot:
        return check(systems, ros_paths, settings, texts).snapshot

    migrations = _migrate(systems, snapshot_of) if systems else ()
    for migration in migrations:
        if result.source(migration.path).undecodable is not None:
            raise PathError(f"{migration.path}: not valid UTF-8; fix the encoding")
    around = _around(systems, result.snapshot.analysis, settings) if migrations else None
    shared = {} if around is None else _broken(migrations, frozenset(systems), around)
    if not shared:
        return migrations
    error = SharedFileError(shared)
    if not with_related:
        raise error
    return migrate([*paths, *error.systems], ros_paths, settings, with_related=True)


def _broken(migrations: Iterable[Migration], migrated: frozenset[str], around: Snapshot) -> dict[str, tuple[str, ...]]:
    """For each file that changes, the systems that it breaks, other than those being migrated: the file is renamed, or
    causes errors."""
    memberships = around.analysis.memberships
    shared: dict[str, tuple[str, ...]] = {}
    for each in migrations:
        others = [system for system in memberships.get(each.path, ()) if system not in migrated]
        if others and each.path == each.new_path:
            after = around.with_texts({each.path: each.after})
            others = [s for s in others if len(after.checker.errors(s)) > len(around.checker.errors(s))]
        if others:
            shared[each.path] = tuple(others)
    return shared


def _around(systems: Iterable[str], analysis: Analysis, settings: Settings) -> Snapshot:
    """The files in the configured roots, and in the repositories of some systems or otherwise around their files."""
    roots = dict.fromkeys(settings.roots)
    for system in systems:
        folders = {os.path.dirname(path) for path in analysis.files_of(system)}
        roots[enclosing_root(system) or os.path.commonpath(folders)] = None
    return Workspace(roots, settings).snapshot()


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
        if isinstance(problem, Problem):
            raise PathError(f"{path}: {problem.value}")
    systems = [path for path, kind in kinds.items() if kind is FileKind.SYSTEM]
    roots = list(folders)
    others = [path for path in kinds if path not in systems]
    for path in others:
        if not any(is_inside(path, folder) for folder in folders):
            roots.extend(settings.roots or (enclosing_root(path) or os.path.dirname(path),))
    interfaces = [enclosing_root(path) or os.path.dirname(path) for path in systems]
    # A link stands for the file that it leads to.
    interfaces += [os.path.dirname(os.path.realpath(path)) for path in others if os.path.islink(path)]
    workspace = Workspace(dict.fromkeys(roots), settings, systems, packages=dict.fromkeys((*roots, *interfaces)))
    for path, text in texts.items():
        workspace.open(path, text)
    return workspace, kinds


def _files(named: list[str], snapshot: Snapshot, kinds: Mapping[str, FileKind]) -> tuple[str, ...]:
    """The files that are reported on, in this order: the configuration, and the named paths."""
    analysis, found = snapshot.analysis, dict[str, None]()
    if origin := snapshot.checker.settings.origin:  # errors in it affect all of them
        found[origin] = None
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
