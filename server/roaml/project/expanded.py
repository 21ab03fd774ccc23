# SPDX-License-Identifier: Apache-2.0
"""The analysis of expanded texts, and the way back from its results to the files of the user.

Everything that needs plain HL-SCXML (rules, linking, translation) uses this analysis.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from roaml.diagnostics import Finding, Fix, Related, Symbol
from roaml.expansion import ExpandedText, SystemExpansion
from roaml.facts import Facts
from roaml.model.system import System
from roaml.record import Record, replace
from roaml.text import Location, SourceFile, Span, TextEdit

if TYPE_CHECKING:
    from roaml.lower.library_tree import LibraryTree


class ExpandedAnalysis(Protocol):
    """What is read from the analysis of expanded texts."""

    @property
    def source(self) -> Callable[[str], SourceFile | None]: ...

    @property
    def system(self) -> Callable[[str], System | None]: ...

    @property
    def library_tree(self) -> Callable[[str], LibraryTree | None]: ...


A = TypeVar("A", bound=ExpandedAnalysis)


class Expanded(Record, Generic[A], frozen=True, eq=False):
    """An expanded system, or file without a system. `analysis` analyses the expanded texts."""

    analysis: A
    expansion: SystemExpansion

    def location(self, location: Location) -> Location:
        """The place in the files of the user that became a place in the expanded texts."""
        text = self.expansion.texts.get(location.path)
        return location if text is None else Location(text.source, text.origin(location.span))

    def symbol(self, symbol: Symbol) -> Symbol:
        """The symbol in the files of the user. A machine keeps the name of its instance."""
        return replace(symbol, path=self.expansion.source(symbol.path))

    def finding(self, path: str, finding: Finding) -> Finding:
        """A finding in the expanded text of `path` as a finding in its file. Fixes that would change an expanded part
        are left out."""
        text = self.expansion.texts.get(path)
        related = tuple(self._related(text, other) for other in finding.related)
        finding = replace(finding, related=related, message=self._message(finding.message), facts=self._facts(finding))
        if text is None:
            return finding
        fixes = tuple(fix for fix in (self._fix(text, fix) for fix in finding.fixes) if fix is not None)
        return replace(finding, span=text.origin(finding.span), fixes=fixes)

    def _message(self, message: str) -> str:
        """A message that names the files of the user, not those of instances."""
        for path, text in self.expansion.texts.items():
            if path != text.source:
                message = message.replace(f"{os.path.basename(path)}`", f"{os.path.basename(text.source)}`")
        return message

    def _facts(self, finding: Finding) -> Facts | None:
        path = getattr(finding.facts, "path", None)
        if finding.facts is None or path is None or path not in self.expansion.texts:
            return finding.facts
        return replace(finding.facts, path=self.expansion.source(path))

    def _related(self, text: ExpandedText | None, related: Related) -> Related:
        if isinstance(related.place, Symbol):
            return Related(self.symbol(related.place), related.message)
        if isinstance(related.place, Location):
            return Related(self.location(related.place), related.message)
        return related if text is None else Related(text.origin(related.place), related.message)

    def _fix(self, text: ExpandedText, fix: Fix) -> Fix | None:
        edits = fix.edits
        if not all(text.is_written(edit.span) for edit in edits):
            return None
        return replace(fix, plan=tuple(TextEdit(text.origin(edit.span), edit.new_text) for edit in edits))

    def written(self, path: str, span: Span) -> str:
        """The text in a span of a file of the user."""
        for variant in self.expansion.paths(path):
            source, text = self.analysis.source(variant), self.expansion.texts.get(variant)
            if source is not None:
                return source.text[span.start : span.end] if text is None else text.written(span)
        return ""

    def linked(self, path: str) -> System | None:
        """The linked system of the expanded texts."""
        return self.analysis.system(path)

    def system(self, path: str) -> System | None:
        """The linked system, in which each automaton has the path of its file."""
        linked = self.analysis.system(path)
        if linked is None:
            return None
        source = self.expansion.source
        nodes = tuple((source(path), outline) for path, outline in linked.nodes)
        plugins = tuple((source(path), outline) for path, outline in linked.plugins)
        return replace(linked, nodes=nodes, plugins=plugins)

    def library_tree(self, path: str) -> LibraryTree | None:
        return self.analysis.library_tree(path)
