# SPDX-License-Identifier: Apache-2.0
"""What is known while a system is expanded."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable
from typing import TYPE_CHECKING, Protocol

from roaml.diagnostics import Fix, Severity, Symbol, Tag
from roaml.expansion.declarations import Declared
from roaml.expansion.instances import ListedInstance, Remap, removed
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.result import NamedPlace, SystemExpansion
from roaml.expansion.text import ExpandedText
from roaml.expansion.uses import ParameterUse, uses_in
from roaml.expansion.values import Scope
from roaml.jani.properties import Property
from roaml.model.kinds import FileKind
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.text import Span
from roaml.xml_syntax import Document

if TYPE_CHECKING:
    from roaml.expansion.draws import DrawnNumber
    from roaml.model.ros import InterfaceType


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


class ExpansionState:
    """What is known while the files of a system, or one file without a system, are expanded.

    Attributes:
        path: the system file; empty for a file without a system.
        others: the paths of all other files.
        given: the texts of values that replace those in the files.
        resolve: returns the path that a file names: (path of the file, text).
        varied: whether the parameters have other values than the given ones, which they could have as well.
        used: the names of parameters of the system that something uses.
        taken: the paths that new files cannot have.
        remapped: the remaps that have an effect.
        set_by_trees: the names of values of trees that something uses.
        plugin_parameters: the name of a parameter of plugins -> the path of a plugin that declares it.
        machines: the path of each machine -> the path of its file.

    The other attributes are those of `SystemExpansion`.
    """

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
        self.names: dict[str, dict[NamedPlace, None]] = {}
        self.renamed: dict[str, set[str]] = {}
        self.of_instances: dict[str, str] = {}
        self.drawn: dict[DrawnNumber, None] = {}
        self.remapped: set[Remap] = set()
        self.set_by_trees: set[Name] = set()
        self.plugin_parameters: dict[str, str] = {}
        self.data: dict[str, str | None] = {}
        self.machines: dict[str, str] = {}
        self.channels: dict[str, tuple[str, Span]] = {}
        self.delivered: dict[Symbol, tuple[Symbol, Symbol]] = {}
        self.namespaces: dict[str, str] = {}
        self.declared: tuple[Declared, ...] = ()

    @property
    def document(self) -> Document:
        """The system file."""
        document = self.sources.document(self.path)
        assert document is not None
        return document

    def target(self, instance: ListedInstance) -> str:
        """The path of the file that a system lists."""
        return self.resolve(self.path, instance.src.value)

    def problems_of(self, path: str) -> Problems:
        return self.problems.setdefault(path, Problems())

    def not_in_reference(self, path: str, span: Span, message: str) -> None:
        """Report a part of the file `path` that AS2FM ignores or rejects."""
        self.problems_of(path).add(ExpansionProblem.REFERENCE, span, message, severity=Severity.INFORMATION)

    def note_place(self, path: str, symbol: Symbol, span: Span, *, defines: bool) -> None:
        """Record a place in the file `path` that defines or uses a name."""
        self.names.setdefault(path, {})[NamedPlace(symbol, span, defines)] = None

    def note(self, path: str, owner: str, name: str, span: Span, *, defines: bool = False) -> None:
        """Record a use of a parameter in the file `path`. `owner` is the file that declares it."""
        self.note_place(path, Symbol(owner, SymbolKind.MODEL_PARAMETER, name), span, defines=defines)

    def note_system_uses(self, uses: Iterable[ParameterUse]) -> None:
        """Record uses of the parameters of the system in the system file."""
        for use in uses:
            self.used.add(use.name)
            self.note(self.path, self.path, use.name, use.span)

    def note_declarations(self, path: str, document: Document, declared: tuple[Declared, ...], scope: Scope) -> None:
        """Record the names in the declarations of parameters in the file `path`."""
        own = {parameter.name.value for parameter in declared}
        for parameter in declared:
            self.note(path, path, parameter.name.value, parameter.name.span, defines=True)
            for attribute in (parameter.value, parameter.least, parameter.most):
                if attribute is not None and parameter.type != "string":
                    for use in uses_in(document, attribute, {*scope, *own}):
                        self.note(path, path if use.name in own else self.path, use.name, use.span)
                        self.used.add(use.name)

    def fresh(self, target: str, instance: ListedInstance) -> str:
        """A path for the text of an instance, beside its file, that no file has."""
        file = target[max(target.rfind("/"), target.rfind("\\")) + 1 :]
        stem, _, extension = file.rpartition(".")
        name = instance.name.value if instance.name else f"{stem}_2"
        if instance.is_plugin and instance.tree is not None:
            name = f"{instance.tree.value}_{stem}"
        return self.fresh_beside(target, name, extension)

    def fresh_beside(self, target: str, name: str, extension: str) -> str:
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

    def expanded(self, path: str) -> ExpandedText | None:
        """The text of a machine, as it is expanded so far; `None` if it cannot be read."""
        source = self.machines[path]
        document = self.sources.document(source)
        if path in self.texts or document is None:
            return self.texts.get(path)
        return ExpandedText(path, source, document.text, ())

    def read_data(self, base: str, name: str) -> str | None:
        """The text of a file with data that the file `base` names; `None` if it cannot be read."""
        path = self.resolve(base, name)
        self.data[path] = self.sources.text(path)
        return self.data[path]

    def owner(self, source: str, name: str) -> str:
        """The file to which a parameter belongs that the file `source` uses and cannot declare."""
        return self.path if any(parameter.name.value == name for parameter in self.declared) else source

    def report_unused(
        self, path: str, document: Document, declared: tuple[Declared, ...], used: Container[str]
    ) -> None:
        """Report the parameters that the file `path` declares, and that are neither in `used` nor in other
        declarations."""
        for parameter in declared:
            name = parameter.name.value
            others = (p for p in declared if p is not parameter)
            texts = (a.value for p in others for a in (p.value, p.least, p.most) if a is not None)
            if name in used or not parameter.type or any(name in text for text in texts):
                continue
            message = f"nothing uses the parameter `{name}`; remove it"
            fix = Fix(f"Remove the parameter `{name}`", (removed(document, parameter.element),))
            tags = (Tag.UNNECESSARY,)
            self.problems_of(path).add(ExpansionProblem.UNUSED, parameter.name.span, message, fixes=(fix,), tags=tags)

    def result(self, scope: Scope) -> SystemExpansion:
        """The expansion, after which nothing is added."""
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
            self.declared,
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


def named(tree: ListedInstance) -> str:
    return tree.name.value if tree.name is not None else ""


def relative(path: str, written: str) -> str:
    """The text with which a system names a file that is beside the file that it names with `written`."""
    name = path[max(path.rfind("/"), path.rfind("\\")) + 1 :]
    return written[: max(written.rfind("/"), written.rfind("\\")) + 1] + name
