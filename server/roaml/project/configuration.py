# SPDX-License-Identifier: Apache-2.0
"""Reads configuration files, and finds the errors in them with their positions.

- `as2fm.toml` takes precedence over `[tool.as2fm]` in a `pyproject.toml` in the same folder. A `pyproject.toml` that is
  not valid TOML, or has no table for this tool, is ignored.
- Only regular files of a limited size are read, as for models (`roaml.project.files`).
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from roaml.comparison import Comparison, effect_on_probabilities
from roaml.diagnostics import Finding, Fix
from roaml.disk import UnreadableReason
from roaml.model.config_files import CONFIG_FILE, CONFIG_FILES, PROJECT_FILE
from roaml.project.files import MAX_CHARACTERS, DiskFiles
from roaml.project.settings import Folder, SettingProblem, Settings, folders_above, folders_in, settings_from
from roaml.record import Record, field, replace
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean
from roaml.text import SourceFile, Span, TextEdit
from roaml.toml import Path, Places, TomlError, loads, places


class Configuration(Record, frozen=True):
    """The content of a configuration file.

    Attributes:
        table: the values; `None` if they cannot be read.
        findings: the errors that do not depend on the disk.
        folders: the folders that the file names, with their positions.
        expected: the names of the properties whose results are expected, with their positions.
        expectations: these names -> the expectations.
    """

    table: Mapping[str, Any] | None
    findings: tuple[Finding, ...] = ()
    folders: tuple[tuple[Span, Folder], ...] = ()
    expected: tuple[tuple[Span, str], ...] = ()
    expectations: Mapping[str, Comparison] = field(default_factory=dict)


def read_configuration(source: SourceFile) -> Configuration:
    """The configuration in a file. It depends only on the text and path of the file, not on the disk."""
    is_ours = os.path.basename(source.path) == CONFIG_FILE
    prefix: Path = () if is_ours else ("tool", "as2fm")
    if len(source.text) > MAX_CHARACTERS:
        return Configuration(None)  # reported by `file-too-large`
    if is_ours and source.encoding != "utf-8":
        text = f"the file is encoded as {source.encoding}, but TOML requires UTF-8"
        return Configuration(None, (Finding("toml-syntax", Span(0, min(1, len(source.text))), text),))
    try:
        table: Any = loads(source.text)
    except TomlError as error:
        message = str(error)
        syntax = (Finding("toml-syntax", error.span, f"{message[:1].lower()}{message[1:]}"),)
        return Configuration(None, syntax if is_ours else ())
    for key in prefix:
        table = table.get(key) if isinstance(table, dict) else None
    if table is None:
        return Configuration(None)
    known = places(source.text)
    if not isinstance(table, dict):
        message = "`tool.as2fm` must be a table of settings"
        return Configuration(None, (Finding("invalid-setting", _span(source, known, prefix), message),))
    settings, problems = settings_from(table, os.path.dirname(source.path), Settings())
    findings = tuple(_finding(source, known, prefix, problem) for problem in problems)
    folders = folders_in(table, os.path.dirname(source.path))
    expected = {name: known.keys.get((*prefix, "verify", "expect", name)) for name in settings.expectations}
    return Configuration(
        table,
        findings,
        tuple((_span(source, known, (*prefix, *f.path)), f) for f in folders),
        tuple((span, name) for name, span in expected.items() if span is not None),
        settings.expectations,
    )


def unknown_expectations(source: SourceFile, configuration: Configuration, names: Collection[str]) -> Iterator[Finding]:
    """A finding for each expected property that is not one of `names`, those of the systems that are known, if one of
    these is similar: it may also belong to a system that is not known. Names with parameters, such as
    `$(var robot)_arrives`, may be any names of this form."""
    written = [name for name in names if "$(" not in name]
    forms = [re.compile(".*".join(map(re.escape, _PARAMETER.split(name)))) for name in names if "$(" in name]
    for span, name in configuration.expected:
        is_known = name in names or any(form.fullmatch(name) for form in forms)
        close = () if is_known else close_names(name, written)
        if close:
            message = f"no system has a property `{name}`, so nothing is expected{did_you_mean(close)}"
            yield Finding("unknown-expectation", span, message, fixes=_renamed(source, span, close))


def vacuous_expectations(configuration: Configuration, probabilities: Collection[str]) -> Iterator[Finding]:
    """A finding for each expectation of a probability that all probabilities meet, or none does."""
    for span, name in configuration.expected:
        comparison = configuration.expectations.get(name)
        effect = effect_on_probabilities(comparison) if comparison is not None and name in probabilities else ""
        if effect:
            message = f"every probability is from 0 to 1, so this expectation is {effect}; change it"
            yield Finding("vacuous-expectation", span, message)


_PARAMETER = regex(r"\$\([^)]*\)")


def missing_folders(configuration: Configuration) -> tuple[Finding, ...]:
    """A finding for each folder in the configuration that does not exist."""
    return tuple(
        Finding(
            "missing-folder",
            span,
            f"there is no folder `{folder.written}`; paths are relative to the folder of this file",
        )
        for span, folder in configuration.folders
        if not os.path.isdir(folder.full)
    )


def _finding(source: SourceFile, known: Places, prefix: Path, problem: SettingProblem) -> Finding:
    path = (*prefix, *problem.path)
    span = known.keys.get(path) if problem.is_key else None
    span = span or _span(source, known, path)
    return Finding("invalid-setting", span, problem.message, fixes=_renamed(source, span, problem.instead))


def _renamed(source: SourceFile, span: Span, names: Iterable[str]) -> tuple[Fix, ...]:
    """A fix for each name that replaces the key or value at `span` by it, with its quotation marks."""
    quotes = source.text[span.start : span.start + 1]
    quotes = quotes if quotes in ("'", '"') else ""
    return tuple(
        Fix(f"Change to `{name}`", (TextEdit(span, f"{quotes}{name}{quotes}"),), preferred=number == 0)
        for number, name in enumerate(names)
    )


def _span(source: SourceFile, known: Places, path: Path) -> Span:
    """The position of the value at `path`, or of the nearest enclosing value that has a position."""
    while path:
        for spans in (known.values, known.keys):
            if path in spans:
                return spans[path]
        path = path[:-1]
    return Span(0, min(1, len(source.text)))


def find_settings(path: str) -> tuple[Settings, tuple[str, ...]]:
    """The settings in the nearest configuration file, in the folder of `path` or an enclosing folder.

    Returns:
        The settings, and messages about errors in the configuration, which begin with the path of the file. If
            `Settings.origin` is set, the diagnostics of that file also contain these errors.
    """
    disk = DiskFiles()
    for folder in folders_above(path):
        for name in CONFIG_FILES:
            file = os.path.join(folder, name)
            source = disk.read(file)
            if isinstance(source, UnreadableReason):
                if name == CONFIG_FILE and source is not UnreadableReason.MISSING:
                    return Settings(), (f"{file}: {source.value}",)
                continue
            if len(source.text) > MAX_CHARACTERS and name == CONFIG_FILE:
                words = f"the file is too large to be read (the limit is {MAX_CHARACTERS:,} characters)"
                return Settings(origin=file), (f"{file}: {words}",)
            configuration = read_configuration(source)
            if name == PROJECT_FILE and configuration.table is None and not configuration.findings:
                continue
            settings, _ = settings_from(configuration.table or {}, folder, Settings())
            return replace(settings, origin=file), tuple(
                _sentence(source, finding) for finding in configuration.findings
            )
    return Settings(), ()


def _sentence(source: SourceFile, finding: Finding) -> str:
    start = source.lines.position(finding.span.start)
    return f"{source.path}:{start.line + 1}:{start.column + 1}: {finding.message}"
