# SPDX-License-Identifier: Apache-2.0
"""Renames each symbol of a system to a new name, and compares the system with the original.

The findings and the translation must be the same except for the name, and renaming back must restore the text.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from roaml import api
from roaml.ide.names.lookup import SymbolGroup, symbol_group
from roaml.ide.names.occurrences import uses
from roaml.ide.rename import RenameRefusal, Renaming, prepare, rename
from roaml.jani.writer import write
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot
from roaml.scxml.names import safe_name, sanitise
from roaml.text import TextEdit, apply_edits

FRESH = "zqfresh"


@dataclass(frozen=True)
class Case:
    """A symbol of a system, and a place at which it can be renamed."""

    thing: SymbolGroup
    path: str
    offset: int

    @property
    def name(self) -> str:
        symbol = self.thing.symbols[0]
        return " ".join(filter(None, (symbol.kind.value, symbol.name, symbol.scope)))


class System:
    """A system on the disk.

    Args:
        main: the path of the system file.
        ros_paths: folders with ROS packages.
    """

    def __init__(self, main: str, ros_paths: tuple[str, ...] = ()) -> None:
        self.main = main
        # After an edit, an editor explores the states later.
        result = api.check([main], ros_paths, Settings(ignore=CODES))
        self.texts = {path: result.source(path).text for path in result.files}
        self.files = result.files
        self.snapshot: Snapshot = result.snapshot
        self.findings = self._findings(result, "", "")
        jani = self._jani(result)
        self.model = None if jani is None else _canonical(jani)

    def check(self, texts: Mapping[str, str]) -> api.CheckResult:
        """The result with other texts, in which only what depends on them is computed again."""
        snapshot = self.snapshot.with_texts(texts)
        diagnostics = tuple(d for path in self.files for d in snapshot.checker.diagnostics(path))
        return api.CheckResult(diagnostics, self.files, (), snapshot)

    def cases(self) -> Iterator[Case]:
        """Each symbol that can be renamed, once, at its first place."""
        analysis, done = self.snapshot.analysis, set()
        for path in self.files:
            for system in analysis.systems_of(path):
                for occurrence in uses(analysis, path, system).all:
                    if occurrence.symbol in done:
                        continue
                    group = symbol_group(analysis, (occurrence.symbol,))
                    done.update(group.symbols)
                    if not isinstance(prepare(analysis, path, occurrence.span.start), RenameRefusal):
                        yield Case(group, path, occurrence.span.start)

    def failures(self, case: Case) -> Iterator[str]:
        """The invariants that a rename, and renaming back, violate."""
        renaming = rename(self.snapshot.analysis, case.path, case.offset, FRESH)
        if not isinstance(renaming, Renaming):
            yield f"refused: {renaming.reason}"
            return
        changed = {path: apply_edits(self.texts[path], edits) for path, edits in renaming.edits.items()}
        for path, edits in renaming.edits.items():
            yield from (f"{path}: odd edit {edit}" for edit in edits if edit.span.start >= edit.span.end)
        result = self.check(changed)
        symbol = case.thing.symbols[0]
        gone, came = _differences(self.findings, self._findings(result, FRESH, symbol.name, renaming.edits))
        if gone or came:
            yield f"findings: {gone} became {came}"
        jani = self._jani(result)
        spellings = {symbol.name, sanitise(symbol.name), safe_name(symbol.name), symbol.name.replace(".", "__")}
        spellings.add(re.sub(r"\W", "_", symbol.name, flags=re.ASCII))
        if self.model is not None and not any(_same(self.model, jani, spelling) for spelling in spellings):
            yield "the translation differs"
        yield from self._back(case, renaming, result.snapshot, changed)

    def _back(self, case: Case, renaming: Renaming, snapshot: Snapshot, changed: dict[str, str]) -> Iterator[str]:
        offset = _moved(case.offset, renaming.edits[case.path])
        # What the user sees at the place is what the name is to be again.
        first = next(
            use for use in case.thing.uses if use.path == case.path and use.occurrence.span.start == case.offset
        )
        old = self.texts[case.path][first.occurrence.span.start : first.occurrence.span.end]
        back = rename(snapshot.analysis, case.path, offset, old)
        if not isinstance(back, Renaming):
            yield f"cannot be renamed back to {old}: {back.reason}"
            return
        restored = {path: apply_edits(changed.get(path, self.texts[path]), edits) for path, edits in back.edits.items()}
        for path, text in {**changed, **restored}.items():
            if text != self.texts[path]:
                yield f"{path} is not restored"

    def _findings(
        self, result: api.CheckResult, new: str, old: str, edits: Mapping[str, tuple[TextEdit, ...]] | None = None
    ) -> list[tuple[str, ...]]:
        rows = []
        for diagnostic in result.diagnostics:
            line = result.source(diagnostic.path).lines.position(diagnostic.span.start).line
            message = diagnostic.message.replace(new, old) if new else diagnostic.message
            rows.append((diagnostic.path, str(line), diagnostic.code, diagnostic.severity.label, message))
        return sorted(rows)

    def _jani(self, result: api.CheckResult) -> str | None:
        try:
            return "".join(write(api.to_jani(api.loaded(result.snapshot, self.main))))
        except api.ModelError:
            return None


def _differences(before: list[tuple[str, ...]], after: list[tuple[str, ...]]) -> tuple[list[str], list[str]]:
    gone = [" ".join(row[1:]) for row in before if row not in after]
    return gone, [" ".join(row[1:]) for row in after if row not in before]


def _same(before: str, after: str | None, old: str) -> bool:
    """Whether a translation is equal to one in canonical form, except for a name and the order of names."""
    return after is not None and _canonical(after.replace(FRESH, old)) == before


def _canonical(jani: str) -> str:
    """The canonical form of a translation. Actions with the same name in several automata are listed once, because a
    rename may separate them. Comments are removed, because they contain names as the user writes them."""
    model = json.loads(jani)
    for property_ in model["properties"]:
        property_.pop("comment", None)
    model["actions"] = list({action["name"]: action for action in model["actions"]}.values())
    return _unordered(model)


def _unordered(value: object) -> str:
    """A JSON value as text, with its lists and members sorted."""
    if isinstance(value, dict):
        return "{" + ", ".join(sorted(f"{key!r}: {_unordered(member)}" for key, member in value.items())) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(sorted(map(_unordered, value))) + "]"
    return repr(value)


def _moved(offset: int, edits: tuple[TextEdit, ...]) -> int:
    """The position of an offset after the edits before it."""
    before = (edit for edit in edits if edit.span.start < offset)
    return offset + sum(len(edit.new_text) - (edit.span.end - edit.span.start) for edit in before)
