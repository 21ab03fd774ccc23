# SPDX-License-Identifier: Apache-2.0
"""Determines the programs of the nodes of an executed tree, and the values of their ports
(docs/spec/mocks.md#nodes)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.forest.cpp_types import mismatch
from roaml.forest.forest import CPP, port_type
from roaml.forest.scripts import script_attributes
from roaml.libraries import LIBRARIES, Port, library, node_in_libraries
from roaml.libraries.node import EVENT_ATTRIBUTE
from roaml.libraries.programs.assembly import NodeProgram, is_executable, programs
from roaml.libraries.programs.statuses import RUNNING, STATUS_CODES, Known
from roaml.libraries.scripts import script_ports
from roaml.libraries.version import NEWEST_VERSION, Version
from roaml.lower.programs.board import Board, names_read, node_scripts
from roaml.lower.programs.cases import case_value
from roaml.lower.programs.entries import BoardEntry, EntryKind, kind_of_cpp, read_literal
from roaml.lower.programs.executed import ExecutedNode
from roaml.lower.programs.refusal import INVALID_SCRIPT, TreeRefusal, first_of
from roaml.lower.programs.scripts import CompiledScript, ScriptRefusal, compiled
from roaml.lower.programs.stored_texts import set_entry
from roaml.record import Record, field
from roaml.roles import UNBOUNDED, NodeKind
from roaml.script.tree import Script
from roaml.text import Location, Span

EVENT_PROBABILITY = 0.1
"""The probability of an event of the world at a tick, unless the tree or a mock sets another one."""


def program_of(node: ExecutedNode, version: Version = NEWEST_VERSION) -> NodeProgram | None:
    """The program of a node of the libraries in a version of BehaviorTree.CPP; `None` for a leaf that is not from a
    library.

    Raises:
        TreeRefusal: the node cannot be executed.
    """
    known_programs = programs(version)
    if node.is_subtree and node.children:
        return known_programs[node.type]
    if is_executable(node.type, node.known, version):
        _check_children(node)
        return known_programs[node.type]
    if is_own_parent(node, version):
        raise TreeRefusal(node.origin, _own_parent(node))
    if node.known is not None and node.known.kind in (NodeKind.CONTROL, NodeKind.DECORATOR):
        raise TreeRefusal(node.origin, f"`{node.type}` needs children", is_reported=True)
    absent = CPP.absent.get(node.type)
    if node.known is None and absent is not None:
        raise TreeRefusal(
            node.origin, f"`{node.type}` cannot be a node of a tree: it is {absent.reason}", is_reported=True
        )
    return None


def is_own_parent(node: ExecutedNode, version: Version = NEWEST_VERSION) -> bool:
    """Whether a node with children has no program of a library in a version of BehaviorTree.CPP."""
    return bool(node.children) and not node.is_subtree and not is_executable(node.type, node.known, version)


def _own_parent(node: ExecutedNode) -> str:
    """Why a node with children cannot be executed, and which nodes of the library are similar."""
    absent = CPP.absent.get(node.type)
    kind = node.known.kind if node.known is not None else absent.kind if absent is not None else None
    if absent is not None and absent.instead:
        like = f"`{absent.instead}`"
    elif kind is NodeKind.CONTROL or (kind is None and len(node.children) > 1):
        like = "`Sequence`, `Fallback` or `Switch2`"
    else:
        like = "`Inverter`, `ForceSuccess` or `Precondition`"
    reason = f"cannot be executed: it is {absent.reason}" if absent else "has children, but its behaviour is not known"
    return (
        f"`{node.type}` {reason}; in a copy of the tree, write the node of BehaviorTree.CPP that behaves most like it, "
        f"such as {like}, or write `{node.type}` as a plugin of a system"
    )


def _check_children(node: ExecutedNode) -> None:
    assert node.known is not None
    least, most = node.known.children
    if not least <= len(node.children) <= most:
        children = "1 child" if len(node.children) == 1 else f"{len(node.children)} children"
        reason = f"{_who(node)} has {children}, but needs {_range(least, most)}"
        raise TreeRefusal(node.origin, reason, is_reported=True)


def _who(node: ExecutedNode) -> str:
    return f"`{node.own_type}`, which is executed like `{node.type}`," if node.own_type else f"`{node.type}`"


def _range(least: int, most: int) -> str:
    """The numbers from `least` to `most` in words."""
    if least == most:
        return f"{least}"
    return f"at least {least}" if most == UNBOUNDED else f"{least} to {most}"


def values_and_scripts(
    node: ExecutedNode, program: NodeProgram | None, board: Board
) -> tuple[PortValues, dict[str, CompiledScript]]:
    """The values of the ports of a node, none without a program; and its scripts, by their attributes or ports.

    Raises:
        TreeRefusal: a value or a script cannot be translated.
    """
    refusals: list[TreeRefusal] = []
    values, scripts = PortValues(), dict[str, CompiledScript]()
    try:
        values = PortValues() if program is None else port_values(node, program, board)
    except TreeRefusal as refusal:
        refusals.append(refusal)
    try:
        scripts = compiled_scripts(node, board)
    except TreeRefusal as refusal:
        refusals.append(refusal)
    if refusals:
        raise first_of(refusals)
    return values, scripts


def compiled_scripts(node: ExecutedNode, board: Board) -> dict[str, CompiledScript]:
    """Attribute or port of a node -> its script.

    Raises:
        TreeRefusal: a script cannot be translated.
    """
    result = {}
    unset: list[TreeRefusal] = []
    places = {attribute.name: attribute.value_span for attribute in script_attributes(node.node)}
    for attribute, script, is_condition in node_scripts(node, board.version):
        try:
            result[attribute] = compiled(
                script,
                lambda entry: board.entries.get(node.frame.entry(entry)),
                board.unset,
                is_condition=is_condition,
            )
        except ScriptRefusal as refusal:
            if refusal.unset:
                unset += _unset_names(node, script, places[attribute], board)
                continue
            at = Location(node.origin.path, refusal.span)
            is_reported = refusal.reason == INVALID_SCRIPT
            place = places[attribute]
            raise TreeRefusal(at, refusal.reason, is_reported=is_reported, script=place) from None
    if unset:
        raise first_of(unset)
    if node.type in programs():
        for port in script_ports().get(node.type, ()):
            if port not in result:
                raise _missing(node, port)
    return result


def _unset_names(node: ExecutedNode, script: Script, place: Span, board: Board) -> Iterator[TreeRefusal]:
    """A refusal for each name that a script reads and nothing sets, at its first place."""
    named: set[str] = set()
    for name in names_read(script):
        entry = node.frame.entry(name.name)
        if name.name not in named and entry not in board.entries:
            named.add(name.name)
            at = Location(node.origin.path, name.span)
            shown = name.name if board.in_system else entry  # without a system, an option names the entry
            yield TreeRefusal(at, board.unset(shown), unset=shown, script=place)


def _missing(node: ExecutedNode, port: str) -> TreeRefusal:
    return TreeRefusal(node.origin, f"{_who(node)} needs the port `{port}`", is_reported=True)


def event_probability(node: ExecutedNode) -> float | None:
    """The probability of an event of the world at a tick that the tree sets; `None` if it sets none.

    Raises:
        TreeRefusal: the value is not a number from 0 to 1.
    """
    attribute = node.node.element.get(EVENT_ATTRIBUTE)
    if attribute is None:
        return None
    try:
        probability = float(attribute.value)
    except ValueError:
        probability = -1.0
    if not 0 <= probability <= 1:
        place = Location(node.origin.path, attribute.value_span)
        raise TreeRefusal(place, f"`{EVENT_ATTRIBUTE}` must be a number from 0 to 1, not `{attribute.value}`")
    return probability


class PortValues(Record, eq=False):
    """The values of the ports that a program uses.

    Attributes:
        known: port with a constant value -> the value.
        bound: port that is bound to an entry -> the entry.
        elements: the elements of the queue of a loop.
        whole: the ports that need an integer and are bound to an entry of real numbers.
    """

    known: dict[str, Known] = field(default_factory=dict)
    bound: dict[str, BoardEntry] = field(default_factory=dict)
    elements: tuple[Known, ...] = ()
    whole: frozenset[str] = frozenset()


def port_values(node: ExecutedNode, program: NodeProgram, board: Board) -> PortValues:
    """The values of the ports of a node.

    Raises:
        TreeRefusal: a value cannot be translated.
    """
    return _Reader(node, program, board).values()


class _Reader(Record, eq=False):
    node: ExecutedNode
    program: NodeProgram
    board: Board

    def values(self) -> PortValues:
        result = PortValues()
        self.set_ports(self.node, self.program, self.board, result.known, result.bound)
        if self.program.name.startswith("Loop"):
            result.elements = self.elements(self.node, result.known)
        result.whole = frozenset(
            port
            for port, entry in result.bound.items()
            if entry.kind is EntryKind.REAL and self.needs_integer(port, result.bound)
        )
        return result

    def needs_integer(self, port: str, bound: Mapping[str, BoardEntry]) -> bool:
        """Whether the node reads an integer from a port, or copies its value to an entry of integers."""
        if self.program.name == "SetBlackboard":
            return port == "value" and bound["output_key"].kind is EntryKind.INTEGER
        declared = self.node.known.port(port) if self.node.known else None
        return not self.program.name.startswith("Switch") and kind_of_cpp(port_type(declared)) is EntryKind.INTEGER

    def set_ports(
        self,
        node: ExecutedNode,
        program: NodeProgram,
        board: Board,
        known: dict[str, Known],
        bound: dict[str, BoardEntry],
    ) -> None:
        """Add the values of the ports that a program uses to `known` and `bound`."""
        if program.name in ("SetBlackboard", "UnsetBlackboard"):
            self.set_blackboard(node, board, known, bound)
            return
        given = {port: (entry, text, span) for port, entry, text, span in node.ports()}
        declared = _declared_ports(node)
        unset: list[TreeRefusal] = []
        kinds = {entry.kind for entry in self.switch_entries(program, given, board)}
        for port in declared:
            if port.name in ("if", "code", "entry", "queue", "value" if program.name.startswith("Loop") else ""):
                if port.name == "value" and port.name in given:
                    entry = given["value"][0]
                    if entry is not None and entry in board.entries:
                        bound["value"] = board.entries[entry]
                continue
            entry, text, span = given.get(port.name, (None, port.default, node.node.element.name_span))
            if entry is not None:
                if entry in board.entries:
                    bound[port.name] = board.entries[entry]
                elif port.name in program.needed_ports:
                    # In systems, the rule blackboard-never-written reports it.
                    is_reported = board.in_system and not any(entry in library(name).entries for name in LIBRARIES)
                    name = "" if board.in_system else entry
                    at = Location(node.origin.path, span)
                    unset.append(TreeRefusal(at, board.unset(entry), is_reported=is_reported, unset=name))
                continue
            if text is None:
                continue
            type_ = port_type(port)
            if _compares_texts(program) and type_ != "NodeStatus":
                known[port.name] = case_value(text, kinds, is_whole=bool(program.fixed.get("is_whole", True)))
            else:
                known[port.name] = _literal(port.name, type_, text, Location(node.origin.path, span))
                self.check_divisor(node, port.name, known[port.name], Location(node.origin.path, span))
        if unset:
            raise first_of(unset)
        needed: Sequence[str] = program.needed_ports
        if program.name.startswith("Switch"):
            needed = ("variable", *(f"case_{number}" for number in range(1, len(node.children))))
        missing = [port for port in needed if port not in known and port not in bound]
        if missing:
            raise _missing(node, missing[0])
        is_text = any(value.kind is EntryKind.TEXT for value in bound.values())
        if is_text and not _compares_texts(program) and node.type != "LoopString":
            raise TreeRefusal(
                node.origin, f"a port of `{node.type}` is bound to an entry with a text; only numbers can be translated"
            )
        for port in declared:
            if port.name not in bound or port.direction.writes:
                continue
            if port.type == "NodeStatus" or (port.type == "bool" and program.name != "BlackboardCheckBool"):
                raise TreeRefusal(
                    node.origin, f"the port `{port.name}` must be a constant; entries cannot be translated here"
                )

    def check_divisor(self, node: ExecutedNode, port: str, value: Known, origin: Location) -> None:
        """Refuse a rate that is not positive, because programs compute its period.

        Raises:
            TreeRefusal: the value is not in the limits of the port.
        """
        known = CPP.nodes.get(node.type) or node_in_libraries(node.type)
        declared = known.port(port) if known is not None else None
        limits = declared.limits if declared is not None else None
        if limits is None or not limits.is_exclusive or limits.minimum is None or isinstance(value, str):
            return
        if value <= limits.minimum:
            reason = f"the port `{port}` must be greater than {limits.minimum:g}, not {value:g}"
            raise TreeRefusal(origin, reason, is_reported=True)

    def switch_entries(
        self, program: NodeProgram, given: Mapping[str, tuple[str | None, str, object]], board: Board
    ) -> list[BoardEntry]:
        if not _compares_texts(program):
            return []
        return [board.entries[entry] for entry, _, _ in given.values() if entry is not None and entry in board.entries]

    def set_blackboard(
        self, node: ExecutedNode, board: Board, known: dict[str, Known], bound: dict[str, BoardEntry]
    ) -> None:
        target = set_entry(node, in_system=board.in_system)
        for port, entry, _, span in node.ports():
            if port in ("output_key", "key") and target is None:
                reason = (
                    f"`{{{entry}}}` means the entry whose name is the value of `{entry}`, which is only known when "
                    f'the tree runs; write `{port}="{entry}"` for the entry `{entry}` itself'
                )
                raise TreeRefusal(Location(node.origin.path, span), reason)
        if node.type == "SetBlackboard" and not board.in_system:
            _check_copy(node, target, board)
        if target is None or target not in board.entries:
            known["value"] = 0
            return
        if node.type == "UnsetBlackboard":
            raise TreeRefusal(
                node.origin, f"the removal of the entry `{target}`, which the tree reads, cannot be translated"
            )
        bound["output_key"] = board.entries[target]
        kind = board.entries[target].kind
        for port, entry, text, span in node.ports():
            if port != "value":
                continue
            if entry is None:
                known["value"] = text if kind is EntryKind.TEXT else read_literal(text)[1]
            elif entry in board.entries and (board.entries[entry].kind is EntryKind.TEXT) is (kind is EntryKind.TEXT):
                bound["value"] = board.entries[entry]
            else:
                reason = (
                    f"the tree reads the entry `{target}`, but the value of `{entry}` is unknown or of another type"
                )
                raise TreeRefusal(Location(node.origin.path, span), reason)

    def elements(self, node: ExecutedNode, known: dict[str, Known]) -> tuple[Known, ...]:
        """The elements of the queue of a loop."""
        known.setdefault("if_empty", STATUS_CODES["SUCCESS"])
        for port, entry, text, span in node.ports():
            if port == "queue":
                if entry is not None:
                    reason = "a queue in the blackboard cannot be translated; write its elements as `1;2;3`"
                    raise TreeRefusal(Location(node.origin.path, span), reason)
                items = [item.strip() for item in text.split(";")] if text.strip() else []
                if node.type == "LoopString":
                    return tuple(items)
                read = tuple(read_literal(item)[1] for item in items)
                return tuple(float(v) for v in read) if node.type == "LoopDouble" else read
        return ()


def _check_copy(node: ExecutedNode, target: str | None, board: Board) -> None:
    """Refuse a copy of a text that has no declared type, because scripts cannot read it in the library.

    Raises:
        TreeRefusal: the library fails, or throws an exception when a script reads the copy.
    """
    for port, entry, _, span in node.ports():
        if port != "value" or entry is None or entry not in board.texts.untyped:
            continue
        source = board.entries.get(entry)
        is_text = source is not None and source.kind is EntryKind.TEXT
        is_read = target in board.read and target in board.texts.untyped
        if entry in board.texts.entries or (is_text and is_read):
            reason = (
                f"the library cannot copy the text of `{entry}` to `{target}`; "
                f'copy it with a script, such as `<Script code="{target} := {entry}"/>`'
            )
            raise TreeRefusal(Location(node.origin.path, span), reason)


def _compares_texts(program: NodeProgram) -> bool:
    """Whether a node compares the values of its ports as texts, or as numbers if they are numbers."""
    return program.name.startswith("Switch") or program.name == "BlackboardCheckString"


def _declared_ports(node: ExecutedNode) -> tuple[Port, ...]:
    """The ports of a node of a library, with those that a model of the node does not describe."""
    if node.known is None or node.known.library:
        return node.known.ports if node.known else ()
    library_node = node_in_libraries(node.type)
    more = library_node.ports if library_node is not None else ()
    return (*node.known.ports, *(port for port in more if node.known.port(port.name) is None))


def flags_at(node: ExecutedNode, board: Board) -> dict[str, tuple[BoardEntry, ...]]:
    """Port of a node that writes an observed entry whose value is never read -> the flags of the observers."""
    flags: dict[str, tuple[BoardEntry, ...]] = {}
    for port, bound, text, _ in node.ports():
        names_entry = node.type == "SetBlackboard" and port == "output_key" and bound is None
        entry = node.frame.entry(text.strip()) if names_entry else bound
        if entry is not None and entry in board.flags and entry not in board.entries:
            flags[port] = board.flags[entry]
    return flags


def _literal(port: str, type_: str, text: str, origin: Location) -> Known:
    """The value of a constant, as the library reads it.

    Raises:
        TreeRefusal: the library rejects the constant.
    """
    if type_ == "NodeStatus" and text.strip() in _STATUS_NUMBERS:
        return int(text)
    wrong = mismatch(type_, text)
    if wrong is not None and not wrong.ignored:
        shown = f"`{text}`" if text.strip() else "an empty value"
        raise TreeRefusal(origin, f"the port `{port}` {wrong.message}, not {shown}", is_reported=True)
    if type_ == "NodeStatus":
        return STATUS_CODES.get(text.strip(), RUNNING)
    return read_literal(wrong.instead if wrong is not None else text)[1]


_STATUS_NUMBERS = ("1", "2", "3")
"""The numbers that trees of systems may use for statuses."""
