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
import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from roaml.diagnostics import Diagnostic, Finding, Related, RelatedPlace, Severity, Symbol, Tag
from roaml.disk import UnreadableReason
from roaml.expansion import ExpandedText
from roaml.interfaces.parse import parse as parse_interface
from roaml.interfaces.registry import NotFound, Reason
from roaml.interfaces.report import CODE as INTERFACE_SYNTAX
from roaml.interfaces.types import Definition, Kind
from roaml.language import HL_SCXML, PLAIN_SCXML, Grammar
from roaml.model.dialect import dialect_of
from roaml.model.expand import TreeFileOutline
from roaml.model.gaps import PlacedGap
from roaml.model.json_schema import structs_in_json
from roaml.model.kinds import GRAMMARS, PROJECT_EXTENSION, FileKind
from roaml.model.machine import Dialect, Machine
from roaml.model.size import Limits
from roaml.model.system import System
from roaml.model.tree import Include
from roaml.project.analysis import NO_STRUCTS, Analysis, Expanded
from roaml.project.configuration import missing_folders
from roaml.project.edits import laid_out
from roaml.project.files import MAX_CHARACTERS
from roaml.project.locate import locate
from roaml.project.memo import Memo
from roaml.project.paths import slashed
from roaml.project.settings import Settings
from roaml.project.suppress import Suppression, covering, suppressions
from roaml.project.translation import size_of_translation
from roaml.record import replace
from roaml.rules import BY_CODE, RULES
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
    UntranslatablePart,
    replacements,
)
from roaml.rules.support.end_tags import without_misnamed_ends
from roaml.suggest import close_names
from roaml.text import Location, SourceFile, Span
from roaml.xml_syntax import Document

MAX_FINDINGS = 1000
"""The maximum number of findings of one rule in one file. It limits the time that is spent on similar names and
fixes."""

_FORM = ("xml-syntax", "nesting-too-deep")
_CRASH = internal_error_rule.RULE.code
_OF_CONFIGURATION = (TOML_SYNTAX.code, INVALID_SETTING.code)

Check: TypeAlias = "tuple[Rule, Callable[[], Iterable[Finding]]]"
"""A rule, and a function that returns its findings in one file."""

_XML_KINDS = (*GRAMMARS, FileKind.SPECIFICATION, FileKind.UNKNOWN)


class RuleRunner:
    """Checks the files of one analysis."""

    def __init__(self, analysis: Analysis, settings: Settings) -> None:
        self.analysis = analysis
        self.settings = settings

    def diagnostics(self, path: str) -> tuple[Diagnostic, ...]:
        """The diagnostics of a file, sorted by position; empty if the file cannot be read."""
        source = self.analysis.source(path)
        if source is None:
            return ()
        systems = self.analysis.memberships.get(path, ())
        findings = dict.fromkeys(
            finding
            for system in (systems or (None,))
            for finding in self.findings(path, system)
            if self._is_selected(finding)
        )
        hidden = suppressions(self.analysis.document(path)) if _is_xml(self.analysis.kind(path)) else ()
        if hidden:
            findings.update(
                dict.fromkeys(
                    finding for finding in self._unused(source, systems, hidden) if self._is_selected(finding)
                )
            )
        return tuple(sorted((self._publish(path, f) for f in _visible(findings, hidden)), key=order))

    def provisional(self, source: SourceFile, document: Document, findings: Iterable[Finding]) -> Iterator[Diagnostic]:
        """Diagnostics of a text that differs from the one that has been checked. They have no fixes and no places in
        other files."""
        selected = [finding for finding in findings if self._is_selected(finding)]
        for finding in _visible(selected, suppressions(document)):
            places = [(r.place, r.message) for r in finding.related if isinstance(r.place, Span)]
            related = tuple(RelatedPlace(Location(source.path, place), message) for place, message in places)
            severity = self.settings.severities.get(finding.code, _own_severity(finding))
            yield Diagnostic(
                *(source.path, finding.code, severity, finding.span, finding.message),
                related=related,
                tags=finding.tags,
                facts=finding.facts,
                source=source,
            )

    def _unused(self, source: SourceFile, systems: tuple[str, ...], hidden: Iterable[Suppression]) -> Iterator[Finding]:
        """The findings about unused suppression comments. There are none for a file that is not in a system, that is in
        an incomplete system, or that has syntax errors, because other findings may be missing."""
        linked = [self.analysis.system(system) for system in systems]
        findings = [finding for system in systems for finding in self.findings(source.path, system)]
        known = linked and all(system is not None and system.complete for system in linked)
        if not known or any(finding.code in _FORM for finding in findings):
            return
        around = covering(hidden)
        used: dict[object, set[str]] = {}
        for finding in findings:
            for suppression in around(finding.span.start):
                if suppression.hides(finding):
                    used.setdefault((suppression.span, suppression.codes), set()).add(finding.code)
        for suppression in itertools.islice(hidden, MAX_FINDINGS):
            key = (suppression.span, suppression.codes)
            if suppression.codes is None or unused_suppression.RULE.code not in suppression.codes:
                codes = None if suppression.codes is None else sorted(suppression.codes)
                yield from unused_suppression.finding(
                    source.text, suppression.comment, codes, used.get(key, ()), BY_CODE
                )

    def errors(self, system: str) -> tuple[Diagnostic, ...]:
        """The errors that prevent the translation of a system. The default severities of the rules are used: settings
        and comments cannot make a system translatable."""
        return tuple(
            self._diagnostic(path, finding, _own_severity(finding))
            for path in self.analysis.files_of(system)
            for finding in sorted(self.findings(path, system), key=lambda finding: finding.span)
            if _own_severity(finding) is Severity.ERROR
        )

    def findings(self, path: str, system: str | None) -> tuple[Finding, ...]:
        """The findings of the rules in the file `path` as a part of `system`. If `system` is `None`, the file is not in
        a system."""
        source = self.analysis.source(path)
        if source is None:
            return ()
        if len(source.text) > MAX_CHARACTERS:
            return (_too_large(source),)
        if (expanded := self._expanded_findings(path, system)) is not None:
            return expanded
        try:
            run = _Run(self.analysis, path, source, self.analysis.kind_in(path, system), system, self.settings.limits)
            return self.analysis.memo.get("findings", (path, system), run.key(), run.findings)
        except Exception as error:  # an internal error in one file must not prevent the check of the others
            _log_exception("%s cannot be analysed", path)
            return (internal_error("the analysis of this file", error),)

    def contexts(self, path: str, system: str | None) -> tuple[FileContext, MachineContext] | None:
        """The contexts in which the rules check the machine in the file `path` as a part of `system`; `None` if it is
        not a machine, or if its text is expanded."""
        source = self.analysis.source(path)
        if source is None or self._expanded(path, system, varied=False) is not None:
            return None
        run = _Run(self.analysis, path, source, self.analysis.kind_in(path, system), system, self.settings.limits)
        machine = run.machine_context() if run.kind is FileKind.MACHINE else None
        return None if machine is None else (run.file_context(), machine)

    def _expanded_findings(self, path: str, system: str | None) -> tuple[Finding, ...] | None:
        """The findings in the expanded texts of a file, at their places in the file, after those about its parameters
        and instances; `None` if nothing is expanded.

        A finding at a place that cannot be expanded is a consequence, and is left out. So is a finding that is not an
        error and that depends on the values of parameters: it does not occur with other values.
        """
        expanded = self._expanded(path, system, varied=False)
        if expanded is None:
            return None
        own = expanded.expansion.findings.get(path, ())
        broken = [finding.span for finding in own if _own_severity(finding) is Severity.ERROR]
        findings = [
            finding
            for finding in self._mapped_findings(expanded, path, system)
            if not any(span.start < finding.span.end and finding.span.start < span.end for span in broken)
        ]
        if path in expanded.expansion.variants and any(_own_severity(f) < Severity.ERROR for f in findings):
            varied = self._expanded(path, system, varied=True)
            assert varied is not None
            always = {(f.code, f.span) for f in self._mapped_findings(varied, path, system)}
            findings = [f for f in findings if _own_severity(f) is Severity.ERROR or (f.code, f.span) in always]
        return tuple(dict.fromkeys((*own, *findings)))

    def _expanded(self, path: str, system: str | None, *, varied: bool) -> Expanded[Analysis] | None:
        if system is not None:
            return self.analysis.expanded(system, varied=varied)
        return self.analysis.expanded_file(path, varied=varied)

    def _mapped_findings(self, expanded: Expanded[Analysis], path: str, system: str | None) -> Iterator[Finding]:
        runner = RuleRunner(expanded.analysis, self.settings)
        for variant in expanded.expansion.paths(path):
            findings, text = runner.findings(variant, system), expanded.expansion.texts.get(variant)
            if text is not None and text.copies:
                findings = _in_all_copies(text, findings)
            for finding in findings:
                yield _meant_parameter(expanded, path, expanded.finding(variant, finding))

    def _is_selected(self, finding: Finding) -> bool:
        code, settings = finding.code, self.settings
        if code == _CRASH:
            return True
        # A selection of rules must not hide that the configuration is invalid.
        chosen = not settings.select or code in settings.select or code in _OF_CONFIGURATION
        return chosen and code not in settings.ignore

    def _publish(self, path: str, finding: Finding) -> Diagnostic:
        severity = self.settings.severities.get(finding.code)
        return self._diagnostic(path, finding, _own_severity(finding) if severity is None else severity)

    def _diagnostic(self, path: str, finding: Finding, severity: Severity) -> Diagnostic:
        related = tuple(place for other in finding.related if (place := self._related(path, other)) is not None)
        source = self.analysis.source(path)
        fixes = tuple(laid_out(source, fix) for fix in finding.fixes) if source else ()
        span, message, tags, facts = finding.span, finding.message, finding.tags, finding.facts
        return Diagnostic(path, finding.code, severity, span, message, fixes, related, tags, facts, source)

    def _related(self, path: str, related: Related) -> RelatedPlace | None:
        if isinstance(related.place, Symbol):
            location = locate(self.analysis, related.place)
            return None if location is None else RelatedPlace(location, related.message)
        return RelatedPlace(Location(path, related.place), related.message)


def _in_all_copies(text: ExpandedText, findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """The findings in a text in which the bodies of handlers are copied. A finding in a copy is reported once; one that
    is not an error, only if it occurs in all copies: otherwise it depends on a value that may be drawn."""
    count = Counter((finding.code, text.origin(finding.span)) for finding in findings)
    kept: dict[object, Finding] = {}
    for finding in findings:
        place = (finding.code, text.origin(finding.span))
        if (copies := text.places(finding.span)) == 1:
            kept[finding] = finding
        elif _own_severity(finding) is Severity.ERROR or count[place] >= copies:
            kept.setdefault(place, finding)
    return tuple(kept.values())


_UNKNOWN_NAMES = ("undeclared-variable", "property-condition", "invalid-rate", "invalid-value")
"""The codes of findings at a name that may be a misspelled parameter."""


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


def _own_severity(finding: Finding) -> Severity:
    if finding.severity is not None:
        return finding.severity
    return BY_CODE[finding.code].severity if finding.code in BY_CODE else Severity.ERROR


def _is_xml(kind: FileKind) -> bool:
    return kind in _XML_KINDS


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


class _Run:
    """The check of one file in one system."""

    def __init__(
        self, analysis: Analysis, path: str, source: SourceFile, kind: FileKind, system: str | None, limits: Limits
    ) -> None:
        self.analysis = analysis
        self.path = path
        self.source = source
        self.kind = kind
        self.system_path = system
        self.limits = limits
        self.system: System | None = analysis.system(system) if system else None

    def key(self) -> object:
        """All values on which the findings depend, as a key for the cache."""
        parts: tuple[object, ...] = (self.source.text, self.source.ignored_encoding, self.kind, self.system)
        match self.kind:
            case FileKind.MACHINE if self.analysis.machine(self.path) is not None:
                machine = self.analysis.machine(self.path)
                assert machine is not None
                typed = self.analysis.typed_in(self.path, self.system_path)
                lookups = tuple(self.analysis.interfaces_of(machine))
                repeated = self.analysis.repeated_types(machine)
                arriving = self.analysis.arriving_at(self.path, self.system_path)
                return (*parts, typed, lookups, repeated, self.analysis.structs(self.system_path).complete, arriving)
            case FileKind.SYSTEM:
                listed = tuple((f.path, f.problem, f.kind) for f in self.analysis.listed(self.path))
                return (*parts, listed, self.analysis.system(self.path), size_of_translation(self.analysis, self.path))
            case FileKind.TREE:
                includes = (tuple(self._missing_includes().items()), tuple(self._found_includes().items()))
                return (*parts, self._tree_outlines(), includes, self.analysis.forest(self.path, self.system_path))
            case FileKind.PROPERTIES if self.system_path:
                return (*parts, tuple(self.analysis.names_before(self.path, self.system_path)))
            case FileKind.XML_PROPERTIES if self.system_path:
                return (*parts, self.analysis.linked_properties(self.path, self.system_path))
            case FileKind.STRUCTS | FileKind.JSON_STRUCTS:
                structs = self.analysis.structs(self.system_path)
                return (*parts, structs.outlines, structs.complete)
            case FileKind.CONFIGURATION:
                return (*parts, self._configuration_findings())
            case FileKind.INTERFACE:
                return (*parts, self._interface_findings())
            case FileKind.MOCKS:
                return (*parts, self._mock_findings())
        return parts

    def findings(self) -> tuple[Finding, ...]:
        return found(self.path, [*file_checks(self.file_context()), *self._own_checks()], self.analysis.memo)

    def _own_checks(self) -> list[Check]:
        try:
            match self.kind:
                case FileKind.MACHINE:
                    return self._machine_checks()
                case FileKind.TREE:
                    tree = self._tree_context()
                    return [(r, functools.partial(r.tree, tree)) for r in RULES if r.tree and tree]
                case FileKind.SYSTEM:
                    system = self._system_context()
                    return [(r, functools.partial(r.system, system)) for r in RULES if r.system and system]
                case FileKind.STRUCTS | FileKind.JSON_STRUCTS:
                    structs = self._structs_context()
                    return [(r, functools.partial(r.structs, structs)) for r in RULES if r.structs]
                case FileKind.XML_PROPERTIES:
                    linked = self.analysis.linked_properties(self.path, self.system_path) if self.system_path else None
                    return [
                        (r, functools.partial(r.xml_properties, linked)) for r in RULES if r.xml_properties and linked
                    ]
                case FileKind.PROPERTIES:
                    properties = self._properties_context()
                    return [
                        (r, functools.partial(r.properties, properties)) for r in RULES if r.properties and properties
                    ]
        except Exception as error:  # after an internal error, the findings of the parsers are still useful
            _log_exception("the model of %s cannot be built", self.path)
            failure = internal_error("the analysis of this file", error)
            return [(internal_error_rule.RULE, lambda: [failure])]
        return []

    # -------------------------------------------------------------- contexts

    def file_context(self) -> FileContext:
        """The context of the rules about files of any kind."""
        match self.kind:
            case FileKind.PROPERTIES:
                _, findings = self.analysis.json(self.path) or (None, ())
                broken = any(finding.code == "json-syntax" for finding in findings)
                more = () if broken else self.analysis.properties(self.path)[1]
                return FileContext(self.source, (*findings, *more))
            case FileKind.JSON_STRUCTS:
                value, findings = self.analysis.json(self.path) or (None, ())
                broken = any(finding.code == "json-syntax" for finding in findings)
                problems = () if value is None or broken else structs_in_json(value)[1]
                return FileContext(self.source, (*findings, *problems))
            case FileKind.JANI_MODEL:
                _, findings = self.analysis.json(self.path) or (None, ())
                return FileContext(self.source, findings)
            case FileKind.INTERFACE:
                return FileContext(self.source, self._interface_findings())
            case FileKind.MOCKS:
                return FileContext(self.source, self._mock_findings())
            case FileKind.CONFIGURATION:
                return FileContext(self.source, self._configuration_findings())
        document = self.analysis.document(self.path)
        assert document is not None
        grammar = self._grammar()
        violations = () if grammar is None else self.analysis.violations(self.path, grammar)
        lone = self.kind is FileKind.TREE and self.system_path is None
        return FileContext(self.source, document.findings, document, grammar, violations, self._older(), lone)

    def _interface_findings(self) -> tuple[Finding, ...]:
        name, _, extension = self.path.replace("\\", "/").rpartition("/")[2].rpartition(".")
        kind: Kind = "msg" if extension == "msg" else "srv" if extension == "srv" else "action"
        package = self.path.replace("\\", "/").split("/")[-3:-2]
        definition, findings = parse_interface(self.source.text, package[0] if package else "package", name, kind)
        return (*findings, *self._misspelled_fields(definition, findings))

    def _misspelled_fields(self, definition: Definition, findings: tuple[Finding, ...]) -> Iterator[Finding]:
        """The types of fields that do not exist in a known package, or whose package resembles a known one. Other
        unknown packages may be in folders that are not searched; the machines that use their types report them."""
        known = {finding.span for finding in findings}
        for section in definition.sections:
            for field in section.fields:
                if field.type.is_primitive or field.type_span in known:
                    continue
                problem = self.analysis.registry.resolve("msg", field.type.name)
                if isinstance(problem, NotFound) and (problem.meant or problem.reason is Reason.UNKNOWN_TYPE):
                    fixes = replacements(field.type_span, problem.meant)
                    yield Finding(INTERFACE_SYNTAX, field.type_span, problem.message, None, tuple(fixes))

    def _mock_findings(self) -> tuple[Finding, ...]:
        from roaml.project.mock_findings import mock_findings  # noqa: PLC0415 - few projects have mocks

        return tuple(mock_findings(self.analysis, self.source))

    def _configuration_findings(self) -> tuple[Finding, ...]:
        configuration = self.analysis.configuration(self.path)
        return (*configuration.findings, *missing_folders(configuration)) if configuration else ()

    def _grammar(self) -> Grammar | None:
        if self.kind is FileKind.MACHINE:
            if self.analysis.machine(self.path) is None:
                return None
            return PLAIN_SCXML if self._dialect() in (Dialect.PLAIN, Dialect.FOREIGN) else HL_SCXML
        return GRAMMARS.get(self.kind)

    def _older(self) -> bool:
        if self.kind is FileKind.MACHINE and self.analysis.machine(self.path) is not None:
            return self._dialect() is Dialect.OLDER
        if self.kind is FileKind.SYSTEM:
            file = self.analysis.system_file(self.path)
            return file is not None and file.older
        return self.system is not None and self.system.older

    def _dialect(self) -> Dialect:
        machine, document = self.analysis.machine(self.path), self.analysis.document(self.path)
        assert machine is not None
        assert document is not None
        return dialect_of(machine, document, self.system.older if self.system else None)

    def _machine_checks(self) -> list[Check]:
        context = self.machine_context()
        return [] if context is None else machine_checks(context)

    def machine_context(self) -> MachineContext | None:
        """The context of the rules about machines; `None` if the file is not a machine."""
        machine, document = self.analysis.machine(self.path), self.analysis.document(self.path)
        if machine is None or document is None:
            return None
        structs = self.analysis.structs(self.system_path)
        listed = self.analysis.listed(self.system_path) if self.system_path else ()
        events = self.system.event_data if self.system else {}
        return MachineContext(
            self.source,
            document,
            machine,
            self.analysis.typed_in(self.path, self.system_path),
            self._dialect(),
            self.system,
            self.system.automata_of(self.path) if self.system else (),
            frozenset(f.input.section for f in listed if f.path == self.path),
            structs.types.get,
            tuple(structs.types),
            structs.complete,
            self.analysis.interface,
            events.get,
            self._machine_gaps(machine),
            self.analysis.repeated_types(machine),
            self.analysis.local_values(self.path, self.system_path),
            self.analysis.values_in(self.path, self.system_path),
        )

    def _machine_gaps(self, machine: Machine) -> tuple[PlacedGap, ...]:
        automata = self.system.automata_of(self.path) if self.system else ()
        if not any(automaton.outline.gaps for automaton in automata):
            return ()
        return self.analysis.machine_gaps(self.path, machine, self.analysis.typed_in(self.path, self.system_path))

    def _gaps(self) -> tuple[PlacedGap, ...]:
        """The gaps of the system that are caused by this file."""
        gaps = self.analysis.gaps(self.system_path) if self.system_path else ()
        return tuple(placed for path, placed in gaps if path == self.path)

    def _tree_context(self) -> TreeContext | None:
        file, document = self.analysis.tree(self.path), self.analysis.document(self.path)
        if file is None or document is None:
            return None
        older = self.system is not None and self.system.older
        outlines = self._tree_outlines()
        missing, interface = self._missing_includes(), self.analysis.interface
        trees = self.analysis.forest(self.path, self.system_path)
        return TreeContext(
            *(self.source, document, file, self.system, outlines, missing, interface, self._gaps(), older, trees),
            self._unknown_packages(),
            self._refusals(),
            self._found_includes(),
        )

    def _refusals(self) -> tuple[UntranslatablePart, ...]:
        """The nodes of this file that cannot be translated, with the reasons, if the tree is executed as
        BehaviorTree.CPP executes it. Reasons that other rules report are left out."""
        tree = self.analysis.library_tree(self.system_path) if self.system_path else None
        refusals = () if tree is None else tree.refusals
        own = (refusal for refusal in refusals if refusal.origin.path == self.path and not refusal.is_reported)
        return tuple(UntranslatablePart(refusal.origin.span, refusal.reason, refusal.unset) for refusal in own)

    def _tree_outlines(self) -> tuple[TreeFileOutline, ...]:
        """The outlines of the tree files with which this file is checked: those of its system; without a system, those
        that it includes or that include it."""
        if self.system_path:
            return self.analysis.tree_outlines(self.system_path)
        return self.analysis.outlines_around(self.path)

    def _unknown_packages(self) -> frozenset[str]:
        """The names of the ROS packages in `<include>` elements that are not found."""
        file = self.analysis.tree(self.path)
        return frozenset(
            include.package.value
            for include in (file.includes if file else ())
            if include.package is not None and self.analysis.include_path(self.path, include) is None
        )

    def _missing_includes(self) -> dict[str, str]:
        """Path in an `<include>` that cannot be used -> the reason."""
        file = self.analysis.tree(self.path)
        problems: dict[str, str] = {}
        for include in file.includes if file else ():
            target = self.analysis.include_path(self.path, include)
            if include.path is None:
                continue
            if target is None:
                if self.system_path and include.package is not None:
                    problems[include.path.value] = (
                        f"no folder around this file contains the ROS package `{include.package.value}`"
                    )
                continue
            source = self.analysis.files.read(target)
            named = self.analysis.named_path(self.path, include)
            if self.system_path and named is not None and target != named:
                problems[include.path.value] = UnreadableReason.MISSING.value
            elif isinstance(source, UnreadableReason):
                problems[include.path.value] = self._missing(source, include)
            elif self.analysis.tree(target) is None:
                problems[include.path.value] = "it is not a file of behavior trees"
            elif self.path in self.analysis.trees_from(target) and not self.path.endswith(PROJECT_EXTENSION):
                problems[include.path.value] = (
                    "it includes this file itself" if target != self.path else "it is this file"
                )
        return problems

    def _missing(self, reason: UnreadableReason, include: Include) -> str:
        """Why a file cannot be included, with the other places where it was looked for."""
        places = self.analysis.include_places(self.path, include)
        if reason is not UnreadableReason.MISSING or not places or self.system_path:
            return reason.value
        folder = os.path.dirname(self.path)
        shown = ", ".join(f"`{slashed(os.path.relpath(place, folder))}`" for place in places)
        return f"{reason.value}, nor {shown} relative to this file"

    def _found_includes(self) -> dict[str, str]:
        """Path in an `<include>` that names no file -> the path, relative to this file, of the file that is read
        instead."""
        file = self.analysis.tree(self.path)
        found: dict[str, str] = {}
        for include in file.includes if file and not self.system_path else ():
            target = self.analysis.include_path(self.path, include)
            is_named = target is None or target == self.analysis.named_path(self.path, include)
            if include.path is not None and target is not None and not is_named:
                found[include.path.value] = slashed(os.path.relpath(target, os.path.dirname(self.path)))
        return found

    def _system_context(self) -> SystemContext | None:
        file, document = self.analysis.system_file(self.path), self.analysis.document(self.path)
        system = self.analysis.system(self.path)
        if file is None or document is None or system is None:
            return None
        size = size_of_translation(self.analysis, self.path)
        assert size is not None
        files, gaps = self.analysis.listed(self.path), self._gaps()
        interface = self.analysis.interface
        return SystemContext(self.source, document, file, files, system, interface, gaps, size, self.limits)

    def _structs_context(self) -> StructsContext:
        declarations = self.analysis.struct_declarations(self.path)
        structs = self.analysis.structs(self.system_path)
        if structs is NO_STRUCTS:
            own = tuple(outline for d in declarations if (outline := d.outline) is not None)
            return StructsContext(self.source, declarations, own, len(own) == len(declarations))
        return StructsContext(self.source, declarations, structs.outlines, structs.complete)

    def _properties_context(self) -> PropertiesContext | None:
        json = self.analysis.json(self.path)
        if json is None:
            return None
        properties, _ = self.analysis.properties(self.path)
        variables = self.analysis.globals(self.system_path) if self.system_path else None
        taken = dict(self.analysis.names_before(self.path, self.system_path)) if self.system_path else {}
        return PropertiesContext(self.source, json[0], properties, self.system, variables, taken)


def file_checks(context: FileContext) -> list[Check]:
    """The checks of the rules about files of any kind."""
    return [(rule, functools.partial(rule.file, context)) for rule in RULES if rule.file]


def machine_checks(context: MachineContext) -> list[Check]:
    """The checks of the rules about machines that apply to the dialect of the machine."""
    plain = context.dialect in (Dialect.PLAIN, Dialect.FOREIGN)
    return [(r, functools.partial(r.machine, context)) for r in RULES if r.machine and (r.plain or not plain)]


def found(path: str, checks: Iterable[Check], memo: Memo) -> tuple[Finding, ...]:
    """The findings of checks in the file `path`."""
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
            _log_exception("rule %s failed on %s", rule.code, path)
            yield internal_error(f"the rule `{rule.code}`", error)


def _log_exception(message: str, *arguments: object) -> None:
    """Log the exception that is handled."""
    import logging  # noqa: PLC0415 - imports `traceback` and `string`, and only internal errors are logged

    logging.getLogger(__name__).exception(message, *arguments)


def internal_error(subject: str, error: Exception) -> Finding:
    """The finding that `error` was raised by `subject`, a phrase such as ``the rule `x` ``."""
    message = (
        f"{subject} failed ({type(error).__name__}: {error}): this is an internal error of the tool; please report it"
    )
    return internal_error_rule.RULE.at(Span(0, 0), message)
