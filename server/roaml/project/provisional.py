# SPDX-License-Identifier: Apache-2.0
"""The diagnostics of a long machine directly after an edit, before the whole machine is checked again.

A key changes one state. Most rules report a problem of a state from this state, the declarations, the names of the
other states and the rest of the system (all rules but those with `Rule.whole`). So these rules check the machine
without the content of its other states: white space takes its place, so that every position remains. The other findings
are those of the last complete check, moved by the edit. They may be out of date until the next complete check, which
replaces all of them.
"""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterable
from typing import NamedTuple

from roaml.diagnostics import Diagnostic, Finding, RelatedPlace
from roaml.language.validate import validate
from roaml.model.build_machine import build_machine
from roaml.model.value_types import Environment, type_machine
from roaml.model.values.analyse import NO_VALUES
from roaml.project.checking import RuleRunner, file_checks, found, machine_checks, order
from roaml.record import Record, replace
from roaml.rules import BY_CODE
from roaml.rules.rule import FileContext, MachineContext
from roaml.text import Location, SourceFile, Span
from roaml.xml_syntax import Document, Element
from roaml.xml_syntax import parse as parse_xml

MIN_CHARACTERS = 20_000
"""The number of characters from which the diagnostics of a machine are first provisional. A shorter one is checked
completely at each key."""

MAX_EDIT_CHARACTERS = 20_000
"""The maximum number of characters of the states in which an edit is. After a larger edit, the whole machine is
checked."""


class _Surroundings(Record, frozen=True, eq=False):
    """What the rules know of a machine in one system: the contexts, of which the rest of the system is that of the last
    complete check."""

    file: FileContext
    machine: MachineContext
    environment: Environment

    def around(self, source: SourceFile, document: Document) -> _Surroundings:
        """The same with another text of the machine. The values of variables are unknown."""
        grammar = self.file.grammar
        violations = validate(document, grammar) if grammar else ()
        file = replace(self.file, source=source, findings=document.findings, document=document, violations=violations)
        machine = build_machine(document) or self.machine.machine
        typed = type_machine(machine, self.environment)
        context = replace(
            self.machine,
            source=source,
            document=document,
            machine=machine,
            typed=typed,
            local_values=NO_VALUES,
            values=NO_VALUES,
        )
        return _Surroundings(file, context, self.environment)


class Checked(Record, frozen=True, eq=False):
    """A version of a long machine and its diagnostics.

    Attributes:
        source: the text.
        diagnostics: the diagnostics, sorted by position.
        blank: the text without the content of the states.
        parts: the spans of the child elements of the root, in order.
        content: the span between the tags of the root.
    """

    source: SourceFile
    diagnostics: tuple[Diagnostic, ...]
    blank: str
    parts: tuple[Span, ...]
    content: Span
    runner: RuleRunner
    surroundings: tuple[_Surroundings, ...]


def checked(runner: RuleRunner, path: str) -> Checked | None:
    """A machine after a complete check; `None` if it is short, is not in the language, or cannot be analysed."""
    file = runner.checked_file(path)
    if file is None or len(file.source.text) < MIN_CHARACTERS:
        return None
    source, document = file.source, file.document
    contexts = [runner.contexts(subject) for subject in file.subjects]
    if document is None or document.root is None or None in contexts:
        return None
    root, environments = document.root, [runner.analysis.environment(subject.system_path) for subject in file.subjects]
    blank, parts = _without_content(source.text, root.elements), tuple(element.span for element in root.elements)
    empty = parse_xml(blank)
    surroundings = tuple(
        _Surroundings(*context, environment).around(source, empty)
        for context, environment in zip(contexts, environments, strict=True)
        if context is not None
    )
    return Checked(source, runner.diagnostics(path), blank, parts, root.content_span, runner, surroundings)


def after(known: Checked, text: str) -> Checked | None:
    """A machine after one edit; `None` if the edit changes the root, or too many states."""
    edit = _Edit.between(known.source.text, text)
    if not (known.content.start <= edit.start and edit.end <= known.content.end):
        return None
    first = bisect.bisect_left([part.end for part in known.parts], edit.start)
    end = bisect.bisect_right([part.start for part in known.parts], edit.end)
    before, following = known.parts[:first], known.parts[end:]
    old = Span(
        before[-1].end if before else known.content.start, following[0].start if following else known.content.end
    )
    changed = Span(old.start, old.end + edit.growth)
    if changed.end - changed.start > MAX_EDIT_CHARACTERS:
        return None
    blank = known.blank[: old.start] + text[changed.start : changed.end] + known.blank[old.end :]
    source, document = replace(known.source, text=text), parse_xml(blank)
    elements = document.root.elements if document.root else []
    new = [element for element in elements if changed.start < element.span.end and element.span.start < changed.end]
    behind = [edit.moved(part) for part in following]
    moved = [_moved(diagnostic, source, edit) for diagnostic in known.diagnostics if not edit.cuts(diagnostic.span)]
    if [element.span for element in elements[first + len(new) :]] == behind:
        diagnostics = _diagnostics(known, source, document, changed, moved)
        parts = [*before, *(element.span for element in new), *behind]
        blank = _without_content(blank, new)
    else:  # while a tag or a comment is being written, it may contain what follows it
        diagnostics, parts = moved, [edit.moved(part) for part in known.parts]
    content = edit.moved(known.content)
    return Checked(source, tuple(diagnostics), blank, tuple(parts), content, known.runner, known.surroundings)


def _diagnostics(
    known: Checked, source: SourceFile, document: Document, changed: Span, moved: Iterable[Diagnostic]
) -> list[Diagnostic]:
    """The moved diagnostics, in which those of local rules in the changed part are replaced by new ones."""
    blank = replace(source, text=document.text)
    findings = dict.fromkeys(
        finding
        for surroundings in known.surroundings
        for finding in _local_findings(surroundings.around(blank, document), known.runner)
        if changed.encloses(finding.span)
    )
    kept = [d for d in moved if not (_is_local(d.code) and changed.encloses(d.span))]
    return sorted((*kept, *known.runner.provisional(source, document, findings)), key=order)


def _local_findings(surroundings: _Surroundings, runner: RuleRunner) -> tuple[Finding, ...]:
    """The findings of the rules that need the content of one state only."""
    checks = (*file_checks(surroundings.file), *machine_checks(surroundings.machine))
    local = [(rule, check) for rule, check in checks if _is_local(rule.code)]
    return found(surroundings.file.source.path, local, runner.analysis.memo)


def _is_local(code: str) -> bool:
    """Whether a rule checks machines and needs the content of one state only."""
    rule = BY_CODE.get(code)
    return rule is not None and not rule.whole and bool(rule.file or rule.machine)


class _Edit(NamedTuple):
    """The replacement of the characters from `start` to `end` by a text that has `growth` characters more."""

    start: int
    end: int
    growth: int

    @classmethod
    def between(cls, old: str, new: str) -> _Edit:
        """The smallest edit that changes one text to the other."""
        shorter, ends = min(len(old), len(new)), (len(old), len(new))
        start = _common(shorter, lambda a, b: old[a:b] == new[a:b])
        same = _common(shorter - start, lambda a, b: old[ends[0] - b : ends[0] - a] == new[ends[1] - b : ends[1] - a])
        return cls(start, ends[0] - same, ends[1] - ends[0])

    def moved(self, span: Span) -> Span:
        """A span after the edit: behind the edit it moves, around the edit it grows."""
        is_behind = span.start >= self.end and span.start > self.start
        start = span.start + self.growth if is_behind else span.start
        return Span(start, span.end + self.growth if span.end >= self.end else span.end)

    def cuts(self, span: Span) -> bool:
        """Whether the edit changes one end of a span, or all of it."""
        is_inside = span.start < self.start and self.end < span.end
        return span.start <= self.end and self.start <= span.end and not is_inside


def _common(length: int, is_equal: Callable[[int, int], bool]) -> int:
    """The number of first characters, at most `length`, that are equal; `is_equal` compares a range."""
    low, high = 0, length
    while low < high:
        middle = (low + high + 1) // 2
        if is_equal(low, middle):
            low = middle
        else:
            high = middle - 1
    return low


def _moved(diagnostic: Diagnostic, source: SourceFile, edit: _Edit) -> Diagnostic:
    """A diagnostic after an edit, without fixes, whose edits would be out of date."""
    related = []
    for place in diagnostic.related:
        path, span = place.location
        is_here = path == source.path
        related.append(RelatedPlace(Location(path, edit.moved(span)), place.message, source) if is_here else place)
    return replace(diagnostic, span=edit.moved(diagnostic.span), related=tuple(related), fixes=(), source=source)


def _without_content(text: str, elements: Iterable[Element]) -> str:
    """A text in which the content of the given elements, if they are states without inner states, is white space."""
    pieces: list[str] = []
    done = 0
    for element in elements:
        content = element.content_span
        if element.name == "state" and element.close_span and all(e.name != "state" for e in element.elements):
            pieces += (text[done : content.start], " " * (content.end - content.start))
            done = content.end
    return "".join((*pieces, text[done:]))
