# SPDX-License-Identifier: Apache-2.0
"""The names in a file of behavior trees."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.forest.scripts import parsed, script_attributes
from roaml.ide.names.frames import Trees
from roaml.ide.names.in_machine import interface_symbol
from roaml.ide.names.occurrence import Access, Occurrence, tree_node, without_slash
from roaml.libraries import library_node
from roaml.model.expand import PortConstant
from roaml.model.outline import MachineOutline
from roaml.model.syntax import Name
from roaml.model.system import System
from roaml.model.tree import SUBTREES, NodeModel, PortSetting, TreeNode, blackboard_variable, is_variable_name, nodes
from roaml.roles import Direction, SymbolKind
from roaml.script.tree import Assignment, walk
from roaml.script.tree import Name as Variable
from roaml.text import Span
from roaml.xml_syntax import Document, Element


def in_tree(document: Document, path: str, trees: Trees, system: System | None) -> Iterator[Occurrence]:
    """The occurrences of names in a file of behavior trees."""
    return _Tree(document, path, trees, system).all()


class _Tree:
    def __init__(self, document: Document, path: str, trees: Trees, system: System | None) -> None:
        self.document = document
        self.path = path
        self.trees = trees
        self.owner = trees.owner
        self.system = system.seen_from(path) if system is not None else None
        self.file = trees.files[path]

    def all(self) -> Iterator[Occurrence]:
        yield from self.tree_name(self.file.main)
        for tree in self.file.trees:
            yield from self.tree_name(tree.id, defines=True)
            inside = tree.id.value if tree.id else ""
            for position, node in enumerate(nodes(tree)):
                if node.name is not None:
                    symbol = tree_node(self.path, inside, position, node.name.value)
                    yield Occurrence(node.name.span, symbol, defines=True)
                yield from self.subtree(node, inside) if node.is_subtree else self.node(node, inside)
                yield from self.scripts(node, inside)
        for model in self.file.models:
            yield from self.model(model)
        yield from self.defaults()
        yield from self.constants()

    def tree_name(self, name: Name | None, *, defines: bool = False) -> Iterator[Occurrence]:
        if name is not None:
            yield Occurrence(name.span, self.trees.tree_symbol(self.path, name.value), defines)

    # ----------------------------------------------------------------- nodes

    def subtree(self, node: TreeNode, inside: str) -> Iterator[Occurrence]:
        yield from self.tree_name(node.plugin)
        path, tree = self.trees.trees.get(node.plugin.value if node.plugin else "", ("", None))
        for port in node.ports:
            if port.key.value.startswith("_"):
                continue
            if tree is not None:
                symbol = self.trees.variable(path, tree.id.value if tree.id else "", port.key.value)
                yield Occurrence(port.key.span, symbol)
            yield from self.reference(port.value, inside, Access.TEXT)

    def node(self, node: TreeNode, inside: str) -> Iterator[Occurrence]:
        path, outline = self.plugin(node.plugin)
        if node.plugin is not None:
            symbol = self.plugin_symbol(node.plugin.value)
            yield from self.tag(node.element, symbol) if node.compact else (Occurrence(node.plugin.span, symbol),)
        for port in node.ports:
            yield from self.port(path, port)
            yield from self.reference(port.value, inside, _access(outline, port.key.value))

    def port(self, path: str, port: PortSetting) -> Iterator[Occurrence]:
        if path:
            yield Occurrence(port.key.span, Symbol(path, SymbolKind.PORT, port.key.value))

    def tag(self, element: Element, symbol: Symbol) -> Iterator[Occurrence]:
        """The occurrences of a symbol as the name of an element, in its start tag and in its end tag."""
        for span in (element.name_span, element.close_name_span):
            if span is not None and self.document.text[span.start : span.end].endswith(element.name):
                yield Occurrence(Span(span.end - len(element.name), span.end), symbol)

    def plugin(self, name: Name | None) -> tuple[str, MachineOutline | None]:
        return self.system.plugin(name.value) if self.system and name else ("", None)

    def plugin_symbol(self, name: str) -> Symbol:
        """The symbol of the machine with this name. For a plugin without a machine, it contains only the name."""
        path, outline = self.system.plugin(name) if self.system else ("", None)
        if path:
            return Symbol(path, SymbolKind.MACHINE, name)
        return Symbol(self.owner if outline is None else "", SymbolKind.PLUGIN, name)

    def reference(self, value: Name, inside: str, access: Access) -> Iterator[Occurrence]:
        """The occurrence of the variable in a value `{…}`."""
        variable = blackboard_variable(value.value)
        span = None if variable is None else self.inner(value, variable)
        if variable is not None and span is not None:
            symbol = self.trees.variable(self.path, inside, variable)
            yield Occurrence(span, symbol, access is Access.WRITE, access)

    def inner(self, value: Name, variable: str) -> Span | None:
        """The span of the variable in a value, without its `@`; `None` if the value contains no name."""
        name = variable.removeprefix("@")
        if not name or name == "=":
            return None
        decoded = self.document.decoded(value.span)
        start = decoded.text.find(name, decoded.text.find("{"))
        return None if start < 0 else decoded.span(start, start + len(name))

    def scripts(self, node: TreeNode, inside: str) -> Iterator[Occurrence]:
        """The variables in the scripts of a node, and the one that a node such as `SetBlackboard` names."""
        for attribute in script_attributes(node):
            script, _ = parsed(self.document.decoded(attribute.value_span))
            targets: set[int] = set()
            for expr in walk(script):
                if isinstance(expr, Assignment):
                    targets.add(id(expr.target))
                elif not isinstance(expr, Variable):
                    continue
                variable = expr.target if isinstance(expr, Assignment) else expr
                if isinstance(expr, Assignment) or id(expr) not in targets:
                    name = variable.name
                    span = Span(variable.span.start + len(name) - len(name.removeprefix("@")), variable.span.end)
                    access = Access.WRITE if isinstance(expr, Assignment) else Access.READ
                    symbol = self.trees.variable(self.path, inside, name)
                    yield Occurrence(span, symbol, access is Access.WRITE, access)
        known = library_node(node.plugin.value) if node.plugin else None
        port = next((port for port in known.ports if port.names_entry), None) if known else None
        setting = next((s.value for s in node.ports if port is not None and s.key.value == port.name), None)
        if port is not None and setting is not None and is_variable_name(setting.value):
            access = Access.WRITE if port.direction.writes else Access.TEXT
            symbol = self.trees.variable(self.path, inside, setting.value)
            start = setting.span.start + (1 if setting.value.startswith("@") else 0)
            yield Occurrence(Span(start, setting.span.end), symbol, access is Access.WRITE, access)

    # ---------------------------------------------------------------- models

    def model(self, model: NodeModel) -> Iterator[Occurrence]:
        if model.kind in SUBTREES:
            yield from self.tree_name(model.id)
            path, tree = self.trees.trees.get(model.id.value if model.id else "", ("", None))
            for port in model.ports:
                if port.name is not None and tree is not None:
                    symbol = self.trees.variable(path, tree.id.value if tree.id else "", port.name.value)
                    yield Occurrence(port.name.span, symbol)
            return
        if model.id is not None:
            yield Occurrence(model.id.span, self.plugin_symbol(model.id.value), self.trees.is_alone)
        path, _ = self.plugin(model.id)
        for port in model.ports:
            if port.name is not None and path:
                yield Occurrence(port.name.span, Symbol(path, SymbolKind.PORT, port.name.value))

    def defaults(self) -> Iterator[Occurrence]:
        """The variables in defaults of ports. Each is a variable of every tree that does not set the port."""
        for plugin, settings in self.trees.defaults.items():
            own = {key: setting for key, setting in settings.items() if setting.path == self.path}
            users = [
                (path, tree.id.value if tree.id else "", node)
                for path, file in self.trees.files.items()
                for tree in file.trees
                for node in nodes(tree)
                if own and node.plugin and node.plugin.value == plugin
            ]
            for key, setting in own.items():
                variable = blackboard_variable(setting.value.value)
                span = None if variable is None else self.inner(setting.value, variable)
                if variable is not None and span is not None:
                    symbols = (self.trees.variable(p, t, variable) for p, t, n in users if n.element.get(key) is None)
                    for symbol in dict.fromkeys(symbols):
                        yield Occurrence(span, symbol)

    # ------------------------------------------------------------- constants

    def constants(self) -> Iterator[Occurrence]:
        """The topics, services and actions in the values of ports."""
        if self.system is None:
            return
        occurrences: dict[Occurrence, None] = {}
        for automaton in self.system.automata:
            if automaton.instance is None:
                continue
            for use in automaton.outline.interfaces:
                if use.port and isinstance(automaton.port(use.port), PortConstant):
                    setting = self.trees.constant(automaton.instance.number, use.port)
                    if setting is not None and setting.path == self.path:
                        name = _stripped(setting.value)
                        symbol = interface_symbol(self.owner, use.kind, name.value)
                        span = without_slash(name) if symbol.kind is SymbolKind.TOPIC else name.span
                        if span.end > span.start:
                            occurrences[Occurrence(span, symbol)] = None
        yield from occurrences


def _access(outline: MachineOutline | None, key: str) -> Access:
    port = outline.port(key) if outline else None
    if port is None:
        return Access.TEXT
    return Access.WRITE if port.direction is Direction.OUT else Access.READ


def _stripped(name: Name) -> Name:
    lead = len(name.value) - len(name.value.lstrip())
    trail = len(name.value) - len(name.value.rstrip())
    return Name(name.value.strip(), Span(name.span.start + lead, name.span.end - trail))
