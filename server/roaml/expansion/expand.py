# SPDX-License-Identifier: Apache-2.0
"""Expands the files of a system (docs/spec/parameters.md#expansion)."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from roaml.diagnostics import Finding, Fix, Severity, Symbol, Tag
from roaml.distributions import calls_distribution
from roaml.expansion.declarations import (
    PARAM,
    PARAMETER,
    SECTIONS,
    SETTING,
    Declared,
    Given,
    declaration_elements,
    declarations,
    values,
)
from roaml.expansion.instances import (
    REMAP,
    ListedInstance,
    Remap,
    in_tree,
    instance_edits,
    instances,
    removed,
    removed_attribute,
    report_unused,
)
from roaml.expansion.namespaces import report_inconsistent, report_repeated
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.text import CopiedText, ExpandedText, edited_again, expanded_text
from roaml.expansion.uses import VARIABLE, ParameterUses, uses_in
from roaml.expansion.values import ParameterValue, Scope
from roaml.expr.types import ScalarKind
from roaml.jani.properties import Property, identifiers
from roaml.language import SYSTEM
from roaml.model.kinds import GRAMMARS, FileKind
from roaml.model.syntax import Name
from roaml.model.system_file import TREE_ATTRIBUTE, SystemSection
from roaml.record import Record, field
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.scxml.names import sanitise
from roaml.suggest import close_names, did_you_mean, listing
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Attribute, Document, Element, parse

if TYPE_CHECKING:
    from roaml.expansion.draws import DrawnNumber
    from roaml.model.ros import InterfaceType

_STRING = ScalarKind.STRING
_LITERAL = regex(r"(?:-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][-+]?\d+)?|true|false)\Z")
"""A number or boolean in JSON."""
CHANNELS = "channels"
"""The name of the section of a system file that declares channels."""


class UserFiles(Protocol):
    """The files of the user."""

    def document(self, path: str) -> Document | None:
        """The XML document in a file; `None` if it cannot be read."""

    def text(self, path: str) -> str | None:
        """The text of a file; `None` if it cannot be read."""

    def kind(self, path: str) -> FileKind:
        """The kind of a file."""

    def properties(self, path: str) -> tuple[Property, ...]:
        """The properties in a file of JANI properties."""

    def interface(self, kind: str, name: str) -> InterfaceType | None:
        """A ROS type of the kind msg, srv or action; `None` if it cannot be read."""


class NamedPlace(Record, frozen=True):
    """A place that defines or uses the name of a parameter or instance."""

    symbol: Symbol
    span: Span
    defines: bool


class SystemExpansion(Record, frozen=True, eq=False):
    """An expanded system.

    Attributes:
        texts: path -> expanded text, for each file that the expansion changes; several for a file with instances.
        variants: path of a file of the user -> the paths under which it is analysed; only for files in `texts`.
        parameters: the parameters of the system with their values.
        declared: the declarations of the parameters of the system.
        settable: the names that values can be given for: those of the parameters of the system, and
            `INSTANCE.PARAMETER` for those of instances.
        findings: path of a file of the user -> the problems of its parameters and instances.
        names: path of a file of the user -> the names of parameters and instances in it.
        renamed: path of a file of the user -> the names of interfaces and events in it, as written, that its instances
            call otherwise.
        of_instances: `INSTANCE.PARAMETER` -> the text of a value that was given from outside.
        drawn: the numbers that machines and channels draw from distributions.
        data: the paths and texts of the files with data for these; `None` for a file that cannot be read.
        channels: the paths of the texts that are machines of channels, which no file of the user contains, each with
            the name of the automaton and the place of the `<channel>` in the system file.
        delivered: the symbol of each name from which a machine receives through a channel -> the symbols of the topic
            or service and of the machine, whose names are its begin and its end.
        namespaces: path under which a machine is analysed -> its namespace, without `/` at its ends; only for those
            that are in one.
    """

    system: str
    texts: Mapping[str, ExpandedText]
    variants: Mapping[str, tuple[str, ...]]
    parameters: Scope
    declared: tuple[Declared, ...]
    settable: frozenset[str]
    findings: Mapping[str, tuple[Finding, ...]] = field(default_factory=dict)
    names: Mapping[str, tuple[NamedPlace, ...]] = field(default_factory=dict)
    renamed: Mapping[str, frozenset[str]] = field(default_factory=dict)
    of_instances: Mapping[str, str] = field(default_factory=dict)
    drawn: tuple[DrawnNumber, ...] = ()
    data: tuple[tuple[str, str | None], ...] = ()
    channels: Mapping[str, tuple[str, Span]] = field(default_factory=dict)
    delivered: Mapping[Symbol, tuple[Symbol, Symbol]] = field(default_factory=dict)
    namespaces: Mapping[str, str] = field(default_factory=dict)

    def source(self, path: str) -> str:
        """The path of the file of the user that is analysed under `path`."""
        return self.texts[path].source if path in self.texts else path

    def known_in(self, path: str) -> frozenset[str]:
        """The names of the parameters that a file can use."""
        return frozenset(self.parameters) | frozenset(
            place.symbol.name for place in self.names.get(path, ()) if place.defines and place.symbol.path == path
        )

    def paths(self, source: str) -> tuple[str, ...]:
        """The paths under which a file of the user is analysed."""
        return self.variants.get(source, (source,))


def needs_expansion(system: Document, texts: Iterator[str]) -> bool:
    """Whether a system uses parameters, instances, channels or distributions.

    Args:
        system: the system file.
        texts: the texts of the other files of the system.
    """
    if next(declaration_elements(system), None) is not None or "$(var" in system.text or has_channels(system):
        return True
    if any(not instance.is_plain for instance in instances(system, Problems())):
        return True
    return any(f"<{PARAMETER}" in text or "$(var" in text or calls_distribution(text) for text in texts)


def has_channels(system: Document) -> bool:
    """Whether a system file declares channels."""
    return next(_channel_sections(system), None) is not None


def _channel_sections(system: Document) -> Iterator[Element]:
    return (child for child in (system.root.elements if system.root else ()) if child.name == CHANNELS)


def expand_file(
    path: str, sources: UserFiles, resolve: Callable[[str, str], str], *, varied: bool = False
) -> SystemExpansion:
    """Expand a file that is not in a system: its parameters have their own values. For `resolve` and `varied`, see
    `expand`."""
    return _Expander("", (path,), sources, (), resolve, varied=varied).of_file(path)


def expand(
    path: str,
    others: tuple[str, ...],
    sources: UserFiles,
    given: tuple[tuple[str, str], ...],
    resolve: Callable[[str, str], str],
    *,
    varied: bool = False,
) -> SystemExpansion:
    """Expand a system.

    Args:
        path: the system file.
        others: the paths of all other files of the system.
        given: names and texts of values that replace those in the files; the last one of equal names is used.
        resolve: returns the path that a file names: (path of the file, text).
        varied: whether the parameters have other values than the given ones, which they could have as well.
    """
    return _Expander(path, others, sources, given, resolve, varied=varied).expansion()


class _Expander:
    def __init__(
        self,
        path: str,
        others: tuple[str, ...],
        sources: UserFiles,
        given: tuple[tuple[str, str], ...],
        resolve: Callable[[str, str], str],
        *,
        varied: bool,
    ) -> None:
        self.path = path
        self.others = others
        self.sources = sources
        self.given = dict(given)
        self.resolve = resolve
        self.varied = varied
        self.problems: dict[str, Problems] = {}
        self.texts: dict[str, ExpandedText] = {}
        self.used: set[str] = set()
        self.settable: set[str] = set()
        self.taken = {path, *others}
        self.has_instances = False
        self.names: dict[str, dict[NamedPlace, None]] = {}
        self.renamed: dict[str, set[str]] = {}
        self.of_instances: dict[str, str] = {}
        self.drawn: dict[DrawnNumber, None] = {}
        self.remapped: set[Remap] = set()
        self.set_by_trees: set[Name] = set()
        self.plugin_parameters: dict[str, str] = {}
        """The name of a parameter of plugins -> the path of a plugin that declares it."""
        self.data: dict[str, str | None] = {}
        self.machines: dict[str, str] = {}
        """The path of each machine -> the path of its file."""
        self.channels: dict[str, tuple[str, Span]] = {}
        self.delivered: dict[Symbol, tuple[Symbol, Symbol]] = {}
        self.namespaces: dict[str, str] = {}
        self.declared: tuple[Declared, ...] = ()

    def problems_of(self, path: str) -> Problems:
        return self.problems.setdefault(path, Problems())

    def note(self, path: str, owner: str, name: str, span: Span, *, defines: bool = False) -> None:
        """Record a use of a parameter in the file `path`. `owner` is the file that declares it."""
        place = NamedPlace(Symbol(owner, SymbolKind.MODEL_PARAMETER, name), span, defines)
        self.names.setdefault(path, {})[place] = None

    def note_declarations(self, path: str, document: Document, declared: tuple[Declared, ...], scope: Scope) -> None:
        own = {parameter.name.value for parameter in declared}
        for parameter in declared:
            self.note(path, path, parameter.name.value, parameter.name.span, defines=True)
            for attribute in (parameter.value, parameter.least, parameter.most):
                if attribute is not None and parameter.type != "string":
                    for use in uses_in(document, attribute, {*scope, *own}):
                        self.note(path, path if use.name in own else self.path, use.name, use.span)
                        self.used.add(use.name)

    def of_file(self, path: str) -> SystemExpansion:
        self._expand_listed(path, path, None, {})
        self._expand_draws()
        return self._result({}, ())

    def expansion(self) -> SystemExpansion:
        document = self.sources.document(self.path)
        assert document is not None
        problems = self.problems_of(self.path)
        declared = self.declared = declarations(document, problems)
        given = {name: Given(text, None, SETTING) for name, text in self.given.items() if "." not in name}
        scope = values(declared, given, {}, problems, varied=self.varied)
        self.settable |= {parameter.name.value for parameter in declared}
        self.note_declarations(self.path, document, declared, scope)
        listed = list(instances(document, problems))
        report_repeated(listed, problems)
        report_inconsistent(listed, problems)
        edits = list(self._system_edits(document, scope))
        count: dict[str, int] = {}
        for instance in listed:
            target = self.resolve(self.path, instance.src.value)
            count[target] = count.get(target, 0) + 1
        trees = [instance for instance in listed if instance.is_tree]
        seen: set[str] = set()
        for instance in listed:
            target = self.resolve(self.path, instance.src.value)
            if instance.is_tree:
                edits += self._plain_input(document, instance)
                self._note_tree(instance.name, instance, defines=True)
                continue
            for tree in trees:
                if instance.tree is not None and _named(tree) == instance.tree.value:
                    self._note_tree(instance.tree, tree, defines=False)
            seen.add(target)
            if instance.is_plugin and any(tree.changes_files for tree in trees):
                edits += self._plugin(document, instance, target, trees, scope, is_again=count[target] > 1)
                continue
            if instance.name is not None:
                symbol = Symbol(target, SymbolKind.MACHINE, instance.name.value)
                self.names.setdefault(self.path, {})[NamedPlace(symbol, instance.name.span, True)] = None
            new = target
            if count[target] > 1 and (instance.name is not None or instance.params):
                new = self._fresh(target, instance)
            self._expand_listed(target, new, instance, scope)
            if new != target:
                edits.append(TextEdit(instance.src.value_span, _relative(new, instance.src.value)))
            edits += self._plain_input(document, instance)
        executing = self._trees_of_files(trees)
        for other in self.others:
            if other not in seen:
                self._expand_listed(other, other, None, scope, executing.get(other, ()))
        self._report_trees(trees, problems)
        edits += self._expand_channels(document, scope)
        self._expand_draws()
        self._report_unused(declared, problems)
        if edits:
            self.texts[self.path] = expanded_text(self.path, self.path, document.text, edits)
        return self._result(scope, declared)

    def _plugin(
        self,
        document: Document,
        plugin: ListedInstance,
        target: str,
        trees: list[ListedInstance],
        scope: Scope,
        *,
        is_again: bool,
    ) -> Iterator[TextEdit]:
        """Expand a plugin for each tree to which it belongs. The input is replaced by one for each of them. `is_again`
        tells whether the system lists the file several times."""
        owners = [tree for tree in trees if plugin.tree is None or _named(tree) == plugin.tree.value]
        source = self.sources.document(target) if self.sources.kind(target) is FileKind.MACHINE else None
        own = {p.name.value for p in declarations(source, Problems())} if source is not None else set()
        inputs = []
        for tree in owners or [plugin]:
            instance = in_tree(plugin, tree, own) if tree is not plugin else plugin
            is_copied = len(owners) > 1 or (is_again and bool(owners))
            new = self._fresh(target, instance) if is_copied and instance.changes_files else target
            self._expand_listed(target, new, instance, scope)
            inputs.append((_relative(new, plugin.src.value), _named(tree)))
            self.set_by_trees |= {name for name, _ in tree.params if name.value in own}
            self.plugin_parameters |= dict.fromkeys(own, target)
        if len(owners) < 2:
            if inputs[0][0] != plugin.src.value:
                yield TextEdit(plugin.src.value_span, inputs[0][0])
            yield from self._plain_input(document, plugin)
            return
        type_ = plugin.element.get("type")
        kind = f'type="{type_.value}" ' if type_ is not None else ""
        texts = (f'<input {kind}src="{src}" {TREE_ATTRIBUTE}="{tree}" />' for src, tree in inputs)
        yield TextEdit(plugin.element.span, "\n        ".join(texts))

    def _note_tree(self, name: Name | None, tree: ListedInstance, *, defines: bool) -> None:
        """Record a place with the name of a tree."""
        if name is not None:
            symbol = Symbol(self.resolve(self.path, tree.src.value), SymbolKind.MACHINE, name.value)
            self.names.setdefault(self.path, {})[NamedPlace(symbol, name.span, defines)] = None

    def _report_trees(self, trees: list[ListedInstance], problems: Problems) -> None:
        """Report the values and the remaps of trees that have no effect on their plugins, and that AS2FM executes only
        one tree."""
        for tree in trees:
            for name, _ in tree.params:
                if name not in self.set_by_trees:
                    message = f"no plugin of this tree has a parameter `{name.value}`, and none of its files uses it"
                    problems.add(ExpansionProblem.UNKNOWN, name.span, message)
            report_unused(tree.remaps, self.remapped, problems)
        if len(trees) > 1:
            message = "AS2FM executes only one tree, so it cannot read this system"
            place = trees[1].element.name_span
            problems.add(ExpansionProblem.REFERENCE, place, message, severity=Severity.INFORMATION)

    def _result(self, scope: Scope, declared: tuple[Declared, ...]) -> SystemExpansion:
        variants: dict[str, list[str]] = {}
        for path, text in self.texts.items():
            if path not in self.channels:
                variants.setdefault(text.source, []).append(path)
        findings = {path: found.findings for path, found in self.problems.items() if found.findings}
        names = {path: tuple(places) for path, places in self.names.items()}
        return SystemExpansion(
            self.path,
            self.texts,
            {source: tuple(paths) for source, paths in variants.items()},
            scope,
            declared,
            frozenset(self.settable),
            findings,
            names,
            {path: frozenset(renamed) for path, renamed in self.renamed.items() if renamed},
            self.of_instances,
            tuple(self.drawn),
            tuple(self.data.items()),
            self.channels,
            self.delivered,
            self.namespaces,
        )

    def _fresh(self, target: str, instance: ListedInstance) -> str:
        """A path for the text of an instance, beside its file, that no file has."""
        file = target[max(target.rfind("/"), target.rfind("\\")) + 1 :]
        stem, _, extension = file.rpartition(".")
        name = instance.name.value if instance.name else f"{stem}_2"
        if instance.is_plugin and instance.tree is not None:
            name = f"{instance.tree.value}_{stem}"
        return self._fresh_beside(target, name, extension)

    def _fresh_beside(self, target: str, name: str, extension: str) -> str:
        """A path beside the file `target` that no file has."""
        folder = target[: max(target.rfind("/"), target.rfind("\\")) + 1]
        dot = "." if extension else ""
        number = 2
        new = f"{folder}{name}{dot}{extension}"
        while new in self.taken or self.sources.text(new) is not None:
            new = f"{folder}{name}_{number}{dot}{extension}"
            number += 1
        self.taken.add(new)
        return new

    # --------------------------------------------------------- the system file

    def _system_edits(self, document: Document, scope: Scope) -> Iterator[TextEdit]:
        uses = ParameterUses(document, SYSTEM, scope, self.problems_of(self.path), frozenset())
        for use in uses.uses:
            self.used.add(use.name)
            self.note(self.path, self.path, use.name, use.span)
        yield from uses.edits
        for element in declaration_elements(document):
            yield removed(document, element)
        for section in document.root.elements if document.root else ():
            if section.name in (SECTIONS[0], CHANNELS):
                yield removed(document, section)
        self._reference(document)

    def _reference(self, document: Document) -> None:
        """Report the parts that AS2FM ignores or rejects, once each."""
        ending = "`as2fm-lsp translate --expand DIR` writes the system without parameters and instances"
        for section in document.root.elements if document.root else ():
            element = next(iter(section.elements if section.name in SECTIONS[1:] else ()), None)
            for element in section.elements if section.name in SECTIONS[1:] else ():
                if element.name == PARAMETER:
                    message = f"AS2FM rejects `<{PARAMETER}>` in `<{section.name}>`; {ending}"
                    self.problems_of(self.path).add(
                        ExpansionProblem.REFERENCE, element.name_span, message, severity=Severity.INFORMATION
                    )
                    return
            if section.name in (SECTIONS[0], PARAMETER):
                message = f"AS2FM ignores `<{section.name}>`, so it cannot read what uses the parameters; {ending}"
                self.problems_of(self.path).add(
                    ExpansionProblem.REFERENCE, section.name_span, message, severity=Severity.INFORMATION
                )
                return

    # --------------------------------------------------------------- channels

    def _expand_channels(self, document: Document, scope: Scope) -> Iterator[TextEdit]:
        """Put the channels of the system between its machines. The edits list their machines in the system file."""
        sections = list(_channel_sections(document))
        if not sections:
            return
        # Few systems have channels.
        from roaml.expansion.channel_links import ListedMachine, declares, link  # noqa: PLC0415
        from roaml.expansion.channels import delay_uses, read_channels, tick_periods  # noqa: PLC0415

        problems = self.problems_of(self.path)
        message = (
            f"AS2FM ignores `<{CHANNELS}>`, so all messages arrive at once in it; `as2fm-lsp translate --expand DIR` "
            "writes a machine for each channel"
        )
        place = sections[0].name_span
        problems.add(ExpansionProblem.REFERENCE, place, message, severity=Severity.INFORMATION)
        for element in (child for section in sections for child in section.elements):
            for use in delay_uses(document, element, scope):
                self.used.add(use.name)
                self.note(self.path, self.path, use.name, use.span)
        texts = {path: text for path in self.machines if (text := self._text(path)) is not None}
        machines = [ListedMachine(path, parse(text.text)) for path, text in texts.items()]
        periods = tick_periods(document, (machine.document for machine in machines), scope)
        read = functools.partial(self._read_data, self.path)
        channels = read_channels(self.path, document, sections, scope, periods, problems, read)
        links = link(channels, machines, self.sources.interface, problems)
        written = [found for path in set(self.machines.values()) if (found := self.sources.document(path)) is not None]
        for channel in channels:
            if any(declares(machine, channel) for machine in written):
                self._note_interface(channel.kind.value, channel.name)
        for path, edits in links.edits.items():
            self.texts[path] = edited_again(texts[path], edits)
        for own in links.delivered:
            sent = self._interface(own.kind.value, own.sent)
            symbol = self._interface(own.kind.value, f"{own.sent}/to_{own.receiver}")
            self.delivered[symbol] = sent, Symbol(self.machines[own.path], SymbolKind.MACHINE, own.receiver)
        inputs = []
        for channel, name, content in links.machines:
            path = self._fresh_beside(self.path, name, "ascxml")
            self.channels[path] = (name, channel.element.span)
            values = tuple(TextEdit(attribute.value_span, value) for attribute, value in channel.values)
            whole = CopiedText(0, len(content), channel.element.span, is_exact=False)
            self.texts[path] = ExpandedText(path, self.path, content, values, (whole,))
            inputs.append(f'<input type="node-ascxml" src="{_relative(path, "")}" />')
        self.drawn.update((channel.drawn, None) for channel in channels if channel.drawn is not None)
        if inputs:
            yield _listed(document, inputs)

    def _note_interface(self, kind: str, name: Name) -> None:
        """Record the name of a topic or service in the system file."""
        slash = len(name.value) - len(name.value.removeprefix("/")) if kind == SymbolKind.TOPIC.value else 0
        span = Span(name.span.start + slash, name.span.end)
        self.names.setdefault(self.path, {})[NamedPlace(self._interface(kind, name.value), span, False)] = None

    def _interface(self, kind: str, name: str) -> Symbol:
        """The symbol of a topic or service."""
        if kind == SymbolKind.TOPIC.value:
            return Symbol(self.path, SymbolKind.TOPIC, sanitise(name))
        return Symbol(self.path, SymbolKind.SERVICE, name)

    def _plain_input(self, document: Document, instance: ListedInstance) -> Iterator[TextEdit]:
        """The edits that remove from an input what plain system files do not have."""
        element = instance.element
        if instance.is_plain:
            return
        first = next(iter(element.elements), None)
        place = first.name_span if first is not None else element.name_span
        for name in ("namespace",) if instance.is_tree else ("name", "namespace"):
            if (attribute := element.get(name)) is not None:
                place = attribute.name_span
                yield removed_attribute(document, attribute)
        extra = [child for child in element.elements if child.name in (PARAM, REMAP)]
        if extra and len(extra) == len(element.elements) and element.close_span is not None:
            yield TextEdit(Span(element.open_span.end - 1, element.span.end), " />")
        else:
            for child in extra:
                yield removed(document, child)
        if self.has_instances:
            return
        self.has_instances = True
        message = (
            "AS2FM ignores the name, the namespace, the parameters and the remaps of an input; "
            "`as2fm-lsp translate --expand DIR` writes a file for each instance"
        )
        self.problems_of(self.path).add(ExpansionProblem.REFERENCE, place, message, severity=Severity.INFORMATION)

    # ---------------------------------------------------------- the other files

    def _trees_of_files(self, trees: list[ListedInstance]) -> dict[str, list[ListedInstance]]:
        """The path of a file of trees -> the trees that a system executes with it: of one that sets values, all that
        list or include the file."""
        executing: dict[str, list[ListedInstance]] = {}
        for tree in trees if any(tree.params for tree in trees) else ():
            pending, known = [self.resolve(self.path, tree.src.value)], set[str]()
            while pending:
                path = pending.pop()
                document = self.sources.document(path) if path not in known and path in self.others else None
                known.add(path)
                if document is None or document.root is None:
                    continue
                executing.setdefault(path, []).append(tree)
                includes = (child.get("path") for child in document.root.elements if child.name == "include")
                pending += (self.resolve(path, name.value) for name in includes if name is not None)
        return executing

    def _values_of_trees(self, trees: Sequence[ListedInstance], scope: Scope) -> dict[str, ParameterValue]:
        """The values that a file of trees has from the trees that are executed with it: those of the first one that
        sets them."""
        given = [self._undeclared(tree, scope) for tree in trees]
        return {name: value for of_tree in reversed(given) for name, value in of_tree.items()}

    def _note_tree_value(
        self, source: str, name: str, trees: Sequence[ListedInstance], scope: Scope, uses: Sequence[Span]
    ) -> None:
        """Record the uses of a value of trees in the file of trees `source`. The file is one text, so that different
        values are a problem.

        Args:
            scope: the parameters of the system.
            uses: the places of the name in the file.
        """
        written = [param for tree in trees for param, _ in tree.params if param.value == name]
        self.set_by_trees |= set(written)
        owner = self.plugin_parameters.get(name) or self._owner(source, name)
        for param in written:
            self.note(self.path, owner, name, param.span, defines=owner == source)
        for span in uses:
            self.note(source, owner, name, span)
        values_ = [(_named(tree), self._undeclared(tree, scope).get(name) or scope.get(name)) for tree in trees]
        first, value = next((tree, value) for tree, value in values_ if value is not None)
        for tree, other in values_:
            if other is not None and other.text == value.text:
                continue
            shown = f"is {other.text}" if other is not None else "has no value"
            message = (
                f"`{name}` is {value.text} in the tree `{first}` and {shown} in the tree `{tree}`, but both execute "
                "this file, which is one text; list a copy of the file with other IDs for one of the trees, or use the "
                "parameter in a plugin, of which each tree has its own"
            )
            for span in uses:
                self.problems_of(source).add(ExpansionProblem.VALUE, span, message)
            return

    def _expand_listed(
        self,
        source: str,
        path: str,
        instance: ListedInstance | None,
        scope: Scope,
        trees: Sequence[ListedInstance] = (),
    ) -> None:
        """Expand a file. `trees` are the trees that are executed with a file of trees, if these set values."""
        kind = self.sources.kind(source)
        if kind is FileKind.PROPERTIES:
            self._expand_jani(source, path, instance, scope)
            return
        document = self.sources.document(source) if kind in GRAMMARS else None
        if document is None or document.root is None:
            return
        problems, system_problems = self.problems_of(source), self.problems_of(self.path)
        of_system = scope
        of_trees = self._values_of_trees(trees, scope)
        scope = {**scope, **of_trees}
        own = declarations(document, problems) if kind in (FileKind.MACHINE, FileKind.XML_PROPERTIES) else ()
        given = self._given(source, instance, own, scope, document, system_problems)
        # A value from the system file is reported there; the problems of defaults and of `--set` belong to the file.
        from_system = {n: g for n, g in given.items() if g.span is not None}
        own_values: dict[str, ParameterValue] = {}
        if from_system:
            values(tuple(p for p in own if p.name.value in from_system), from_system, scope, system_problems)
        own_values = values(own, given, scope, Problems() if from_system else problems, varied=self.varied)
        inner = {**{name: value for name, value in scope.items() if name not in own_values}, **own_values}
        uses = ParameterUses(document, GRAMMARS[kind], inner, problems, frozenset(own_values))
        names = {use.name for use in uses.uses} | uses.hidden
        self.used |= names - own_values.keys()
        for use in uses.uses:
            if use.name not in of_trees:
                self.note(source, source if use.name in own_values else self.path, use.name, use.span)
        for name in dict.fromkeys(use.name for use in uses.uses if use.name in of_trees):
            spans = [use.span for use in uses.uses if use.name == name]
            self._note_tree_value(source, name, trees, of_system, spans)
        self.note_declarations(source, document, own, scope)
        edits = list(uses.edits)
        edits += (removed(document, parameter.element) for parameter in own)
        for parameter in own:
            if parameter.name.value not in names and parameter.type and not self._uses_in_declarations(own, parameter):
                _unused(document, parameter, problems)
        if own:
            message = (
                "AS2FM ignores `<parameter>`, so it cannot read what uses the parameters; "
                "`as2fm-lsp translate --expand DIR` writes the file without them"
            )
            problems.add(ExpansionProblem.REFERENCE, own[0].element.name_span, message, severity=Severity.INFORMATION)
        if instance is not None and kind is FileKind.MACHINE:
            renamed = list(instance_edits(document, instance, self.remapped))
            own_remaps = (remap for remap in instance.remaps if remap.element in instance.element.elements)
            report_unused(own_remaps, self.remapped, system_problems)
            own_name = document.root.get("name")
            spans = [edit.span for edit in renamed if own_name is None or edit.span != own_name.value_span]
            names_in_file = (document.decoded(span).text.strip() for span in spans if span.start < span.end)
            self.renamed.setdefault(source, set()).update(names_in_file)
            edits = [*renamed, *edits]
        text = expanded_text(path, source, document.text, edits)
        if kind is FileKind.MACHINE:
            self.machines[path] = source
            if instance is not None and instance.namespace:
                self.namespaces[path] = instance.namespace
        if text.text != document.text or path != source:
            self.texts[path] = text

    def _text(self, path: str) -> ExpandedText | None:
        """The text of a machine, as it is expanded so far; `None` if it cannot be read."""
        source = self.machines[path]
        document = self.sources.document(source)
        if path in self.texts or document is None:
            return self.texts.get(path)
        return ExpandedText(path, source, document.text, ())

    def _expand_draws(self) -> None:
        """Expand the draws of all machines."""
        for path, source in self.machines.items():
            text = self._text(path)
            if text is not None and calls_distribution(text.text):
                drawn = self._with_draws(text, self.problems_of(source))
                if drawn is not text:
                    self.texts[path] = drawn

    def _with_draws(self, text: ExpandedText, problems: Problems) -> ExpandedText:
        from roaml.expansion.draws import expand_draws  # noqa: PLC0415 - few machines draw numbers

        text, numbers = expand_draws(text, problems, functools.partial(self._read_data, text.source))
        self.drawn.update(dict.fromkeys(numbers))
        if numbers:
            message = (
                "AS2FM has no distributions; `as2fm-lsp translate --expand DIR` writes targets with probabilities "
                "instead"
            )
            problems.add(ExpansionProblem.REFERENCE, numbers[0].span, message, severity=Severity.INFORMATION)
        return text

    def _read_data(self, base: str, name: str) -> str | None:
        """The text of a file with data that the file `base` names; `None` if it cannot be read."""
        path = self.resolve(base, name)
        self.data[path] = self.sources.text(path)
        return self.data[path]

    def _uses_in_declarations(self, own: tuple[Declared, ...], parameter: Declared) -> bool:
        name = parameter.name.value
        texts = (a.value for p in own for a in (p.value, p.least, p.most) if a is not None and p is not parameter)
        return any(name in text for text in texts)

    def _given(
        self,
        source: str,
        instance: ListedInstance | None,
        own: tuple[Declared, ...],
        scope: Scope,
        document: Document,
        problems: Problems,
    ) -> dict[str, Given]:
        """The values that the system gives for the parameters of a file, in increasing precedence: a parameter of the
        system with the same name, a `<param>`, and a value from outside."""
        known = {parameter.name.value: parameter for parameter in own}
        given: dict[str, Given] = {}
        for name in known:
            if name in scope:
                self.used.add(name)
                given[name] = Given(scope[name].text, None, f"the parameter `{name}` of the system")
        for param, value in instance.params if instance else ():
            if param.value not in known:
                close = close_names(param.value, known)
                src = instance.src.value if instance else ""
                declares = f"; it declares {listing(tuple(known))}" if known else "; it declares no parameters"
                message = f"`{src}` has no parameter `{param.value}`{did_you_mean(close) if close else declares}"
                problems.add(ExpansionProblem.UNKNOWN, param.span, message, close=close)
                continue
            self.note(self.path, source, param.value, param.span)
            given[param.value] = self._given_by_param(value, known[param.value].type, scope, problems)
        root = document.root
        machine = root.get("name") if root is not None else None
        name = instance.name.value if instance and instance.name else (machine.value.strip() if machine else "")
        for parameter in known:
            names = tuple(filter(None, (name, instance.tree.value if instance and instance.tree else "")))
            self.settable |= {f"{name}.{parameter}" for name in names}
            for key in (f"*.{parameter}", *(f"{name}.{parameter}" for name in names)):
                if key in self.given:
                    given[parameter] = Given(self.given[key], None, SETTING)
                    self.of_instances |= {f"{owner}.{parameter}": self.given[key] for owner in names[-1:]}
        return given

    def _given_by_param(self, value: Attribute, type_: str, scope: Scope, problems: Problems) -> Given:
        """The value that a `<param>` gives to a parameter of a type."""
        for match in VARIABLE.finditer(value.value):
            if match[1] not in scope:
                message = f"there is no parameter `{match[1]}`; declare it with `<parameter>`"
                problems.add(ExpansionProblem.UNKNOWN, value.value_span, message)
        text = VARIABLE.sub(lambda m: scope[m[1]].text if m[1] in scope else m[0], value.value)
        system = self.sources.document(self.path)
        assert system is not None
        if type_ != "string" or "$(var" in value.value:
            for use in uses_in(system, value, scope):
                self.used.add(use.name)
                self.note(self.path, self.path, use.name, use.span)
        return Given(text, value.value_span, "`<param>`")

    def _undeclared(self, instance: ListedInstance, scope: Scope) -> dict[str, ParameterValue]:
        """The values of the `<param>` of an input whose file cannot declare parameters: those of parameters of the
        system with these names, and texts. Those of trees can be given from outside."""
        problems, given = self.problems_of(self.path), dict[str, ParameterValue]()
        for param, value in instance.params:
            declared = [parameter for parameter in self.declared if parameter.name.value == param.value]
            type_ = declared[0].type if declared else "string"
            of_param = self._given_by_param(value, type_, scope, problems)
            if instance.is_tree and instance.name is not None:
                key = f"{instance.name.value}.{param.value}"
                self.settable.add(key)
                if key in self.given:
                    of_param = Given(self.given[key], None, SETTING)
                    self.of_instances |= {key: self.given[key]}
            if declared:
                given |= values(tuple(declared), {param.value: of_param}, scope, problems)
            else:
                given[param.value] = ParameterValue("string", of_param.text)
        return given

    def _expand_jani(self, source: str, path: str, instance: ListedInstance | None, scope: Scope) -> None:
        """Expand a file of properties in JANI, which uses the parameters of the system and the `<param>` of its
        input."""
        text = self.sources.text(source)
        if text is None:
            return
        problems = self.problems_of(source)
        edits: list[TextEdit] = []
        own = {} if instance is None else self._undeclared(instance, scope)
        scope = {**scope, **own}
        used: set[str] = set()
        for declared in self.sources.properties(source):
            for name, span in identifiers(declared.expression):
                value = scope.get(name)
                if value is not None and span.end > span.start:
                    used.add(name)
                    self.note(source, self._owner(source, name), name, span)
                    quoted = Span(span.start - 1, span.end + 1)
                    is_text = value.kind is _STRING and not (name in own and _LITERAL.match(value.text))
                    edits.append(TextEdit(quoted, json.dumps(value.content) if is_text else value.text))
        for match in VARIABLE.finditer(text):
            value = scope.get(match[1])
            if value is None:
                message = (
                    f"there is no parameter `{match[1]}`; declare it in the system file with `<parameter>`, or set it "
                    "with `<param>` in the input of this file"
                )
                problems.add(ExpansionProblem.UNKNOWN, Span(*match.span(1)), message)
            else:
                used.add(match[1])
                self.note(source, self._owner(source, match[1]), match[1], Span(*match.span(1)))
                edits.append(TextEdit(Span(*match.span()), value.text.replace("\\", "\\\\").replace('"', '\\"')))
        self.used |= used
        for param, _ in () if instance is None else instance.params:
            owner = self._owner(source, param.value)
            self.note(self.path, owner, param.value, param.span, defines=owner == source)
            if instance is not None and param.value not in used:
                message = f"`{instance.src.value}` does not use the parameter `{param.value}`; remove it"
                self.problems_of(self.path).add(ExpansionProblem.UNKNOWN, param.span, message)
        if edits or path != source:
            self.texts[path] = expanded_text(path, source, text, edits)

    def _owner(self, source: str, name: str) -> str:
        """The file to which a parameter belongs that the file `source` uses and cannot declare."""
        return self.path if any(parameter.name.value == name for parameter in self.declared) else source

    def _report_unused(self, declared: tuple[Declared, ...], problems: Problems) -> None:
        document = self.sources.document(self.path)
        assert document is not None
        for parameter in declared:
            name = parameter.name.value
            if name not in self.used and parameter.type and not self._uses_in_declarations(declared, parameter):
                _unused(document, parameter, problems)


def _unused(document: Document, parameter: Declared, problems: Problems) -> None:
    message = f"nothing uses the parameter `{parameter.name.value}`; remove it"
    fix = Fix(f"Remove the parameter `{parameter.name.value}`", (removed(document, parameter.element),))
    problems.add(ExpansionProblem.UNUSED, parameter.name.span, message, fixes=(fix,), tags=(Tag.UNNECESSARY,))


def _listed(document: Document, inputs: list[str]) -> TextEdit:
    """The edit that lists further machines in a system file."""
    root = document.root
    assert root is not None
    section = root.find(SystemSection.NODE_MODELS.value)
    lines = "".join(f"\n        {text}" for text in inputs)
    if section is None:
        end = root.open_span.end
        return TextEdit(Span(end, end), f"\n    <node_models>{lines}\n    </node_models>")
    if section.close_span is None:
        return TextEdit(section.span, f"<node_models>{lines}\n    </node_models>")
    end = section.elements[-1].span.end if section.elements else section.open_span.end
    return TextEdit(Span(end, end), lines)


def _named(tree: ListedInstance) -> str:
    return tree.name.value if tree.name is not None else ""


def _relative(path: str, written: str) -> str:
    """The text with which a system names a file that is beside the file that it names with `written`."""
    name = path[max(path.rfind("/"), path.rfind("\\")) + 1 :]
    return written[: max(written.rfind("/"), written.rfind("\\")) + 1] + name
