# SPDX-License-Identifier: Apache-2.0
"""Systems without errors, and their translation to plain SCXML and to JANI."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from roaml.api.checking import CheckResult
from roaml.api.jani_files import PathError
from roaml.api.reading import read
from roaml.jani.model import Model
from roaml.jani.properties import Property
from roaml.jani.selection import select
from roaml.model.kinds import FileKind
from roaml.model.parameters import NO_OVERRIDES, Overrides
from roaml.project.analysis import Analysis
from roaml.project.configuration import find_settings
from roaml.project.paths import slashed
from roaml.project.settings import Settings, ament_prefixes
from roaml.project.source_map import SourceMap
from roaml.project.source_map import source_map as _source_map
from roaml.project.translation import network_of, observed_properties_of, properties_of
from roaml.project.workspace import Snapshot
from roaml.record import Record, replace
from roaml.scxml.model import Network
from roaml.scxml.observed import ObservedProperty
from roaml.suggest import close_names, did_you_mean, listing
from roaml.text import ignored_encoding

if TYPE_CHECKING:
    from roaml.expansion.draws import DrawnNumber
    from roaml.xml_syntax import Document


class ModelError(ValueError):
    """Raised if a system, or a tree without a system, has errors or cannot be translated.

    Attributes:
        result: only these errors.
        unset: for a tree without a system, for each of these errors the entry of the blackboard that needs a value at
            the start, if this is the reason, otherwise ""; empty for a system.
    """

    def __init__(self, result: CheckResult, unset: tuple[str, ...] = ()) -> None:
        first = result.diagnostics[0]
        more = f", and {len(result.diagnostics) - 1} more" if len(result.diagnostics) > 1 else ""
        super().__init__(f"{first.path}: {first.message}{more}")
        self.result = result
        self.unset = unset


class ParameterError(ValueError):
    """Raised if a value is given for a parameter that no file of a system declares."""


class LoadedSystem(Record, frozen=True):
    """A system without errors, in the state of its files at the time of loading.

    Attributes:
        path: the path of the system file.
        properties: the properties in the JANI files of the system, in their order.
        analysis: the models and findings of the files of the system.
        observed: the properties in the XML files of the system, in their order.
    """

    path: str
    properties: tuple[Property, ...]
    analysis: Analysis
    observed: tuple[ObservedProperty, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """All files of the system, the system file first, and the files with data from which its machines draw."""
        expanded = self.analysis.expanded(self.path)
        data = () if expanded is None else (path for path, text in expanded.expansion.data if text is not None)
        return tuple(dict.fromkeys((*self.analysis.files_of(self.path), *data)))

    @property
    def parameters(self) -> dict[str, str]:
        """Name of a parameter of the system -> the text of its value; and `INSTANCE.NAME` -> a value that was given for
        the parameter of an instance from outside of the files (docs/spec/parameters.md#values)."""
        return _parameters(self.analysis, self.path)

    @property
    def drawn(self) -> tuple[DrawnNumber, ...]:
        """The numbers that machines draw from distributions (docs/spec/distributions.md#values)."""
        expanded = self.analysis.expanded(self.path)
        return () if expanded is None else expanded.expansion.drawn


def load(
    path: str,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
    overrides: Overrides = NO_OVERRIDES,
    parameters: Mapping[str, bool | int | float | str] | None = None,
) -> LoadedSystem:
    """Read and check a system, to translate it.

    Args:
        path: the system file.
        ros_paths, settings, texts: as for `check`.
        overrides: parameters that replace those in the system file.
        parameters: name of a parameter that the models declare -> its value, such as `{"capacity": 80}`; the name
            `INSTANCE.NAME` is that of one instance (docs/spec/parameters.md#values).

    Raises:
        PathError: the path cannot be read, or is not a system file.
        ParameterError: a value in `overrides` is for a parameter that the system does not declare.
        ModelError: the system has errors.
    """
    if settings is None:
        settings, _ = find_settings(os.path.abspath(path))
        settings = replace(settings, ament_prefixes=ament_prefixes())
    overrides = with_parameters(overrides, parameters or {})
    snapshot = read([path], ros_paths, replace(settings, overrides=overrides), texts).snapshot
    return loaded(snapshot, os.path.abspath(path))


def with_parameters(overrides: Overrides, parameters: Mapping[str, bool | int | float | str]) -> Overrides:
    """Overrides with further values of parameters."""
    texts = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in parameters.items()}
    return replace(overrides, values=(*overrides.values, *texts.items()))


def loaded(snapshot: Snapshot, path: str) -> LoadedSystem:
    """A system without errors, from a workspace.

    Args:
        path: the absolute path of the system file.

    Raises:
        PathError: the path is not a system file.
        ParameterError: a value of the settings is for a parameter that the system does not declare.
        ModelError: the system has errors.
    """
    analysis = snapshot.analysis
    if analysis.kind(path) is not FileKind.SYSTEM or analysis.system(path) is None:
        raise PathError(f"{path}: not a system file")
    if unknown := unknown_parameter(analysis, [path], snapshot.checker.settings.overrides):
        raise ParameterError(unknown)
    errors = snapshot.checker.errors(path)
    if errors:
        raise ModelError(CheckResult(errors, analysis.files_of(path), (), snapshot))
    return LoadedSystem(path, properties_of(analysis, path), analysis, observed_properties_of(analysis, path))


def _parameters(analysis: Analysis, path: str) -> dict[str, str]:
    expanded = analysis.expanded(path)
    if expanded is None:
        return {}
    expansion = expanded.expansion
    return {**{name: value.text for name, value in expansion.parameters.items()}, **expansion.of_instances}


def values_of_parameters(
    path: str, ros_paths: Iterable[str], settings: Settings, texts: Mapping[str, str | bytes]
) -> dict[str, str]:
    """Name of a parameter of a system -> the text of its value, even if the system has errors. The arguments are those
    of `check`."""
    return _parameters(read([path], ros_paths, settings, texts).snapshot.analysis, os.path.abspath(path))


def unknown_parameter(analysis: Analysis, systems: Iterable[str], overrides: Overrides) -> str:
    """A sentence about the first value in `overrides` for a parameter that none of the systems declares; "" if there is
    none."""
    expanded = [analysis.expanded(system) for system in systems]
    names = {name for part in expanded if part is not None for name in part.expansion.settable}
    for name, _ in overrides.values:
        if name not in names:
            close = close_names(name, names)
            declared = listing(sorted(names)) if names else "no parameters"
            known = did_you_mean(close) if close else f"; it declares {declared}"
            return f"the system declares no parameter `{name}`{known}"
    return ""


def to_scxml(system: LoadedSystem) -> Network:
    """The system as plain SCXML: flat state machines that exchange events. `roaml.scxml.write` creates the files."""
    return network_of(system.analysis, system.path)


def to_plain(system: LoadedSystem) -> dict[str, str]:
    """The files of a system without parameters and instances (docs/spec/parameters.md#expansion), which AS2FM reads.

    Returns:
        The path of each file, relative to the folder that contains all of them, with `/` -> its text, which declares no
        other encoding than UTF-8. The system file is the first one.
    """
    from roaml.expansion.impossible_targets import without_impossible_targets  # noqa: PLC0415 - a check does not need it

    analysis = system.analysis
    expanded = analysis.expanded(system.path)
    plain = analysis if expanded is None else expanded.analysis
    texts = {path: source.text for path in plain.files_of(system.path) if (source := plain.source(path)) is not None}
    if expanded is not None:
        machines = (path for path in texts if plain.kind(path) is FileKind.MACHINE and path in expanded.expansion.texts)
        texts |= {path: without_impossible_targets(texts[path]) for path in machines}
    passed = (folder for path in texts for folder in _passed_folders(path, plain.document(path)))
    folder = os.path.commonpath([*(os.path.dirname(path) for path in texts), *passed])
    return {slashed(os.path.relpath(path, folder)): _in_utf8(text) for path, text in texts.items()}


def _passed_folders(path: str, document: Document | None) -> Iterator[str]:
    """The folders to which `..` leads in the paths of other files that a file lists."""
    for element in document.root.walk() if document and document.root else ():
        listed = element.get("src" if element.name == "input" else "path") if element.name in _LISTING else None
        folder = os.path.dirname(path)
        for part in listed.value.strip().split("/") if listed else ():
            folder = os.path.normpath(os.path.join(folder, part))
            if part == "..":
                yield folder


_LISTING = ("input", "include")
"""The elements that list other files."""


def _in_utf8(text: str) -> str:
    """A text whose XML declaration states that it is UTF-8, if it states an encoding."""
    place = ignored_encoding(text, "utf-8")
    return text if place is None else f"{text[: place.start]}UTF-8{text[place.end :]}"


def to_jani(system: LoadedSystem, properties: Iterable[str] | None = None, *, has_activity: bool = False) -> Model:
    """The system as a network of Markov decision processes. `roaml.jani.write` creates the text.

    Args:
        properties: the names of the properties to include; `None` for all.
        has_activity: whether observers also record whether their property was triggered.

    Raises:
        PropertyError: the system has no property with one of the names.
    """
    from roaml.to_jani import translate  # noqa: PLC0415 - a check does not translate

    if properties is None:
        return translate(to_scxml(system), system.properties, system.observed, has_activity=has_activity)
    chosen: tuple[Property | ObservedProperty, ...] = select(
        (*system.properties, *system.observed), properties, "system"
    )
    in_jani = tuple(property_ for property_ in chosen if isinstance(property_, Property))
    in_xml = tuple(property_ for property_ in chosen if isinstance(property_, ObservedProperty))
    return translate(to_scxml(system), in_jani, in_xml, has_activity=has_activity)


def source_map(system: LoadedSystem, model: Model) -> SourceMap:
    """The sources of every automaton, edge and variable of a translated model, as a value for JSON."""
    return _source_map(model, system.analysis, system.path)
