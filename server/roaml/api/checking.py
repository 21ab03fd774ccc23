# SPDX-License-Identifier: Apache-2.0
"""Checks files, and applies safe fixes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from roaml.api.reading import read
from roaml.diagnostics import Diagnostic
from roaml.model.dialect import dialect_of
from roaml.model.kinds import FileKind
from roaml.model.machine import Dialect
from roaml.project.fixing import fix_all, safe_fix
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot
from roaml.record import Record
from roaml.regex import regex
from roaml.text import SourceFile


class CheckResult(Record, frozen=True):
    """The result of `check`.

    Attributes:
        diagnostics: the findings, in the order of `files`, then by position.
        files: the files that were checked.
        problems: errors in the configuration, as sentences.
        snapshot: the state of the files from which the diagnostics were computed.
    """

    diagnostics: tuple[Diagnostic, ...]
    files: tuple[str, ...]
    problems: tuple[str, ...]
    snapshot: Snapshot

    @property
    def ignored(self) -> tuple[str, ...]:
        """The files of plain SCXML that no system lists: only their syntax is checked."""
        return tuple(path for path in self.files if self._is_plain(path))

    def _is_plain(self, path: str) -> bool:
        analysis = self.snapshot.analysis
        machine, document = analysis.machine(path), analysis.document(path)
        if analysis.kind(path) is not FileKind.MACHINE or machine is None or document is None:
            return False
        is_listed = any(system is not None for system in analysis.systems_of(path))
        return not is_listed and dialect_of(machine, document, None) in (Dialect.PLAIN, Dialect.FOREIGN)

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

    A system file is checked together with all files that it names, a tree with the mocks beside it, and a folder with
    all systems and files in it. Any other file is checked as a part of the systems that name it. These systems are
    searched for in the configured roots; without configured roots, in the enclosing repository; without a repository,
    in the folder of the file.

    Args:
        paths: the files and folders to check.
        ros_paths: folders with ROS interface packages, in addition to the configured ones.
        settings: the settings; if not given, the configuration file around the first path is read.
        texts: path -> text or bytes that replace the content of the file.

    Raises:
        PathError: a path does not exist or cannot be read, and `texts` has no text for it.
    """
    found = read(paths, ros_paths, settings, texts)
    checker = found.snapshot.checker
    diagnostics = tuple(d for path in found.files for d in checker.diagnostics(path, explores=True))
    return CheckResult(diagnostics, found.files, found.problems, found.snapshot)


def fix(result: CheckResult) -> dict[str, bytes]:
    """The texts of the checked files after all safe fixes have been applied. Nothing is written.

    A safe fix removes nothing that has an effect and guesses nothing. The result does not contain unchanged files
    and files that are not valid UTF-8.
    """
    sources = {path: result.source(path) for path in result.files}
    fixable = (path for path, source in sources.items() if source.undecodable is None and _is_text(source.text))
    texts = fix_all(result.snapshot, fixable, safe_fix, careful=True)
    return {path: sources[path].encode(text) for path, text in texts.items()}


_HALF = regex("[\ud800-\udfff]")


def _is_text(text: str) -> bool:
    """Whether a text can be encoded. A text that was not read from a file may contain unpaired surrogates."""
    return _HALF.search(text) is None
