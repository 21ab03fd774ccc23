# SPDX-License-Identifier: Apache-2.0
"""Runs the rules on models and systems and returns the diagnostics.

- A file in several systems is checked in each of them, and equal findings are merged. A file that is not in a system is
  checked alone.
- Findings are cached by their dependencies: the content of the file, its types and its system.
- A rule that raises an exception is reported as `internal-error`, once for each file, and the other rules continue. No
  setting or comment suppresses this finding, because an unchecked file must not look like a correct one.
"""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeAlias

from roaml.diagnostics import Diagnostic, Finding, RelatedPlace, Severity, Symbol, Tag
from roaml.exhaustive import assert_never
from roaml.expansion import ExpandedText
from roaml.expansion.problems import ExpansionProblem
from roaml.json_syntax.brackets import deep_recursion
from roaml.model.kinds import FileKind
from roaml.model.machine import Dialect
from roaml.model.property_links import LinkedFile
from roaml.project import explored_findings
from roaml.project.analysis import Analysis, Expanded
from roaml.project.analysis.subjects import CheckedFile, Contexts, FileInSystem, Inspection
from roaml.project.edits import laid_out
from roaml.project.files import MAX_CHARACTERS
from roaml.project.memo import Memo
from roaml.project.settings import Settings
from roaml.project.suppress import Suppression, covering, suppressions
from roaml.record import replace
from roaml.rules import BY_CODE, RULES
from roaml.rules.answers.answer_needs_time import DependsOnOrder
from roaml.rules.elements import invalid_value
from roaml.rules.files import file_too_large, unused_suppression
from roaml.rules.files import internal_error as internal_error_rule
from roaml.rules.parser_rules import INVALID_SETTING, TOML_SYNTAX
from roaml.rules.rule import (
    FileContext,
    MachineContext,
    PropertiesContext,
    Rule,
    StructsContext,
    SystemContext,
    TreeContext,
    replacements,
)
from roaml.rules.states.constant_condition import ConstantCondition
from roaml.rules.support.end_tags import without_misnamed_ends
from roaml.rules.support.impossible_targets import ImpossibleTarget
from roaml.suggest import close_names
from roaml.text import Location, SourceFile, Span
from roaml.xml_syntax import Document

_INVALID_DRAWS = (ExpansionProblem.DISTRIBUTION.value, ExpansionProblem.MISPLACED.value)
"""The codes of findings about numbers that cannot be drawn."""
MAX_FINDINGS = 1000
"""The maximum number of findings of one rule in one file. It limits the time that is spent on similar names and
fixes."""

_FORM = ("xml-syntax", "nesting-too-deep")
_CRASH = internal_error_rule.RULE.code
_OF_CONFIGURATION = (TOML_SYNTAX.code, INVALID_SETTING.code)

_FileInSystem: TypeAlias = "FileInSystem[Expanded[Analysis]]"

Check: TypeAlias = "tuple[Rule, Callable[[], Iterable[Finding]]]"
"""A rule, and a function that returns its findings in one file."""


class RuleRunner:
    """Checks the files of one analysis."""

    def __init__(self, analysis: Analysis, settings: Settings) -> None:
        self.analysis = analysis
        self.settings = settings
        self._contents: dict[str, object] = {}
        self._inspection = Inspection(settings.limits, functools.partial(_found, analysis.memo))

    def diagnostics(self, path: str, *, explores: bool = False) -> tuple[Diagnostic, ...]:
        """The diagnostics of a file, sorted by position; empty if the file cannot be read.

        Args:
            explores: whether the reachable states of its systems are explored. Otherwise the findings that need them
                are contained if the systems have been explored as they are, or before other files were changed.
        """
        file = self.checked_file(path)
        if file is None:
            return ()
        known = [self._findings(subject) for subject in file.subjects]
        findings = dict.fromkeys(finding for of_system in known for finding in of_system if self._is_selected(finding))
        systems = dict.fromkeys(subject.system_path for subject in file.subjects)
        explored = {s: self._explored(s, explores=explores) for s in systems if s is not None}
        reached = _in_all(
            (self._before(system, path) if found is None else found.get(path, ()) for system, found in explored.items())
        )
        known.append(reached)
        reached = tuple(finding for finding in reached if self._is_selected(finding))
        findings = _without_weaker(findings, reached)
        blamed = {f.span for f in findings if self._severity(f) >= Severity.WARNING}
        findings.update(dict.fromkeys(f for f in reached if f.span not in blamed))
        hidden = suppressions(file.document) if file.document is not None else ()
        linked = [subject.system for subject in file.subjects]
        if hidden and all(system is not None and system.complete for system in linked):
            of_all = [finding for of_system in known for finding in of_system]
            codes = explored_findings.CODES | explored_findings.FAULT_CODES
            unexplored = codes if None in explored.values() else frozenset[str]()
            unused = self._unused(file.source, of_all, hidden, unexplored)
            findings.update(dict.fromkeys(finding for finding in unused if self._is_selected(finding)))
        published = [(file.source, finding, self._severity(finding)) for finding in _visible(findings, hidden)]
        return tuple(sorted(self._published(published), key=order))

    def checked_file(self, path: str) -> CheckedFile[Expanded[Analysis]] | None:
        """A file with the findings of the rules; `None` if it cannot be read."""
        return self.analysis.checked_file(path, self._inspection)

    def provisional(self, source: SourceFile, document: Document, findings: Iterable[Finding]) -> Iterator[Diagnostic]:
        """Diagnostics of a text that differs from the one that has been checked. They have no fixes and no places in
        other files."""
        selected = [finding for finding in findings if self._is_selected(finding)]
        for finding in _visible(selected, suppressions(document)):
            yield Diagnostic(
                *(source.path, finding.code, self._severity(finding), finding.span, finding.message),
                related=tuple(_related(source, finding, {})),
                tags=finding.tags,
                facts=finding.facts,
                source=source,
            )

    def _explored(self, system: str, *, explores: bool) -> Mapping[str, tuple[Finding, ...]] | None:
        """Path of a file -> the findings in it that follow from the reachable states of a system; `None` if the states
        are not known."""
        settings = self.settings
        if settings.ignore >= explored_findings.CODES or (
            settings.select and not (explored_findings.CODES | explored_findings.FAULT_CODES) & settings.select
        ):
            return {}
        memo = self.analysis.memo
        if not explores and not memo.holds("exploration", system):
            return None
        if system not in self._contents:
            self._contents[system] = explored_findings.content_of(self.analysis, system)
        content = self._contents[system]
        if explores:
            found = memo.get("exploration", system, content, lambda: self._explore(system))
            if found is not None or not self.errors(system):
                memo.get("explored", system, content, lambda: found or {})
            return found
        known: Mapping[str, tuple[Finding, ...]] | None = memo.known("exploration", system, content)
        return known

    def _before(self, system: str, path: str) -> tuple[Finding, ...] | None:
        """The findings in a file that followed from the reachable states of a system before other files were changed.
        They are kept until the states are explored again, also while the system has errors; `None` if there were
        none."""
        last = self.analysis.memo.last("explored", system)
        if last is None or path not in last[1]:
            return None
        content, found = last
        return explored_findings.still_true(found[path], path, content, self.analysis.source)

    def has_too_many_states(self, system: str) -> bool:
        """Whether a system without errors is too large for the rules that need its reachable states."""
        return not self.errors(system) and self._explored(system, explores=True) is None

    def _explore(self, system: str) -> Mapping[str, tuple[Finding, ...]] | None:
        if self.errors(system):
            return None
        try:
            found = explored_findings.findings_of(self.analysis, system, self.settings.expectations)
            if found is None:
                return None
            static = list(self._of_system(system))
            unobserved = explored_findings.unobserved(self.analysis, system, static)
            replaced = {(path, f.code, f.span) for path, of_file in unobserved.items() for f in of_file}
            codes = {f.code for path, f in static if (path, f.code, f.span) not in replaced}
            found = explored_findings.without_consequences(found, codes)
            return {path: (*found.get(path, ()), *unobserved.get(path, ())) for path in {**found, **unobserved}}
        except Exception as error:  # an internal error must not stop the rules
            _log_exception(error, "%s cannot be explored", system)
            return {system: (internal_error("the exploration of this system", error),)}

    def _unused(
        self,
        source: SourceFile,
        findings: Iterable[Finding],
        hidden: Iterable[Suppression],
        unknown: frozenset[str],
    ) -> Iterator[Finding]:
        """The findings about unused suppression comments in a file of complete systems. There are none for a file that
        has syntax errors, because other findings may be missing, nor about comments with the codes `unknown`."""
        if any(finding.code in _FORM for finding in findings):
            return
        around = covering(hidden)
        used: dict[object, set[str]] = {}
        for finding in findings:
            for suppression in around(finding.span.start):
                if suppression.hides(finding):
                    used.setdefault((suppression.span, suppression.codes), set()).add(finding.code)
        for suppression in itertools.islice(hidden, MAX_FINDINGS):
            key = (suppression.span, suppression.codes)
            if unknown and (suppression.codes is None or unknown.intersection(suppression.codes)):
                continue
            if suppression.codes is None or unused_suppression.RULE.code not in suppression.codes:
                codes = None if suppression.codes is None else sorted(suppression.codes)
                yield from unused_suppression.finding(
                    source.text, suppression.comment, codes, used.get(key, ()), BY_CODE
                )

    def errors(self, system: str) -> tuple[Diagnostic, ...]:
        """The errors that prevent the translation of a system. The default severities of the rules are used: settings
        and comments cannot make a system translatable."""
        subjects = (self.analysis.subject(path, system, self._inspection) for path in self.analysis.files_of(system))
        errors = [
            (subject.source, finding, Severity.ERROR)
            for subject in subjects
            if subject is not None
            for finding in sorted(self._findings(subject), key=lambda finding: finding.span)
            if own_severity(finding) is Severity.ERROR
        ]
        return tuple(self._published(errors))

    def _of_system(self, system: str) -> Iterator[tuple[str, Finding]]:
        """The paths of the files of a system, and the warnings and errors of the rules in them."""
        for path in self.analysis.files_of(system):
            subject = self.analysis.subject(path, system, self._inspection)
            for finding in self._findings(subject) if subject is not None else ():
                if own_severity(finding) >= Severity.WARNING:
                    yield path, finding

    def findings(self, path: str, system: str | None) -> tuple[Finding, ...]:
        """The findings of the rules in the file `path` as a part of `system`. If `system` is `None`, the file is not in
        a system."""
        subject = self.analysis.subject(path, system, self._inspection)
        return () if subject is None else self._findings(subject)

    def _findings(self, subject: _FileInSystem) -> tuple[Finding, ...]:
        if len(subject.source.text) > MAX_CHARACTERS:
            return (_too_large(subject.source),)
        if subject.expanded is not None:
            return self._expanded_findings(subject.expanded, subject)
        if subject.failure is None:
            return subject.findings
        _log_exception(subject.failure, "%s cannot be analysed", subject.path)
        return (internal_error("the analysis of this file", subject.failure),)

    def contexts(self, subject: _FileInSystem) -> tuple[FileContext, MachineContext] | None:
        """The contexts in which the rules check a machine; `None` for other files, and if its text is expanded."""
        if subject.expanded is not None or subject.kind is not FileKind.MACHINE or subject.failure is not None:
            return None
        contexts = self.analysis.contexts(subject, self.settings.limits)
        return (contexts.file, contexts.own) if isinstance(contexts.own, MachineContext) else None

    def _expanded_findings(self, expanded: Expanded[Analysis], subject: _FileInSystem) -> tuple[Finding, ...]:
        """The findings in the expanded texts of a file, at their places in the file, after those about its parameters
        and instances.

        A finding at a place that cannot be expanded is a consequence, and is left out. So is a finding that is not an
        error and that depends on the values of parameters: the same instance does not have it with other values. While
        a number cannot be drawn, a constant replaces it, so that all findings that are not errors may be consequences.
        """
        path, system = subject.path, subject.system_path
        own = expanded.expansion.findings.get(path, ())
        broken = [finding.span for finding in own if own_severity(finding) is Severity.ERROR]
        has_invalid_draw = any(finding.code in _INVALID_DRAWS for finding in own)
        of_variants = self._mapped_findings(expanded, path, system)
        if path in expanded.expansion.variants and any(
            own_severity(f) < Severity.ERROR for fs in of_variants for f in fs
        ):
            analysis = self.analysis
            varied = analysis.expanded(system, varied=True) if system else analysis.expanded_file(path, varied=True)
            assert varied is not None
            others = self._mapped_findings(varied, path, system)
            of_variants = [
                [f for f in findings if own_severity(f) is Severity.ERROR or _stated(f) in always]
                for findings, always in zip(of_variants, ({_stated(f) for f in fs} for fs in others), strict=True)
            ]
        findings = [
            finding
            for finding in itertools.chain.from_iterable(of_variants)
            if not any(span.start < finding.span.end and finding.span.start < span.end for span in broken)
            and (own_severity(finding) is Severity.ERROR or not has_invalid_draw)
        ]
        known = {(finding.code, finding.span) for finding in findings}
        unseen = (f for f in self._replaced_findings(expanded, subject) if (f.code, f.span) not in known)
        unseen = (f for f in unseen if not any(f.span.start < span.end and span.start < f.span.end for span in broken))
        return tuple(dict.fromkeys((*own, *findings, *unseen)))

    def _replaced_findings(self, expanded: Expanded[Analysis], subject: _FileInSystem) -> Iterator[Finding]:
        """The findings about the form of the parts of a file that its expanded texts do not contain, such as
        declarations. Values in them are checked by the expansion."""
        texts = [expanded.expansion.texts.get(variant) for variant in expanded.expansion.paths(subject.path)]
        spans = [edit.span for text in texts if text is not None for edit in text.expansions[0].edits]
        context = self.analysis.file_context(subject) if spans else None
        if context is None or context.document is None:
            return
        for finding in found(subject.path, file_checks(context), self.analysis.memo):
            place = finding.span
            if finding.code not in _OF_VALUES and any(s.start <= place.start and place.end <= s.end for s in spans):
                yield finding

    def _mapped_findings(self, expanded: Expanded[Analysis], path: str, system: str | None) -> list[list[Finding]]:
        """The findings in each expanded text of a file, at their places in the file."""
        runner = RuleRunner(expanded.analysis, self.settings)
        mapped: list[list[Finding]] = []
        for variant in expanded.expansion.paths(path):
            findings, text = runner.findings(variant, system), expanded.expansion.texts.get(variant)
            if text is not None and text.copies:
                findings = _in_all_copies(text, findings)
            mapped.append(
                [
                    _meant_parameter(expanded, path, expanded.finding(variant, finding))
                    for finding in findings
                    if text is None or not _is_given_impossible(text, finding)
                ]
            )
        return mapped

    def _is_selected(self, finding: Finding) -> bool:
        code, settings = finding.code, self.settings
        if code == _CRASH:
            return True
        # A selection of rules must not hide that the configuration is invalid.
        chosen = not settings.select or code in settings.select or code in _OF_CONFIGURATION
        return chosen and code not in settings.ignore

    def _severity(self, finding: Finding) -> Severity:
        severity = self.settings.severities.get(finding.code)
        return own_severity(finding) if severity is None else severity

    def _published(self, findings: Iterable[tuple[SourceFile, Finding, Severity]]) -> Iterator[Diagnostic]:
        """Findings in texts, with their severities, as diagnostics."""
        findings = tuple(findings)
        symbols = {r.place for _, finding, _ in findings for r in finding.related if isinstance(r.place, Symbol)}
        places = self.analysis.places(symbols) if symbols else {}
        for source, finding, severity in findings:
            yield Diagnostic(
                *(source.path, finding.code, severity, finding.span, finding.message),
                fixes=tuple(laid_out(source, fix) for fix in finding.fixes),
                related=tuple(_related(source, finding, places, self.analysis.source)),
                tags=finding.tags,
                facts=finding.facts,
                source=source,
            )


def _without_weaker(findings: dict[Finding, None], explored: Iterable[Finding]) -> dict[Finding, None]:
    """The findings without those at the places where an exploration has found errors of the same rules, or that a wait
    does not occur: these say more."""
    certain = {
        (f.code, f.span) for f in explored if f.severity is Severity.ERROR or isinstance(f.facts, DependsOnOrder)
    }
    return {f: None for f in findings if (f.code, f.span) not in certain}


def _in_all(explored: Iterable[tuple[Finding, ...] | None]) -> tuple[Finding, ...]:
    """The findings in a file that follow from the reachable states of all its systems whose states are known: another
    system may reach what one does not."""
    known = [found for found in explored if found is not None]
    return tuple(finding for finding in known[0] if all(finding in other for other in known)) if known else ()


def _related(
    source: SourceFile,
    finding: Finding,
    places: Mapping[Symbol, tuple[Location, SourceFile]],
    source_of: Callable[[str], SourceFile | None] = lambda _: None,
) -> Iterator[RelatedPlace]:
    """The related places of a finding. Symbols that no longer exist are left out."""
    for related in finding.related:
        if isinstance(related.place, Span):
            yield RelatedPlace(Location(source.path, related.place), related.message, source)
        elif isinstance(related.place, Location):
            yield RelatedPlace(related.place, related.message, source_of(related.place.path))
        elif related.place in places:
            location, text = places[related.place]
            yield RelatedPlace(location, related.message, text)


def _in_all_copies(text: ExpandedText, findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """The findings in a text in which the bodies of handlers are copied. A finding in a copy is reported once; one that
    is not an error, only if it occurs in all copies: otherwise it depends on a value that may be drawn."""
    places = [(finding.code, text.origin(finding.span), _claim(finding)) for finding in findings]
    count = Counter(places)
    kept: dict[object, Finding] = {}
    for finding, place in zip(findings, places, strict=True):
        if (copies := text.places(finding.span)) == 1:
            kept[finding] = finding
        elif own_severity(finding) is Severity.ERROR or count[place] >= copies:
            kept.setdefault(place, finding)
    return tuple(kept.values())


def _stated(finding: Finding) -> tuple[str, Span, bool | None]:
    """What a finding states and where: `always true` and `never true` differ, and the values of parameters do not."""
    return finding.code, finding.span, _claim(finding)


def _claim(finding: Finding) -> bool | None:
    """Whether a condition is always or never true; `None` for findings about something else."""
    return finding.facts.is_true if isinstance(finding.facts, ConstantCondition) else None


_OF_VALUES = (invalid_value.RULE.code,)
"""The codes of findings about the values of attributes, which may be expressions over parameters."""
_UNKNOWN_NAMES = ("undeclared-variable", "property-condition", "invalid-rate", "invalid-value")
"""The codes of findings at a name that may be a misspelled parameter."""


def _is_given_impossible(text: ExpandedText, finding: Finding) -> bool:
    """Whether a finding states that a target is never chosen, because of the value of a parameter, which is
    no mistake (docs/spec/parameters.md#uses)."""
    return isinstance(finding.facts, ImpossibleTarget) and not text.is_written(finding.span)


def _meant_parameter(expanded: Expanded[Analysis], path: str, finding: Finding) -> Finding:
    """A finding about an unknown name with a suggestion, if the name is similar to that of a parameter."""
    if finding.code not in _UNKNOWN_NAMES or finding.fixes:
        return finding
    text = expanded.written(path, finding.span)
    close = close_names(text, expanded.expansion.known_in(path), 1) if text.isidentifier() else ()
    if not close or close[0] == text:
        return finding
    message = f"there is no variable or parameter `{text}`; did you mean the parameter `{close[0]}`?"
    return replace(finding, message=message, fixes=tuple(replacements(finding.span, close)))


def _limited(rule: Rule, findings: Iterable[Finding]) -> list[Finding]:
    """The findings of one rule in one file. If there are more than `MAX_FINDINGS`, a last finding that states this
    follows the first `MAX_FINDINGS`."""
    kept = list(itertools.islice(findings, MAX_FINDINGS + 1))
    if len(kept) > MAX_FINDINGS:
        message = f"only the first {MAX_FINDINGS:,} findings of `{rule.code}` in this file are shown"
        kept[-1] = rule.at(kept[-1].span, message, severity=kept[-1].severity)
    return kept


def order(diagnostic: Diagnostic) -> tuple[object, ...]:
    """The key by which the diagnostics of a file are sorted."""
    return diagnostic.span, -diagnostic.severity, diagnostic.code, diagnostic.message


def _visible(findings: Iterable[Finding], hidden: Iterable[Suppression]) -> Iterator[Finding]:
    """The findings without repetitions, and without those that a comment suppresses."""
    around = covering(hidden)
    for finding in _without_repetition(findings):
        if finding.code == _CRASH or not any(_hides(comment, finding) for comment in around(finding.span.start)):
            yield finding


def _hides(comment: Suppression, finding: Finding) -> bool:
    """Whether a comment suppresses a finding. A comment without codes does not suppress the finding that the comment
    itself is unused."""
    is_about_comments = finding.code == unused_suppression.RULE.code
    return comment.hides(finding) and not (is_about_comments and comment.codes is None)


def own_severity(finding: Finding) -> Severity:
    """The severity of a finding if no setting changes that of its rule."""
    if finding.severity is not None:
        return finding.severity
    return BY_CODE[finding.code].severity if finding.code in BY_CODE else Severity.ERROR


def _without_repetition(findings: Iterable[Finding]) -> Iterator[Finding]:
    """The findings without duplicates. Findings of several systems that differ only in fixes or related positions are
    duplicates."""
    seen = set()
    for finding in findings:
        key = (finding.code, finding.span, finding.message)
        if key not in seen:
            seen.add(key)
            yield finding


def _too_large(source: SourceFile) -> Finding:
    message = f"the file is too large to be checked: {len(source.text):,} characters; the limit is {MAX_CHARACTERS:,}"
    return file_too_large.RULE.at(Span(0, source.lines.line_end(0)), message)


def _found(memo: Memo, path: str, contexts: Contexts) -> tuple[Finding, ...]:
    """The findings of all rules in a file."""
    return found(path, [*file_checks(contexts.file), *_own_checks(path, contexts)], memo)


def _own_checks(path: str, contexts: Contexts) -> list[Check]:
    """The checks of the rules about files of one kind."""
    if contexts.failure is not None:
        _log_exception(contexts.failure, "the model of %s cannot be built", path)
        failure = internal_error("the analysis of this file", contexts.failure)
        return [(internal_error_rule.RULE, lambda: [failure])]
    match contexts.own:
        case MachineContext() as machine:
            return machine_checks(machine)
        case TreeContext() as tree:
            return [(r, functools.partial(r.tree, tree)) for r in RULES if r.tree]
        case SystemContext() as system:
            return [(r, functools.partial(r.system, system)) for r in RULES if r.system]
        case StructsContext() as structs:
            return [(r, functools.partial(r.structs, structs)) for r in RULES if r.structs]
        case PropertiesContext() as properties:
            return [(r, functools.partial(r.properties, properties)) for r in RULES if r.properties]
        case LinkedFile() as linked:
            return [(r, functools.partial(r.xml_properties, linked)) for r in RULES if r.xml_properties]
        case None:
            return []
        case _:
            return assert_never(contexts.own)


def file_checks(context: FileContext) -> list[Check]:
    """The checks of the rules about files of any kind."""
    return [(rule, functools.partial(rule.file, context)) for rule in RULES if rule.file]


def machine_checks(context: MachineContext) -> list[Check]:
    """The checks of the rules about machines that apply to the dialect of the machine."""
    plain = context.dialect in (Dialect.PLAIN, Dialect.FOREIGN)
    return [(r, functools.partial(r.machine, context)) for r in RULES if r.machine and (r.plain or not plain)]


def found(path: str, checks: Iterable[Check], memo: Memo) -> tuple[Finding, ...]:
    """The findings of checks in the file `path`."""
    with deep_recursion():
        findings = without_misnamed_ends(tuple(_all(path, checks, memo)))
    if any(finding.code in _FORM for finding in findings):
        # A declaration that seems unused may be used in an unreadable part.
        return tuple(finding for finding in findings if Tag.UNNECESSARY not in finding.tags)
    return findings


def _all(path: str, checks: Iterable[Check], memo: Memo) -> Iterator[Finding]:
    for rule, check in checks:
        memo.checkpoint()
        try:
            yield from _limited(rule, check())
        except Exception as error:  # an internal error must not stop the other rules
            _log_exception(error, "rule %s failed on %s", rule.code, path)
            yield internal_error(f"the rule `{rule.code}`", error)


def _log_exception(error: Exception, message: str, *arguments: object) -> None:
    import logging  # noqa: PLC0415 - imports `traceback` and `string`, and only internal errors are logged

    logging.getLogger(__name__).error(message, *arguments, exc_info=error)


def internal_error(subject: str, error: Exception) -> Finding:
    """The finding that `error` was raised by `subject`, a phrase such as ``the rule `x` ``."""
    message = (
        f"{subject} failed ({type(error).__name__}: {error}): this is an internal error of the tool; please report it"
    )
    return internal_error_rule.RULE.at(Span(0, 0), message)
