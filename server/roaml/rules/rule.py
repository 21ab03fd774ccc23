# SPDX-License-Identifier: Apache-2.0
"""The definition of a rule, and the contexts that it can access.

- A rule is a code, a default severity, one sentence, and a check for each kind of file that it supports. Its document
  is beside its module (`name.md`): the manual page, the text of `--explain` and the first test are generated from it.
- A check is a pure function from a context to findings. Everything in a context is immutable.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction

from roaml.diagnostics import Finding, Fix, Related, Severity, Tag
from roaml.expr.types import Struct, Type
from roaml.facts import Facts
from roaml.forest.forest import Forest
from roaml.interfaces.registry import NotFound
from roaml.jani.properties import Property
from roaml.json_syntax import JsonValue
from roaml.language import Grammar
from roaml.language.validate import Violation
from roaml.model.expand import TreeFileOutline
from roaml.model.gaps import PlacedGap
from roaml.model.globals import GlobalVariable
from roaml.model.machine import Dialect, Machine
from roaml.model.property_links import LinkedFile
from roaml.model.ros import InterfaceType, RepeatedType
from roaml.model.size import Limits, Size
from roaml.model.structs import StructDeclaration, StructOutline
from roaml.model.system import System, SystemAutomaton
from roaml.model.system_file import ListedFile, SystemFile, SystemSection
from roaml.model.tree import TreeFile, TreeNode
from roaml.model.value_types import TypedMachine
from roaml.model.values.analyse import NO_VALUES, MachineValues
from roaml.model.values.global_values import GlobalValues
from roaml.record import Record, field
from roaml.suggest import close_names as close_names  # noqa: PLC0414 - the rules import it from here
from roaml.suggest import did_you_mean as did_you_mean  # noqa: PLC0414
from roaml.suggest import listing as listing  # noqa: PLC0414
from roaml.text import SourceFile, Span, TextEdit
from roaml.xml_syntax import Document


class FileContext(Record, frozen=True):
    """The context of rules about any kind of file.

    Attributes:
        findings: the findings of the parsers.
        document: the XML tree; `None` if the file is not XML.
        grammar: the grammar of a supported kind of XML file, otherwise `None`.
        violations: the violations of `grammar` in the file.
        older: whether the file is checked in the older dialect.
        is_lone_tree: whether the file contains trees and belongs to no system, so that BehaviorTree.CPP executes it.
    """

    source: SourceFile
    findings: tuple[Finding, ...]
    document: Document | None = None
    grammar: Grammar | None = None
    violations: tuple[Violation, ...] = ()
    older: bool = False
    is_lone_tree: bool = False


class MachineContext(Record, frozen=True):
    """The context of rules about a machine.

    Attributes:
        system: the system that lists the machine; `None` if the machine is checked without a system.
        automata: the automata of the machine in `system`; empty without a system.
        listed_as: the sections of the system file that list the machine.
        struct: returns the type of a struct by its name; `None` if there is no struct with this name.
        struct_names: the names of the known structs.
        all_structs: whether the system has no other structs than those in `struct_names`.
        interface: returns a ROS type by its kind and its name as written.
        event_data: returns the type of the data of an event by its name; `None` if the type is unknown.
        gaps: the facts that unreadable parts of the machine may contain, with their places.
        repeated_types: the ROS types that the machine uses and that two files define differently.
        local_values: the values that variables, fields and conditions have if everything may arrive that the types
            allow. Only these justify a warning about a condition, because machines that represent the environment
            often answer in one way only.
        values: the values that they have with what the machines of the system send.
    """

    source: SourceFile
    document: Document
    machine: Machine
    typed: TypedMachine
    dialect: Dialect
    system: System | None
    automata: tuple[SystemAutomaton, ...]
    listed_as: frozenset[SystemSection]
    struct: Callable[[str], Type | None]
    struct_names: tuple[str, ...]
    all_structs: bool
    interface: Callable[[str, str], InterfaceType | NotFound]
    event_data: Callable[[str], Struct | None]
    gaps: tuple[PlacedGap, ...]
    repeated_types: tuple[RepeatedType, ...] = ()
    local_values: MachineValues = NO_VALUES
    values: MachineValues = NO_VALUES

    @property
    def older(self) -> bool:
        return self.dialect is Dialect.OLDER


class UntranslatablePart(Record, frozen=True):
    """Why a part of a system's tree cannot be translated. `unset` is the name of the entry that a script reads and
    nothing sets, if this is the reason."""

    span: Span
    reason: str
    unset: str = ""


class TreeContext(Record, frozen=True):
    """The context of rules about a file of trees.

    Attributes:
        files: the outlines of all tree files of the system, the executed file first.
        missing_includes: the paths in `<include>` that cannot be included -> the reasons.
        interface: returns a ROS type by its kind and its name as written.
        gaps: the facts that unreadable parts of this file may contain.
        trees: the trees that are checked together with this file, with the definitions of their nodes; `None` if the
            system of the file cannot be read.
        unknown_packages: the ROS packages of includes that no folder around the file contains.
        refusals: the places and reasons why nodes cannot be translated, for a tree that is executed as by
            BehaviorTree.CPP.
        found_includes: the paths in `<include>` that name no file -> the paths of the files that are read instead,
            relative to this file.
        mocked: the leaves of a file without a system that a mock can let succeed, each with the time, in ns, that it
            then takes.
        mock_patterns: what the mocks beside the files of a tree without a system name.
    """

    source: SourceFile
    document: Document
    file: TreeFile
    system: System | None
    files: tuple[TreeFileOutline, ...]
    missing_includes: Mapping[str, str]
    interface: Callable[[str, str], InterfaceType | NotFound]
    gaps: tuple[PlacedGap, ...]
    older: bool = False
    trees: Forest | None = None
    unknown_packages: frozenset[str] = frozenset()
    refusals: tuple[UntranslatablePart, ...] = ()
    found_includes: Mapping[str, str] = field(default_factory=dict)
    mocked: Mapping[TreeNode, Fraction] = field(default_factory=dict)
    mock_patterns: frozenset[str] = frozenset()

    @property
    def forest(self) -> Forest | None:
        """`trees`, if the file belongs to no system; otherwise `None`."""
        return None if self.trees is None or self.trees.system is not None else self.trees


class SystemContext(Record, frozen=True):
    """The context of rules about a system file.

    Attributes:
        files: the files that the system lists.
        interface: returns a ROS type by its kind and its name as written.
        gaps: the facts that unreadable parts of this file may contain.
        size: the size of the translation.
        limits: the maximum sizes.
        unlisted: the property files beside the system file, or beside those that it lists, that no system file in the
            folder lists; relative to the folder.
    """

    source: SourceFile
    document: Document
    file: SystemFile
    files: tuple[ListedFile, ...]
    system: System
    interface: Callable[[str, str], InterfaceType | NotFound]
    gaps: tuple[PlacedGap, ...]
    size: Size
    limits: Limits
    unlisted: tuple[str, ...] = ()


class StructsContext(Record, frozen=True):
    """The context of rules about a file of struct declarations, in XML or JSON.

    Attributes:
        declarations: the declarations in this file.
        outlines: the structs of the system.
        complete: whether the names of all structs are known.
    """

    source: SourceFile
    declarations: tuple[StructDeclaration, ...]
    outlines: tuple[StructOutline, ...]
    complete: bool


class PropertiesContext(Record, frozen=True):
    """The context of rules about a property file in JANI.

    Attributes:
        value: the content of the file.
        system: the system of the file; `None` if the file belongs to no system.
        variables: the global variables of the translated system, by name; `None` if the file belongs to no system.
        taken: the names of the properties in the files that the system lists before this file, each with a phrase that
            names its file.
        values: the values of the global variables for integers of interfaces, codes of results and statuses, by name.
    """

    source: SourceFile
    value: JsonValue
    properties: tuple[Property, ...]
    system: System | None
    variables: Mapping[str, GlobalVariable] | None
    taken: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, GlobalValues] = field(default_factory=dict)


class Rule(Record, frozen=True):
    """A rule: its code, its default severity, and a check for each kind of file that it supports.

    Attributes:
        code: a phrase for the problem, in kebab-case.
        summary: one sentence that states the problem.
        file, machine, tree, system, structs, properties, xml_properties: the checks for files of these kinds.
        plain: whether the machine check also applies to plain SCXML.
        whole: whether the machine check reports problems of a state that depend on what the other states contain, or on
            what the whole system does with the machine. `roaml.project.provisional` delays such a check. Findings in a
            state that do not depend on these come from this state, the declarations and the names of the states.
        facts: the type of the facts of the findings, for rules whose fixes read facts.
    """

    code: str
    severity: Severity
    summary: str
    file: Callable[[FileContext], Iterable[Finding]] | None = None
    machine: Callable[[MachineContext], Iterable[Finding]] | None = None
    tree: Callable[[TreeContext], Iterable[Finding]] | None = None
    system: Callable[[SystemContext], Iterable[Finding]] | None = None
    structs: Callable[[StructsContext], Iterable[Finding]] | None = None
    properties: Callable[[PropertiesContext], Iterable[Finding]] | None = None
    xml_properties: Callable[[LinkedFile], Iterable[Finding]] | None = None
    plain: bool = False
    whole: bool = False
    facts: type[Facts] | None = None

    def at(
        self,
        span: Span,
        message: str,
        *fixes: Fix,
        severity: Severity | None = None,
        related: Iterable[Related] = (),
        tags: tuple[Tag, ...] = (),
        facts: Facts | None = None,
    ) -> Finding:
        """A finding of this rule at `span`; the severity is the default of the rule unless `severity` is given."""
        assert facts is None or type(facts) is self.facts
        return Finding(self.code, span, message, severity, fixes, tuple(related), tags, facts)


def replacements(span: Span, close: Iterable[str]) -> Iterator[Fix]:
    """A fix for each name in `close` that replaces the text at `span` by the name; the first fix is preferred."""
    for number, name in enumerate(close):
        yield Fix(f"Change to `{name}`", (TextEdit(span, name),), preferred=number == 0)


def unused(name: str, names: Iterable[str]) -> str:
    """`name` with a number appended: the smallest number from 2 on for which the result is not in `names`."""
    taken = set(names)
    return next(new for number in itertools.count(2) if (new := f"{name}_{number}") not in taken)
