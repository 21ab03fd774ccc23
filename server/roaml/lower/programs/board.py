# SPDX-License-Identifier: Apache-2.0
"""The entries of the blackboard that a translated tree needs, with their types (docs/spec/mocks.md#blackboard).

An entry is needed if a script or a node of the libraries reads it. Other entries are left out, because they may have
any C++ type.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.forest.forest import port_type
from roaml.forest.scripts import grammar_of, parsed, script_attributes
from roaml.libraries.programs.assembly import NodeProgram
from roaml.libraries.scripts import is_condition
from roaml.libraries.version import CASES_WHOLE_SINCE, CONSTANTS_TYPED_SINCE, Version
from roaml.lower.programs.cases import number_in
from roaml.lower.programs.entries import BoardEntry, EntryKind, kind_of_cpp, read_literal
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree
from roaml.lower.programs.stored_texts import StoredTexts, set_entry, stored_texts
from roaml.record import Record, field
from roaml.roles import Direction
from roaml.script.infer import Type, type_of
from roaml.script.tree import Assignment, Comparison, Name, Number, Script, String, walk
from roaml.scxml.names import update_flag
from roaml.text import Decoded
from roaml.xml_syntax import Attribute

_NO_PORTS: frozenset[str] = frozenset()
_KIND = {Type.INTEGER: EntryKind.INTEGER, Type.REAL: EntryKind.REAL, Type.TEXT: EntryKind.TEXT}
_TYPE = {kind: type_ for type_, kind in _KIND.items()}


class Board(Record, frozen=True, eq=False):
    """The entries of the blackboard of a translated tree.

    An observer is a node that checks whether an entry was written. Its flag is an additional entry that stores this.

    Attributes:
        entries: name -> needed entry that is set by the tree or the user.
        flags: observed entry -> the flags of its observers.
        flag_of: number of an observer -> its flag.
        values: entry -> the values that mocks may write to it.
        texts: the entries of texts that constants of `SetBlackboard` set.
        read: the names of the entries that programs and scripts read.
        written: the names of the entries that nodes and scripts write.
        assigned: the names of the entries that scripts and `SetBlackboard` write.
        computed: the names of the entries that scripts compute from entries, such as counters, or that the programs of
            nodes write, such as the elements of loops.
        in_system: whether the tree is part of a system.
        version: the version of BehaviorTree.CPP that executes the tree.
    """

    entries: Mapping[str, BoardEntry]
    flags: Mapping[str, tuple[BoardEntry, ...]]
    flag_of: Mapping[int, BoardEntry]
    values: Mapping[str, tuple[int | float | str, ...]]
    texts: StoredTexts
    read: frozenset[str]
    written: frozenset[str]
    assigned: frozenset[str]
    computed: frozenset[str]
    in_system: bool
    version: Version

    def unset(self, name: str) -> str:
        """A message that states why the entry `name`, which nothing sets, cannot be read."""
        if self.in_system:
            return f"nothing sets the entry `{name}`; a script, a port or a `<SubTree>` of the tree must set it"
        return f"nothing sets the entry `{name}`; give it a value at the start"


def node_scripts(node: ExecutedNode, version: Version) -> Iterator[tuple[str, Script, bool]]:
    """The scripts of a node, each with its attribute, and with whether its value is used as a condition."""
    for attribute in script_attributes(node.node):
        script = parsed(_text(attribute), grammar_of(version))[0]
        yield attribute.name, script, is_condition(node.type, attribute.name)


def _text(attribute: Attribute) -> Decoded:
    return Decoded(attribute.value, attribute.value_span.start)


def build_board(
    tree: ExecutedTree,
    given: Mapping[str, str],
    used: Mapping[int, NodeProgram | None],
    typed: Mapping[str, str] | None = None,
) -> Board:
    """The entries of the blackboard that a tree needs.

    Args:
        given: entry of the root blackboard -> the text to which the program that runs the tree sets it.
        used: number of a node -> its program; `None` for mocks and machines.
        typed: in a system, entry that ports of machines use -> the name of its type; all of them are needed.
    """
    reader = _Reader(tree, given, used, typed)
    for entry, type_ in (typed or {}).items():
        reader.kinds[entry] = _kind_of_type(type_)
    return reader.board()


def _kind_of_type(name: str) -> EntryKind:
    """The kind of the values of `name`, the type of a port of a machine."""
    if name == "string":
        return EntryKind.TEXT
    return EntryKind.REAL if name.startswith("float") else EntryKind.INTEGER


class _ScriptFacts(Record, frozen=True, eq=False):
    """The parts of a script from which types and uses of entries are inferred.

    Attributes:
        typed: the assignments and comparisons, which determine types of entries, in the order of the text.
        read: the names of the entries that the script reads.
    """

    typed: tuple[Assignment | Comparison, ...]
    read: tuple[str, ...]


_PLAIN_ASSIGNMENTS = (":=", "=")
"""The operators of assignments that do not read their target."""


def _facts(script: Script) -> _ScriptFacts:
    typed = tuple(part for part in walk(script) if isinstance(part, (Assignment, Comparison)))
    return _ScriptFacts(typed, tuple(dict.fromkeys(name.name for name in names_read(script))))


def names_read(script: Script) -> tuple[Name, ...]:
    """The names that a script reads, in the order of the text."""
    parts = list(walk(script))
    assigned = (part for part in parts if isinstance(part, Assignment) and part.operator in _PLAIN_ASSIGNMENTS)
    targets = {id(part.target) for part in assigned}
    return tuple(part for part in parts if isinstance(part, Name) and id(part) not in targets)


def _is_computed(assignment: Assignment) -> bool:
    """Whether an assignment computes its value from entries."""
    parts = walk(Script(assignment.span, (assignment.value,)))
    return assignment.operator not in _PLAIN_ASSIGNMENTS or any(isinstance(part, Name) for part in parts)


class _Reader(Record):
    tree: ExecutedTree
    given: Mapping[str, str]
    used: Mapping[int, NodeProgram | None]
    typed: Mapping[str, str] | None
    kinds: dict[str, EntryKind] = field(default_factory=dict)
    readers: set[str] = field(default_factory=set)
    stored: set[str] = field(default_factory=set)
    writers: set[str] = field(default_factory=set)
    assigned: set[str] = field(default_factory=set)
    computed: set[str] = field(default_factory=set)
    texts: dict[str, list[str]] = field(default_factory=dict)
    mentioned: dict[str, list[int | float | str]] = field(default_factory=dict)
    observed: dict[int, str] = field(default_factory=dict)
    copies: list[tuple[str, str]] = field(default_factory=list)
    switched: list[tuple[str, EntryKind]] = field(default_factory=list)
    read_texts: list[str] = field(default_factory=list)

    def board(self) -> Board:
        for entry, text in (*self.tree.initial.items(), *self.given.items()):
            self.texts.setdefault(entry, []).append(text)
        for node in self.tree.nodes:
            self.ports(node)
        version = self.tree.version
        if version < CONSTANTS_TYPED_SINCE:
            for entry in self.tree.initial:
                self.add(entry, EntryKind.TEXT)
        scripts = [(node, _facts(script)) for node in self.tree.nodes for _, script, _ in node_scripts(node, version)]
        self.follow(scripts)
        for entry in self.read_texts:  # a port that only reads a text converts the value of any type
            if entry not in self.kinds:
                self.add(entry, EntryKind.TEXT)
        self.from_texts()
        if self.switched:
            self.follow(scripts)
            for entry, kind in self.switched:
                if entry not in self.kinds:
                    self.add(entry, kind)
            self.follow(scripts)
            self.from_texts()
        return self.result()

    def follow(self, scripts: Sequence[tuple[ExecutedNode, _ScriptFacts]]) -> None:
        """Infer the kinds of entries from scripts and copies, until nothing changes."""
        for _ in range(len(self.tree.nodes) + 2):
            before = dict(self.kinds), len(self.readers)
            for node, script_facts in scripts:
                self.script(node, script_facts)
            self.copied()
            if before == (self.kinds, len(self.readers)):
                break

    def add(self, entry: str, kind: EntryKind | None) -> None:
        """Record that an entry is used with values of `kind`; `None` means that the kind is not known."""
        if kind is None or entry in (self.typed or {}):
            return
        known = self.kinds.get(entry)
        self.kinds[entry] = EntryKind.REAL if {known, kind} == {EntryKind.INTEGER, EntryKind.REAL} else known or kind

    def ports(self, node: ExecutedNode) -> None:
        program = self.used[node.number]
        read, written = (_NO_PORTS, _NO_PORTS) if program is None else (program.read_ports, program.written_ports)
        for port, entry, text, _ in node.ports():
            declared = node.known.port(port) if node.known else None
            if program is not None and program.observes and port == "entry":
                self.observed[node.number] = entry or node.frame.entry(text.strip())
                continue
            if node.type == "SetBlackboard" and port == "output_key":
                if entry is None or self.typed is not None:
                    self.assigned.add(entry or node.frame.entry(text.strip()))
                    self.writers.add(entry or node.frame.entry(text.strip()))
                continue
            if node.type == "SetBlackboard" and port == "value":
                self.set_value(node, entry, text)
                continue
            if entry is None:
                continue
            if port in read:
                self.readers.add(entry)
            if node.is_subtree:
                continue
            if port in written or declared is None or declared.direction is not Direction.IN:
                self.writers.add(entry)
            if port in written:
                self.computed.add(entry)
            kind = kind_of_cpp(port_type(declared)) if node.type[:6] != "Switch" else None
            if kind is EntryKind.TEXT and declared is not None and declared.direction is Direction.IN:
                self.read_texts.append(entry)
            else:
                self.add(entry, kind)
        if node.type.startswith("Switch"):
            self.switch(node)
        elif node.type.startswith("BlackboardCheck"):
            self.checked(node)

    def checked(self, node: ExecutedNode) -> None:
        """Record the constants with which a node of version 3 compares an entry."""
        values = {port: (entry, text) for port, entry, text, _ in node.ports() if port in ("value_A", "value_B")}
        entries = [entry for entry, _ in values.values() if entry is not None]
        texts = [text for entry, text in values.values() if entry is None]
        for entry in entries:
            for text in texts:
                constant = text if node.type == "BlackboardCheckString" else read_literal(text)[1]
                if constant not in self.mentioned.setdefault(entry, []):
                    self.mentioned[entry].append(constant)

    def set_value(self, node: ExecutedNode, entry: str | None, text: str) -> None:
        target = set_entry(node, in_system=self.typed is not None)
        if target is None:
            return
        if entry is None:
            self.texts.setdefault(target, []).append(text)
        else:
            self.copies.append((target, entry))

    def switch(self, node: ExecutedNode) -> None:
        bound = next((entry for port, entry, _, _ in node.ports() if port == "variable" and entry is not None), None)
        cases = [text for port, entry, text, _ in node.ports() if port.startswith("case_") and entry is None]
        if bound is None:
            return
        is_whole = self.tree.version >= CASES_WHOLE_SINCE
        numbers = [number_in(text, is_whole=is_whole) for text in cases]
        if None in numbers:
            kind = EntryKind.TEXT
        else:
            kind = EntryKind.REAL if any(isinstance(number, float) for number in numbers) else EntryKind.INTEGER
        self.texts.setdefault(bound, [])
        self.switched.append((bound, kind))
        values = [text if number is None else number for text, number in zip(cases, numbers, strict=True)]
        self.mentioned.setdefault(bound, []).extend(values)

    def copied(self) -> None:
        for target, source in self.copies:
            if target in self.readers or target in self.stored or target in (self.typed or {}):
                self.readers.add(source)
            for one, other in ((target, source), (source, target)):
                if other in self.kinds:
                    self.add(one, self.kinds[other])

    def script(self, node: ExecutedNode, facts: _ScriptFacts) -> None:
        def entry(name: str) -> Type:
            kind = self.kinds.get(node.frame.entry(name))
            return Type.UNKNOWN if kind is None else _TYPE[kind]

        for expr in facts.typed:
            if isinstance(expr, Comparison):
                self.compared(node, expr.operands)
                continue
            full = node.frame.entry(expr.target.name)
            self.writers.add(full)
            self.assigned.add(full)
            self.stored.add(full)  # a computed value must be stored
            if _is_computed(expr):
                self.computed.add(full)
            if expr.operator in _PLAIN_ASSIGNMENTS:
                self.add(full, _KIND.get(type_of(expr.value, entry)))
        for name in facts.read:
            self.readers.add(node.frame.entry(name))

    def compared(self, node: ExecutedNode, operands: tuple[object, ...]) -> None:
        """Infer the kinds of entries from a comparison with a constant."""
        names = [operand for operand in operands if isinstance(operand, Name)]
        constants = [operand.value for operand in operands if isinstance(operand, (Number, String))]
        for operand in names:
            full = node.frame.entry(operand.name)
            for constant in constants:
                kind = EntryKind.TEXT if isinstance(constant, str) else None
                kind = kind or (EntryKind.INTEGER if isinstance(constant, int) else EntryKind.REAL)
                if full not in self.kinds or kind is not EntryKind.TEXT:
                    self.add(full, kind)
                if constant not in self.mentioned.setdefault(full, []):
                    self.mentioned[full].append(constant)

    def from_texts(self) -> None:
        """Infer the kinds of entries to which only texts are assigned: they are numbers if all texts are numbers."""
        for entry, texts in self.texts.items():
            for text in texts:
                kind = read_literal(text)[0]
                known = self.kinds.get(entry)
                if entry in (self.typed or {}):
                    continue
                widens = kind is EntryKind.REAL and known is EntryKind.INTEGER
                if known is None or widens or kind is EntryKind.TEXT:
                    self.kinds[entry] = kind

    def result(self) -> Board:
        entries: dict[str, BoardEntry] = {}
        typed = self.typed or {}
        texts = self.stored_texts()
        for name in sorted(self.readers | self.stored | typed.keys()):
            initial = self.given.get(name, self.tree.initial.get(name))
            if name not in self.writers and name not in typed and initial is None:
                continue
            kind = self.kinds.get(name, EntryKind.INTEGER)
            literal = None if initial is None else read_literal(initial)[1] if kind is not EntryKind.TEXT else initial
            is_text = name in texts.entries and kind is not EntryKind.TEXT
            entries[name] = BoardEntry(name, kind, literal, typed.get(name, ""), self.constant_text(name), is_text)
        flags: dict[str, list[BoardEntry]] = {}
        flag_of: dict[int, BoardEntry] = {}
        for number, name in self.observed.items():
            if name in self.writers or name in self.given or name in self.tree.initial:
                is_set = name in self.given or name in self.tree.initial
                flag_of[number] = BoardEntry(update_flag(name, number), EntryKind.INTEGER, int(is_set))
                flags.setdefault(name, []).append(flag_of[number])
        values = {name: self.values(name, entry.kind) for name, entry in entries.items()}
        observers = {name: tuple(known) for name, known in flags.items()}
        read, written = frozenset(self.readers), frozenset(self.writers)
        assigned, computed = frozenset(self.assigned), frozenset(self.computed)
        return Board(
            entries,
            observers,
            flag_of,
            values,
            texts,
            read,
            written,
            assigned,
            computed,
            self.typed is not None,
            self.tree.version,
        )

    def stored_texts(self) -> StoredTexts:
        if self.typed is not None:
            return StoredTexts(frozenset(), frozenset())
        scripts = ((n, script) for n in self.tree.nodes for _, script, _ in node_scripts(n, self.tree.version))
        return stored_texts(self.tree, scripts, self.given)

    def constant_text(self, name: str) -> str | None:
        """The text of an entry that a `<SubTree>` sets and nothing else writes, if the version stores it as a text."""
        is_constant = name not in self.writers and name not in (self.typed or {})
        return self.tree.initial.get(name) if is_constant and self.tree.version < CONSTANTS_TYPED_SINCE else None

    def values(self, name: str, kind: EntryKind) -> tuple[int | float | str, ...]:
        """The values that a mock may write to an entry: those with which the tree compares the entry, and defaults of
        the kind `kind`."""
        other: list[int | float | str] = [""] if kind is EntryKind.TEXT else [0, 1]
        mentioned = self.mentioned.get(name, [])
        fitting = [value for value in mentioned if isinstance(value, str) is (kind is EntryKind.TEXT)]
        return tuple(dict.fromkeys((*fitting, *other)))
