# SPDX-License-Identifier: Apache-2.0
"""The names in property files in XML: the names of properties and variables, and the interfaces and nodes to which
ports refer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.tree import Name as NameExpr
from roaml.expr.tree import walk
from roaml.ide.names.frames import Frame, Piece, Trees
from roaml.ide.names.occurrence import Access, Occurrence, fields, tree_node, without_slash
from roaml.interfaces.registry import split_type_name
from roaml.interfaces.types import Kind
from roaml.model.expand import Instance
from roaml.model.property_file import Port, PortKind, PortVariable, PropertyFile
from roaml.model.property_ports import INTERFACE_KINDS, part_of
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Name
from roaml.model.system import System, SystemAutomaton
from roaml.model.tree_paths import nodes_called, parts_above
from roaml.roles import SymbolKind
from roaml.scxml.names import flag_of, sanitise
from roaml.text import Span

FindInterface = Callable[[str, str], InterfaceType | None]

SYMBOL_KINDS = {
    PortKind.TOPIC: SymbolKind.TOPIC,
    PortKind.SERVICE: SymbolKind.SERVICE,
    PortKind.ACTION: SymbolKind.ACTION,
}


def in_property_file(
    text: str,
    file: PropertyFile,
    path: str,
    owner: str,
    system: System | None,
    trees: Trees,
    table: Mapping[str, tuple[Piece, ...]],
    find: FindInterface,
) -> Iterator[Occurrence]:
    """The occurrences of names in a property file in XML.

    Args:
        owner: the system file, or `path` if the file is analysed alone.
        table: the names of the global variables of the translation -> their parts.
    """
    names = _PropertyFile(text, file, path, owner, system, trees, table, find)
    return (occurrence for occurrence in names.all() if occurrence.span.start < occurrence.span.end)


class _PropertyFile:
    def __init__(
        self,
        text: str,
        file: PropertyFile,
        path: str,
        owner: str,
        system: System | None,
        trees: Trees,
        table: Mapping[str, tuple[Piece, ...]],
        find: FindInterface,
    ) -> None:
        self.text = text
        self.file = file
        self.path = path
        self.owner = owner
        self.system = system
        self.trees = trees
        self.table = table
        self.find = find

    def all(self) -> Iterator[Occurrence]:
        for port in self.file.ports:
            if port.name is not None:
                yield from self.port(port, port.name)
            for choice in (port.origin, port.target):
                yield from self.automaton(choice)
            for variable in port.variables:
                if variable.id is not None:
                    yield self.variable(variable.id.span, variable.id.value, defines=True)
                yield from self.field(port, variable)
        for written in self.file.properties:
            if written.id is not None:
                yield Occurrence(written.id.span, Symbol(self.owner, SymbolKind.PROPERTY, written.id.value), True)
            for condition in written.expressions:
                for node in walk(condition.tree):
                    if isinstance(node, NameExpr) and self.text[node.span.start : node.span.end] == node.name:
                        yield self.variable(node.span, node.name)

    def variable(self, span: Span, name: str, *, defines: bool = False) -> Occurrence:
        access = Access.WRITE if defines else Access.READ
        return Occurrence(span, Symbol(self.path, SymbolKind.PORT_VARIABLE, name), defines, access)

    # ----------------------------------------------------------------- ports

    def port(self, port: Port, name: Name) -> Iterator[Occurrence]:
        if len(name.value) != name.span.end - name.span.start:
            return  # the name is written with entities
        if port.kind is PortKind.NODE:
            yield from self.node(name)
        elif port.kind is PortKind.PLAIN:
            yield from self.pieces(self.table.get(flag_of(name.value), ()), name.span)
        else:
            kind = SYMBOL_KINDS[port.kind]
            is_topic = kind is SymbolKind.TOPIC
            symbol = Symbol(self.owner, kind, sanitise(name.value) if is_topic else name.value)
            yield Occurrence(without_slash(name) if is_topic else name.span, symbol, access=Access.READ)
            if port.type is not None:
                interface: Kind = INTERFACE_KINDS[port.kind]
                parts = split_type_name(port.type.value, interface)
                if parts is not None:
                    symbol = Symbol("", SymbolKind.ROS_TYPE, "/".join(parts), interface)
                    yield Occurrence(port.type.span, symbol)

    def pieces(self, pieces: tuple[Piece, ...], span: Span, skipped: int = 0) -> Iterator[Occurrence]:
        """The occurrences of symbols in a name of the translation. `span` contains the name without its first `skipped`
        characters."""
        start = span.start - skipped
        for written, symbol, form in pieces:
            if symbol is not None and span.start <= start and start + len(written) <= span.end:
                yield Occurrence(Span(start, start + len(written)), symbol, access=Access.READ, form=form)
            start += len(written)

    def node(self, name: Name) -> Iterator[Occurrence]:
        """The occurrences of the nodes and trees on a path."""
        matches = nodes_called(self.system, name.value) if self.system is not None else ()
        if len(matches) != 1 or self.system is None:
            return
        *path, last = name.value.split("/")
        start = name.span.start
        above = zip(
            (part.names for part in parts_above(self.system, matches[0])),
            self.around(self.system, matches[0]),
            strict=True,
        )
        for text in path:
            names, symbols = next((names, symbols) for names, symbols in above if text in names)
            yield Occurrence(Span(start, start + len(text)), symbols[names.index(text)])
            start += len(text) + 1
        symbol = self.symbol_of(self.system.by_instance[matches[0].number])
        yield Occurrence(Span(start, start + len(last)), symbol, access=Access.READ)

    def around(self, system: System, instance: Instance) -> list[tuple[Symbol, ...]]:
        """The symbols to which the names in `parts_above` refer, in the same order."""
        symbols_around: list[tuple[Symbol, ...]] = []
        frame = self.frame_of(instance)
        while True:
            parent = system.by_instance.get(instance.parent) if instance.parent is not None else None
            around = parent.instance if parent is not None else None
            outermost = self.frame_of(around) if around is not None else None
            while frame is not None and frame is not outermost:
                symbols = tuple(self.names_of(frame))
                symbols_around += [symbols] if symbols else []
                frame = frame.outer
            if parent is None or around is None:
                return symbols_around[::-1]
            symbols_around.append((self.symbol_of(parent),))
            instance = around

    def frame_of(self, instance: Instance) -> Frame | None:
        return self.trees.nodes[instance.number][0] if instance.number in self.trees.nodes else None

    def names_of(self, frame: Frame) -> Iterator[Symbol]:
        """The symbols of the names of an instance of a tree: the `<SubTree>`, if it has a name, and the tree."""
        use, id_ = frame.expanded.use, frame.expanded.tree.id
        if frame.expanded.name != id_:
            name = frame.expanded.name
            yield self.trees.instance(name) if use is None else tree_node(use.path, use.tree, use.position, name)
        if id_:
            yield self.trees.tree_symbol(frame.path, id_)

    def symbol_of(self, automaton: SystemAutomaton) -> Symbol:
        """The symbol to which the name of a node of the tree refers: the node, or its plugin if the node has no
        name."""
        assert automaton.instance is not None
        _, node = self.trees.nodes.get(automaton.instance.number, (None, None))
        source = automaton.instance.source
        if node is not None and node.name is not None and node.name.value == automaton.instance.name:
            return tree_node(source.path, source.tree, source.position, node.name.value)
        if automaton.path:
            return Symbol(automaton.path, SymbolKind.MACHINE, automaton.outline.name)
        return Symbol("", SymbolKind.PLUGIN, automaton.outline.name)

    # ------------------------------------------------------ machines, fields

    def automaton(self, name: Name | None) -> Iterator[Occurrence]:
        if name is None or self.system is None:
            return
        for automaton in self.system.automata:
            if automaton.instance is not None and name.value == automaton.instance.name:
                yield Occurrence(name.span, self.symbol_of(automaton))
            elif automaton.path and name.value == automaton.outline.name:
                yield Occurrence(name.span, Symbol(automaton.path, SymbolKind.MACHINE, name.value))

    def field(self, port: Port, variable: PortVariable) -> Iterator[Occurrence]:
        name = variable.field
        if name is None or len(name.value) != name.span.end - name.span.start:
            return
        if port.kind is PortKind.PLAIN and port.name is not None:
            pieces = self.table.get(f"{port.name.value}__{name.value}", ())
            yield from self.pieces(pieces, name.span, len(port.name.value) + 2)
            return
        part = part_of(port, self.find)
        if part is not None:
            yield from fields(name, part, Access.READ)
