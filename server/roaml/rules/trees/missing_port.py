# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-port`, which missing_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.model.outline import MachineOutline, PortOutline
from roaml.model.system import CHILDREN_COUNT, optional_ports
from roaml.model.tree import TreeNode, nodes
from roaml.roles import Direction, SymbolKind
from roaml.rules.rule import Rule, TreeContext, close_names, listing
from roaml.text import Span, TextEdit

EXAMPLES = {"bool": "true", "string": ""}


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is None:
        return
    defaults = {(plugin, port) for file in context.files for plugin, port, _ in file.defaults}
    for tree in context.file.trees:
        for node in nodes(tree):
            if node.is_subtree or node.plugin is None:
                continue
            path, plugin = context.system.plugin(node.plugin.value)
            if plugin is None:
                continue
            missing = [port for port in missing_ports(node, plugin, path) if (plugin.name, port.key) not in defaults]
            if missing:
                yield _finding(node, plugin, path, missing)


def missing_ports(node: TreeNode, plugin: MachineOutline, path: str) -> list[PortOutline]:
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
    assert node.plugin is not None
    keys = [port.key for port in missing]
    ports = "port" if len(keys) == 1 else "ports"
    message = f"the {ports} {listing(keys)} of `{plugin.name}` must be set"
    related = [Related(Symbol(path, SymbolKind.PORT, keys[0]), "declared here")] if path else []
    end = node.element.attributes[-1].span.end if node.element.attributes else node.element.name_span.end
    new = "".join(f' {port.key}="{_example(port)}"' for port in missing)
    fix = Fix(f"Add the missing {ports}", (TextEdit(Span(end, end), new),))
    return RULE.at(node.plugin.span, message, fix, related=related)


def _example(port: PortOutline) -> str:
    if port.direction is Direction.OUT:
        return f"{{{port.key}}}"
    if port.type.startswith("float"):
        return "0.0"
    return EXAMPLES.get(port.type, "0")


RULE = Rule("missing-port", Severity.ERROR, "A node does not set a port of its plugin.", tree=check)
