# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-port`, which missing_port.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.forest.cpp_types import normal
from roaml.forest.entries import is_autoremapped
from roaml.forest.forest import CPP, is_model_of
from roaml.forest.ports import missing_ports, probable_ports
from roaml.libraries import LIBRARIES, Node, Port, library
from roaml.model.outline import MachineOutline, PortOutline
from roaml.model.system import CHILDREN_COUNT, optional_ports
from roaml.model.tree import TreeNode, nodes
from roaml.regex import regex
from roaml.roles import Direction, NodeKind, SymbolKind
from roaml.rules.rule import Rule, TreeContext, close_names, listing
from roaml.rules.support.forest import forest_of
from roaml.text import Span, TextEdit


def check(context: TreeContext) -> Iterator[Finding]:
    yield from _alone(context) if context.system is None else _of_system(context)


def _of_system(context: TreeContext) -> Iterator[Finding]:
    assert context.system is not None
    defaults = {(plugin, port) for file in context.files for plugin, port, _ in file.defaults}
    for tree in context.file.trees:
        for node in nodes(tree):
            if node.is_subtree or node.plugin is None:
                continue
            path, plugin = context.system.plugin(node.plugin.value)
            if plugin is None:
                continue
            missing = [port for port in _missing_ports(node, plugin, path) if (plugin.name, port.key) not in defaults]
            if missing:
                yield _finding(node, plugin, path, missing)


def _missing_ports(node: TreeNode, plugin: MachineOutline, path: str) -> list[PortOutline]:
    """The ports that a node does not set although they are not optional. Defaults of `<TreeNodesModel>` are not
    considered; ports that are only misspelled are left out."""
    known = set(optional_ports(plugin.name)) if path == "" else set()
    known.add(CHILDREN_COUNT)
    given = {attribute.name for attribute in node.element.attributes} | {setting.key.value for setting in node.ports}
    missing = [port for port in plugin.ports if port.key not in known and port.key not in given]
    # unknown-port reports a port that is only misspelled.
    unknown_keys = [setting.key.value for setting in node.ports if plugin.port(setting.key.value) is None]
    misspelled = {close for name in unknown_keys for close in close_names(name, [port.key for port in missing], 1)}
    return [port for port in missing if port.key not in misspelled]


def _finding(node: TreeNode, plugin: MachineOutline, path: str, missing: list[PortOutline]) -> Finding:
    related = [Related(Symbol(path, SymbolKind.PORT, missing[0].key), "declared here")] if path else []
    types = {port.key: port.type if normal(port.type) in _VALUES else "int" for port in missing}
    types |= {port.key: f"{{{port.key}}}" for port in missing if port.direction is Direction.OUT}
    return _must_be_set(node, f"`{plugin.name}`", types, related=related)


def _must_be_set(
    node: TreeNode,
    owner: str,
    types: Mapping[str, str],
    severity: Severity = Severity.ERROR,
    related: Sequence[Related] = (),
    *,
    preferred: bool = True,
) -> Finding:
    """The finding that ports must be set. `types` contains the type of each port, or a value."""
    assert node.plugin is not None
    ports = "port" if len(types) == 1 else "ports"
    message = f"the {ports} {listing(types)} of {owner} must be set"
    return RULE.at(
        node.plugin.span, message, _adding(node, types, preferred=preferred), severity=severity, related=related
    )


def _adding(node: TreeNode, types: Mapping[str, str], *, preferred: bool) -> Fix:
    end = node.element.attributes[-1].span.end if node.element.attributes else node.element.name_span.end
    new = "".join(f' {name}="{_VALUES.get(normal(type_), _reference(name, type_))}"' for name, type_ in types.items())
    return Fix(
        f"Add the missing {'port' if len(types) == 1 else 'ports'}",
        (TextEdit(Span(end, end), new),),
        preferred=preferred,
    )


_VALUES = {
    **dict.fromkeys(("int8", "int16", "int", "int64", "uint8", "uint16", "unsigned", "uint64"), "1"),
    "double": "0.0",
    "float": "0.0",
    "bool": "true",
    "string": "",
}
"""Type of a port -> a value with which the port can be set."""


def _reference(name: str, type_: str) -> str:
    return type_ if type_.startswith("{") else f"{{{name}}}"


# ------------------------------------------------------------ trees without a system


_OPTIONAL = regex(r"\boptional|\bif (?:it is |this is )?(?:not|un)|\bdefault|\bempty\b", re.I)
"""Matches descriptions of ports that need not be set, although the model gives them no default."""


def _alone(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        known = forest.declaration(node)
        if known is None or (known.kind is NodeKind.SUBTREE and is_autoremapped(node)):
            continue
        if known.library or known.kind is NodeKind.SUBTREE:
            yield from _needed(node, known, known)
        elif not forest.is_partly_described(known):
            of_libraries = [library(name).nodes.get(known.name) for name in LIBRARIES]
            library_node = next((other for other in of_libraries if other and is_model_of(known, other)), None)
            yield from _needed(node, known, library_node) if library_node else _without_value(node, known)


def _needed(node: TreeNode, known: Node, needing: Node) -> Iterator[Finding]:
    """Report the ports that the declaration `needing` requires and that the node does not set."""
    certain = needing.name in CPP.nodes or needing.kind is NodeKind.SUBTREE
    probable = _probable(node, known)
    types = {port.name: _type(port) for port in missing_ports(node, needing) if port.name not in probable}
    if types:
        owner = f"the subtree `{known.name}`" if node.is_subtree else f"`{known.name}`"
        yield _must_be_set(node, owner, types, Severity.ERROR if certain else Severity.WARNING, preferred=False)


def _without_value(node: TreeNode, known: Node) -> Iterator[Finding]:
    """Report the input ports that are not set and have no default, although the node may work without them."""
    ports_of_attributes = probable_ports(node, known)
    if not all(ports_of_attributes.values()):
        return  # unknown-port reports an attribute that may be a misspelling of any port
    probable = _probable(node, known)
    for port in known.ports:
        if port.name in probable or node.element.get(port.name) is not None or _OPTIONAL.search(port.text):
            continue
        if port.direction is Direction.IN and port.default is None:
            message = f"`{port.name}` of `{known.name}` has no value: it is not set, and its model has no default"
            assert node.plugin is not None
            fix = _adding(node, {port.name: _type(port)}, preferred=False)
            yield RULE.at(node.plugin.span, message, fix, severity=Severity.INFORMATION)


def _probable(node: TreeNode, known: Node) -> set[str]:
    """The ports that misspelled attributes are probably intended to set; unknown-port reports these attributes."""
    return {name for names in probable_ports(node, known).values() for name in names}


def _type(port: Port) -> str:
    """The type of a port of which a value can be proposed, otherwise a reference to the blackboard."""
    return (
        port.type
        if port.direction is Direction.IN and normal(port.type) not in ("string", "any")
        else f"{{{port.name}}}"
    )


RULE = Rule("missing-port", Severity.ERROR, "A node or subtree does not set a port that it needs.", tree=check)
