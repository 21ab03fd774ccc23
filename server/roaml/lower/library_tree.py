# SPDX-License-Identifier: Apache-2.0
"""Translates the tree of a system whose nodes are executed as BehaviorTree.CPP executes them
(docs/spec/nodes.md#library).

- Nodes of the libraries become programs. Plugins remain machines and exchange the same events.
- Separate automata evaluate the conditions of plugins and of `<SubTree>` nodes. Such an automaton receives the events
  of the node, such as `bt_1003_tick`. The node itself then has another address, as in `bt_1003_inner_tick`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from fractions import Fraction
from functools import cached_property

from roaml.forest.forest import node_of_machine
from roaml.forest.scripts import script_attributes
from roaml.libraries import Node, library_node, node_in_libraries
from roaml.libraries.programs.assembly import NodeProgram, programs
from roaml.lower.programs.automaton import (
    CONDITION_MACHINE,
    MACHINE,
    MACHINES,
    NodeTooLargeError,
    node_automaton,
    too_large,
)
from roaml.lower.programs.board import Board, build_board
from roaml.lower.programs.code import STATUSES, Child, NodeCode
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree, FrameNames, TreeLinks
from roaml.lower.programs.nodes import (
    EVENT_PROBABILITY,
    event_probability,
    flags_at,
    program_of,
    values_and_scripts,
)
from roaml.lower.programs.refusal import TreeRefusal
from roaml.lower.programs.stored_texts import set_entry
from roaml.model.expand import Instance, entered_uses
from roaml.model.node_effects import tree_effects
from roaml.model.system import EntryOutline, System, SystemAutomaton
from roaml.model.tree import TreeFile
from roaml.record import Record, replace
from roaml.roles import NodeKind
from roaml.script.names import names_in
from roaml.scxml.model import Automaton
from roaml.scxml.names import CONDITIONS_PREFIX
from roaml.text import Location


class LibraryTree(Record, frozen=True, eq=False):
    """The translation of a tree.

    Attributes:
        codes: number of an instance -> the inputs for its automata: those of its conditions, the outermost first, and
            that of its program. Machines are not included.
        addresses: number of an instance -> its address in names of events, if it differs from the number.
        board: the entries of the blackboard.
        refusals: the reasons why the tree cannot be translated.
    """

    codes: Mapping[int, tuple[NodeCode, ...]]
    addresses: Mapping[int, str]
    board: Board
    refusals: tuple[TreeRefusal, ...]

    def address(self, number: int) -> str:
        return self.addresses.get(number, str(number))

    def automata(self, number: int) -> tuple[Automaton, ...]:
        """The automata of the instance `number`, in the order of `codes`."""
        return tuple(node_automaton(code).automaton for code in self.codes[number])


class _Part(Record, eq=False):
    """One part of an instance, which becomes an automaton: the conditions of a node, or the node itself. `program` is
    `None` for a machine."""

    node: ExecutedNode
    program: NodeProgram | None
    address: str
    name: str


class LibraryTreeBuilder:
    """Translates the tree of a system. The variables of the blackboard are determined first.

    Args:
        system: the system; `System.entries` is not used.
        files: the tree files of the system, by path.
        known_children: the shapes of nodes that were explored for other trees; `child` adds those of this tree.
    """

    def __init__(
        self, system: System, files: Mapping[str, TreeFile], known_children: dict[Hashable, Child | None]
    ) -> None:
        self.system = system
        self.links = TreeLinks(files, {})
        self.refusals: list[TreeRefusal] = []
        self.parts = {instance.number: tuple(self.parts_of(instance)) for instance in system.instances}
        nodes = [part for parts in self.parts.values() for part in parts]
        # In the tree of all parts, each part has a separate number.
        self.tree_of_parts = ExecutedTree(
            "", tuple(replace(part.node, number=index) for index, part in enumerate(nodes)), self.links.initial
        )
        used = {index: part.program for index, part in enumerate(nodes)}
        for node in self.tree_of_parts.nodes:
            list(node.ports())  # adds the constants of subtrees to `initial`
        self.board = build_board(self.tree_of_parts, {}, used, self.machine_types())
        self.index = {id(part): index for index, part in enumerate(nodes)}
        self.known_children = known_children

    # ------------------------------------------------------------------- parts

    def parts_of(self, instance: Instance) -> Iterator[_Part]:
        """The parts of an instance, the outermost first; empty if its node cannot be translated."""
        automaton = self.system.by_instance.get(instance.number)
        if automaton is None:
            return
        known = _declared(automaton, is_program=self.system.is_program(automaton))
        node = self.links.node(instance, self.system.tree_uses[instance.use].frame, known, instance.children)
        try:
            program = program_of(node) if self.system.is_program(automaton) else None
        except TreeRefusal as refusal:
            self.refusals.append(refusal)
            return
        conditions = [*self.subtrees_above(instance)]
        if program is None and instance.scripts:
            conditions.append(replace(node, type=CONDITION_MACHINE if _is_condition(instance) else MACHINE))
        for level, condition in enumerate(conditions):
            kind = programs()[condition.type if condition.type in MACHINES else "SubTree"]
            name = f"{CONDITIONS_PREFIX}{_address(instance.number, level)}_{condition.name}"
            yield _Part(condition, kind, _address(instance.number, level), name)
        yield _Part(node, program, _address(instance.number, len(conditions)), instance.automaton)

    def subtrees_above(self, instance: Instance) -> Iterator[ExecutedNode]:
        """The `<SubTree>` elements that need an automaton and whose top node is the instance, the outermost first:
        those with conditions, and one whose parent may tick it again after it has ended. Like any decorator, a
        `<SubTree>` resets its child when the child has ended."""
        parent = None if instance.parent is None else self.system.by_instance.get(instance.parent)
        around = parent.instance.use if parent is not None and parent.instance is not None else None
        uses = [self.system.tree_uses[index] for index in entered_uses(self.system.tree_uses, instance.use, around)]
        is_ticked_again = parent is not None and self.ticks_ended(parent, instance)
        for position, use in enumerate(uses):
            if not use.scripts and (position > 0 or not is_ticked_again):
                continue
            yield self.links.subtree(0, use, instance.number)

    def ticks_ended(self, parent: SystemAutomaton, instance: Instance) -> bool:
        """Whether the parent of an instance may tick it again after it has ended, without resetting it."""
        return (
            bool(parent.path)
            or tree_effects(self.system).on_child(parent, self.system.by_instance[instance.number]).ticks_ended
        )

    def machine_types(self) -> dict[str, str]:
        """Variable to which a port of a machine is bound -> the name of its type."""
        types: dict[str, str] = {}
        for variable, ports in self.system.blackboard.items():
            if not all(self.system.is_program(bound.automaton) for bound in ports):
                types[variable] = self.system.variable_type(variable)
        return types

    # ---------------------------------------------------------------- automata

    def entries(self) -> Mapping[str, EntryOutline]:
        """Name of a variable of the blackboard -> its outline."""

        def outline(name: str, type_: str) -> EntryOutline:
            ports = self.system.blackboard.get(name, ())
            read = name in self.board.read or any(bound.port.read for bound in ports)
            written = name in by_programs or any(bound.port.written for bound in ports)
            return EntryOutline(type_, read, written)

        by_programs = self.written_by_programs()
        flags = {flag.variable: EntryOutline(flag.type_name, True, True) for flag in self.board.flag_of.values()}
        return {name: outline(name, entry.type_name) for name, entry in self.board.entries.items()} | flags

    def written_by_programs(self) -> frozenset[str]:
        """The entries that scripts and nodes of the libraries write."""
        written: set[str | None] = set()
        for part in (part for parts in self.parts.values() for part in parts):
            node = part.node
            for attribute in script_attributes(node.node):
                names = names_in(attribute.value)
                written |= {node.frame.entry(name) for name, operator in names if operator != "read"}
            if part.program is not None and node.known is not None:
                written.add(set_entry(node, in_system=True) if node.type == "SetBlackboard" else None)
                ports = ((node.known.port(port), entry) for port, entry, _, _ in node.ports())
                written |= {entry for port, entry in ports if port is not None and port.direction.writes}
        return frozenset(name for name in written if name is not None)

    def tree(self) -> LibraryTree:
        """Translate the tree. Parts that cannot be translated are left out, with a refusal for each."""
        codes: dict[int, tuple[NodeCode, ...]] = {}
        refusals = list(self.refusals)
        children: dict[int, Child] = {}
        for instance in reversed(self.system.instances):
            translated: list[NodeCode] = []
            origin = self.links.origin(instance.source)
            child = Child(str(instance.number), STATUSES, False, origin)
            for part in reversed(self.parts[instance.number]):
                try:
                    self.check(part)
                    if part.program is None:
                        self.check_machine(instance, part, children)
                        child = Child(part.address, STATUSES, False, origin)
                        continue
                    below = [child] if part.address != self.parts[instance.number][-1].address else None
                    below = below or [children[number] for number in instance.children]
                    code = self.code(part, part.program, tuple(below), instance.tree)
                    child = self.child(code)
                    translated.append(code)
                except NodeTooLargeError:
                    refusals.append(TreeRefusal(part.node.origin, too_large(part.node.name, len(instance.children))))
                except TreeRefusal as refusal:
                    refusals += refusal.all
            children[instance.number] = child
            codes[instance.number] = tuple(reversed(translated))
        addresses = {n: parts[-1].address for n, parts in self.parts.items() if len(parts) > 1}
        refusals.sort(key=lambda refusal: (refusal.origin.path, refusal.origin.span.start))
        return LibraryTree(codes, addresses, self.board, tuple(refusals))

    def child(self, code: NodeCode) -> Child:
        """The properties of a node on which its parent depends. Nodes with equal shapes are explored only once.

        Raises:
            NodeTooLargeError: the node has too many states.
        """
        shape = code.shape
        if shape not in self.known_children:
            try:
                self.known_children[shape] = node_automaton(code).child
            except NodeTooLargeError:
                self.known_children[shape] = None
        known = self.known_children[shape]
        if known is None:
            raise NodeTooLargeError
        return replace(known, address=code.address, origin=code.origin)

    @cached_property
    def constants_of_machines(self) -> frozenset[str]:
        """The entries to which ports of machines are bound and that a `<SubTree>` sets to constants. The machines use
        them as constants."""
        machines = [parts[-1] for parts in self.parts.values() if parts and parts[-1].program is None]
        bound = ((part, entry) for part in machines for _, entry, _, _ in part.node.ports() if entry is not None)
        return frozenset(entry for part, entry in bound if _names(part).is_initial(entry))

    def check(self, part: _Part) -> None:
        """Check that a part does not write an entry that a machine uses as a constant.

        Raises:
            TreeRefusal: the part writes such an entry.
        """
        for attribute in script_attributes(part.node.node):
            for name, operator in names_in(attribute.value):
                if operator != "read" and part.node.frame.entry(name) in self.constants_of_machines:
                    raise _constant(name, Location(part.node.origin.path, attribute.value_span))
        for port, entry, _, span in part.node.ports():
            declared = part.node.known.port(port) if part.node.known else None
            writes = declared is not None and declared.direction.writes and part.program is not None
            if writes and entry is not None and entry in self.constants_of_machines:
                raise _constant(entry, Location(part.node.origin.path, span))

    def check_machine(self, instance: Instance, part: _Part, children: Mapping[int, Child]) -> None:
        for number in instance.children:
            if not children[number].answers <= STATUSES:
                below = self.system.by_instance[number].instance
                name = below.name if below else ""
                reason = f"`{name}` can be skipped, but its parent `{instance.plugin}` cannot handle SKIPPED"
                raise TreeRefusal(part.node.origin, reason)

    def code(self, part: _Part, program: NodeProgram, children: tuple[Child, ...], tree: str) -> NodeCode:
        node = part.node
        number = self.index[id(part)]
        is_condition = node.type in (*MACHINES, "SubTree")
        values, scripts = values_and_scripts(node, None if is_condition else program, self.board)
        if program.reads_world:
            probability = event_probability(node)
            values.known["event"] = EVENT_PROBABILITY if probability is None else probability
        return NodeCode(
            part.address,
            part.name,
            program,
            children,
            values.known,
            values.bound,
            scripts,
            self.board.flag_of.get(number),
            (),
            values.elements,
            flags_at(node, self.board),
            Fraction(str(self.system.tick_rate(tree))),
            counts=False,
            origin=node.origin,
            is_halted_always=True,
            whole=values.whole,
            tree=tree,
        )


def _names(part: _Part) -> FrameNames:
    assert isinstance(part.node.frame, FrameNames)
    return part.node.frame


def _constant(name: str, origin: Location) -> TreeRefusal:
    reason = f"`{name}` is a constant that a `<SubTree>` passes to the port of a plugin, so it cannot be assigned"
    return TreeRefusal(origin, reason)


def _address(number: int, level: int) -> str:
    """The address of a part of the instance `number`. `level` is 0 for the outermost part, whose address is the
    number."""
    return str(number) if level == 0 else f"{number}_inner" if level == 1 else f"{number}_inner{level}"


def _declared(automaton: SystemAutomaton, *, is_program: bool) -> Node:
    """The declaration of a node in its library; for a machine, a declaration with its ports."""
    if not is_program:
        return node_of_machine(automaton.outline)
    node = library_node(automaton.outline.name)
    assert node is not None, automaton.outline.name
    return node


def _is_condition(instance: Instance) -> bool:
    """Whether a node is declared as a condition, in the file of the tree or in a library."""
    known = node_in_libraries(instance.plugin)
    return instance.condition or (known is not None and known.kind is NodeKind.CONDITION)
